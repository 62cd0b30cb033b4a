// A tap in a map about a part of another one. GLSL and HLSL.
#ifndef GNOMON_MAPS_PART_TAP_GLSL
#define GNOMON_MAPS_PART_TAP_GLSL
#include "../shared/plane_tap.glsl"

// look, plane, at: the receiver in the map at hand. part: texel of the other map = xy * texel of this one + zw.
Tap partTap(MapLookup look, PlanarDepth plane, vec2 at, vec4 part, float layer)
{
    plane.perTexel /= part.xy;
    return tapAt(look, plane, at * part.xy + part.zw, layer);
}
#endif
