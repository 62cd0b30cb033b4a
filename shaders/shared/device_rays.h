// Casters as shaders meet them behind a top level's instances.
#ifndef GNOMON_SHARED_DEVICE_RAYS_H
#define GNOMON_SHARED_DEVICE_RAYS_H
#include "types.h"

GN_SHARED_BEGIN

// By an instance's custom index; std430. Looked up where the instance is not opaque: its mask is not all bits, or some of
// its triangles may be too long or thin to count for rays that start on them (runtime/scene/long_edges.hpp).
struct TracedCaster {
    uvec2 positions; // address of three floats a vertex, object space
    uvec2 indices;   // address of three uints a triangle
    uint mask;       // Caster::mask
    uint isLong;     // 1: ask startsOn()
};
GN_SHARED_OFFSET(TracedCaster, mask, 16)
GN_SHARED_SIZE(TracedCaster, 24)

// What an instance's eight bits hold of 32: bit i of the mask is bit i % 8. Masks that meet still meet.
GN_SHARED_FN uint foldedMask(uint mask)
{
    return (mask | mask >> 8 | mask >> 16 | mask >> 24) & 255u;
}

GN_SHARED_END
#endif
