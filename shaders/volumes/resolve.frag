#version 460
#extension GL_GOOGLE_include_directive : require
// Visibility behind a stencil test: drawn once where the count is 0, once where it is not.
#include "../shared/resolve.glsl"

layout(constant_id = 0) const bool COUNTED = false; // this draw's pixels lie in some volume

layout(set = 0, binding = 0, std140) uniform Constants {
    ViewConstants view;
    LightConstants light;
};
layout(set = 0, binding = 1) uniform sampler2D depthImage;
layout(set = 0, binding = 2) uniform sampler2D normalImage;
layout(location = 0) out float visibility;

void main()
{
    Receiver r = fetchReceiver(view, light, depthImage, normalImage);
    float known = visibilityWithoutCasters(view, r);
    visibility = known >= 0.0 ? known : COUNTED ? 0.0 : 1.0;
}
