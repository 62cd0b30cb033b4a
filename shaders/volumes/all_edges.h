// All edges and faces of a mesh as the device reads them, and which of them bound the volume of a caster: found out per
// corner, so that nothing depends on light or place but constants.
//
// The list of a mesh is one buffer: three indirect commands, the indices they draw, then slots of 16 bytes. A slot is
//   a pair    v0, v1, use, use    two faces at an edge v0 -> v1
//   a border  v0, v1, use, use    one face at an edge: the same use twice
//   a face    v0, v1, v2, slot of its plane
//   a plane   four floats: xyz normal, w distance, object space
// with use = 2 * slot of the face's plane + 1 if the face runs v0 -> v1, + 0 if v1 -> v0. An index is
//   4 * slot + corner             of the four corners of a side
//   8 * slot + 4 * copy + corner  of the three corners of a cap, near (copy 0) and far (copy 1)
#ifndef GNOMON_VOLUMES_ALL_EDGES_H
#define GNOMON_VOLUMES_ALL_EDGES_H
#include "volume.h"

GN_SHARED_BEGIN

// One caster.
struct AllEdgesPush {
    VolumePush caster;
    vec4 lightOs;    // of facesLight
    uint capsFacing; // which faces are caps: those with this answer of facesLight, or ALL_FACES
    uint padding0;
    uint padding1;
    uint padding2;
};
GN_SHARED_SIZE(AllEdgesPush, 96)

GN_SHARED_CONST uint ALL_FACES = 2u;
GN_SHARED_CONST uint NO_CORNER = 0xffffffffu; // of an edge or face that is not drawn

// Whether a face's winding, in the world, looks towards the light. The same operations in the same order everywhere:
// the three edges of a face, its caps and the CPU (silhouette.cpp) must agree.
GN_SHARED_FN bool facesLight(vec4 plane, vec4 lightOs)
{
    GN_PRECISE float side = plane.x * lightOs.x + plane.y * lightOs.y + plane.z * lightOs.z + plane.w * lightOs.w;
    return side > 0.0f;
}

// +1 if the face, turned towards the light, runs v0 -> v1; -1 if v1 -> v0.
GN_SHARED_FN int edgeWay(bool facing, uint use)
{
    return facing == ((use & 1u) != 0u) ? 1 : -1;
}

// Corner 0 to 3 of the side at an edge, as 2 * vertex + copy: counter-clockwise from outside in the order 0 1 2, 0 2 3.
// NO_CORNER where the two faces look the same way and the side cancels out.
GN_SHARED_FN uint sideCorner(uvec4 edge, bool facing0, bool facing1, uint corner)
{
    int ways = edgeWay(facing0, edge.z) + edgeWay(facing1, edge.w);
    if (ways == 0) return NO_CORNER;
    // The faces lie left of from -> to seen from the light, the outside to the right.
    bool atFrom = corner < 2u;
    uint vertex = atFrom == (ways > 0) ? edge.x : edge.y;
    return 2u * vertex + (((corner + 1u) >> 1) & 1u);
}

// Corner 0 to 2 of a cap, near (copy 0, in the order 0 1 2) or far (copy 1, in the order 0 2 1), as 2 * vertex + copy.
GN_SHARED_FN uint capCorner(uvec4 face, bool facing, uint capsFacing, uint copy, uint corner)
{
    if (capsFacing != ALL_FACES && capsFacing != (facing ? 1u : 0u)) return NO_CORNER;
    uint vertex = corner == 0u ? face.x : ((corner == 1u) == facing ? face.y : face.z);
    return 2u * vertex + copy;
}

GN_SHARED_END
#endif
