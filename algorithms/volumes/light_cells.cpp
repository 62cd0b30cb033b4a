#include "algorithms/volumes/light_cells.hpp"

#include <algorithm>
#include <cmath>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

namespace gnomon {

namespace {

/// Bounds of a box in a fit's clip space; depth from 0 near.
struct Projected {
    glm::vec2 lower{1e30f}, upper{-1e30f};
    float nearest = 1e30f;
    bool before = false, behind = false; ///< Corners on this side of the plane through the light.
};

Projected project(const LightFit& fit, const Aabb& box)
{
    Projected result;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p((corner & 1) ? box.upper.x : box.lower.x, (corner & 2) ? box.upper.y : box.lower.y,
                          (corner & 4) ? box.upper.z : box.lower.z);
        const glm::vec4 clip = fit.clipFromWorld * glm::vec4(p, 1.0f);
        // Closer to the light's plane than 1/1000 of the near end, a projection says little.
        if (clip.w <= 1e-3f * std::min(fit.nearWs > 0.0f ? fit.nearWs : 1.0f, 1.0f)) {
            result.behind = true;
            continue;
        }
        result.before = true;
        const glm::vec2 place = glm::vec2(clip) / clip.w;
        result.lower = glm::min(result.lower, place);
        result.upper = glm::max(result.upper, place);
        result.nearest = std::min(result.nearest, clip.z / clip.w);
    }
    return result;
}

} // namespace

std::uint32_t cellFootprints(std::span<const LightFit> fits, std::uint32_t resolution, const Aabb& box,
                             gpu::CellFootprint (&out)[gpu::MAX_LAYERS])
{
    constexpr auto kCells = static_cast<float>(gpu::CELLS);
    constexpr std::uint32_t kLast = gpu::CELLS - 1;
    std::uint32_t count = 0;
    for (std::uint32_t layer = 0; layer < fits.size(); ++layer) {
        // Light rays start inside the sides and stay there; what is outside shadows nothing that the map looks at.
        if (!touches(box, std::span(fits[layer].volume).first(4))) continue;
        const Projected projected = project(fits[layer], box);
        if (!projected.before) continue;
        if (projected.behind) { // its picture has no simple bounds
            out[count++] = {layer, 0, 0, kLast, kLast, 1};
            continue;
        }
        // One texel around covers the rounding of either side.
        const float margin = kCells / static_cast<float>(resolution);
        const glm::vec2 lower = (0.5f * projected.lower + 0.5f) * kCells - margin;
        const glm::vec2 upper = (0.5f * projected.upper + 0.5f) * kCells + margin;
        if (upper.x < 0.0f || upper.y < 0.0f || lower.x > kCells || lower.y > kCells) continue;
        const auto cell = [](float at) { return static_cast<std::uint32_t>(std::clamp(at, 0.0f, kCells - 1.0f)); };
        out[count++] = {layer,         cell(lower.x), cell(lower.y),
                        cell(upper.x), cell(upper.y), gpu::depthKey(projected.nearest - 4.0f * gpu::DEPTH_ROUNDING)};
    }
    return count;
}

} // namespace gnomon
