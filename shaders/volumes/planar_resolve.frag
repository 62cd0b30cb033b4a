#version 460
#extension GL_GOOGLE_include_directive : require
// Where the flattened casters' word counts: on the plane. Blended as colour + what is there * alpha.
#include "planar.h"

layout(set = 0, binding = 0, std140) uniform Constants { VolumeResolve resolve; };
layout(set = 0, binding = 1) uniform sampler2D depthImage;
layout(set = 0, binding = 2) uniform sampler2D normalImage;
layout(set = 0, binding = 3, std430) readonly buffer Plane { ReceiverPlane plane; };
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 0) out vec4 visibility;

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(depthImage, pixel, 0).x;
    float w = linearDepth(resolve.view, depth);
    vec3 receiver = w * rayWs;
    vec3 toLight = resolve.lightEs.xyz - resolve.lightEs.w * receiver;
    bool reached = depth != resolve.view.skyDepth && reaches(-toLight, resolve.cone, resolve.rangeSquared);
    bool facing = resolve.view.hasNormals == 0u || dot(texelFetch(normalImage, pixel, 0).xyz, toLight) > 0.0;
    // A shadow on what lies off the plane by a sixteenth of a pixel's footprint is out of place by about as much. Depth
    // values are no better than their last place.
    float tolerance = w * resolve.view.pixelSize / 16.0 + 4.0 * depthUlpWs(resolve.view, depth, rayWs);
    float off = abs(dot(plane.normal.xyz, receiver) - 1.0);
    bool onPlane = plane.normal.w > 0.0 && off <= tolerance * length(plane.normal.xyz);
    visibility = vec4(reached && (!facing || onPlane) ? 0.0 : 1.0, 0.0, 0.0, reached && facing && onPlane ? 1.0 : 0.0);
}
