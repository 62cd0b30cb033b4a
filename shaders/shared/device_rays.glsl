// Shadow rays on the device, with the answers of the CPU's (runtime/rays). The includer enables GL_EXT_ray_query,
// GL_EXT_buffer_reference and GL_EXT_buffer_reference_uvec2, and declares `topLevel` (accelerationStructureEXT) and
// `traced[]`, a buffer of TracedCaster.
#ifndef GNOMON_SHARED_DEVICE_RAYS_GLSL
#define GNOMON_SHARED_DEVICE_RAYS_GLSL
#include "device_rays.h"
#include "receiver.h"

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer MeshPositions {
    float at[];
};
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer MeshIndices {
    uint at[];
};

// Triangles looked at for one ray, of casters that are not opaque. No scene comes near it; it ends what an invalid
// structure might never end.
const int MAX_CANDIDATES = 1048576;

// What counts as infinitely far: traversal takes it as a plain number.
const float FARTHEST = 1e30;

dvec3 cornerWs(TracedCaster caster, dmat4x3 worldFromObject, uint triangle, uint corner)
{
    MeshPositions positions = MeshPositions(caster.positions);
    uint first = 3u * MeshIndices(caster.indices).at[3u * triangle + corner];
    vec3 object = vec3(positions.at[first], positions.at[first + 1u], positions.at[first + 2u]);
    return worldFromObject * dvec4(dvec3(object), 1.0lf);
}

// startsOn() of runtime/scene/long_edges.hpp: a ray does not meet the triangle that it starts on, as far as that can be told.
bool startsOn(dvec3 a, dvec3 b, dvec3 c, dvec3 start)
{
    dvec3 ab = b - a, bc = c - b, ca = a - c;
    dvec3 normal = cross(ab, bc);
    double area = length(normal);
    double longest = sqrt(max(max(dot(ab, ab), dot(bc, bc)), dot(ca, ca)));
    double height = area / longest;
    double counted = min(longest, 64.0lf); // kLongEdge
    const double ROUNDING = 1.0lf / 4194304.0lf;
    double off = max(ROUNDING * longest, min(ROUNDING * counted * counted / height, 0.25lf * height));
    return abs(dot(normal, start - a)) <= off * area;
}

// How far along the ray something blocks it, in multiples of ray.along: what is met first, not the nearest. Below zero:
// nothing does, as of a ray that is no number or ends before it starts.
float blockedAt(LightRay ray, uint lightMask)
{
    // Compared so that what is no number fails.
    bool isNumber = dot(abs(ray.start), vec3(1.0)) < FARTHEST && dot(abs(ray.along), vec3(1.0)) < FARTHEST;
    if (!isNumber || !(ray.end >= 0.0) || ray.along == vec3(0.0)) return -1.0;
    rayQueryEXT query;
    rayQueryInitializeEXT(query, topLevel, gl_RayFlagsTerminateOnFirstHitEXT, foldedMask(lightMask), ray.start, 0.0,
                          ray.along, min(ray.end, FARTHEST));
    for (int i = 0; i < MAX_CANDIDATES && rayQueryProceedEXT(query); ++i) {
        TracedCaster caster = traced[rayQueryGetIntersectionInstanceCustomIndexEXT(query, false)];
        bool blocks = (caster.mask & lightMask) != 0u;
        if (blocks && caster.isLong != 0u) {
            uint triangle = uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, false));
            dmat4x3 toWorld = dmat4x3(rayQueryGetIntersectionObjectToWorldEXT(query, false));
            blocks = !startsOn(cornerWs(caster, toWorld, triangle, 0u), cornerWs(caster, toWorld, triangle, 1u),
                               cornerWs(caster, toWorld, triangle, 2u), dvec3(ray.start));
        }
        if (blocks) rayQueryConfirmIntersectionEXT(query);
    }
    bool met = rayQueryGetIntersectionTypeEXT(query, true) != gl_RayQueryCommittedIntersectionNoneEXT;
    return met ? rayQueryGetIntersectionTEXT(query, true) : -1.0;
}

bool isOccluded(LightRay ray, uint lightMask)
{
    return blockedAt(ray, lightMask) >= 0.0;
}
#endif
