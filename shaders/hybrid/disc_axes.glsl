// The disc that a light's sphere turns towards a receiver: LightDisc of algorithms/hybrid/light_disc.hpp.
#ifndef GNOMON_HYBRID_DISC_AXES_GLSL
#define GNOMON_HYBRID_DISC_AXES_GLSL

mat2x3 discAxes(vec3 towardsLight, float radius)
{
    vec3 size = abs(towardsLight);
    vec3 across = size.x <= size.y && size.x <= size.z ? vec3(1.0, 0.0, 0.0)
                  : size.y <= size.z                  ? vec3(0.0, 1.0, 0.0)
                                                      : vec3(0.0, 0.0, 1.0);
    vec3 y = cross(towardsLight, across);
    vec3 x = cross(y, towardsLight);
    return mat2x3(x * (radius / max(length(x), 1e-30)), y * (radius / max(length(y), 1e-30)));
}
#endif
