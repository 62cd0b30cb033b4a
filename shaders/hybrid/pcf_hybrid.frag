#version 460
// Which pixels a depth map can answer. The four texels whose centres surround the receiver decide where they agree; all
// other pixels go onto the list, and show as lit until their ray says otherwise.
// Source: Beister, Ernst and Stamminger 2005; Morais 2015, 3.4.1. Differs: the four comparisons are counted, not read from a
// filtered value, whose weights may hide one of them; and a comparison closer than depths are exact does not count.
#extension GL_GOOGLE_include_directive : require
#include "pcf_hybrid.h"
#ifdef MAP_LAYERS
#include "../omni/cube.h"
#endif

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    uint capacity;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
#ifdef MAP_LAYERS
layout(set = 0, binding = 4) uniform sampler2DArray map;
#else
layout(set = 0, binding = 4) uniform sampler2D map; // border: depth 1, past the map nothing casts
#endif
layout(set = 0, binding = 5, std430) buffer List {
    uint count;
    uint pixels[];
};
layout(location = 0) in vec3 rayWs;
layout(location = 1) in vec4 rayClip;
layout(location = 0) out float visibility;

#include "../maps/planar_tap.glsl"

#ifdef MAP_LAYERS
Tap tapOf(PlaneReceiver r)
{
    MapLook look = constants.map;
    uint face = cubeFaceOf(r.fromLight);
    vec3 local = inCubeFace(face, r.fromLight);
    vec3 normal = inCubeFace(face, r.normalWs);
    vec2 texels = (local.xy / look.slope + local.z) * (0.5 * look.side);
    vec4 clip = vec4(texels, look.depthConstant * local.z + look.depthScale, local.z);
    return planarTap(look, r, clip, normal.xy * (2.0 * look.slope / look.side), float(face));
}
#else
Tap tapOf(PlaneReceiver r)
{
    MapLook look = constants.map;
    vec4 clip = look.clipOfEye + r.w * rayClip;
    vec2 normalPerTexel = vec2(dot(r.normalWs, look.texelDx.xyz), dot(r.normalWs, look.texelDy.xyz));
    return planarTap(look, r, clip, normalPerTexel, 0.0);
}
#endif

// What the four texels around the receiver say, each compared at its own centre: 1 all lit, 0 all in shadow, otherwise
// something between. A texel within the slack of rounding and snapping on either side says neither.
float verdict(Tap tap)
{
    float slack = DEPTH_ROUNDING + SNAP_TEXELS * (abs(tap.depthPerTexel.x) + abs(tap.depthPerTexel.y));
    vec2 corner = floor(tap.at - 0.5) + 1.0;
    vec4 nearest = vec4(tapDepth(tap, corner + vec2(-0.5, 0.5)), tapDepth(tap, corner + vec2(0.5, 0.5)),
                        tapDepth(tap, corner + vec2(0.5, -0.5)), tapDepth(tap, corner + vec2(-0.5, -0.5)));
    vec4 texels = mapGather(tap, corner);
    bool lit = all(lessThanEqual(min(nearest + 2.0 * slack, vec4(1.0)), texels));
    bool dark = all(greaterThan(min(nearest, vec4(1.0)), texels));
    return lit ? 1.0 : dark ? 0.0 : 0.5;
}

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float lit = verdict(tapOf(r));
    // A normal guessed from depth is no reason to call a surface turned away.
    bool decided = r.decided && (HAS_NORMALS || r.visibility > 0.0);
    bool certain = decided || (!r.decided && lit != 0.5);
    visibility = decided ? r.visibility : certain ? lit : 1.0;
    if (!certain) {
        uint place = atomicAdd(count, 1u);
        uvec2 pixel = uvec2(gl_FragCoord.xy);
        if (place < capacity) pixels[place] = packPixel(pixel.x, pixel.y);
    }
}
