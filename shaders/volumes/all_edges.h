// All edges and faces of a mesh as the device reads them, and which of them bound the volume of a caster: found out per
// corner, so that nothing depends on light or place but constants.
//
// The list of a mesh is one buffer: three indirect commands for each cluster and for the mesh, the indices they draw, then slots of 16 bytes. A slot is
//   a pair    v0, v1, use, use    two faces at an edge v0 -> v1
//   a border  v0, v1, use, use    one face at an edge: the same use twice
//   a face    v0, v1, v2, slot of its plane
//   a plane   four floats: xyz normal, w distance, object space
// with use = 2 * slot of the face's plane + 1 if the face runs v0 -> v1, + 0 if v1 -> v0. An index is
//   4 * slot + corner             of the four corners of a side
//   8 * slot + 4 * copy + corner  of the three corners of a cap, near (copy 0) and far (copy 1)
#ifndef GNOMON_VOLUMES_ALL_EDGES_H
#define GNOMON_VOLUMES_ALL_EDGES_H
#include "../shared/face_light.h"
#include "volume.h"

GN_SHARED_BEGIN

// One caster.
struct AllEdgesPush {
    VolumePush caster;
    FaceLight light;
    uint capsWay; // which faces are caps: those of this way, or of a way other than FACE_TOUCHED
    uint firstPlane; // slot of the first plane, where planes are in a buffer of their own; 0: they are in the list
    uint padding1;
    uint padding2;
};
GN_SHARED_SIZE(AllEdgesPush, 112)

GN_SHARED_CONST uint NO_CORNER = 0xffffffffu; // of an edge or face that is not drawn

// Corner 0 to 3 of the side at an edge, as 2 * vertex + copy: counter-clockwise from outside in the order 0 1 2, 0 2 3.
// NO_CORNER where the two faces look the same way and the side cancels out, and in instances beyond what they ask for:
// of a pair one face alone counts if the light touches the other.
GN_SHARED_FN uint sideCorner(uvec4 edge, uint way0, uint way1, uint instance, uint corner)
{
    int ways = edgeWay(way0, (edge.z & 1u) != 0u) + edgeWay(way1, (edge.w & 1u) != 0u);
    if (ways == 0 || (instance != 0u && ways * ways == 1)) return NO_CORNER;
    // The faces lie left of from -> to seen from the light, the outside to the right.
    bool atFrom = corner < 2u;
    uint vertex = atFrom == (ways > 0) ? edge.x : edge.y;
    return 2u * vertex + (((corner + 1u) >> 1) & 1u);
}

// Corner 0 to 2 of a cap, near (copy 0, in the order 0 1 2) or far (copy 1, in the order 0 2 1), as 2 * vertex + copy.
GN_SHARED_FN uint capCorner(uvec4 face, uint way, uint capsWay, uint copy, uint corner)
{
    if (capsWay == FACE_TOUCHED ? way == FACE_TOUCHED : way != capsWay) return NO_CORNER;
    uint vertex = corner == 0u ? face.x : ((corner == 1u) == (way == FACE_TOWARDS) ? face.y : face.z);
    return 2u * vertex + copy;
}

GN_SHARED_END
#endif
