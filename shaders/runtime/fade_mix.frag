#version 460
// What a light shows while its method changes: the outgoing method's visibility and the incoming one's, mixed.
layout(set = 0, binding = 0) uniform sampler2DArray methods; // layer 0: outgoing, layer 1: incoming
layout(push_constant) uniform Push { float incomingShare; };

layout(location = 0) out float visibility;

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float outgoing = texelFetch(methods, ivec3(pixel, 0), 0).r;
    float incoming = texelFetch(methods, ivec3(pixel, 1), 0).r;
    visibility = mix(outgoing, incoming, incomingShare);
}
