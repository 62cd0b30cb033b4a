#version 460
// Casters into a depth map.
#extension GL_GOOGLE_include_directive : require
#include "caster_clip.glsl"

void main() { gl_Position = casterClip(); }
