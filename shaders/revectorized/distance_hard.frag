#version 460
// The hard shadow that distances are measured in: rbsm's lines through the middles of stairs. With MAP_LAYERS the map is
// the six faces around a point light.
#extension GL_GOOGLE_include_directive : require
#include "distance.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
};
#include "../shared/map_inputs.glsl"
layout(location = 0) out float visibility;
layout(constant_id = 1) const bool HAS_STATES = false; // STATE_* where a caster matters

#include "../shared/agreement.glsl"
#include "../shared/filter.glsl"
#include "revectorize.h"

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float layer;
    vec4 clip = mapClipOf(r, layer);
    Tap tap = tapOf(r, clip, layer);
    float lit = revectorizedVisibility(tap, tap.at, REVECTORIZE_NONCONSERVATIVE, r.decided ? 0u : LONGEST_STAIR);
    visibility = r.decided ? r.visibility : HAS_STATES ? mix(STATE_DARK, STATE_LIT, lit) : lit;
}
