// Taps in a map with straight edges (matrix projection): there the depth of a plane is linear in texels.
// The includer declares `sampler2D map` or, with MAP_LAYERS, `sampler2DArray map` at binding 4.
#ifndef GNOMON_MAPS_PLANAR_TAP_GLSL
#define GNOMON_MAPS_PLANAR_TAP_GLSL
#include "map_receiver.glsl"

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

bool texelExists(Tap tap, vec2 centre)
{
    return min(centre.x, centre.y) > 0.0 && max(centre.x, centre.y) * tap.inverseSide < 1.0;
}

float tapDepth(Tap tap, vec2 texel) { return tap.depth + dot(tap.depthPerTexel, texel - tap.at); }

#ifdef MAP_LAYERS
float mapTexel(Tap tap, vec2 texel) { return textureLod(map, vec3(texel * tap.inverseSide, tap.layer), 0.0).x; }
vec4 mapGather(Tap tap, vec2 corner) { return textureGather(map, vec3(corner * tap.inverseSide, tap.layer)); }
#else
float mapTexel(Tap tap, vec2 texel) { return textureLod(map, texel * tap.inverseSide, 0.0).x; }
vec4 mapGather(Tap tap, vec2 corner) { return textureGather(map, corner * tap.inverseSide); }
#endif
#endif
