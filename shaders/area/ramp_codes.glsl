// Visibility of a point in four bits: 0 hidden, RAMP_CODES seen, between: on a ramp, in 14 steps.
#ifndef GNOMON_AREA_RAMP_CODES_GLSL
#define GNOMON_AREA_RAMP_CODES_GLSL
#include "quads.h"

bool onRamp(uint code) { return code > 0u && code < RAMP_CODES; }

uint codeOf(float visibility)
{
    uint ramp = 1u + uint(clamp(visibility, 0.0, 1.0) * float(RAMP_CODES - 2u) + 0.5);
    return visibility <= 0.0 ? 0u : visibility >= 1.0 ? RAMP_CODES : min(ramp, RAMP_CODES - 1u);
}

float visibilityOf(uint code) { return clamp((float(code) - 1.0) / float(RAMP_CODES - 2u), 0.0, 1.0); }
#endif
