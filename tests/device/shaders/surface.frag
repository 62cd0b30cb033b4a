#version 460
// The normal of the triangle's plane, turned to the eye: a plane's derivatives are the same all over it. Stored as the
// target wants it: GnNormalEncoding.
layout(push_constant) uniform Push
{
    layout(offset = 112) vec4 looking; // xyz: the way the view looks, where it has no perspective; w: the encoding
};
layout(location = 0) in vec3 positionEye;
layout(location = 0) out vec4 normal;

vec2 onOctahedron(vec3 n)
{
    vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    if (n.z >= 0.0) return p;
    return vec2((1.0 - abs(p.y)) * (p.x >= 0.0 ? 1.0 : -1.0), (1.0 - abs(p.x)) * (p.y >= 0.0 ? 1.0 : -1.0));
}

void main()
{
    vec3 n = normalize(cross(dFdx(positionEye), dFdy(positionEye)));
    n = dot(n, looking.xyz == vec3(0.0) ? positionEye : looking.xyz) > 0.0 ? -n : n;
    int encoding = int(looking.w);
    normal = vec4(encoding < 2 ? n : vec3(onOctahedron(n), 0.0), 1.0);
    if (encoding == 1 || encoding == 3) normal = 0.5 * normal + 0.5;
}
