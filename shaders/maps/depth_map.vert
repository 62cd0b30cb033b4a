#version 460
// Casters into a depth map: moved to the zero of the projection first, because a matrix with a far translation would
// round depths near the light away.
#extension GL_GOOGLE_include_directive : require
#include "../shared/casters.glsl"

layout(push_constant) uniform Push {
    mat4 clipFromZero;
    vec4 zeroWs;
};

void main()
{
    gl_Position = clipFromZero * vec4(casterWorldPosition() - zeroWs.xyz, 1.0);
}
