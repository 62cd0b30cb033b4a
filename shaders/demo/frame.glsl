// Set 0 of every shader of the demo's renderer.
#ifndef GNOMON_DEMO_FRAME_GLSL
#define GNOMON_DEMO_FRAME_GLSL
#extension GL_GOOGLE_include_directive : require
#include "frame.h"

layout(std430, set = 0, binding = 0) readonly buffer View { DemoView view; };
layout(std430, set = 0, binding = 1) readonly buffer Instances { DemoInstance instances[]; };
layout(std430, set = 0, binding = 2) readonly buffer Normals { vec4 triangleNormals[]; }; // object space, unit

float instanceAsHalf(uint instance) { return unpackHalf2x16(FIRST_INSTANCE_HALF + instance).x; }
uint instanceOfHalf(float value) { return packHalf2x16(vec2(value, 0.0)) - FIRST_INSTANCE_HALF; }
#endif
