#version 460
// Where the map is believed it is the answer; elsewhere the stencil gets its mask, and volumes will be counted there.
// Source: Chan and Durand 2004, 4. Differs: comparisons are counted one by one (maps/agreement.glsl), and their computation
// mask is the stencil's top bit, set where the depth test fails: certain pixels write depth 1, which always passes
// against what the host drew, silhouette pixels depth 0. Depth itself is not written.
#extension GL_GOOGLE_include_directive : require
#include "chan_durand.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    int widen;
};
#include "../shared/map_inputs.glsl"
layout(set = 0, binding = 5, std430) buffer Cells { uint cells[]; };
layout(location = 0) out float visibility;

layout(constant_id = 1) const bool WIDENED = false; // a loop without known end takes a third longer for 2 x 2

#include "../shared/agreement.glsl"

void mark(vec4 clip, float layer)
{
    vec2 place = clip.xy / clip.w;
    uvec2 cell = uvec2(clamp(place * (float(CELLS) / constants.map.side), vec2(0.0), vec2(float(CELLS - 1u))));
    uint index = (uint(layer) * CELLS + cell.y) * CELLS + cell.x, key = depthKey(mapDepth(constants.map, clip));
    // Reading first keeps most pixels off the atomics; an outdated value only makes one more of them try.
    if (cells[index] < key) atomicMax(cells[index], key);
}

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float layer;
    vec4 clip = mapClipOf(r, layer);
    float lit = verdict(tapOf(r, clip, layer), WIDENED ? widen : 0);
    // A normal guessed from depth is no reason to call a surface turned away.
    bool decided = r.decided && (HAS_NORMALS || r.visibility > 0.0);
    bool certain = decided || (!r.decided && lit != 0.5);
    visibility = decided ? r.visibility : lit;
    gl_FragDepth = certain ? 1.0 : 0.0;
    if (!certain) mark(clip, layer);
}
