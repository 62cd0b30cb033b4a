// Push constants of mesh_planes.comp.
#ifndef GNOMON_VOLUMES_MESH_PLANES_H
#define GNOMON_VOLUMES_MESH_PLANES_H
#include "../shared/types.h"

GN_SHARED_BEGIN

GN_SHARED_CONST uint PLANES_GROUP = 64u; // invocations

struct MeshPlanesPush {
    uint faces;
};

GN_SHARED_END
#endif
