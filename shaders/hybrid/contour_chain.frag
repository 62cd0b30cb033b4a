#version 460
// What the map alone says of a pixel: one texel, as shadow_map and cube_map look it up. The chain goes on from there. Bit
// 0 of the byte is 1 where the pixel is lit, as visibility (255 or 0), as a reason (REASON_OUTSIDE, REASON_MAP_LIT) and
// as MAP_UNSURE alike.
#extension GL_GOOGLE_include_directive : require
#include "reasons.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    uint reasons;
};
#include "../shared/map_inputs.glsl"
layout(location = 0) out float visibility;

#include "../shared/agreement.glsl"
#include "../shared/filter.glsl"
#include "decided.glsl"

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float layer;
    vec4 clip = mapClipOf(r, layer);
    Tap tap = tapOf(r, clip, layer);
    float lit = nearestVisibility(tap, tap.at);
    bool unsure = lit > 0.0 && mapTexel(tap, floor(tap.at) + 0.5) <= 0.0; // who is nearer is lost before the near end
    if (r.decided)
        visibility = decidedAs(r.visibility, r.visibility > 0.0 ? REASON_OUTSIDE : REASON_BACKFACING);
    else if (unsure)
        visibility = float(MAP_UNSURE) / 255.0;
    else
        visibility = decidedAs(lit, lit > 0.0 ? REASON_MAP_LIT : REASON_MAP_SHADOW);
}
