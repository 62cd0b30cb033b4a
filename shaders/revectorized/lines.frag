#version 460
// Visibility from the depth map of a light, its edges revectorized. With MAP_LAYERS the map is the six faces around a
// point light.
#extension GL_GOOGLE_include_directive : require
#include "lines.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    uint mode;
    uint longest;
};
#include "../shared/map_inputs.glsl"
layout(location = 0) out float visibility;
layout(constant_id = 1) const bool FILTERED = false; // mode REVECTORIZE_KERNEL

#include "../shared/agreement.glsl"
#include "../shared/filter.glsl"
#include "line_kernel.h"

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float layer;
    vec4 clip = mapClipOf(r, layer);
    Tap tap = tapOf(r, clip, layer);
    visibility = r.visibility;
    if (!r.decided)
        visibility = FILTERED
                         ? lineKernelVisibility(tap, tap.at, boxKernel(uint(constants.map.filterSide)), longest)
                         : revectorizedVisibility(tap, tap.at, mode, longest);
}
