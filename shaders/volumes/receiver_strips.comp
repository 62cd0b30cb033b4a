#version 460
#extension GL_GOOGLE_include_directive : require
// Depths that volumes are counted against, from the host's, and what every strip of STRIP_COLUMNS x TILE_ROWS pixels
// shows: once per view, whatever the lights.
#include "receiver_tile.h"

layout(local_size_x = 64) in; // STRIP_GROUP

layout(set = 0, binding = 0, std140) uniform Constants {
    ViewConstants view;
    uvec4 area;  // x, y, width, height of the pixels drawn
    uvec4 sizes; // column of the first strip; strips in a row; vec4s in a row of the buffer
};
// The host's depths, four columns each; lifted afterwards.
layout(set = 0, binding = 1, std430) buffer Depths { vec4 depths[]; };
layout(set = 0, binding = 2) uniform sampler2D normalImage;
layout(set = 0, binding = 3, std430) writeonly buffer Strips { ReceiverTile strips[]; };

// Four pixels of a row.
struct Four {
    vec4 depth;
    vec3 normal[STRIP_COLUMNS];
};

Four readRow(ivec2 pixel, uint index, int end)
{
    Four four;
    four.depth = depths[index];
    for (int i = 0; i < int(STRIP_COLUMNS); ++i)
        four.normal[i] = texelFetch(normalImage, ivec2(min(pixel.x + i, end - 1), pixel.y), 0).xyz;
    return four;
}

void main()
{
    uint strip = gl_GlobalInvocationID.x;
    if (strip >= sizes.y) return;
    uint firstRow = gl_WorkGroupID.y * TILE_ROWS;
    uint rows = min(TILE_ROWS, area.w - firstRow);
    ivec2 pixel = ivec2(sizes.x + STRIP_COLUMNS * strip, area.y + firstRow);
    ivec2 ends = ivec2(area.x, area.x + area.z);
    vec3 firstRay = viewRayWs(view, vec2(pixel) + 0.5);
    uint index = uint(pixel.y) * sizes.z + uint(pixel.x) / STRIP_COLUMNS;
    vec3 lower = vec3(1e38), upper = vec3(-1e38), normalLower = vec3(1.0), normalUpper = vec3(-1.0);
    bool gaps = false;
    Four next = readRow(pixel, index, ends.y);
    for (uint row = 0; row < rows; ++row) {
        // A row ahead, so that waiting for it and working on this one overlap.
        Four here = next;
        bool more = row + 1 < rows;
        next = readRow(more ? pixel + ivec2(0, 1) : pixel, more ? index + sizes.z : index, ends.y);
        vec4 lifted = here.depth;
        vec3 ray = firstRay;
        for (int i = 0; i < int(STRIP_COLUMNS); ++i) {
            int x = pixel.x + i;
            bool inside = x >= ends.x && x < ends.y, exists = inside && here.depth[i] != view.skyDepth;
            vec3 receiver = linearDepth(view, here.depth[i]) * ray;
            vec3 normal = here.normal[i];
            lower = min(lower, exists ? receiver : lower);
            upper = max(upper, exists ? receiver : upper);
            normalLower = min(normalLower, exists ? normal : normalLower);
            normalUpper = max(normalUpper, exists ? normal : normalUpper);
            gaps = gaps || (inside && !exists);
            float cosine = view.hasNormals == 0u ? MEAN_LIFT_COSINE : abs(dot(normal, ray));
            lifted[i] = exists ? liftedDepth(view, here.depth[i], cosine) : here.depth[i];
            ray += view.rayDxWs.xyz;
        }
        depths[index] = lifted;
        firstRay += view.rayDyWs.xyz;
        index += sizes.z;
        ++pixel.y;
    }
    strips[gl_WorkGroupID.y * sizes.y + strip] =
        ReceiverTile(vec4(lower, gaps ? 1.0 : 0.0), vec4(upper, 0.0), vec4(normalLower, 0.0), vec4(normalUpper, 0.0));
}
