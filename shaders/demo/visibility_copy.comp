#version 460
// Visibility as 8-bit numbers, four pixels a word, through the function that hosts use: what the CPU reads is what a
// shader would have seen.
#extension GL_GOOGLE_include_directive : require
#define GNOMON_VISIBILITY_SET 0
#define GNOMON_VISIBILITY_BINDING 0
#include "gnomon/visibility.glsl"

layout(local_size_x = 64) in;
layout(std430, set = 0, binding = 1) writeonly buffer Words { uint words[]; };
layout(push_constant) uniform Push {
    uint width;
    uint height;
    uint layers;
};

void main()
{
    uint word = gl_GlobalInvocationID.y * gl_NumWorkGroups.x * 64 + gl_GlobalInvocationID.x;
    uint pixels = width * height * layers;
    if (word * 4 >= pixels) return;
    uint packed = 0;
    for (uint i = 0; i < 4; ++i) {
        uint index = min(word * 4 + i, pixels - 1);
        uint inLayer = index % (width * height);
        float v = gnomonVisibility(ivec2(inLayer % width, inLayer / width), int(index / (width * height)));
        packed |= uint(v * 255.0 + 0.5) << (8 * i);
    }
    words[word] = packed;
}
