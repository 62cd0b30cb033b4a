#version 460
#extension GL_GOOGLE_include_directive : require
// One triangle over the area, or none: the near rectangle is capped only if a texel about it lies before it, or if the
// receivers are asked.
#include "mccool.h"

layout(set = 0, binding = 0, std140) uniform Constants { CapConstants constants; };
layout(set = 0, binding = 3) uniform sampler2D map; // border: depth 1
layout(set = 0, binding = 4, std430) readonly buffer Polygons { uint command[]; };
layout(location = 0) noperspective out vec3 rayWs;
layout(location = 1) noperspective out vec4 rayClip;

bool wanted()
{
    if (constants.always != 0.0 || constants.receivers != 0.0 || command[1] == 0u) return true;
    vec2 first = constants.nearTexels.xy, size = max(constants.nearTexels.zw - first + 1.0, vec2(0.0));
    uint columns = max(uint(size.x), 1u), count = min(uint(size.x * size.y), MAX_NEAR_TEXELS);
    bool before = false;
    for (uint i = 0u; i < count && !before; ++i) { // bound: MAX_NEAR_TEXELS
        vec2 texel = first + vec2(i % columns, i / columns);
        before = textureLod(map, (texel + 0.5) / float(constants.surface.side), 0.0).x < constants.nearDepth;
    }
    return before;
}

void main()
{
    vec2 corner = vec2((gl_VertexIndex << 1) & 2, gl_VertexIndex & 2);
    vec4 area = constants.base.map.area;
    rayWs = viewRayWs(constants.base.view, area.xy + corner * area.zw);
    rayClip = constants.base.map.clipFromRay * vec4(rayWs, 0.0);
    gl_Position = wanted() ? vec4(corner * 2.0 - 1.0, 0.0, 1.0) : vec4(2.0, 2.0, 0.0, 1.0);
}
