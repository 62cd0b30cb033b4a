#version 460
// Depth by the rasteriser; the geometric normal of the triangle by its number. The normal turns with the side that is
// seen, so that both sides of a sheet receive light from where they face.
#extension GL_GOOGLE_include_directive : require
#include "alpha.h"
#include "frame.glsl"

layout(constant_id = 0) const bool kAlphaTested = false;

layout(location = 0) flat in uint instanceIndex;
layout(location = 1) in vec3 alphaPosition;
layout(location = 0) out vec4 normalAndInstance;

void main()
{
    if (kAlphaTested && alphaOpacity(alphaPosition) < 0.5) discard;
    vec3 n = triangleNormals[instances[instanceIndex].firstTriangle + gl_PrimitiveID].xyz;
    vec3 normal = vec3(dot(instances[instanceIndex].cofactors[0].xyz, n),
                       dot(instances[instanceIndex].cofactors[1].xyz, n),
                       dot(instances[instanceIndex].cofactors[2].xyz, n));
    normalAndInstance = vec4(normalize(gl_FrontFacing ? normal : -normal), instanceAsHalf(instanceIndex));
}
