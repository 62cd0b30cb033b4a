#version 460
#extension GL_GOOGLE_include_directive : require
// Vertices of a depth map's polygons. Everything follows from the index, so equal indices are equal points.
#include "mccool.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    VolumeConstants constants;
    DepthSurface surface;
};
layout(set = 0, binding = 1) uniform sampler2D map; // border: depth 1

#include "receiver_plane.glsl"

void main()
{
    uint index = uint(gl_VertexIndex);
    vec2 texel = indexTexel(surface.side, index) + 0.5;
    float depth = textureLod(map, texel / float(surface.side), 0.0).x;
    bool nothing = depth >= NOTHING;
    vec3 es = surfacePoint(surface, constants.lightEs, indexPlace(surface.side, index), nothing ? 0.0 : depth);
    vec4 plane = receiverPlane(surface.reach.xyz);
    gl_Position = constants.clipFromEye * (nothing ? extruded(es, constants.lightEs, plane) : vec4(es, 1.0));
}
