#version 460
#extension GL_GOOGLE_include_directive : require
// Depths that volumes are counted against, from the host's, and what every strip of TILE_COLUMNS x STRIP_ROWS pixels
// shows: once per view, whatever the lights. Strips are wide, since rows of an image lie in pages of their own, which
// no processor reads ahead.
#include "receiver_tile.h"

layout(local_size_x = 64) in; // STRIP_GROUP

layout(set = 0, binding = 0, std140) uniform Constants {
    ViewConstants view;
    uvec4 area;  // x, y, width, height of the pixels drawn
    uvec4 sizes; // column of the first strip; strips in a row, in all; fours in a row of the buffer
};
// The host's depths, four columns each; lifted afterwards.
layout(set = 0, binding = 1, std430) buffer Depths { vec4 depths[]; };
layout(set = 0, binding = 2) uniform sampler2D normalImage;
layout(set = 0, binding = 3, std430) writeonly buffer Strips { ReceiverTile strips[]; };

// Adds the pixels of a row that begin at `pixel`, and lifts their depths.
//   ray     the view ray of the first
//   normal  of the receiver that was added last, before and after
vec4 addFour(ViewConstants here, DepthLift lift, inout ReceiverTile strip, inout vec3 normal, vec4 depth, ivec2 pixel,
             vec3 ray)
{
    int begin = int(area.x), end = int(area.x + area.z);
    vec3 left = ray, right = ray + float(FOUR - 1u) * here.rayDxWs.xyz;
    vec4 lifted = depth;
    vec3 direction = here.rayDepthWs.xyz / max(length(here.rayDepthWs.xyz), 1e-30); // orthographic, else 0
    vec3 normals[FOUR];
    for (int i = 0; i < int(FOUR); ++i) {
        vec3 held = texelFetch(normalImage, ivec2(min(pixel.x + i, end - 1), pixel.y), 0).xyz;
        normals[i] = any(isnan(held)) ? vec3(0.0) : held; // it faces no light; least and greatest pass over NaN
    }
    float least = 1e38, most = -1e38; // of the depth values
    for (int i = 0; i < int(FOUR); ++i) {
        int x = pixel.x + i;
        bool inside = x >= begin && x < end, exists = inside && depth[i] != here.skyDepth;
        least = min(least, exists ? depth[i] : least);
        most = max(most, exists ? depth[i] : most);
        normal = exists ? normals[i] : normal;
        strip.normalLower.xyz = min(strip.normalLower.xyz, normal);
        strip.normalUpper.xyz = max(strip.normalUpper.xyz, normal);
        strip.lower.w = inside && !exists ? 1.0 : strip.lower.w;
        float cosine = here.hasNormals == 0u ? MEAN_LIFT_COSINE : abs(dot(normal, direction == vec3(0.0) ? ray : direction));
        lifted[i] = exists ? liftedDepth(lift, depth[i], cosine) : depth[i];
        ray += here.rayDxWs.xyz;
    }
    // All depths at both ends: a box of four pixels is not smaller by much.
    bool any = least <= most;
    float first = linearDepth(here, least), last = linearDepth(here, most);
    vec3 a = first * receiverRayWs(here, left, least), b = first * receiverRayWs(here, right, least);
    vec3 c = last * receiverRayWs(here, left, most), d = last * receiverRayWs(here, right, most);
    vec3 lower = min(min(a, b), min(c, d)), upper = max(max(a, b), max(c, d));
    strip.lower.xyz = min(strip.lower.xyz, any ? lower : strip.lower.xyz);
    strip.upper.xyz = max(strip.upper.xyz, any ? upper : strip.upper.xyz);
    return lifted;
}

void main()
{
    uint place = gl_GlobalInvocationID.x;
    if (place >= sizes.z) return;
    uint firstRow = place / sizes.y * STRIP_ROWS, rows = min(STRIP_ROWS, area.w - firstRow);
    ivec2 pixel = ivec2(sizes.x + TILE_COLUMNS * (place % sizes.y), area.y + firstRow);
    uint fours = min(TILE_COLUMNS / FOUR, (area.x + area.z - uint(pixel.x) + FOUR - 1u) / FOUR);
    uint first = uint(pixel.y) * sizes.w + uint(pixel.x) / FOUR;
    vec3 firstRay = viewRayWs(view, vec2(pixel) + 0.5);
    ViewConstants here = view; // read once, not again after each store
    DepthLift lift = depthLift(here);
    ReceiverTile strip =
        ReceiverTile(vec4(vec3(1e38), 0.0), vec4(vec3(-1e38), 0.0), vec4(vec3(1.0), 0.0), vec4(vec3(-1.0), 0.0));
    // Where a strip begins with sky, or before the area, this is taken in: its tile may face away for all that is known.
    vec3 normal = vec3(0.0);
    for (uint row = 0; row < rows; ++row) { // bound: STRIP_ROWS
        vec3 ray = firstRay;
        for (uint i = 0; i < fours; ++i) { // bound: TILE_COLUMNS
            depths[first + i] = addFour(here, lift, strip, normal, depths[first + i], pixel + ivec2(FOUR * i, row), ray);
            ray += float(FOUR) * here.rayDxWs.xyz;
        }
        firstRay += here.rayDyWs.xyz;
        first += sizes.w;
    }
    strips[place] = strip;
}
