#version 460
#extension GL_GOOGLE_include_directive : require
// The cap: fragments where the near plane lies behind the map's surface turn the stencil's bit, others are discarded.
// The surface is the one that is drawn, template by template. Where the polygons did not fit, or would not be counted
// right, the receiver itself is asked, and no polygon is drawn.
#include "mccool.h"

layout(set = 0, binding = 0, std140) uniform Constants { CapConstants constants; };
layout(set = 0, binding = 1) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D map; // border: depth 1
layout(set = 0, binding = 4, std430) readonly buffer Polygons { uint command[]; };
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 1) noperspective in vec4 rayClip;

float texelDepth(vec2 texel) { return textureLod(map, (texel + 0.5) / float(constants.surface.side), 0.0).x; }

bool jumpsBetween(vec2 a, vec2 along, float depthA, float depthB)
{
    return depthJumps(constants.surface, texelDepth(a - along), depthA, depthB, texelDepth(a + 2.0 * along));
}

// Twice the area of the triangle a, b, p.
float side(vec2 a, vec2 b, vec2 p) { return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x); }

// Depth of the surface at a place of the map, in texels; NOWHERE where no caster is.
const float NOWHERE = 1e30;
float surfaceDepth(vec2 at)
{
    vec2 cell = floor(at - 0.5), place = 2.0 * (at - 0.5 - cell);
    const vec2 right = vec2(1.0, 0.0), down = vec2(0.0, 1.0);
    vec4 depths = vec4(texelDepth(cell), texelDepth(cell + right), texelDepth(cell + 1.0), texelDepth(cell + down));
    uint jumps = uint(jumpsBetween(cell, right, depths[0], depths[1])) |
                 (uint(jumpsBetween(cell + right, down, depths[1], depths[2])) << 1) |
                 (uint(jumpsBetween(cell + down, right, depths[3], depths[2])) << 2) |
                 (uint(jumpsBetween(cell, down, depths[0], depths[3])) << 3);
    uint first = templateOf(jumps, depths) * TEMPLATE_TRIANGLES, last = first + min(triangleCountOf(jumps), TEMPLATE_TRIANGLES);
    float found = NOWHERE, margin = -1e30; // the triangle that the place lies in most clearly
    for (uint i = first; i < last; ++i) { // bound: TEMPLATE_TRIANGLES
        uint triangle = constants.templates[i >> 2][i & 3u];
        uint a = vertexOf(triangle, 0u), b = vertexOf(triangle, 1u), c = vertexOf(triangle, 2u);
        float area = side(placeOf(a), placeOf(b), placeOf(c));
        if (area == 0.0) continue; // a wall, seen from the light
        vec3 weights = vec3(side(placeOf(b), placeOf(c), place), side(placeOf(c), placeOf(a), place),
                            side(placeOf(a), placeOf(b), place)) / area;
        float inside = min(weights.x, min(weights.y, weights.z));
        if (inside <= margin) continue;
        margin = inside;
        vec3 corners = vec3(depths[cornerOf(a)], depths[cornerOf(b)], depths[cornerOf(c)]);
        found = any(greaterThanEqual(corners, vec3(NOTHING))) ? NOWHERE : dot(weights, corners);
    }
    return found;
}

void main()
{
    MapLookup look = constants.base.map;
    float w = constants.nearWs, depth = 1.0 - constants.base.view.skyDepth; // of the near plane
    if (constants.receivers != 0.0 || command[1] == 0u) {
        depth = texelFetch(depthImage, ivec2(gl_FragCoord.xy), 0).x;
        if (depth == constants.base.view.skyDepth) discard;
        w = linearDepth(constants.base.view, depth);
    }
    vec4 clip = look.clipOfEye + w * (rayClip + depth * look.clipOfDepth);
    vec2 at = clip.xy / clip.w;
    bool over = clip.w > 0.0 && all(greaterThan(at, vec2(-0.5))) && all(lessThan(at, vec2(look.side + 0.5)));
    if (!over || mapDepth(look, clip) <= surfaceDepth(at)) discard;
}
