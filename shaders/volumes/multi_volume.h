// Constants of multi_volume's passes.
#ifndef GNOMON_VOLUMES_MULTI_VOLUME_H
#define GNOMON_VOLUMES_MULTI_VOLUME_H
#include "receiver_tile.h"

GN_SHARED_BEGIN

// std140.
struct MultiVolume {
    VolumeResolve volumes; // of the light's centre
    vec4 pointEs;          // xyz: one of its points, metres; directional: unit, towards it. w: 1 / number of points
};
GN_SHARED_SIZE(MultiVolume, 256)

// The way from a receiver to a point of the light that is given as VolumeResolve::lightEs is.
//   ray  the pixel's view ray
GN_SHARED_FN vec3 wayTo(VolumeResolve resolve, vec3 pointEs, vec3 ray, float depth)
{
    return pointEs - resolve.lightEs.w * linearDepth(resolve.view, depth) * receiverRayWs(resolve.view, ray, depth);
}

GN_SHARED_END
#endif
