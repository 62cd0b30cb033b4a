#version 460
// A caster that the host draws into a shadow map itself.
layout(location = 0) in vec3 positionOs;
layout(location = 0) out vec3 alphaPosition;
layout(push_constant) uniform Push {
    mat4 clipFromObject;
};

void main()
{
    alphaPosition = positionOs;
    gl_Position = clipFromObject * vec4(positionOs, 1.0);
}
