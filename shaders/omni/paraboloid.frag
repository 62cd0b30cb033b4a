#version 460
// Visibility of a point light from its paraboloids.
#extension GL_GOOGLE_include_directive : require
#include "paraboloid.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    Paraboloid parts[2];
    vec4 firstWs;
};
layout(set = 0, binding = 2) uniform sampler2D depthImage;
layout(set = 0, binding = 3) uniform sampler2D normalImage;
layout(set = 0, binding = 4) uniform sampler2DArray map;
layout(location = 0) noperspective in vec3 rayWs;
layout(location = 0) out float visibility;
layout(constant_id = 1) const bool FILTERED = false;

#include "../shared/map_receiver.glsl"

struct Tap {
    vec2 at;        // the receiver, in texels
    vec3 normal;    // in the axes of the part
    float plane;    // n . (receiver - light), moved towards the light, over the distance of depth 1
    float slack;    // for rounding and snapped vertices
    float layer;
    vec2 centre;    // of the map, on the disc
    float perDisc;  // texels per unit of the disc
};

// Where the texel's own ray meets the receiver's plane.
float tapDepth(Tap tap, vec2 texel)
{
    vec2 disc = (texel - 0.5 * constants.map.side) / tap.perDisc + tap.centre;
    float along = dot(tap.normal, paraboloidDirection(disc));
    // Away from the plane's horizon; past it the ray never meets the plane and nothing can be said: far away.
    return (along < 0.0 ? tap.plane / along : 1.0) - tap.slack;
}
float mapTexel(Tap tap, vec2 texel) { return textureLod(map, vec3(texel / constants.map.side, tap.layer), 0.0).x; }
vec4 mapGather(Tap tap, vec2 corner) { return textureGather(map, vec3(corner / constants.map.side, tap.layer)); }

#include "../shared/filter.glsl"

void main()
{
    MapLookup look = constants.map;
    PlaneReceiver r = fetchPlaneReceiver(constants.view, look, rayWs);
    uint layer = dot(r.fromLight, firstWs.xyz) >= 0.0 ? 0u : 1u;
    Paraboloid part = parts[layer];
    vec3 local = inParaboloid(part, r.fromLight);
    float distance = max(length(local), 1e-20);

    Tap tap;
    tap.normal = inParaboloid(part, r.normalWs);
    tap.plane = min(r.facing + r.offset, 0.001 * r.facing) / look.farWs;
    tap.centre = vec2(part.rightWs.w, part.downWs.w);
    tap.perDisc = part.axisWs.w * 0.5 * look.side;
    tap.at = (paraboloidDisc(local / distance) - tap.centre) * tap.perDisc + 0.5 * look.side;
    // A texel spans at most 2 / perDisc radians, across which a plane at n.l = c recedes by tan / distance.
    float grazing = -r.facing / distance;
    float depthPerTexel = 2.0 * sqrt(max(1.0 - grazing * grazing, 0.0)) / (tap.perDisc * max(grazing, 0.01));
    tap.slack = DEPTH_ROUNDING + SNAP_TEXELS * depthPerTexel * distance / look.farWs;
    tap.layer = float(layer);
    float lit = FILTERED ? boxVisibility(tap, tap.at, look.filterSide) : nearestVisibility(tap, tap.at);
    visibility = r.decided ? r.visibility : lit;
}
