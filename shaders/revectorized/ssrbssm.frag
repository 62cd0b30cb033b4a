#version 460
// The answer of revectorized edges, for a filter on the screen.
#extension GL_GOOGLE_include_directive : require
#include "../shared/screen_penumbra.glsl"
#include "revectorize.h"

float hardVisibility(Tap tap) { return revectorizedVisibility(tap, tap.at, hard.x, hard.y); }
