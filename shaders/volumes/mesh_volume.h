// Push constants of mesh_sides.comp and mesh_caps.comp: one volume. Places count words of the list.
#ifndef GNOMON_VOLUMES_MESH_VOLUME_H
#define GNOMON_VOLUMES_MESH_VOLUME_H
#include "../shared/face_light.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint MESH_VOLUME_GROUP = 64u; // invocations

struct MeshVolumePush {
    FaceLight light;
    uint first;      // sides: of the mesh's edges
    uint count;      // edges, or faces
    uint command;    // place of the volume's
    uint firstIndex; // place of its first index
    uint halves;     // sides: 2 for closed meshes, else 1
    uint capsWay;    // caps: AllEdgesPush::capsWay
    uint padding0;
    uint padding1;
};
GN_SHARED_SIZE(MeshVolumePush, 64)

GN_SHARED_END
#endif
