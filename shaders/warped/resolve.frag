#version 460
// Visibility from a light's warped map, or of a point light's six (CUBE) or two paraboloids (DISCS). A texel shows what lies at its source place:
// there the receiver's plane is compared, wherever in the texel the receiver is.
#extension GL_GOOGLE_include_directive : require
#include "warped.glsl"

layout(set = 0, binding = 0, std140) uniform Constants { WarpConstants warp; };
#define MAP_LAYERS
#include "../shared/map_inputs.glsl"
layout(location = 0) out float visibility;
layout(constant_id = 1) const bool CUBE = false;
layout(constant_id = 2) const bool DISCS = false;

#include "../shared/planar_tap.glsl"
#include "../shared/cube_tap.glsl"
#include "../shared/paraboloid_tap.glsl"

Tap tapOf(MapLookup look, PlaneReceiver r)
{
    if (CUBE) {
        uint face = cubeFaceOf(r.fromLight);
        return faceTap(look, r, cubeClip(look, r.fromLight, face), face);
    }
    return matrixTap(look, r, receiverClip(look, r, rayClip));
}

// Whether a layer shows what is looked up at a place, 0..1. Beside the map of a directional light there is no caster. A
// layer without a map holds no receiver.
bool isShown(uint layer, vec2 at)
{
    return hasWarpMap(warp, layer) && min(at.x, at.y) >= 0.0 && max(at.x, at.y) < 1.0;
}

bool isLit(uint layer, uvec2 texel, float receiver)
{
    return min(receiver, 1.0) <= texelFetch(map, ivec3(texel, layer), 0).x;
}

bool litByDisc(MapLookup look, PlaneReceiver r)
{
    uint layer = dot(r.fromLight, warp.firstWs.xyz) >= 0.0 ? 0u : 1u;
    DiscTap tap = discTap(look, warp.discs[layer], r, float(layer));
    vec2 at = tap.at / look.side;
    if (!isShown(layer, at)) return true;
    uvec2 texel = texelAt(layer, at, look.side);
    return isLit(layer, texel, tapDepth(tap, texelPlace(layer, texel, look.side)));
}

bool litByMap(MapLookup look, PlaneReceiver r)
{
    Tap tap = tapOf(look, r);
    uint layer = uint(tap.layer);
    vec2 at = tap.at * tap.inverseSide;
    if (!isShown(layer, at)) return true;
    uvec2 texel = texelAt(layer, at, look.side);
    return isLit(layer, texel, tapDepth(tap, texelPlace(layer, texel, look.side)));
}

void main()
{
    MapLookup look = warp.base.map;
    PlaneReceiver r = fetchPlaneReceiver(warp.base.view, look, rayWs);
    if (r.decided) {
        visibility = r.visibility;
        return;
    }
    visibility = (DISCS ? litByDisc(look, r) : litByMap(look, r)) ? 1.0 : 0.0;
}
