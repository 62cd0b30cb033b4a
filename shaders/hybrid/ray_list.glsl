// For fragment shaders that decide pixels by a map and put the rest onto the list that is traced. The includer declares
// `HybridConstants`' members as `constants`, `capacity` and `reasons`.
#ifndef GNOMON_HYBRID_RAY_LIST_GLSL
#define GNOMON_HYBRID_RAY_LIST_GLSL
#include "decided.glsl"

layout(set = 0, binding = 5, std430) buffer List {
    uint count;
    uint pixels[];
};

// Puts the pixel onto the list. @return what it shows until its ray says otherwise: lit.
float undecided()
{
    uint place = atomicAdd(count, 1u);
    uvec2 pixel = uvec2(gl_FragCoord.xy);
    if (place < capacity) pixels[place] = packPixel(pixel.x, pixel.y);
    return decidedAs(1.0, REASON_RT_LIT);
}
#endif
