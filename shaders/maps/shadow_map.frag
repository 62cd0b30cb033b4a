#version 460
// Visibility of a directional or spot light from its depth map.
#extension GL_GOOGLE_include_directive : require
#include "../shared/map_lookup.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
};
#include "../shared/map_inputs.glsl"
layout(location = 0) out float visibility;
#ifdef CROPPED
#include "desired_view.h"
layout(set = 0, binding = 5, std430) readonly buffer View { DesiredView desired; };
#endif
layout(constant_id = 1) const bool FILTERED = false;

#include "../shared/planar_tap.glsl"
#ifdef CROPPED
#include "part_tap.glsl"
#endif
#include "../shared/filter.glsl"
#include "../shared/kernels.glsl"

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    vec4 clip = receiverClip(constants.map, r, rayClip);
#ifdef CROPPED
    vec2 normalPerTexel = vec2(dot(r.normalWs, constants.map.texelDx.xyz), dot(r.normalWs, constants.map.texelDy.xyz));
    PlanarDepth plane = planeOf(constants.map, r, clip, normalPerTexel);
    Tap tap = partTap(constants.map, plane, clip.xy / clip.w, desired.crop, 0.0);
#else
    Tap tap = matrixTap(constants.map, r, clip);
#endif
    float lit = FILTERED ? kernelVisibility(tap, tap.at, constants.map.filterSide, constants.map.kernel)
                          : nearestVisibility(tap, tap.at);
    visibility = r.decided ? r.visibility : lit;
}
