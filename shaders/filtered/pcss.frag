#version 460
// Visibility of a light's disc from its depth map. With MAP_LAYERS the map is the six faces around a point light.
#extension GL_GOOGLE_include_directive : require
#include "pcss.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    DiscCone disc;
    uint taps;
    uint early;
    uint reasons;
};
layout(std430, set = 0, binding = 1) readonly buffer Bounds { vec2 bounds[]; };
#include "../shared/map_inputs.glsl"
layout(location = 0) out float visibility;

#include "../shared/agreement.glsl"
#include "../shared/filter.glsl"
#include "../shared/blocker_search.glsl"
#include "../shared/disc_visibility.glsl"

float softVisibility(LightCone cone, uint layer, out uint reason)
{
    float decided;
    float spread = narrowedCone(cone, uint(constants.map.side), layer, decided);
    reason = decided == 1.0 ? SOFT_LIT : SOFT_DARK;
    if (early != 0u && decided >= 0.0) return decided;
    vec2 direction = firstDirection(gl_FragCoord.xy);
    Blockers found = blockersIn(cone, spread, direction);
    reason = found.count > 0.0 ? SOFT_FILTERED : SOFT_EMPTY;
    // Half a texel: the edge of a map is not sharper than that.
    return found.count > 0.0 ? discVisibility(cone, max(spreadAt(cone, found.mean), 0.5), direction, taps) : 1.0;
}

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float layer;
    vec4 clip = mapClipOf(r, layer);
    Tap tap = tapOf(r, clip, layer);
    uint reason = SOFT_DECIDED;
    visibility = r.visibility;
    if (!r.decided)
        visibility = softVisibility(lightCone(constants.map, tap, mapDepth(constants.map, clip)), uint(layer), reason) *
                     (HAS_NORMALS ? shareAbove(constants.map, r, disc.radius) : 1.0);
    if (reasons != 0u) visibility = float(reason) / 255.0;
}
