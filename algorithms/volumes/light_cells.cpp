#include "algorithms/volumes/light_cells.hpp"

#include <algorithm>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "algorithms/shared/map_lookup.hpp"

namespace gnomon {

namespace {

// The box and the casters in it are floats that count from the frame's origin: eight units in the last place of the
// largest, as for receivers (map_lookup.cpp).
constexpr double kCoordinateError = 0x1p-21;

/// Bounds of a box in a fit's clip space; depth from 0 near.
struct Projected {
    glm::dvec2 lower{1e30}, upper{-1e30};
    double nearest = 1e30;
    bool before = false, behind = false; ///< Corners on this side of the plane through the light.
};

double largest(const Aabb& box)
{
    const glm::dvec3 size = glm::max(glm::abs(glm::dvec3(box.lower)), glm::abs(glm::dvec3(box.upper)));
    return std::max({size.x, size.y, size.z});
}

/// As the shader looks receivers up: about the light, and with depth made of clip w alone (mapDepth(), map_lookup.h).
/// One from a clip z of its own, or about the origin, would round apart from it, by metres where the near end is close.
Projected project(const LightFit& fit, const LightView& light, const Aabb& box)
{
    const MapProjection map = mapProjection(fit, light);
    const glm::dmat4 clipFromZero(map.clipFromZero), rows = glm::transpose(clipFromZero);
    const auto lengthOf = [&](int row) { return glm::length(glm::dvec3(rows[row])); };
    const bool perspective = light.type != GN_LIGHT_TYPE_DIRECTIONAL;
    const double error = kCoordinateError * largest(box), forward = error * lengthOf(3);
    const double aside = error * std::max(lengthOf(0), lengthOf(1)), along = error * lengthOf(2);
    // Closer to the light's plane than 1/1000 of the near end, a projection says little.
    const double least = forward + 1e-3 * (perspective ? std::min(static_cast<double>(fit.nearWs), 1.0) : 1.0);
    Projected result;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p((corner & 1) ? box.upper.x : box.lower.x, (corner & 2) ? box.upper.y : box.lower.y,
                          (corner & 4) ? box.upper.z : box.lower.z);
        const glm::dvec4 clip = clipFromZero * glm::dvec4(glm::dvec3(p) - glm::dvec3(map.zeroWs), 1.0);
        if (clip.w <= least) {
            result.behind = true;
            continue;
        }
        result.before = true;
        const glm::dvec2 place = glm::dvec2(clip) / clip.w;
        const glm::dvec2 room = (aside + forward * glm::abs(place)) / clip.w;
        result.lower = glm::min(result.lower, place - room);
        result.upper = glm::max(result.upper, place + room);
        const double depth = perspective ? static_cast<double>(map.depthConstant) +
                                               static_cast<double>(map.depthScale) / (clip.w - forward)
                                         : clip.z - along;
        result.nearest = std::min(result.nearest, depth);
    }
    return result;
}

} // namespace

std::uint32_t cellFootprints(std::span<const LightFit> fits, const LightView& light, std::uint32_t resolution,
                             const Aabb& box, gpu::CellFootprint (&out)[gpu::MAX_LAYERS])
{
    constexpr auto kCells = static_cast<float>(gpu::CELLS);
    constexpr std::uint32_t kLast = gpu::CELLS - 1;
    std::uint32_t count = 0;
    for (std::uint32_t layer = 0; layer < fits.size(); ++layer) {
        // Light rays start inside the sides and stay there; what is outside shadows nothing that the map looks at.
        if (!touches(box, std::span(fits[layer].volume).first(4))) continue;
        const Projected projected = project(fits[layer], light, box);
        if (!projected.before) continue;
        if (projected.behind) { // its picture has no simple bounds
            out[count++] = {layer, 0, 0, kLast, kLast, 1};
            continue;
        }
        // One texel around covers the rounding of either side.
        const float margin = kCells / static_cast<float>(resolution);
        const glm::vec2 lower = (0.5f * glm::vec2(projected.lower) + 0.5f) * kCells - margin;
        const glm::vec2 upper = (0.5f * glm::vec2(projected.upper) + 0.5f) * kCells + margin;
        if (upper.x < 0.0f || upper.y < 0.0f || lower.x > kCells || lower.y > kCells) continue;
        const auto cell = [](float at) { return static_cast<std::uint32_t>(std::clamp(at, 0.0f, kCells - 1.0f)); };
        const float nearest = static_cast<float>(projected.nearest) - 4.0f * gpu::DEPTH_ROUNDING;
        out[count++] = {layer, cell(lower.x), cell(lower.y), cell(upper.x), cell(upper.y), gpu::depthKey(nearest)};
    }
    return count;
}

} // namespace gnomon
