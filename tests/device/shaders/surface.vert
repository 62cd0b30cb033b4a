#version 460
// What a host draws before it asks for shadows: depth, and the place of each pixel for its normal.
layout(push_constant) uniform Push
{
    mat4 clipFromObject;
    vec4 eyeFromObject[3]; // rows; world axes, origin at the eye
};
layout(location = 0) in vec3 positionOs;
layout(location = 0) out vec3 positionEye;

void main()
{
    vec4 p = vec4(positionOs, 1.0);
    positionEye = vec3(dot(eyeFromObject[0], p), dot(eyeFromObject[1], p), dot(eyeFromObject[2], p));
    gl_Position = clipFromObject * p;
}
