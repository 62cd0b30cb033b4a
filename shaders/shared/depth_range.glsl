// Looks into the pyramid of depth_bounds.h. The includer declares, before:
//   bounds[]   its storage buffer of vec2
#include "depth_bounds.h"

vec2 boundsAt(uint index) { return bounds[min(index, uint(bounds.length()) - 1u)]; }

// Where a layer begins.
uint boundsOfLayer(uint side, uint layer)
{
    uint squares = 0u;
    for (uint level = 0u; level < BOUNDS_LEVELS && side > 1u; ++level) { // bound: BOUNDS_LEVELS
        side = boundsSide(side);
        squares += side * side;
    }
    return layer * squares;
}

// Nearest and farthest depth of a layer of `side` texels.
vec2 rangeOfLayer(uint side, uint layer) { return boundsAt(boundsOfLayer(side, layer + 1u) - 1u); }

// And of a square of it, or of a little more: at most 3 x 3 squares of one level, or 5 x 5 of half the size with `fine`.
vec2 rangeAround(uint side, uint layer, vec2 middle, float halfWidth, bool fine)
{
    float least = fine ? 0.5 * halfWidth : halfWidth;
    uint first = boundsOfLayer(side, layer), row = boundsSide(side);
    float square = float(BOUNDS_STEP);
    for (uint level = 1u; level < BOUNDS_LEVELS && row > 1u && square < least; ++level) { // bound: BOUNDS_LEVELS
        first += row * row;
        row = boundsSide(row);
        square *= float(BOUNDS_STEP);
    }
    vec2 low = clamp(floor((middle - halfWidth) / square), vec2(0.0), vec2(row - 1u));
    vec2 high = clamp(floor((middle + halfWidth) / square), vec2(0.0), vec2(row - 1u));
    vec2 range = vec2(1.0, 0.0);
    for (int y = 0; y < 5 && low.y + float(y) <= high.y; ++y) { // bound: 5
        for (int x = 0; x < 5 && low.x + float(x) <= high.x; ++x) { // bound: 5
            uvec2 at = min(uvec2(low) + uvec2(x, y), uvec2(row - 1u));
            vec2 part = boundsAt(first + at.y * row + at.x);
            range = vec2(min(range.x, part.x), max(range.y, part.y));
        }
    }
    return range;
}
