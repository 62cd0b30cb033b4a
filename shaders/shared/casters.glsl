// Casters for any method: object space to world through the frame's table of transforms. A caster vertex shader
// includes this, calls casterWorldPosition() and projects the result in its own way.
//
// The table is a vertex buffer read once per instance: a storage buffer indexed by gl_InstanceIndex is gathered lane by
// lane on some devices (a fifth of a depth pass on lavapipe).
#ifndef GNOMON_SHARED_CASTERS_GLSL
#define GNOMON_SHARED_CASTERS_GLSL

layout(location = 0) in vec3 casterPosition;
layout(location = 1) in vec4 casterRows[3]; // (basis row, translation); runtime/store/scene_registry.hpp InstanceTransform

vec3 casterWorldPosition()
{
    vec4 p = vec4(casterPosition, 1.0);
    return vec3(dot(casterRows[0], p), dot(casterRows[1], p), dot(casterRows[2], p));
}
#endif
