#version 460
layout(local_size_x = 64) in;
layout(set = 0, binding = 0) uniform Block { uint count; };
layout(set = 0, binding = 1) readonly buffer Input { uint items[]; };
layout(set = 0, binding = 2) buffer Output { uint used; uint kept[]; };
layout(set = 0, binding = 4, r32ui) uniform uimage2D marks;
layout(push_constant) uniform Push { uint threshold; };
void main()
{
    if (items[gl_GlobalInvocationID.x] > threshold) return;
    kept[atomicAdd(used, 1u)] = count;
    imageAtomicMax(marks, ivec2(gl_LocalInvocationID.xy), 1u);
}
