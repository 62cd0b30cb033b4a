#version 460
// Which pixels a depth map can answer. The four texels whose centres surround the receiver decide where they agree; all
// other pixels are left to their rays.
// Source: Beister, Ernst and Stamminger 2005; Morais 2015, 3.4.1. Differs: the four comparisons are counted, not read from a
// filtered value, whose weights may hide one of them; and a comparison closer than depths are exact does not count.
#extension GL_GOOGLE_include_directive : require
#include "reasons.h"

layout(set = 0, binding = 0, std140) uniform Constants {
    MapConstants constants;
    uint reasons;
};
#include "../shared/map_inputs.glsl"
layout(location = 0) out float visibility;

#include "../shared/agreement.glsl"
#include "decided.glsl"

void main()
{
    PlaneReceiver r = fetchPlaneReceiver(constants.view, constants.map, rayWs);
    float layer;
    vec4 clip = mapClipOf(r, layer);
    float lit = verdict(tapOf(r, clip, layer), 0);
    // A normal guessed from depth is no reason to call a surface turned away.
    if (r.decided && (HAS_NORMALS || r.visibility > 0.0))
        visibility = decidedAs(r.visibility, r.visibility > 0.0 ? REASON_OUTSIDE : REASON_BACKFACING);
    else if (!r.decided && lit != 0.5)
        visibility = decidedAs(lit, lit > 0.5 ? REASON_TC_LIT : REASON_TC_SHADOW);
    else
        visibility = undecided();
}
