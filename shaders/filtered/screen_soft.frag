#version 460
// The nearest texel's answer, for a filter on the screen.
#extension GL_GOOGLE_include_directive : require
#include "../shared/screen_penumbra.glsl"

float hardVisibility(Tap tap) { return nearestVisibility(tap, tap.at); }
