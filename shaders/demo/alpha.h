// The pattern of alpha-tested casters: round holes on a grid. One formula for the depth pass, for the shadow maps the
// host draws and for the opacity callback of rays.
#ifndef GNOMON_DEMO_ALPHA_H
#define GNOMON_DEMO_ALPHA_H
#include "../shared/types.h"
#ifdef __cplusplus
#include <glm/vec3.hpp>
#endif

GN_SHARED_BEGIN

GN_SHARED_CONST float HOLE_SPACING = 0.25f; // metres, in the object's xy plane
GN_SHARED_CONST float HOLE_RADIUS = 0.08f;

// 1 where the caster is solid, 0 in a hole.
GN_SHARED_FN float alphaOpacity(vec3 positionOs)
{
    vec2 cell = vec2(positionOs.x, positionOs.y) / HOLE_SPACING;
    vec2 fromCentre = (cell - floor(cell) - vec2(0.5f)) * HOLE_SPACING;
    return dot(fromCentre, fromCentre) < HOLE_RADIUS * HOLE_RADIUS ? 0.0f : 1.0f;
}

GN_SHARED_END
#endif
