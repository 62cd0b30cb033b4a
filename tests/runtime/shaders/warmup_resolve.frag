#version 460
layout(constant_id = 0) const int TAPS = 1;
layout(set = 0, binding = 0) uniform Block { vec4 scale; };
layout(set = 0, binding = 1) uniform sampler2DArray map;
layout(set = 0, binding = 2) uniform usampler2D stencil;
layout(set = 0, binding = 3) uniform sampler2D depth;
layout(location = 0) out float visibility;
void main()
{
    float sum = 0.0;
    for (int i = 0; i < TAPS; ++i)
        sum += texture(map, vec3(gl_FragCoord.xy * scale.xy, float(i))).r;
    visibility = sum + texelFetch(depth, ivec2(gl_FragCoord.xy), 0).r +
                 float(texelFetch(stencil, ivec2(gl_FragCoord.xy), 0).r);
}
