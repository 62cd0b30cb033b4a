// The cone from a receiver to a light's disc, narrowed by the nearest and farthest depths around it. The includer
// declares, before: planar_tap.glsl, filter.glsl and
//   DiscCone disc   in its block of constants
//   vec2 bounds[]   a storage buffer, the pyramid of depth_bounds.h
#include "depth_range.glsl"
#include "light_cone.glsl"

// Half width of a square of texels that holds all that taps of a disc of this spread look at.
float searchWidth(LightCone cone, float spread) { return spread * cone.stretch + 2.0; }

// What the range says of all taps: 1 lit, 0 dark, -1 neither.
float decidedBy(LightCone cone, vec2 range, float spread)
{
    float width = searchWidth(cone, spread);
    float change = width * (abs(cone.tap.depthPerTexel.x) + abs(cone.tap.depthPerTexel.y));
    if (min(cone.tap.depth + change, 1.0) <= range.x) return 1.0;
    bool ends = min(cone.tap.at.x, cone.tap.at.y) - width < 0.0 ||
                max(cone.tap.at.x, cone.tap.at.y) + width > 1.0 / cone.tap.inverseSide;
    bool open = ends && cone.inside.x < 0.0; // no caster beyond
    return !open && min(cone.tap.depth - change, 1.0) > range.y ? 0.0 : -1.0;
}

// Narrows the cone to the nearest depth that it holds, which is found in ever smaller squares. Returns the spread.
// decided: decidedBy() the depths there. Source: Guennebaud, Barthe and Paulin 2006, 4.
float narrowedCone(LightCone cone, uint side, uint layer, out float decided)
{
    vec2 range = rangeOfLayer(side, layer);
    float spread = min(spreadAt(cone, range.x), float(side));
    decided = decidedBy(cone, range, spread);
    for (int i = 0; i < 2 && decided < 0.0; ++i) { // bound: 2
        range = rangeAround(side, layer, cone.tap.at, searchWidth(cone, spread), i == 1);
        spread = min(spread, spreadAt(cone, range.x));
        decided = decidedBy(cone, range, spread);
    }
    return spread;
}
