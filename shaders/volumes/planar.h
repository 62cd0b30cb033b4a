// Projected shadows: the plane that receives them, and how a caster's vertex falls onto it.
//
// Positions are relative to the eye, in world axes (suffix Es). The plane is dot(normal, p) = 1; the eye is never on
// it.
#ifndef GNOMON_VOLUMES_PLANAR_H
#define GNOMON_VOLUMES_PLANAR_H
#include "../shared/tile_plane.h"
#include "volume.h"

GN_SHARED_BEGIN

// What the choice of a plane depends on. std140.
struct PlaneChoice {
    ViewConstants view;
    vec4 lightEs; // xyz metres, w = 1; directional: unit direction towards the light, w = 0
    vec4 cone;    // of reaches(), receiver.h
    vec4 middle;  // xy: pixel at the middle of the area, zw: its first pixel
    uvec4 grid;   // tiles in x, in y, in all
    float rangeSquared;
    float padding0;
    float padding1;
    float padding2;
};
GN_SHARED_SIZE(PlaneChoice, 256)

// The plane that was chosen.
struct ReceiverPlane {
    vec4 normal; // w: 1 found, 0 no plane
};

// One view and light. std140.
struct PlanarConstants {
    mat4 clipFromEye;
    vec4 lightEs; // as in PlaneChoice
};
GN_SHARED_SIZE(PlanarConstants, 80)

struct PlanarPush {
    vec4 rows[3]; // positionEs[i] = dot(rows[i], vec4(positionOs, 1))
};
GN_SHARED_SIZE(PlanarPush, 48)

// Where a caster's vertex falls.
struct Fallen {
    vec4 positionEs; // homogeneous, on the plane
    float above;     // > 0: the vertex lies on the light's side of the plane and can cast
    float below;     // > 0: and not beyond the light
};

// Distances from the plane are measured in multiples of the eye's. A caster must be above it by 2^-16 of what its place
// is made of: the plane's own surface is a caster too, and rounding (2^-23, some ten times) must not make it one.
GN_SHARED_FN Fallen fallen(vec3 p, vec3 normal, vec4 lightEs)
{
    float side = dot(normal, p) - 1.0f;
    float lightSide = dot(normal, vec3(lightEs)) - lightEs.w;
    float height = abs(lightSide);
    float distance = lightSide > 0.0f ? side : -side;
    Fallen result;
    // On the ray from the light through p: p + (p - light) distance / (height - distance).
    result.positionEs = vec4(p * height - vec3(lightEs) * distance, height - lightEs.w * distance);
    result.above = distance - (length(normal) * length(p) + 1.0f) / 65536.0f;
    result.below = height - lightEs.w * distance;
    return result;
}

GN_SHARED_END
#endif
