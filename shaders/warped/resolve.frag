#version 460
// Visibility from a light's warped map, or (CUBE) the six of a point light. A texel shows what lies at its source place:
// there the receiver's plane is compared, wherever in the texel the receiver is.
#extension GL_GOOGLE_include_directive : require
#include "warped.glsl"

layout(set = 0, binding = 0, std140) uniform Constants { WarpConstants warp; };
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
layout(set = 0, binding = 4) uniform sampler2DArray map;
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 1) noperspective in vec4 rayClip;
layout(location = 0) out float visibility;
layout(constant_id = 1) const bool CUBE = false;

#define MAP_LAYERS
#include "../shared/planar_tap.glsl"
#include "../shared/cube_tap.glsl"

Tap tapOf(MapLookup look, PlaneReceiver r)
{
    if (CUBE) {
        uint face = cubeFaceOf(r.fromLight);
        return faceTap(look, r, cubeClip(look, r.fromLight, face), face);
    }
    return matrixTap(look, r, receiverClip(look, r, rayClip));
}

void main()
{
    MapLookup look = warp.base.map;
    PlaneReceiver r = fetchPlaneReceiver(warp.base.view, look, rayWs);
    Tap tap = tapOf(look, r);
    uint layer = uint(tap.layer);
    vec2 at = tap.at * tap.inverseSide;
    // Beside the map of a directional light there is no caster. A face without a map holds no receiver.
    bool beside = !hasWarpMap(warp, layer) || !(min(at.x, at.y) >= 0.0 && max(at.x, at.y) < 1.0);
    uvec2 texel = min(uvec2(warped(layer, at, look.side) * look.side), uvec2(look.side - 1.0));
    float receiver = min(tapDepth(tap, placeOf(layer, texel, look.side)), 1.0);
    bool lit = beside || receiver <= texelFetch(map, ivec3(texel, layer), 0).x;
    visibility = r.decided ? r.visibility : lit ? 1.0 : 0.0;
}
