// Where a caster's vertex falls in a map with straight edges: moved to the zero of the projection first, because a matrix
// with a far translation would round depths near the light away. With a perspective a depth is 1 - near / w, and clip z
// the near end alone, drawn into a viewport whose depth runs from 1 to 0: a clipper makes z and w of its vertices one by
// one, and of a triangle that ends 1000 m away both would be off by more than a receiver on it may be nearer.
#ifndef GNOMON_MAPS_CASTER_CLIP_GLSL
#define GNOMON_MAPS_CASTER_CLIP_GLSL
#include "casters.glsl"

layout(push_constant) uniform Push {
    mat4 clipFromZero;
    vec4 zeroWs; // w: with a perspective 1, else 0
#ifdef GNOMON_NUMBERED_DRAWS
    uint firstFace; // of the draw
#endif
};

vec4 casterClip()
{
    vec4 clip = clipFromZero * vec4(casterWorldPosition() - zeroWs.xyz, 1.0);
    if (zeroWs.w != 0.0) clip.z = -clipFromZero[3].z;
    return clip;
}
#endif
