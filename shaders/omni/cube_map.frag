#version 460
// Visibility of a point light from its six depth maps.
#extension GL_GOOGLE_include_directive : require
#include "../shared/map_lookup.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
};
#define MAP_LAYERS
#include "../shared/map_inputs.glsl"
layout(location = 0) out float visibility;
layout(constant_id = 1) const bool FILTERED = false;

#include "../shared/planar_tap.glsl"
#include "../shared/cube_tap.glsl"
#include "../shared/filter.glsl"
#include "../shared/kernels.glsl"

void main()
{
    MapLookup look = constants.map;
    PlaneReceiver r = fetchPlaneReceiver(constants.view, look, rayWs);
    uint face = cubeFaceOf(r.fromLight);
    Tap tap = faceTap(look, r, cubeClip(look, r.fromLight, face), face);
    float lit = FILTERED ? kernelVisibility(tap, tap.at, look.filterSide, look.kernel)
                          : nearestVisibility(tap, tap.at);
    visibility = r.decided ? r.visibility : lit;
}
