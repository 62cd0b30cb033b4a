// How much of a light arrives where nothing blocks it: 0 where it does not reach.
#ifndef GNOMON_DEMO_ATTENUATION_GLSL
#define GNOMON_DEMO_ATTENUATION_GLSL

// Falls smoothly to zero at the range; inside, no inverse square, so that intensity means what it says in scene files.
float attenuation(DemoLight light, vec3 fromLight, vec3 towardsLight)
{
    if (light.type == LIGHT_DIRECTIONAL) return 1.0;
    float reach = light.colour.w > 0.0 ? min(length(fromLight) / light.colour.w, 1.0) : 0.0;
    float window = 1.0 - reach * reach;
    float cone = light.type == LIGHT_SPOT
                     ? smoothstep(light.direction.w, light.cosInner, -dot(towardsLight, light.direction.xyz))
                     : 1.0;
    return window * window * cone;
}
#endif
