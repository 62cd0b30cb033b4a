// The vote of the texels around a receiver, each compared at its own centre on the receiver's plane. For the includer:
// planar_tap.glsl.
#ifndef GNOMON_MAPS_VERDICT_GLSL
#define GNOMON_MAPS_VERDICT_GLSL
#include "planar_tap.glsl"

// What the (2 + 2 * widen)^2 texels around the receiver say: 1 all lit, 0 all in shadow, 0.5 they disagree. A texel
// within the slack of rounding and snapping on either side says neither. One of depth 0 holds a caster at or before the
// near end, which may lie on either side of a receiver there: it never says lit.
float verdict(Tap tap, int widen)
{
    float slack = DEPTH_ROUNDING + SNAP_TEXELS * (abs(tap.depthPerTexel.x) + abs(tap.depthPerTexel.y));
    vec2 centre = floor(tap.at - 0.5) + 1.0;
    bool lit = true, dark = true;
    widen = clamp(widen, 0, MAX_WIDEN);
    for (int y = -widen; y <= widen; y += 2) {     // bound: MAX_WIDEN
        for (int x = -widen; x <= widen; x += 2) { // bound: MAX_WIDEN
            vec2 corner = centre + vec2(x, y);
            vec4 nearest = vec4(tapDepth(tap, corner + vec2(-0.5, 0.5)), tapDepth(tap, corner + vec2(0.5, 0.5)),
                                tapDepth(tap, corner + vec2(0.5, -0.5)), tapDepth(tap, corner + vec2(-0.5, -0.5)));
            vec4 texels = mapGather(tap, corner);
            lit = lit && all(lessThanEqual(clamp(nearest + 2.0 * slack, vec4(DEPTH_ROUNDING), vec4(1.0)), texels));
            dark = dark && all(greaterThan(min(nearest, vec4(1.0)), texels));
        }
    }
    return lit ? 1.0 : dark ? 0.0 : 0.5;
}
#endif
