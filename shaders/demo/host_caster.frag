#version 460
#extension GL_GOOGLE_include_directive : require
#include "alpha.h"

layout(constant_id = 0) const bool kAlphaTested = false;
layout(location = 0) in vec3 alphaPosition;

void main()
{
    if (kAlphaTested && alphaOpacity(alphaPosition) < 0.5) discard;
}
