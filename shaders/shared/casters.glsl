// Casters for any method: object space to world through the frame's table of transforms. A caster vertex shader
// includes this, calls casterWorldPosition() and projects the result in its own way.
#ifndef GNOMON_SHARED_CASTERS_GLSL
#define GNOMON_SHARED_CASTERS_GLSL

// Three rows of (basis row, translation) per caster; runtime/scene/scene_registry.hpp InstanceTransform.
layout(std430, set = 0, binding = 1) readonly buffer Transforms { vec4 transformRows[]; };
layout(location = 0) in vec3 casterPosition;

vec3 casterWorldPosition()
{
    uint row = gl_InstanceIndex * 3; // gl_InstanceIndex starts at the draw's firstInstance in Vulkan
    vec4 p = vec4(casterPosition, 1.0);
    return vec3(dot(transformRows[row], p), dot(transformRows[row + 1], p), dot(transformRows[row + 2], p));
}
#endif
