#version 460
// Visibility of a directional or spot light from its depth map.
#extension GL_GOOGLE_include_directive : require
#include "../shared/map_lookup.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
layout(set = 0, binding = 4) uniform sampler2D map; // border: depth 1
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 1) noperspective in vec4 rayClip;
layout(location = 0) out float visibility;
layout(constant_id = 1) const bool FILTERED = false;

#include "../shared/planar_tap.glsl"
#include "../shared/filter.glsl"
#include "../shared/kernels.glsl"

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    vec4 clip = receiverClip(constants.map, r, rayClip);
    Tap tap = matrixTap(constants.map, r, clip);
    float lit = FILTERED ? kernelVisibility(tap, tap.at, constants.map.filterSide, constants.map.kernel)
                          : nearestVisibility(tap, tap.at);
    visibility = r.decided ? r.visibility : lit;
}
