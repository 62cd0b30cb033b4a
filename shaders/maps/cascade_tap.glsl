// The tap in the finest of a directional light's maps that a receiver lies in. GLSL and HLSL. The includer defines
// CASCADE_PART(i), CascadesConstants::parts.
#ifndef GNOMON_MAPS_CASCADE_TAP_GLSL
#define GNOMON_MAPS_CASCADE_TAP_GLSL
#include "../shared/plane_tap.glsl"
#include "../shared/shadow_sample.h"

// look, clip: of the finest map. count, lastLayer, border: CascadesConstants.
Tap cascadeTap(MapLookup look, PlaneReceiver r, vec4 clip, uint count, float lastLayer, float border)
{
    vec2 normalPerTexel = vec2(dot(r.normalWs, look.texelDx.xyz), dot(r.normalWs, look.texelDy.xyz));
    PlanarDepth plane = planeOf(look, r, clip, normalPerTexel);
    // The last map is all casters': beside it nothing is in shadow.
    uint last = clamp(count, 1u, MAX_SAMPLE_PARTS) - 1u;
    vec4 part = CASCADE_PART(last);
    float layer = lastLayer;
    for (uint i = last; i > 0u; --i) { // bound: MAX_SAMPLE_PARTS
        vec4 finer = CASCADE_PART(i - 1u);
        vec2 at = clip.xy * finer.xy + finer.zw;
        bool inside = min(at.x, at.y) >= border && max(at.x, at.y) <= look.side - border;
        part = inside ? finer : part;
        layer = inside ? float(i - 1u) : layer;
    }
    plane.perTexel /= part.xy;
    return tapAt(look, plane, clip.xy * part.xy + part.zw, layer);
}
#endif
