#version 460
// Visibility of a light from the pages of its virtual map: from the finest that is there of the level that a receiver's
// pixel asks for and those coarser.
#extension GL_GOOGLE_include_directive : require
#define MAP_LAYERS 1
#include "virtual_map.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    vec4 parts[MAX_PAGE_WINDOWS];
    uvec4 windows[MAX_PAGE_WINDOWS];
    uvec4 given[MAX_PAGE_LEVELS];
    uint levels;
    uint slices;
    float footprint;
    float pageTexels;
    float border;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
layout(set = 0, binding = 4) uniform sampler2DArray map; // a page a layer; border: depth 1
layout(set = 0, binding = 5, std430) readonly buffer Table { uint table[]; }; // a page's layer + 1; 0: it is not there
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 1) noperspective in vec4 rayClip;
layout(location = 0) out float visibility;
layout(constant_id = 1) const bool FILTERED = false;
layout(constant_id = 2) const bool CUBE = false;

#include "../shared/planar_tap.glsl"
#include "../shared/cube_clip.glsl"
#include "part_tap.glsl"
#include "../shared/filter.glsl"

struct PagePlace {
    vec4 part;   // texel in the layer = xy * texel of the base + zw
    float layer; // below 0: no page is there
};

PagePlace pageAt(vec2 texel, uint face, uint level)
{
    uint end = min(levels, MAX_PAGE_LEVELS);
    for (uint i = level; i < end; ++i) { // bound: MAX_PAGE_LEVELS
        uint here = face * MAX_PAGE_LEVELS + i;
        vec4 part = parts[here];
        uvec4 window = windows[here];
        vec2 page = floor((texel * part.xy + part.zw) / pageTexels);
        if (!(min(page.x, page.y) >= 0.0 && page.x < float(window.y) && page.y < float(window.z))) continue;
        uint entry = window.x + uint(page.y) * window.y + uint(page.x);
        uint slot = entry < uint(table.length()) ? table[entry] : 0u;
        if (slot != 0u) return PagePlace(vec4(part.xy, part.zw - page * pageTexels + border), float(slot) - 1.0);
    }
    return PagePlace(vec4(1.0, 1.0, 0.0, 0.0), -1.0);
}

// In the base's texels. Rounding does not leave the face: its pages end there.
vec2 placeInBase(MapLookup look, vec4 clip)
{
    vec2 at = clip.xy / clip.w;
    if (!CUBE) return at;
    float middle = 0.5 * look.side, reach = middle / look.slope - 0.0625;
    return clamp(at, middle - reach, middle + reach);
}

void main()
{
    MapLookup look = constants.map;
    PlaneReceiver r = fetchPlaneReceiver(constants.view, look, rayWs);
    uint face = CUBE ? cubeFaceOf(r.fromLight) : 0u;
    vec4 clip = CUBE ? cubeClip(look, r.fromLight, face) : receiverClip(look, r, rayClip);
    vec2 at = placeInBase(look, clip);
    float wide = r.w * footprint / clip.w;
    uint slice = wide >= 2.0 ? uint(findMSB(uint(min(wide, 65536.0)))) : 0u;
    PagePlace place = pageAt(at, face, given[min(slice, clamp(slices, 1u, MAX_PAGE_LEVELS) - 1u)].x);

    vec2 normalPerTexel = CUBE ? inCubeFace(face, r.normalWs).xy * (2.0 * look.slope / look.side)
                               : vec2(dot(r.normalWs, look.texelDx.xyz), dot(r.normalWs, look.texelDy.xyz));
    Tap tap = partTap(look, planeOf(look, r, clip, normalPerTexel), at, place.part, max(place.layer, 0.0));
    tap.at = clamp(tap.at, border + 0.001, look.side - border - 0.001); // rounding does not leave the page
    float lit = FILTERED ? boxVisibility(tap, tap.at, look.filterSide) : nearestVisibility(tap, tap.at);
    visibility = r.decided ? r.visibility : place.layer < 0.0 ? 1.0 : lit;
}
