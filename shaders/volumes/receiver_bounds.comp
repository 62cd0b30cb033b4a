#version 460
#extension GL_GOOGLE_include_directive : require
// Bounds of everything the camera sees, from the depth image as a buffer: once per view, whatever the lights. With
// STRIPS also those of every invocation's own strip of pixels, for receiver_tiles.comp.
#include "cull.h"

layout(local_size_x = 64) in; // BOUNDS_COLUMNS

layout(set = 0, binding = 0, std140) uniform Constants {
    ViewConstants view;
    uvec4 area;  // x, y, width, height of the pixels drawn
    uint stride; // pixels in a row of the buffer
};
layout(set = 0, binding = 1, std430) readonly buffer Depths { float depths[]; };
layout(set = 0, binding = 2, std430) coherent buffer Bounds { ReceiverBounds bounds; };
#ifdef STRIPS
layout(set = 0, binding = 3, std430) writeonly buffer Strips { ReceiverBox strips[]; };
#endif

// Reading first keeps most invocations off the atomics; an outdated value only makes one more of them try.
void widen(vec3 lower, vec3 upper)
{
    for (int axis = 0; axis < 3; ++axis) {
        uint low = orderedKey(lower[axis]), high = orderedKey(upper[axis]);
        if (low < bounds.lower[axis]) atomicMin(bounds.lower[axis], low);
        if (high > bounds.upper[axis]) atomicMax(bounds.upper[axis], high);
    }
}

void main()
{
    uint column = gl_GlobalInvocationID.x;
    if (column >= area.z) return;
    uint firstRow = gl_WorkGroupID.y * BOUNDS_ROWS;
    uint lastRow = min(firstRow + BOUNDS_ROWS, area.w);
    vec2 pixel = vec2(area.xy + uvec2(column, firstRow)) + 0.5;
    vec3 ray = viewRayWs(view, pixel);
    uint index = (area.y + firstRow) * stride + area.x + column;
    vec3 lower = vec3(1e38), upper = vec3(-1e38);
    for (uint row = firstRow; row < lastRow; ++row) {
        float depth = depths[index];
        vec3 receiver = linearDepth(view, depth) * ray;
        bool exists = depth != view.skyDepth;
        lower = min(lower, exists ? receiver : lower);
        upper = max(upper, exists ? receiver : upper);
        ray += view.rayDyWs.xyz;
        index += stride;
    }
    if (lower.x <= upper.x) widen(lower, upper);
#ifdef STRIPS
    strips[gl_WorkGroupID.y * area.z + column] = ReceiverBox(vec4(lower, 0.0), vec4(upper, 0.0));
#endif
}
