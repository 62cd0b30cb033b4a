// Points spread evenly over a disc, any number of them. GLSL and HLSL.
// Source: H. Vogel, "A better way to construct the sunflower head", Mathematical Biosciences 44, 1979.
#ifndef GNOMON_SHARED_DISC_POINTS_GLSL
#define GNOMON_SHARED_DISC_POINTS_GLSL
#include "types.h"

GN_SHARED_CONST float GOLDEN_COS = -0.73736887, GOLDEN_SIN = 0.67549029; // of the golden angle, 2.39996323 radians

// Direction of the first point, turned from pixel to pixel so that neighbours see other points.
// Source: J. Jimenez, "Next generation post processing in Call of Duty: Advanced Warfare", SIGGRAPH 2014.
vec2 firstDirection(vec2 pixel)
{
    float along = dot(pixel, vec2(0.06711056, 0.00583715)); // HLSL has no fract()
    float turns = 52.9829189 * (along - floor(along));
    float angle = 6.2831853 * (turns - floor(turns));
    return vec2(cos(angle), sin(angle));
}

vec2 nextDirection(vec2 direction)
{
    return vec2(GOLDEN_COS * direction.x - GOLDEN_SIN * direction.y, GOLDEN_SIN * direction.x + GOLDEN_COS * direction.y);
}

// Distance of point i of n from the centre, in radii.
float pointRadius(float i, float n) { return sqrt((i + 0.5) / n); }
#endif
