// What a pixel asks of a light, as Receivers::at() has it (algorithms/shared/receivers.cpp). The includer declares
// `normalImage` (binding 3) and HAS_NORMALS, and what seen_normal.glsl wants.
#ifndef GNOMON_HYBRID_ASKED_RAY_GLSL
#define GNOMON_HYBRID_ASKED_RAY_GLSL
#include "../shared/device_rays.h"
#include "../shared/device_rays.glsl"
#include "../shared/seen_normal.glsl"

const uint ASKED_LIT = 0u;  // there is nothing, or the light does not reach it
const uint ASKED_DARK = 1u; // it faces away
const uint ASKED_RAY = 2u;

// ray  towards the light's centre; of ASKED_RAY alone
uint askedAt(ViewConstants view, LightConstants light, vec4 area, ivec2 pixel, float depth, out LightRay ray)
{
    ray = LightRay(vec3(0.0), vec3(0.0), 0.0);
    if (depth == view.skyDepth) return ASKED_LIT;
    vec3 viewRay = receiverRayWs(view, viewRayWs(view, vec2(pixel) + 0.5), depth);
    vec3 receiverWs = view.eyeWs.xyz + linearDepth(view, depth) * viewRay;
    if (!lightReaches(light, receiverWs)) return ASKED_LIT;

    vec3 looking = lookingWs(view, viewRay);
    vec3 normalWs = looking / length(looking), away; // without normals: the longest offset there is
    if (HAS_NORMALS) {
        vec3 texel = texelFetch(normalImage, pixel, 0).xyz;
        normalWs = texel / max(length(texel), 1e-20);
        away = normalWs;
        if (!(dot(normalWs, towardsLightWs(light, receiverWs)) > 0.0)) return ASKED_DARK;
    } else {
        away = startDirectionWs(seenNormal(view, area, pixel, depth, viewRay), normalWs);
    }
    float offset = receiverOffset(view, light, depth, viewRay, receiverWs, normalWs);
    ray = lightRay(light, receiverWs, away, offset, FARTHEST);
    return ASKED_RAY;
}
#endif
