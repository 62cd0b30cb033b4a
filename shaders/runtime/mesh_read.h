// Push constants of the passes that read meshes and transforms out of the host's buffers. Words are of four bytes,
// counted from where the buffer is bound.
#ifndef GNOMON_RUNTIME_MESH_READ_H
#define GNOMON_RUNTIME_MESH_READ_H
#include "../shared/types.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint MESH_FLOATS = 0u; // R32G32B32_SFLOAT
GN_SHARED_CONST uint MESH_HALVES = 1u; // R16G16B16A16_SFLOAT
GN_SHARED_CONST uint MESH_SNORMS = 2u; // R16G16B16A16_SNORM
GN_SHARED_CONST uint MESH_GROUP = 64u; // invocations

struct MeshPositionsRead {
    vec4 scale; // xyz
    vec4 bias;  // xyz, object space
    uint count;
    uint firstWord;
    uint strideWords;
    uint format;  // MESH_FLOATS, MESH_HALVES or MESH_SNORMS
    uint watches; // 1: whether vertices stay at the one that they are welded to
    uint padding0;
    uint padding1;
    uint padding2;
};
GN_SHARED_SIZE(MeshPositionsRead, 64)

struct MeshIndicesRead {
    uint triangleCount;
    uint firstByte;
    uint indexBytes;   // 2, 4, or 0: there are none, corners count from 0
    uint vertexOffset; // of two's complement
    uint vertexCount;
    uint turned; // 1: the second and third corner change places
};
GN_SHARED_SIZE(MeshIndicesRead, 24)

struct PlacementsRead {
    vec4 shift; // xyz, added to translations
    uint count;
    uint firstElement; // of the array
    uint firstIndex;   // in the table
    uint firstWord;    // of element 0
    uint strideWords;
    uint mirrored; // 1: determinants are negative
    uint padding0;
    uint padding1;
};
GN_SHARED_SIZE(PlacementsRead, 48)

GN_SHARED_END

#endif
