#version 460
// Visibility of a point light from its paraboloids.
#extension GL_GOOGLE_include_directive : require
#include "../shared/map_lookup.h"
#include "../shared/paraboloid.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    Paraboloid parts[2];
    vec4 firstWs;
};
#define MAP_LAYERS
#include "../shared/map_inputs.glsl"
layout(location = 0) out float visibility;
layout(constant_id = 1) const bool FILTERED = false;

#include "../shared/map_receiver.glsl"
#include "../shared/map_texels.glsl"
#include "../shared/paraboloid_tap.glsl"

void main()
{
    MapLookup look = constants.map;
    PlaneReceiver r = fetchPlaneReceiver(constants.view, look, rayWs);
    uint layer = dot(r.fromLight, firstWs.xyz) >= 0.0 ? 0u : 1u;
    DiscTap tap = discTap(look, parts[layer], r, float(layer));
    float lit = FILTERED ? boxVisibility(tap, tap.at, look.filterSide) : nearestVisibility(tap, tap.at);
    visibility = r.decided ? r.visibility : lit;
}
