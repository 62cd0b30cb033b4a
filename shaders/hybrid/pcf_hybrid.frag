#version 460
// Which pixels a depth map can answer. The four texels whose centres surround the receiver decide where they agree; all
// other pixels go onto the list, and show as lit until their ray says otherwise.
// Source: Beister, Ernst and Stamminger 2005; Morais 2015, 3.4.1. Differs: the four comparisons are counted, not read from a
// filtered value, whose weights may hide one of them.
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
    vec3 fromLight = r.ws - constants.light.positionWs.xyz;
    uint face = cubeFaceOf(fromLight);
    vec3 local = inCubeFace(face, fromLight);
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

// How many of the four texels around the receiver are lit, each compared at its own centre.
float litTexels(Tap tap)
{
    vec2 corner = floor(tap.at - 0.5) + 1.0;
    vec4 receiver = vec4(tapDepth(tap, corner + vec2(-0.5, 0.5)), tapDepth(tap, corner + vec2(0.5, 0.5)),
                         tapDepth(tap, corner + vec2(0.5, -0.5)), tapDepth(tap, corner + vec2(-0.5, -0.5)));
    return dot(vec4(lessThanEqual(min(receiver, vec4(1.0)), mapGather(tap, corner))), vec4(1.0));
}

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.light, constants.map, rayWs);
    float lit = litTexels(tapOf(r));
    bool unanimous = lit == 0.0 || lit == 4.0;
    // A normal guessed from depth is no reason to call a surface turned away.
    bool decided = r.decided && (HAS_NORMALS || r.visibility > 0.0);
    visibility = decided ? r.visibility : unanimous && !r.decided ? 0.25 * lit : 1.0;
    if (!decided && (r.decided || !unanimous)) {
        uint place = atomicAdd(count, 1u);
        uvec2 pixel = uvec2(gl_FragCoord.xy);
        if (place < capacity) pixels[place] = packPixel(pixel.x, pixel.y);
    }
}
