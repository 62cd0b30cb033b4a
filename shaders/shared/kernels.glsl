// Kernels of percentage-closer filtering, GLSL and HLSL. The includer includes filter.glsl before. Where pixels have no
// place on a screen it defines NO_DISC_KERNEL: a disc is a box then.
#ifndef NO_DISC_KERNEL
#include "disc_points.glsl"
#endif

// The side^2 texels around the receiver's own, all of one weight: penumbrae in steps of a texel.
float nearestKernel(Tap tap, vec2 at, float side)
{
    vec2 first = floor(at) + 1.0 - 0.5 * side;
    float lit = 0.0;
    for (float y = 0.0; y < side; y += 1.0) // bound: MAX_KERNEL_SIDE
        for (float x = 0.0; x < side; x += 1.0) // bound: MAX_KERNEL_SIDE
            lit += texelLit(tap, first + vec2(x, y)) ? 1.0 : 0.0;
    return lit / (side * side);
}

// Weights fall in a line from the receiver to nothing (side + 1) / 2 texels away. Four texels a gather, as in the box.
float tentKernel(Tap tap, vec2 at, float side)
{
    float reach = 0.5 * (side + 1.0);
    vec2 base = floor(at - 0.5 * side);
    float lit = 0.0;
    for (float y = 0.0; y < side; y += 2.0) { // bound: MAX_KERNEL_SIDE
        for (float x = 0.0; x < side; x += 2.0) { // bound: MAX_KERNEL_SIDE
            vec2 corner = base + vec2(x, y) + 1.0;
            vec2 low = max(reach - abs(corner - 0.5 - at), 0.0), high = max(reach - abs(corner + 0.5 - at), 0.0);
            vec4 receiver = vec4(tapDepth(tap, corner + vec2(-0.5, 0.5)), tapDepth(tap, corner + vec2(0.5, 0.5)),
                                 tapDepth(tap, corner + vec2(0.5, -0.5)), tapDepth(tap, corner + vec2(-0.5, -0.5)));
            vec4 passes = step(min(receiver, 1.0), mapGather(tap, corner));
            lit += dot(passes, vec4(low.x * high.y, high.x * high.y, high.x * low.y, low.x * low.y));
        }
    }
    return lit / (reach * reach * reach * reach);
}

#ifndef NO_DISC_KERNEL
// DISC_TAPS bilinear taps in the disc that touches the box's sides, turned from pixel to pixel.
float discKernel(Tap tap, vec2 at, float side)
{
    vec2 direction = firstDirection(gl_FragCoord.xy);
    float lit = 0.0;
    for (int i = 0; i < DISC_TAPS; ++i) {
        lit += boxVisibility(tap, at + 0.5 * side * pointRadius(float(i), float(DISC_TAPS)) * direction, 1.0);
        direction = nextDirection(direction);
    }
    return lit / float(DISC_TAPS);
}
#endif

float kernelVisibility(Tap tap, vec2 at, float side, float kernel)
{
    side = clamp(side, 1.0, float(MAX_KERNEL_SIDE));
    if (kernel == KERNEL_NEAREST) return nearestKernel(tap, at, side);
    if (kernel == KERNEL_TENT) return tentKernel(tap, at, side);
#ifndef NO_DISC_KERNEL
    if (kernel == KERNEL_DISC) return discKernel(tap, at, side);
#endif
    return boxVisibility(tap, at, side);
}
