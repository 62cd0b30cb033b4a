#version 460
// Visibility of a point light from its six depth maps.
#extension GL_GOOGLE_include_directive : require
#include "../shared/map_lookup.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
layout(set = 0, binding = 4) uniform sampler2DArray map;
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 0) out float visibility;
layout(constant_id = 1) const bool FILTERED = false;

#define MAP_LAYERS
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
