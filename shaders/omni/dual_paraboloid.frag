#version 460
// Visibility of a point light from its two paraboloids.
#extension GL_GOOGLE_include_directive : require
#include "../shared/map_lookup.h"
#include "paraboloid.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
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
    vec3 normal;    // in the half's axes
    float plane;    // n . (receiver - light), moved towards the light, over the distance of depth 1
    float slack;    // for rounding and snapped vertices
    float layer;
};

// Where the texel's own ray meets the receiver's plane.
float tapDepth(Tap tap, vec2 texel)
{
    vec2 disc = (texel - 0.5 * constants.map.side) / constants.map.slope;
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
    uint hemi = paraboloidHalfOf(r.fromLight);
    vec3 local = inParaboloid(hemi, r.fromLight);
    float distance = max(length(local), 1e-20);

    Tap tap;
    tap.normal = inParaboloid(hemi, r.normalWs);
    tap.plane = min(r.facing + r.offset, 0.001 * r.facing) / look.farWs;
    tap.at = paraboloidDisc(local / distance) * look.slope + 0.5 * look.side;
    // A texel of the disc spans at most 2 / slope radians, across which a plane at n.l = c recedes by tan / distance.
    float grazing = -r.facing / distance;
    float depthPerTexel = 2.0 * sqrt(max(1.0 - grazing * grazing, 0.0)) / (look.slope * max(grazing, 0.01));
    tap.slack = DEPTH_ROUNDING + SNAP_TEXELS * depthPerTexel * distance / look.farWs;
    tap.layer = float(hemi);
    float lit = FILTERED ? boxVisibility(tap, tap.at, look.filterSide) : nearestVisibility(tap, tap.at);
    visibility = r.decided ? r.visibility : lit;
}
