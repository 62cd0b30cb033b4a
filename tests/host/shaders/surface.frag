#version 450
// G-buffer: albedo, and the geometric normal of the side that is seen, since open meshes are drawn from both.
#extension GL_GOOGLE_include_directive : require
#include "frame.h"

layout(location = 0) in vec3 surfaceWs;
layout(location = 1) flat in vec3 surfaceNormalWs;
layout(location = 2) flat in vec3 albedo;
layout(location = 0) out vec4 outAlbedo;
layout(location = 1) out vec4 outNormalWs;

void main()
{
    const bool seenFromBehind = dot(surfaceNormalWs, frame.eye.xyz - surfaceWs) < 0.0;
    outAlbedo = vec4(albedo, 1.0);
    outNormalWs = vec4(seenFromBehind ? -surfaceNormalWs : surfaceNormalWs, 0.0);
}
