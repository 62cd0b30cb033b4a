#version 460
// Visibility of a directional light from the finest of its maps that a receiver lies in.
#extension GL_GOOGLE_include_directive : require
#define MAP_LAYERS 1
#include "cascades.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    vec4 parts[MAX_CASCADES];
    uint count;
    float lastLayer;
    float border;
};
#include "../shared/map_inputs.glsl"
layout(location = 0) out float visibility;
layout(constant_id = 1) const bool FILTERED = false;

#include "../shared/planar_tap.glsl"
#define CASCADE_PART(i) parts[i]
#include "cascade_tap.glsl"
#include "../shared/filter.glsl"

void main()
{
    MapLookup look = constants.map;
    PlaneReceiver r = fetchPlaneReceiver(constants.view, look, rayWs);
    vec4 clip = receiverClip(look, r, rayClip);
    CascadeTaps taps = cascadeTaps(look, r, clip, count, lastLayer, border);
    float lit;
    if (FILTERED) {
        lit = boxVisibility(taps.fine, taps.fine.at, look.filterSide);
        if (taps.coarseShare > 0.0)
            lit = mix(lit, boxVisibility(taps.coarse, taps.coarse.at, look.filterSide), taps.coarseShare);
    } else {
        lit = nearestVisibility(taps.fine, taps.fine.at);
    }
    visibility = r.decided ? r.visibility : lit;
}
