#include "runtime/scene/shadow_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/scene/topology.hpp"

namespace gnomon {

namespace {

constexpr int kPieces = 4; // a volume's way is cut into so many; each is taken as a rectangle on the screen
// Silhouette edges of a mesh whose topology is not known. A great circle over a sphere of s x s / 2 patches, n = s^2
// triangles, meets s rows of them and is a zigzag of at most two edges in each.
constexpr float kEdges = 2.0f;
// Sides are slivers, two triangles from an edge to its end. A non-negative least-squares fit to the 86 moments that
// `gnomon calibrate` takes of plain shadow volumes on lavapipe has 7.4 ns for a pixel of the resolve and
//     10.2 ns along   a pixel of a side's length: blocks that an edge of a sliver cuts
//      0.5 ns inside  a pixel of a side's area: whole blocks
//    106   ns          a side, however small
// (how good predictions by such sizes are: ../cost/README.md).
// Here they are in units of a pixel inside; cost_model.cpp knows what that is of a resolved one (kSideShare).
constexpr float kAlong = 20.0f;
constexpr float kSide = 200.0f;

/// What a caster's volume is made of.
struct Sides {
    float count = 0.0f;
    float length = 0.0f; ///< Of the edges together, metres.
};

/// Of lengths, on average over directions.
float scaleOf(const Caster& caster)
{
    return std::cbrt(std::fabs(glm::determinant(caster.basis)));
}

Sides sidesOf(const Caster& caster)
{
    if (!caster.mesh) return {};
    if (const Topology* topology = caster.mesh->topology)
        return {topology->whole.meanSides, scaleOf(caster) * topology->whole.meanSideLength};
    const float rows = std::sqrt(static_cast<float>(caster.mesh->triangleCount()));
    const float edge = glm::distance(caster.bounds.lower, caster.bounds.upper) / std::max(rows, 1.0f);
    return {kEdges * rows, kEdges * rows * edge};
}

/// What turns metres into pixels, taken from the view once.
struct Lens {
    glm::vec3 eye, right, up, forward;
    float pixelsPerMetre; ///< At depth 1; orthographic: anywhere.
    bool orthographic;
    glm::vec2 half; ///< Of the picture, pixels.
};

Lens lensOf(const CameraView& view)
{
    const glm::mat3 world = glm::transpose(view.viewFromWorld);
    const VkExtent2D size = view.area.extent;
    return {.eye = view.eye,
            .right = world[0],
            .up = world[1],
            .forward = view.ahead() * world[2],
            .pixelsPerMetre = 1.0f / std::max(view.constants.pixelSize, 1e-9f),
            .orthographic = gpu::isOrthographic(view.constants),
            .half = 0.5f * glm::vec2(static_cast<float>(size.width), static_cast<float>(size.height))};
}

/// Length from `from` until the ray leaves the box; 0 where it starts outside and leads away.
float wayOut(const Aabb& box, glm::vec3 from, glm::vec3 ray)
{
    if (ray == glm::vec3(0.0f)) return 0.0f; // of a light in the caster's middle: it has no direction
    float way = std::numeric_limits<float>::max();
    for (int axis = 0; axis < 3; ++axis) {
        if (std::fabs(ray[axis]) < 1e-6f) continue;
        const float end = ray[axis] > 0.0f ? box.upper[axis] : box.lower[axis];
        way = std::min(way, (end - from[axis]) / ray[axis]);
    }
    return std::max(way, 0.0f);
}

/// Half of what a box measures across a volume as the eye sees it: along the direction at right angles to both rays.
float halfWidthOf(glm::vec3 halfSize, glm::vec3 ray, glm::vec3 es, const Lens& lens)
{
    const glm::vec3 normal = glm::cross(ray, es);
    const float length = glm::length(normal);
    const glm::vec3 across = length > 1e-6f * glm::length(es) ? normal / length : lens.right;
    return glm::dot(glm::abs(across), halfSize);
}

/// Share of a rectangle that lies on the screen. @param axis its half length, a vector in pixels
float shareOnScreen(const Lens& lens, glm::vec2 centre, glm::vec2 axis, float halfWidth)
{
    const float length = glm::length(axis);
    const glm::vec2 unit = length > 1e-6f ? glm::abs(axis) / length : glm::vec2(1.0f, 0.0f);
    const glm::vec2 half = unit * length + glm::vec2(unit.y, unit.x) * halfWidth + 0.5f; // of the box around it
    const glm::vec2 inside = glm::min(centre + half, lens.half) - glm::max(centre - half, -lens.half);
    if (inside.x <= 0.0f || inside.y <= 0.0f) return 0.0f;
    return inside.x * inside.y / (4.0f * half.x * half.y);
}

/// Pixels of a piece of a volume: `length` metres along `ray` around `at`, where the caster's half size has spread to
/// `halfSize`.
float pixelsOf(const Lens& lens, glm::vec3 at, glm::vec3 ray, float length, glm::vec3 halfSize, const Sides& sides)
{
    const glm::vec3 es = at - lens.eye;
    const float radius = halfWidthOf(halfSize, ray, es, lens);
    float depth = glm::dot(es, lens.forward);
    if (lens.orthographic) depth = 1.0f;
    if (depth < -radius) return 0.0f; // behind the eye
    if (!lens.orthographic) depth = std::max(depth, std::max(radius, 1e-3f));
    const float scale = lens.pixelsPerMetre / depth;
    const glm::vec2 centre = scale * glm::vec2(glm::dot(es, lens.right), glm::dot(es, lens.up));
    const glm::vec3 along = ray - glm::dot(ray, es) / std::max(glm::dot(es, es), 1e-12f) * es; // across the view ray
    const glm::vec2 axis = 0.5f * scale * length * glm::vec2(glm::dot(along, lens.right), glm::dot(along, lens.up));
    const float share = shareOnScreen(lens, centre, axis, scale * radius);
    const float way = 2.0f * share * glm::length(axis);
    return way * (kAlong * sides.count + scale * sides.length) + kSide * share * sides.count;
}

/// The box around all casters, and the light.
struct Volumes {
    const LightView& light;
    const Lens& lens;
    Aabb end;

    /// Pixels of the volume of what has these bounds and sides.
    double pixels(const Aabb& bounds, const Sides& sides) const
    {
        const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
        const glm::vec3 centre = bounds.center(), halfSize = bounds.halfExtent();
        const glm::vec3 toCaster = directional ? light.direction() : centre - light.position();
        const float away = directional ? 1.0f : std::max(glm::length(toCaster), 1e-3f);
        const glm::vec3 ray = toCaster / away;
        float way = wayOut(end, centre, ray);
        if (!light.unlimited() && !directional) way = std::min(way, std::max(light.constants.range - away, 0.0f));
        double sum = 0.0;
        for (int piece = 0; piece < kPieces; ++piece) {
            const float t = way * (static_cast<float>(piece) + 0.5f) / kPieces;
            const float spread = directional ? 1.0f : 1.0f + t / away;
            const Sides spreadOut{sides.count, spread * sides.length};
            sum +=
                static_cast<double>(pixelsOf(lens, centre + t * ray, ray, way / kPieces, spread * halfSize, spreadOut));
        }
        return sum;
    }
};

} // namespace

double shadowPixels(const LightView& light, const LightCasters& casters, const CameraView& view)
{
    if (casters.all.empty()) return 0.0;
    const Lens lens = lensOf(view);
    Volumes volumes{light, lens, casters.all.front()->bounds};
    for (const Caster* caster : casters.all)
        volumes.end = unionOf(volumes.end, caster->bounds);
    double pixels = 0.0;
    for (const Caster* caster : casters.all) {
        const Topology* topology = caster->mesh ? caster->mesh->topology : nullptr;
        if (!topology || topology->clusters.size() < 2 || !holdsLight(caster->bounds, light)) {
            pixels += volumes.pixels(caster->bounds, sidesOf(*caster));
            continue;
        }
        const float scale = scaleOf(*caster);
        for (const Topology::Cluster& cluster : topology->clusters)
            pixels += volumes.pixels(transformed(cluster.bounds, caster->basis, caster->translation),
                                     {cluster.meanSides, scale * cluster.meanSideLength});
    }
    return pixels;
}

Outline outlineOf(const Caster& caster)
{
    const Topology* topology = caster.mesh ? caster.mesh->topology : nullptr;
    const float scale = scaleOf(caster);
    if (topology) return {scale * topology->whole.meanSideLength, scale * scale * topology->whole.meanArea};
    const glm::vec3 size = 2.0f * caster.bounds.halfExtent(); // a solid box's area
    return {sidesOf(caster).length, 0.5f * (size.x * size.y + size.y * size.z + size.z * size.x)};
}

} // namespace gnomon
