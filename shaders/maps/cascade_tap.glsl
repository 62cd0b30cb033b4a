// Taps in the finest of a directional light's maps that a receiver lies in, and in the next. GLSL and HLSL. The
// includer defines CASCADE_PART(i), CascadesConstants::parts.
#ifndef GNOMON_MAPS_CASCADE_TAP_GLSL
#define GNOMON_MAPS_CASCADE_TAP_GLSL
#include "../shared/shadow_sample.h"
#include "part_tap.glsl"

struct CascadeTaps {
    Tap fine;
    Tap coarse;
    float coarseShare; // 0: the finest alone
};

// look, clip: of the finest map; look.slope: texels before a map's edge over which it fades into the next. count,
// lastLayer, border: CascadesConstants.
CascadeTaps cascadeTaps(MapLookup look, PlaneReceiver r, vec4 clip, uint count, float lastLayer, float border)
{
    vec2 normalPerTexel = vec2(dot(r.normalWs, look.texelDx.xyz), dot(r.normalWs, look.texelDy.xyz));
    PlanarDepth plane = planeOf(look, r, clip, normalPerTexel);
    // The last map is all casters': beside it nothing is in shadow.
    uint last = clamp(count, 1u, MAX_SAMPLE_PARTS) - 1u;
    vec4 part = CASCADE_PART(last), coarsePart = part;
    float layer = lastLayer, coarseLayer = lastLayer, room = 1e30;
    for (uint i = last; i > 0u; --i) { // bound: MAX_SAMPLE_PARTS
        vec4 finer = CASCADE_PART(i - 1u);
        vec2 at = clip.xy * finer.xy + finer.zw;
        float toEdge = min(min(at.x, at.y), look.side - max(at.x, at.y)) - border;
        bool inside = toEdge >= 0.0;
        coarsePart = inside ? part : coarsePart;
        coarseLayer = inside ? layer : coarseLayer;
        part = inside ? finer : part;
        layer = inside ? float(i - 1u) : layer;
        room = inside ? toEdge : room;
    }
    CascadeTaps taps;
    taps.fine = partTap(look, plane, clip.xy, part, layer);
    taps.coarse = partTap(look, plane, clip.xy, coarsePart, coarseLayer);
    taps.coarseShare = room < look.slope ? 1.0 - room / look.slope : 0.0;
    return taps;
}
#endif
