#include "algorithms/volumes/depth_surface.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "algorithms/shared/map_lookup.hpp"

// Projections are inverted in double and rounded once.
namespace gnomon {

namespace {

bool jumps(std::uint32_t mask, std::uint32_t side)
{
    return (mask >> (side & 3u)) & 1u;
}

/// The ring of vertices from behind the jump on `first` to before it; without any jump the four corners.
std::vector<std::uint32_t> ringFrom(std::uint32_t mask, std::uint32_t first)
{
    if (mask == 0) return {0, 1, 2, 3};
    std::vector<std::uint32_t> ring;
    for (std::uint32_t i = 0; i < 4; ++i) {
        const std::uint32_t side = (first + i) & 3u;
        if (i > 0) {
            ring.push_back(side);
            if (jumps(mask, side)) ring.push_back(4 + 2 * side);
        }
        if (jumps(mask, side)) ring.push_back(5 + 2 * side);
    }
    ring.push_back(first);
    ring.push_back(4 + 2 * first);
    return ring;
}

/// Writes the triangles of one template, one after another.
class Filling {
public:
    explicit Filling(std::uint32_t* to) : to_(to) {}

    void add(std::uint32_t a, std::uint32_t b, std::uint32_t c)
    {
        const std::uint32_t corners = (1u << gpu::cornerOf(a)) | (1u << gpu::cornerOf(b)) | (1u << gpu::cornerOf(c));
        *to_++ = a | (b << 4) | (c << 8) | (corners << 12);
    }
    void fan(std::uint32_t apex, const std::uint32_t* first, const std::uint32_t* last)
    {
        for (; first + 1 <= last; ++first)
            add(apex, first[0], first[1]);
    }

private:
    std::uint32_t* to_;
};

/// A wall between the jump the ring begins and ends at and the one on `other`, both sides of it filled.
void fillWithWall(Filling& filling, const std::vector<std::uint32_t>& ring, std::uint32_t other)
{
    const std::size_t before =
        static_cast<std::size_t>(std::find(ring.begin(), ring.end(), 4 + 2 * other) - ring.begin());
    const std::uint32_t* at = ring.data();
    filling.fan(ring.front(), at + 1, at + before + 1);
    filling.add(ring.front(), ring[before + 1], ring.back());
    filling.fan(ring.back(), at + before + 1, at + ring.size() - 2);
}

/// Four jumps: corners `first` + 1 and `first` + 3 parted from the other two, which stay together.
void fillWithTwoWalls(Filling& filling, const std::vector<std::uint32_t>& ring)
{
    // The ring: 0 jump, 1 corner, 2-3 jump, 4 corner, 5-6 jump, 7 corner, 8-9 jump, 10 corner, 11 jump.
    filling.add(ring[0], ring[1], ring[2]);
    filling.add(ring[0], ring[2], ring[3]);
    filling.add(ring[0], ring[3], ring[11]);
    const std::uint32_t middle[] = {ring[3], ring[4], ring[5], ring[9], ring[10]};
    filling.fan(ring[11], middle, middle + 4);
    filling.add(ring[5], ring[6], ring[8]);
    filling.add(ring[5], ring[8], ring[9]);
    filling.add(ring[6], ring[7], ring[8]);
}

void fillTemplate(std::uint32_t* triangles, std::uint32_t mask, std::uint32_t variant)
{
    std::vector<std::uint32_t> sides; // that jump
    for (std::uint32_t side = 0; side < 4; ++side)
        if (jumps(mask, side)) sides.push_back(side);
    Filling filling(triangles);
    if (sides.size() == 4) return fillWithTwoWalls(filling, ringFrom(mask, variant));
    if (sides.size() == 3) sides.erase(sides.begin() + variant);
    const std::vector<std::uint32_t> ring = ringFrom(mask, sides.empty() ? 0 : sides[0]);
    if (sides.size() == 2) return fillWithWall(filling, ring, sides[1]);
    filling.fan(ring.front(), ring.data() + 1, ring.data() + ring.size() - 1);
}

/// Columns: what one texel to the right, one down and one unit of clip depth or clip w are, and the point or ray of
/// texel coordinate (0, 0); relative to the light, directional: to the eye.
struct Grid {
    glm::dvec3 dx, dy, last, zero;
};

Grid gridOf(const LightFit& fit, const LightView& light, glm::dvec3 eye, double side)
{
    const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    // Rows of the map's clip space, x and y in texels. Positional: relative to the light x, y and w have no constant
    // part.
    glm::dmat4 rows = glm::transpose(glm::dmat4(fit.clipFromWorld));
    rows[0] = 0.5 * side * (rows[0] + rows[3]);
    rows[1] = 0.5 * side * (rows[1] + rows[3]);
    const glm::dvec4 last = directional ? rows[2] : rows[3];
    const glm::dmat3 fromClip =
        glm::inverse(glm::transpose(glm::dmat3(glm::dvec3(rows[0]), glm::dvec3(rows[1]), glm::dvec3(last))));
    Grid grid{fromClip[0], fromClip[1], fromClip[2], fromClip[2]};
    if (directional) grid.zero = -(fromClip * glm::dvec3(rows[0].w, rows[1].w, last.w)) - eye;
    return grid;
}

/// `reach` of extrusionPlane() for everything in the map.
glm::dvec3 reachOf(const Grid& grid, const LightFit& fit, bool directional, double side)
{
    if (directional) return grid.zero + 0.5 * side * (grid.dx + grid.dy) + 0.5 * grid.last;
    glm::dvec3 least(1e30), most(-1e30);
    for (int i = 0; i < 4; ++i) {
        // The polygons reach one texel past the map.
        const double x = i & 1 ? side + 1.0 : -1.0, y = i & 2 ? side + 1.0 : -1.0;
        const glm::dvec3 ray = grid.zero + x * grid.dx + y * grid.dy;
        least = glm::min(least, ray);
        most = glm::max(most, ray);
    }
    glm::dvec3 reach(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        // Rays nearly across the axis would send vertices to the horizon.
        if (least[axis] > 1e-3 * most[axis]) reach[axis] = least[axis] * static_cast<double>(fit.nearWs);
        if (most[axis] < 1e-3 * least[axis]) reach[axis] = most[axis] * static_cast<double>(fit.nearWs);
    }
    return reach;
}

} // namespace

std::array<std::uint32_t, gpu::TEMPLATES * gpu::TEMPLATE_TRIANGLES> cellTemplates()
{
    std::array<std::uint32_t, gpu::TEMPLATES * gpu::TEMPLATE_TRIANGLES> result{};
    for (std::uint32_t variant = 0; variant < 3; ++variant) {
        for (std::uint32_t mask = 0; mask < 16; ++mask) {
            const std::uint32_t count = gpu::jumpCount(mask);
            const std::uint32_t variants = count == 4 ? 2 : count == 3 ? 3 : 1;
            if (variant < variants)
                fillTemplate(&result[(mask + 16 * variant) * gpu::TEMPLATE_TRIANGLES], mask, variant);
        }
    }
    return result;
}

gpu::DepthSurface depthSurface(const LightFit& fit, const LightView& light, glm::vec3 eye, std::uint32_t resolution)
{
    const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    const double side = resolution;
    const Grid grid = gridOf(fit, light, glm::dvec3(eye), side);
    gpu::DepthSurface surface{};
    surface.originEs = glm::vec4(glm::vec3(grid.zero), 0.0f);
    surface.texelDx = glm::vec4(glm::vec3(grid.dx), 0.0f);
    surface.texelDy = glm::vec4(glm::vec3(grid.dy), 0.0f);
    surface.reach = glm::vec4(glm::vec3(reachOf(grid, fit, directional, side)), 0.0f);
    surface.positional = directional ? 0.0f : 1.0f;
    surface.side = resolution;
    const double texel = std::max(glm::length(grid.dx), glm::length(grid.dy)); // metres; positional: at distance 1
    if (directional) {
        surface.axis = glm::vec4(glm::vec3(grid.last), 0.0f);
        surface.tolerance = static_cast<float>(texel / glm::length(grid.last));
        return surface;
    }
    // depth = constant + scale / w: a texel's width, w texel, changes it by -scale / w^2 of that = (constant - depth)
    // texel.
    const MapProjection projection = mapProjection(fit, light);
    surface.depthConstant = projection.depthConstant;
    surface.depthScale = projection.depthScale;
    surface.tolerancePerDepth = static_cast<float>(texel);
    return surface;
}

NearTexels nearTexels(const LightFit& fit, const std::array<glm::vec3, 4>& nearCorners, std::uint32_t resolution)
{
    NearTexels result;
    glm::dvec3 least(1e30), most(-1e30);
    int before = 0;
    for (const glm::vec3& corner : nearCorners) {
        const glm::dvec4 clip = glm::dmat4(fit.clipFromWorld) * glm::dvec4(glm::dvec3(corner), 1.0);
        if (clip.w <= 1e-6) continue; // micrometres before the light
        ++before;
        const glm::dvec3 at = glm::dvec3(clip) / clip.w;
        least = glm::min(least, at);
        most = glm::max(most, at);
    }
    if (before == 0) return result; // behind the light
    result.always = before < 4;
    if (result.always) return result;
    // Depth is linear over a plane, so its extremes lie in corners. 2^-20 covers its rounding.
    result.depth = static_cast<float>(most.z + 0x1p-20);
    if (result.depth <= 0.0f) return result;
    const double side = resolution;
    const auto texelOf = [side](double ndc) { return std::floor(0.5 * side * (ndc + 1.0) - 0.5); };
    // The cells it touches, and all their corners; past the map nothing casts, and one texel of that is enough.
    const glm::dvec2 first(texelOf(least.x), texelOf(least.y));
    const glm::dvec2 last(texelOf(most.x) + 1.0, texelOf(most.y) + 1.0);
    const glm::dvec2 from = glm::max(first, glm::dvec2(0.0)), to = glm::min(last, glm::dvec2(side - 1.0));
    if (from.x > to.x || from.y > to.y) return result; // beside the map
    result.always = (to.x - from.x + 1.0) * (to.y - from.y + 1.0) > gpu::MAX_NEAR_TEXELS;
    if (!result.always) result.texels = glm::vec4(glm::vec2(from), glm::vec2(to));
    return result;
}

} // namespace gnomon
