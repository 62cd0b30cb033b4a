// Where a light shines, shadows aside.
#ifndef GNOMON_SHARED_REACH_H
#define GNOMON_SHARED_REACH_H
#include "types.h"

GN_SHARED_BEGIN

// Whether a light reaches what lies at `fromLight` of it: range and cone. By squares: no root per pixel.
//   cone  xyz: unit axis, the way light travels; w: cosine of the half angle times its absolute value; below -1 every
//         direction passes
GN_SHARED_FN bool reaches(vec3 fromLight, vec4 cone, float rangeSquared)
{
    float square = dot(fromLight, fromLight);
    float along = dot(fromLight, GN_XYZ(cone));
    return square <= rangeSquared && along * abs(along) >= cone.w * square;
}

GN_SHARED_END
#endif
