#version 460
// Two bones: vertices are blended between them along y. One invocation a vertex.
layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    vec4 lower[3]; // rows of the bone at the bottom
    vec4 upper[3]; // and of the one at the top
    float bottom, top;
    uint count;
};
layout(std430, set = 0, binding = 0) readonly buffer Bind { float bind[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Skinned { float skinned[]; };

void main()
{
    uint vertex = gl_GlobalInvocationID.x;
    if (vertex >= count) return;
    vec4 p = vec4(bind[3 * vertex], bind[3 * vertex + 1], bind[3 * vertex + 2], 1.0);
    float weight = smoothstep(bottom, top, p.y);
    for (uint row = 0; row < 3; ++row)
        skinned[3 * vertex + row] = dot(mix(lower[row], upper[row], weight), p);
}
