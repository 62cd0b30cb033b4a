// Comparison of a receiver with the texels around it, GLSL and HLSL. The includer declares the receiver type (TAP, if it
// is not called Tap) and these, before:
//   float tapDepth(Tap tap, vec2 texel)   depth of the receiver's plane at a texel's centre
//   float mapTexel(Tap tap, vec2 texel)   the texel there
//   vec4 mapGather(Tap tap, vec2 corner)  the four texels around a corner, in textureGather's order
// Nothing is nearer to the light than depth 1 in a texel without casters, wherever the receiver lies.

#ifndef TAP
#define TAP Tap
#endif

bool texelLit(TAP tap, vec2 centre) { return min(tapDepth(tap, centre), 1.0) <= mapTexel(tap, centre); }

float nearestVisibility(TAP tap, vec2 at) { return texelLit(tap, floor(at) + 0.5) ? 1.0 : 0.0; }

// Percentage-closer filtering (Reeves, Salesin and Cook 1987) over a box of `side` (odd) texels that slides with the
// receiver: (side + 1)^2 texels, those at the border weighted by what of them lies in the box.
float boxVisibility(TAP tap, vec2 at, float side)
{
    side = min(side, float(MAX_KERNEL_SIDE));
    vec2 low = at - 0.5 * side;
    vec2 base = floor(low);
    vec2 part = low - base;
    float lit = 0.0;
    for (float y = 0.0; y < side; y += 2.0) { // bound: MAX_KERNEL_SIDE
        vec2 wy = vec2(y == 0.0 ? 1.0 - part.y : 1.0, y + 1.0 == side ? part.y : 1.0);
        for (float x = 0.0; x < side; x += 2.0) { // bound: MAX_KERNEL_SIDE
            vec2 wx = vec2(x == 0.0 ? 1.0 - part.x : 1.0, x + 1.0 == side ? part.x : 1.0);
            vec2 corner = base + vec2(x, y) + 1.0;
            vec4 receiver = vec4(tapDepth(tap, corner + vec2(-0.5, 0.5)), tapDepth(tap, corner + vec2(0.5, 0.5)),
                                 tapDepth(tap, corner + vec2(0.5, -0.5)), tapDepth(tap, corner + vec2(-0.5, -0.5)));
            vec4 passes = step(min(receiver, 1.0), mapGather(tap, corner));
            lit += dot(passes, vec4(wx.x * wy.y, wx.y * wy.y, wx.y * wy.x, wx.x * wy.x));
        }
    }
    return lit / (side * side);
}
#undef TAP
