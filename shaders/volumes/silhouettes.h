// Topology of casters as the compute shader reads it: words of one buffer,
//
//   piece of every workgroup | pieces | of every mesh: edges, uses, planes
//
// edges: two vertices, first use, uses; uses: 2 * face + 1 where the face runs from the first vertex to the second, else
// 2 * face; planes in blocks of a structure of arrays (runtime/scene/face_block.hpp).
#ifndef GNOMON_VOLUMES_SILHOUETTES_H
#define GNOMON_VOLUMES_SILHOUETTES_H
#include "../shared/types.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint SILHOUETTE_GROUP = 64u; // invocations, each for an edge
GN_SHARED_CONST uint SILHOUETTE_BLOCK = 16u; // faces of a block of planes
GN_SHARED_CONST uint EDGE_WORDS = 4u;

// A run of a caster's edges and where it writes. Places count words of the buffer.
struct SilhouettePiece {
    uint edges; // the first of the run
    uint edgeCount;
    uint uses; // of the mesh
    uint planes;
    uint firstGroup;
    uint firstIndex; // of its sides, in the list
    uint halves;     // 2 for closed meshes, else 1: signed multiplicities are divided by it
    uint padding;
};
GN_SHARED_SIZE(SilhouettePiece, 32)

struct SilhouettePush {
    uint groups;
    uint firstPiece; // its place
};
GN_SHARED_SIZE(SilhouettePush, 8)

GN_SHARED_END
#endif
