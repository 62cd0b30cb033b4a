#version 460
// One shadow ray a pixel, traced by the device: of all pixels, or of those that a map left open (undecided.vert).
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

#include "asked_ray.glsl"

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    LightRay ray;
    uint asked = askedAt(constants.view, constants.light, constants.area, pixel, texelFetch(depthImage, pixel, 0).x, ray);
    bool dark = asked == ASKED_RAY ? isOccluded(ray, constants.lightMask.x) : asked == ASKED_DARK;
    visibility = float(dark ? constants.lightMask.z : constants.lightMask.y) / 255.0;
}
