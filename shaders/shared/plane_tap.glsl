// Taps in a map with straight edges (matrix projection): there the depth of a plane is linear in texels. GLSL and HLSL.
// The includer defines, for a place in [0, 1]^2 of a layer of the map:
//   MAP_TEXEL(at, layer)   the texel there
//   MAP_GATHER(at, layer)  the four texels around it, in textureGather's order
#ifndef GNOMON_SHARED_PLANE_TAP_GLSL
#define GNOMON_SHARED_PLANE_TAP_GLSL
#include "plane_receiver.glsl"

struct Tap {
    vec2 at;            // the receiver, in texels
    float depth;        // of its plane there, and ...
    vec2 depthPerTexel; // ... how it changes
    float inverseSide;
    float layer;
};

// plane: the receiver's, in the texels of this layer; at: where the receiver is in it.
Tap tapAt(MapLookup look, PlanarDepth plane, vec2 at, float layer)
{
    Tap tap;
    tap.at = at;
    tap.depthPerTexel = plane.perTexel;
    tap.depth = plane.at - DEPTH_ROUNDING - SNAP_TEXELS * (abs(plane.perTexel.x) + abs(plane.perTexel.y));
    tap.inverseSide = 1.0 / look.side;
    tap.layer = layer;
    return tap;
}

// clip: the receiver in the map's clip space, x and y in texels.
PlanarDepth planeOf(MapLookup look, PlaneReceiver r, vec4 clip, vec2 normalPerTexel)
{
    return planarDepth(look, mapDepth(look, clip), 1.0 / clip.w, r.facing, r.offset, normalPerTexel);
}

Tap planarTap(MapLookup look, PlaneReceiver r, vec4 clip, vec2 normalPerTexel, float layer)
{
    return tapAt(look, planeOf(look, r, clip, normalPerTexel), clip.xy / clip.w, layer);
}

// In a map of one projection.
Tap matrixTap(MapLookup look, PlaneReceiver r, vec4 clip)
{
    vec2 normalPerTexel = vec2(dot(r.normalWs, look.texelDx.xyz), dot(r.normalWs, look.texelDy.xyz));
    return planarTap(look, r, clip, normalPerTexel, 0.0);
}

bool texelExists(Tap tap, vec2 centre)
{
    return min(centre.x, centre.y) > 0.0 && max(centre.x, centre.y) * tap.inverseSide < 1.0;
}

float tapDepth(Tap tap, vec2 texel) { return tap.depth + dot(tap.depthPerTexel, texel - tap.at); }

float mapTexel(Tap tap, vec2 texel) { return MAP_TEXEL(texel * tap.inverseSide, tap.layer); }
vec4 mapGather(Tap tap, vec2 corner) { return MAP_GATHER(corner * tap.inverseSide, tap.layer); }
#endif
