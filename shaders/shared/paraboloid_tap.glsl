// Taps in the paraboloids of a point light. GLSL and HLSL; MAP_TEXEL and MAP_GATHER as for plane_tap.glsl.
#ifndef GNOMON_SHARED_PARABOLOID_TAP_GLSL
#define GNOMON_SHARED_PARABOLOID_TAP_GLSL
#include "paraboloid.h"
#include "plane_receiver.glsl"

struct DiscTap {
    vec2 at;       // the receiver, in texels
    vec3 normal;   // in the axes of the part
    float plane;   // n . (receiver - light), moved towards the light, over the distance of depth 1
    float slack;   // for rounding and snapped vertices
    float layer;
    vec2 centre;   // of the map, on the disc
    float perDisc; // texels per unit of the disc
    float side;    // texels
};

DiscTap discTap(MapLookup look, Paraboloid part, PlaneReceiver r, float layer)
{
    vec3 local = inParaboloid(part, r.fromLight);
    float away = max(length(local), 1e-20);

    DiscTap tap;
    tap.normal = inParaboloid(part, r.normalWs);
    tap.plane = min(r.facing + r.offset, 0.001 * r.facing) / look.farWs;
    tap.centre = vec2(part.rightWs.w, part.downWs.w);
    tap.perDisc = part.axisWs.w * 0.5 * look.side;
    tap.at = (paraboloidDisc(local / away) - tap.centre) * tap.perDisc + 0.5 * look.side;
    // A texel spans at most 2 / perDisc radians, across which a plane at n.l = c recedes by tan / distance.
    float grazing = -r.facing / away;
    float depthPerTexel = 2.0 * sqrt(max(1.0 - grazing * grazing, 0.0)) / (tap.perDisc * max(grazing, 0.01));
    tap.slack = DEPTH_ROUNDING + SNAP_TEXELS * depthPerTexel * away / look.farWs;
    tap.layer = layer;
    tap.side = look.side;
    return tap;
}

// Where the texel's own ray meets the receiver's plane.
float tapDepth(DiscTap tap, vec2 texel)
{
    vec2 disc = (texel - 0.5 * tap.side) / tap.perDisc + tap.centre;
    float along = dot(tap.normal, paraboloidDirection(disc));
    // Away from the plane's horizon; past it the ray never meets the plane and nothing can be said: far away.
    return (along < 0.0 ? tap.plane / along : 1.0) - tap.slack;
}
float mapTexel(DiscTap tap, vec2 texel) { return MAP_TEXEL(texel / tap.side, tap.layer); }
vec4 mapGather(DiscTap tap, vec2 corner) { return MAP_GATHER(corner / tap.side, tap.layer); }

#define TAP DiscTap
#include "filter.glsl"
#endif
