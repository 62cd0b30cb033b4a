// Paraboloids around a point light (Brabec, Annen and Seidel 2002; Navratil 2015, 3.3.2 and 4.1): the stereographic image
// of directions, of which a map shows a square. Two back to back, one cut to a cone and two skewed ones differ in their
// numbers alone.
#ifndef GNOMON_SHARED_PARABOLOID_H
#define GNOMON_SHARED_PARABOLOID_H
#include "types.h"

GN_SHARED_BEGIN

// How a layer of a map shows directions. A unit direction v in the axes is projected to the disc point
// v.xy / (1 + v.z), and that to the map, -1 to 1, as (disc - centre) * scale.
struct Paraboloid {
    vec4 rightWs; // xyz: axes of the projection, unit; right x down = axis, so nothing is mirrored; w: centre x
    vec4 downWs;  // w: centre y
    vec4 axisWs;  // w: scale
    vec4 poleWs;  // xyz: middle of the hemisphere that the layer holds, unit
};
GN_SHARED_SIZE(Paraboloid, 64)

// A vector in the axes of the projection.
GN_SHARED_FN vec3 inParaboloid(Paraboloid p, vec3 v)
{
    return vec3(dot(GN_XYZ(p.rightWs), v), dot(GN_XYZ(p.downWs), v), dot(GN_XYZ(p.axisWs), v));
}

// Point of the disc for a direction of unit length in the axes: radius tan(angle / 2), 1 at a right angle.
GN_SHARED_FN vec2 paraboloidDisc(vec3 unitLocal)
{
    float scale = 1.0f / (1.0f + unitLocal.z);
    return vec2(unitLocal.x * scale, unitLocal.y * scale);
}

// The direction behind a point of the disc, unit length, in the axes.
GN_SHARED_FN vec3 paraboloidDirection(vec2 disc)
{
    float r2 = disc.x * disc.x + disc.y * disc.y;
    float scale = 1.0f / (1.0f + r2);
    return vec3(2.0f * disc.x * scale, 2.0f * disc.y * scale, (1.0f - r2) * scale);
}

// From the disc to the map, and back.
GN_SHARED_FN vec2 paraboloidMap(Paraboloid p, vec2 disc) { return (disc - vec2(p.rightWs.w, p.downWs.w)) * p.axisWs.w; }
GN_SHARED_FN vec2 paraboloidOfMap(Paraboloid p, vec2 at) { return at / p.axisWs.w + vec2(p.rightWs.w, p.downWs.w); }

GN_SHARED_END
#endif
