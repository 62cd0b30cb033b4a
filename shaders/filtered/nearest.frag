#version 460
// Visibility of a light without a radius from the nearest texel of its depth map. With MAP_LAYERS the map is the six
// faces around a point light.
#extension GL_GOOGLE_include_directive : require
#include "../shared/map_lookup.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
};
#include "../shared/map_inputs.glsl"
layout(location = 0) out float visibility;

#include "../shared/agreement.glsl"
#include "../shared/filter.glsl"

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float layer;
    vec4 clip = mapClipOf(r, layer);
    Tap tap = tapOf(r, clip, layer);
    visibility = r.decided ? r.visibility : nearestVisibility(tap, tap.at);
}
