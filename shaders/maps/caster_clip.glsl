// Where a caster's vertex falls in a map with straight edges: moved to the zero of the projection first, because a matrix
// with a far translation would round depths near the light away. With a perspective clip z is made of clip w, as that of
// receivers is (mapDepth(), map_look.h).
#ifndef GNOMON_MAPS_CASTER_CLIP_GLSL
#define GNOMON_MAPS_CASTER_CLIP_GLSL
#include "../shared/casters.glsl"

layout(push_constant) uniform Push {
    mat4 clipFromZero;
    vec4 zeroWs; // w: with a perspective its depthConstant, else 0
};

vec4 casterClip()
{
    vec4 clip = clipFromZero * vec4(casterWorldPosition() - zeroWs.xyz, 1.0);
    if (zeroWs.w != 0.0) clip.z = zeroWs.w * clip.w + clipFromZero[3].z;
    return clip;
}
#endif
