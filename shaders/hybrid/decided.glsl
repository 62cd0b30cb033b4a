// What a pass writes for a pixel that needs no ray. The includer declares `reasons` of `HybridConstants`.
#ifndef GNOMON_HYBRID_DECIDED_GLSL
#define GNOMON_HYBRID_DECIDED_GLSL
#include "ray_list.h"

float decidedAs(float visibility, uint reason) { return reasons == 0u ? visibility : float(reason) / 255.0; }
#endif
