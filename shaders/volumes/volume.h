// How a silhouette edge becomes a side of a shadow volume, and what the volume shaders are given.
//
// Positions here are relative to the eye, in world axes (suffix Es): the numbers stay small where pixels are small.
#ifndef GNOMON_VOLUMES_VOLUME_H
#define GNOMON_VOLUMES_VOLUME_H
#include "../shared/receiver.h"

GN_SHARED_BEGIN

// One light in one view. std140.
struct VolumeConstants {
    mat4 clipFromEye; // clip = clipFromEye * vec4(positionEs, 1)
    vec4 lightEs;     // xyz metres, w = 1; directional: unit direction in which light travels, w = 0
    vec4 nearLowerEs; // xyz: bounds of the view's near rectangle; w: 1 ends volumes behind the receivers, 0 at infinity
    vec4 nearUpperEs; // w: where a volume has no end, the w of its far corners
    vec4 rangeLowerEs; // xyz: bounds of all that the light can reach
    vec4 rangeUpperEs;
};
GN_SHARED_SIZE(VolumeConstants, 144)

// One caster.
struct VolumePush {
    vec4 rows[3]; // positionEs[i] = dot(rows[i], vec4(positionOs, 1))
    vec4 reach;   // xyz: see extrusionPlane; w: added to clip z, times w
};
GN_SHARED_SIZE(VolumePush, 64)

// What resolve.frag asks of view and light. std140.
struct VolumeResolve {
    ViewConstants view;
    vec4 lightEs;       // xyz metres, w = 1; directional: unit direction towards the light, w = 0
    vec4 cone;          // of reaches(), receiver.h
    vec4 area;          // pixels drawn: x, y, width, height
    float rangeSquared; // square metres; infinite where there is no range
    float shadow;       // visibility where the stencil is not 0
    float turnedAway;   // and on surfaces that face away from the light
    uint tileColumns;   // tiles in a row
};
GN_SHARED_SIZE(VolumeResolve, 240)

// Bounds of the visible receivers, Es: floats as orderedKey, so that integer atomics can widen them.
struct ReceiverBounds {
    uint lower[3];
    uint upper[3];
};
GN_SHARED_SIZE(ReceiverBounds, 24)

GN_SHARED_CONST uint EMPTY_LOWER = 0xffffffffu; // what the bounds start from
GN_SHARED_CONST uint EMPTY_UPPER = 0u;

// Sorts as the floats do.
GN_SHARED_FN uint orderedKey(float value)
{
    uint bits = floatBitsToUint(value);
    return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}
GN_SHARED_FN float fromOrderedKey(uint key)
{
    return uintBitsToFloat((key & 0x80000000u) != 0u ? key & 0x7fffffffu : ~key);
}

// The plane dot(xyz, p) = w at which all sides of one caster end: beyond everything in the box lower..upper, and such
// that the caster's sides are short. xyz = 0: no such plane, the sides go on to infinity.
//
// A plane, not a distance: all far edges then lie beyond the box, where ends at equal distances would leave chords that
// cut into it. Of the six planes of the box those qualify towards which all of the caster's light travels.
//
//   reach  light with a position: least signed distance (metres along each axis) from light to caster, 0 where the
//          caster lies on both sides; directional: the caster's centre
GN_SHARED_FN vec4 extrusionPlane(vec4 light, vec3 reach, vec3 lower, vec3 upper)
{
    vec4 plane = vec4(0.0f, 0.0f, 0.0f, 0.0f);
    float best = 1e30f;
    for (int axis = 0; axis < 3; ++axis) {
        float along = light.w != 0.0f ? reach[axis] : light[axis];
        if (abs(along) < 1e-6f) continue;
        float start = light.w != 0.0f ? light[axis] : reach[axis];
        float end = along > 0.0f ? upper[axis] : lower[axis], side = along > 0.0f ? 1.0f : -1.0f;
        // How far light must travel: multiples of the way to the caster, or metres from its centre.
        float cost = max((end - start) / along, light.w);
        if (cost >= best) continue;
        best = cost;
        // Where the box ends before the caster, up to the caster: never to the other side of the light. Else the box's
        // own end, not start + cost * along, which a light far away rounds to more than the box's margin.
        plane = vec4(0.0f, 0.0f, 0.0f, max(side * end, side * (start + light.w * along)));
        plane[axis] = side;
    }
    return plane;
}

// A point moved along its light ray onto the plane, homogeneous; where there is no plane to infinity, or 1 / plane.w
// times as far as the light is.
GN_SHARED_FN vec4 extruded(vec3 p, vec4 light, vec4 plane)
{
    vec3 ray = light.w != 0.0f ? p - vec3(light) : vec3(light);
    vec3 normal = vec3(plane);
    if (normal == vec3(0.0f, 0.0f, 0.0f)) return vec4(ray + p * plane.w, plane.w);
    float along = max(dot(normal, ray), 0.0f); // below 0 by rounding only
    float rest = plane.w - dot(normal, p);
    return vec4(p * along + ray * rest, along); // (p + ray * rest / along), without the division
}

GN_SHARED_END
#endif
