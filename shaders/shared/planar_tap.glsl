// The receiver behind this fragment, and taps in the resolve pass's map (map_texels.glsl) about it.
#ifndef GNOMON_MAPS_PLANAR_TAP_GLSL
#define GNOMON_MAPS_PLANAR_TAP_GLSL
#include "map_receiver.glsl"
#include "map_texels.glsl"
#include "plane_tap.glsl"
#endif
