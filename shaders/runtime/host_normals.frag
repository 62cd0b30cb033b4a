#version 460
#extension GL_GOOGLE_include_directive : require
// A view's normals as methods read them: xyz as they are.
#include "host_image.glsl"

layout(location = 0) out vec4 normal;

// GnNormalEncoding
const uint ENCODING_UNSIGNED = 1u;
const uint ENCODING_OCTAHEDRAL = 2u;
const uint ENCODING_OCTAHEDRAL_UNSIGNED = 3u;

// Source: Cigolle, Donow, Evangelakos, Mara, McGuire and Meyer 2014, listing 2.
vec3 fromOctahedron(vec2 at)
{
    vec3 n = vec3(at, 1.0 - abs(at.x) - abs(at.y));
    vec2 turned = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
    n.xy = n.z < 0.0 ? turned : n.xy;
    return normalize(n);
}

void main()
{
    vec3 texel = hostTexel().xyz;
    if (way == ENCODING_UNSIGNED || way == ENCODING_OCTAHEDRAL_UNSIGNED) texel = 2.0 * texel - 1.0;
    bool octahedral = way == ENCODING_OCTAHEDRAL || way == ENCODING_OCTAHEDRAL_UNSIGNED;
    normal = vec4(octahedral ? fromOctahedron(texel.xy) : texel, 0.0);
}
