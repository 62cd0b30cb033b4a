#version 460
// One triangle over the area; the view ray is linear on the screen.
#extension GL_GOOGLE_include_directive : require
#include "volume.h"

layout(set = 0, binding = 0, std140) uniform Constants { VolumeResolve resolve; };
layout(location = 0) noperspective out vec3 rayWs;

void main()
{
    vec2 corner = vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2);
    rayWs = viewRayWs(resolve.view, resolve.area.xy + corner * resolve.area.zw);
    gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}
