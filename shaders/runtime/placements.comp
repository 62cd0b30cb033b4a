#version 460
#extension GL_GOOGLE_include_directive : require
#include "runtime/mesh_read.h"

// Transforms of instances out of the host's buffer into the frame's table. One invocation an instance.
layout(local_size_x = MESH_GROUP) in;

layout(push_constant) uniform Push { PlacementsRead read; };
layout(std430, set = 0, binding = 0) readonly buffer Source { uint source[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Table { vec4 table[]; };
layout(std430, set = 0, binding = 2) buffer Findings { uint firstWrong; }; // the least element; all ones: none

// Of its bits: comparisons with NaN may be taken for granted by a compiler.
bool usable(vec4 row)
{
    uvec4 magnitude = floatBitsToUint(row) & 0x7fffffffu;
    return all(lessThanEqual(magnitude, uvec4(floatBitsToUint(1e18))));
}

// Whether there is an inverse, and the basis turns or mirrors as the host says. Divided by the largest element first:
// the determinant of a basis in small units leaves the range of floats.
bool invertible(vec3 x, vec3 y, vec3 z)
{
    vec3 largest = max(abs(x), max(abs(y), abs(z)));
    float scale = max(largest.x, max(largest.y, largest.z));
    if (!(scale >= 1e-18)) return false;
    float determinant = dot(x / scale, cross(y / scale, z / scale));
    return read.mirrored != 0 ? determinant < 0.0 : determinant > 0.0;
}

vec4 rowAt(uint word)
{
    return uintBitsToFloat(uvec4(source[word], source[word + 1], source[word + 2], source[word + 3]));
}

void main()
{
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint i = group * MESH_GROUP + gl_LocalInvocationID.x;
    if (i >= read.count) return;
    uint element = read.firstElement + i;
    uint word = read.firstWord + element * read.strideWords;
    vec4 rows[3] = vec4[3](rowAt(word), rowAt(word + 4), rowAt(word + 8));
    bool good = usable(rows[0]) && usable(rows[1]) && usable(rows[2]);
    good = good && invertible(rows[0].xyz, rows[1].xyz, rows[2].xyz);
    if (!good) atomicMin(firstWrong, element);
    for (uint row = 0; row < 3; ++row) {
        precise float place = rows[row].w + read.shift[row];
        table[3 * (read.firstIndex + i) + row] = good ? vec4(rows[row].xyz, place) : vec4(0.0);
    }
}
