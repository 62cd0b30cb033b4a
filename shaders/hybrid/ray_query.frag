#version 460
// One shadow ray a pixel, traced by the device.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_ray_query : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "ray_query.h"
#include "../shared/device_rays.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    RayQueryConstants constants;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
layout(set = 0, binding = 4) uniform accelerationStructureEXT topLevel;
layout(set = 0, binding = 5, std430) readonly buffer Traced {
    TracedCaster traced[];
};
layout(location = 0) out float visibility;
layout(constant_id = 0) const bool HAS_NORMALS = true;

#include "../shared/device_rays.glsl"
#include "../shared/seen_normal.glsl"

// As Receivers::at() has it (algorithms/shared/receivers.cpp).
float traceReceiver(ViewConstants view, LightConstants light, ivec2 pixel, float depth)
{
    vec3 viewRay = receiverRayWs(view, viewRayWs(view, vec2(pixel) + 0.5), depth);
    vec3 receiverWs = view.eyeWs.xyz + linearDepth(view, depth) * viewRay;
    if (!lightReaches(light, receiverWs)) return 1.0;

    vec3 looking = lookingWs(view, viewRay);
    vec3 normalWs = looking / length(looking), away; // without normals: the longest offset there is
    if (HAS_NORMALS) {
        vec3 texel = texelFetch(normalImage, pixel, 0).xyz;
        normalWs = texel / max(length(texel), 1e-20);
        away = normalWs;
        if (!(dot(normalWs, towardsLightWs(light, receiverWs)) > 0.0)) return 0.0;
    } else {
        away = startDirectionWs(seenNormal(view, constants.area, pixel, depth, viewRay), normalWs);
    }
    float offset = receiverOffset(view, light, depth, viewRay, receiverWs, normalWs);
    return isOccluded(lightRay(light, receiverWs, away, offset, FARTHEST), constants.lightMask.x) ? 0.0 : 1.0;
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(depthImage, pixel, 0).x;
    bool exists = depth != constants.view.skyDepth;
    visibility = exists ? traceReceiver(constants.view, constants.light, pixel, depth) : 1.0;
}
