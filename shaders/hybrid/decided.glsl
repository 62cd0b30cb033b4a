// What a pass writes for a pixel that needs no ray, and for one that does. The includer declares `reasons` of
// `HybridConstants`.
#ifndef GNOMON_HYBRID_DECIDED_GLSL
#define GNOMON_HYBRID_DECIDED_GLSL
#include "reasons.h"

float decidedAs(float visibility, uint reason) { return reasons == 0u ? visibility : float(reason) / 255.0; }
float undecided() { return float(UNDECIDED) / 255.0; }
#endif
