#version 460
// Visibility of a light's disc from its depth map, whose edges are lines where the penumbra is narrow. With MAP_LAYERS
// the map is the six faces around a point light.
#extension GL_GOOGLE_include_directive : require
#include "rbssm.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    DiscCone disc;
    uint taps;
    uint kernel;
    uint longest;
};
layout(std430, set = 0, binding = 1) readonly buffer Bounds { vec2 bounds[]; };
#include "../shared/map_inputs.glsl"
layout(location = 0) out float visibility;

#include "../shared/agreement.glsl"
#include "../shared/filter.glsl"
#include "../shared/blocker_search.glsl"
#include "../shared/disc_visibility.glsl"
#include "line_kernel.h"

// Taps a texel apart spread a line by as much as a disc whose radius is sqrt(1/3) texels; the squares of deviations add
// up. The ramps of lines spread it once more; that stays, since the place of a line is uncertain by about as much.
const float OWN_SPREAD = 1.0 / 3.0;
// At contact too: 0.8 texels had the least errors in room and torus_grid.
const float LEAST_SPREAD = 0.8;

float narrowVisibility(LightCone cone, float spread)
{
    LineKernel discKernel;
    spread = max(spread, LEAST_SPREAD);
    discKernel.radius = sqrt(spread * spread - OWN_SPREAD);
    discKernel.squeeze = cone.tangent / sqrt(cone.stretch * (cone.stretch + 1.0));
    discKernel.side = min(2u * uint(ceil((discKernel.radius + 0.5) * cone.stretch)) - 1u, kernel);
    return lineKernelVisibility(cone.tap, cone.tap.at, discKernel, longest);
}

float softVisibility(LightCone cone, uint layer)
{
    float decided;
    float spread = narrowedCone(cone, uint(constants.map.side), layer, decided);
    if (decided >= 0.0) return decided;
    vec2 direction = firstDirection(gl_FragCoord.xy);
    // Lines differ from their stairs by less than a texel: what is near enough to have one is searched.
    Blockers found = blockersIn(cone, max(spread, 1.5), direction);
    if (found.count == 0.0) return 1.0;
    spread = spreadAt(cone, found.mean);
    return (spread + 0.5) * cone.stretch <= 0.5 * float(kernel) + 0.5 ? narrowVisibility(cone, spread)
                                                                     : discVisibility(cone, spread, direction, taps);
}

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float layer;
    vec4 clip = mapClipOf(r, layer);
    Tap tap = tapOf(r, clip, layer);
    visibility = r.visibility;
    if (!r.decided)
        visibility = softVisibility(lightCone(constants.map, tap, mapDepth(constants.map, clip)), uint(layer)) *
                     (HAS_NORMALS ? shareAbove(constants.map, r, disc.radius) : 1.0);
}
