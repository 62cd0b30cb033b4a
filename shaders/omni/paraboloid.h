// Two paraboloids back to back (Brabec, Annen and Seidel 2002; Navratil 2015, 3.3.2): the stereographic image of the lower
// and of the upper half space around a point light.
#ifndef GNOMON_OMNI_PARABOLOID_H
#define GNOMON_OMNI_PARABOLOID_H
#include "../shared/types.h"

GN_SHARED_BEGIN

// Half 0 looks down (-Y), half 1 up: lights mostly hang above what they are seen to light, so that the upper half can
// often be left out.
GN_SHARED_FN uint paraboloidHalfOf(vec3 v) { return v.y > 0.0f ? 1u : 0u; }

// A vector in the half's axes: right, down, forward; right x down = forward, so nothing is mirrored.
GN_SHARED_FN vec3 inParaboloid(uint hemi, vec3 v)
{
    return hemi == 0u ? vec3(v.x, v.z, -v.y) : vec3(v.x, -v.z, v.y);
}

// Point of the disc for a direction of unit length in the half's axes: radius tan(angle / 2), 1 at the rim.
GN_SHARED_FN vec2 paraboloidDisc(vec3 unitLocal)
{
    float scale = 1.0f / (1.0f + unitLocal.z);
    return vec2(unitLocal.x * scale, unitLocal.y * scale);
}

// The direction behind a point of the disc, unit length, in the half's axes.
GN_SHARED_FN vec3 paraboloidDirection(vec2 disc)
{
    float r2 = disc.x * disc.x + disc.y * disc.y;
    float scale = 1.0f / (1.0f + r2);
    return vec3(2.0f * disc.x * scale, 2.0f * disc.y * scale, (1.0f - r2) * scale);
}

GN_SHARED_END
#endif
