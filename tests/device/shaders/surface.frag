#version 460
// The normal of the triangle's plane, turned to the eye: a plane's derivatives are the same all over it.
layout(location = 0) in vec3 positionEye;
layout(location = 0) out vec4 normal;

void main()
{
    vec3 n = normalize(cross(dFdx(positionEye), dFdy(positionEye)));
    normal = vec4(dot(n, positionEye) > 0.0 ? -n : n, 1.0);
}
