#version 460
// Visibility of a directional or spot light from its warped map. A texel shows what lies at its source place: there the
// receiver's plane is compared, wherever in the texel the receiver is.
#extension GL_GOOGLE_include_directive : require
#include "warped.glsl"

layout(set = 0, binding = 0, std140) uniform Constants { WarpConstants warp; };
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
layout(set = 0, binding = 4) uniform sampler2D map;
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 1) noperspective in vec4 rayClip;
layout(location = 0) out float visibility;

#include "../shared/planar_tap.glsl"

void main()
{
    MapLookup look = warp.base.map;
    PlaneReceiver r = fetchPlaneReceiver(warp.base.view, look, rayWs);
    vec4 clip = receiverClip(look, r, rayClip);
    vec2 normalPerTexel = vec2(dot(r.normalWs, look.texelDx.xyz), dot(r.normalWs, look.texelDy.xyz));
    Tap tap = planarTap(look, r, clip, normalPerTexel, 0.0);
    vec2 at = tap.at * tap.inverseSide;
    // Beside the map of a directional light there is no caster.
    bool beside = !(min(at.x, at.y) >= 0.0 && max(at.x, at.y) < 1.0);
    uvec2 texel = min(uvec2(warped(at) * look.side), uvec2(look.side - 1.0));
    float receiver = min(tapDepth(tap, placeOf(texel, look.side)), 1.0);
    bool lit = beside || receiver <= texelFetch(map, ivec2(texel), 0).x;
    visibility = r.decided ? r.visibility : lit ? 1.0 : 0.0;
}
