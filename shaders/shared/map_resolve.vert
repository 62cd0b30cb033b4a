#version 460
// One triangle over the area. The view ray is linear on the screen, in world space and in the map's clip space alike, so
// both are interpolated: a look-up then costs a multiply-add where a matrix would cost a third of it.
#extension GL_GOOGLE_include_directive : require
#include "map_lookup.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
};
layout(location = 0) noperspective out vec3 rayWs;
layout(location = 1) noperspective out vec4 rayClip;

void main()
{
    vec2 corner = vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2);
    rayWs = viewRayWs(constants.view, constants.map.area.xy + corner * constants.map.area.zw);
    rayClip = constants.map.clipFromRay * vec4(rayWs, 0.0);
    gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}
