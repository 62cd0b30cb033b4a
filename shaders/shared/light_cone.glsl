// The cone from a receiver to a light's disc as the light's depth map shows it, and what in it hides the disc. GLSL and
// HLSL. The includer declares, before: plane_tap.glsl, filter.glsl and
//   DiscCone disc   such as in its block of constants
#ifndef GNOMON_SHARED_LIGHT_CONE_GLSL
#define GNOMON_SHARED_LIGHT_CONE_GLSL
#include "blocker_search.h"
#include "disc_points.glsl"
#include "horizon.glsl"

// The cone from a receiver to the light's disc, as the map shows it. At a depth nearer to the light by D it is an
// ellipse of texels about the receiver's own place: reach D wide across, and longer along the line to the map's middle,
// since the disc faces the receiver and the map does not.
struct LightCone {
    Tap tap;
    float own;    // depth of the receiver
    vec2 tangent; // place of the receiver in the map, width over distance; directional: 0
    float stretch;
    vec2 inside; // least and greatest coordinates of taps: a map with a perspective ends, others go on without casters
};

LightCone lightCone(MapLookup look, Tap tap, float own)
{
    LightCone cone;
    cone.tap = tap;
    cone.own = own;
    cone.tangent = (tap.at - 0.5 * look.side) * disc.tangentPerTexel;
    cone.stretch = sqrt(1.0 + dot(cone.tangent, cone.tangent));
    bool ends = look.positional != 0.0;
    cone.inside = vec2(ends ? 1.0 : -1e30, ends ? look.side - 1.0 : 1e30);
    return cone;
}

// Half width of the disc at a depth, texels.
float spreadAt(LightCone cone, float depth) { return max(disc.reach * (cone.own - depth), 0.0); }

// Where a point of the unit disc appears that is `spread` texels wide.
vec2 placeOf(LightCone cone, vec2 inDisc, float spread)
{
    vec2 longer = inDisc + cone.tangent * (dot(cone.tangent, inDisc) / (cone.stretch + 1.0));
    return clamp(cone.tap.at + spread * longer, vec2(cone.inside.x, cone.inside.x), vec2(cone.inside.y, cone.inside.y));
}

struct Blockers {
    float mean;  // depth; with none 0
    float count;
    float open;  // texels from the middle to the nearest tap that is none
};

// Adds the depth of a texel that lies before the receiver's plane, and in the cone: what lies beside it, such as a wall
// next to the receiver, hides nothing of the disc. mean: the sum as yet.
void addBlocker(LightCone cone, vec2 place, float fromMiddle, inout Blockers found)
{
    vec2 texel = floor(place) + 0.5;
    float depth = mapTexel(cone.tap, texel);
    bool blocks = min(tapDepth(cone.tap, texel), 1.0) > depth && fromMiddle <= spreadAt(cone, depth) + 1.0;
    found.mean += blocks ? depth : 0.0;
    found.count += blocks ? 1.0 : 0.0;
    found.open = blocks ? found.open : min(found.open, fromMiddle);
}

Blockers blockersIn(LightCone cone, float spread, vec2 direction)
{
    Blockers found;
    found.mean = found.count = 0.0;
    found.open = 1e30;
    addBlocker(cone, cone.tap.at, 0.0, found);
    for (int i = 0; i < SEARCH_TAPS; ++i) {
        float radius = pointRadius(float(i), float(SEARCH_TAPS));
        addBlocker(cone, placeOf(cone, radius * direction, spread), radius * spread, found);
        direction = nextDirection(direction);
    }
    found.mean /= max(found.count, 1.0);
    return found;
}
#endif
