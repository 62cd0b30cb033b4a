#include "runtime/select/facts.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "runtime/cost/exponent.hpp"

namespace gnomon {

const std::array<FactName, kFactCount> kFactNames = {{
    {"dynamicLights", "count"},
    {"lightMotion", "share"},
    {"viewerDistance", "m"},
    {"screenShare", "share"},
    {"casterTriangles", "log10"},
    {"lightRadius", "m"},
    {"receiverPlanarity", "share"},
    {"frameBudget", "ratio"},
    {"frameRate", "Hz"},
}};

double trianglesFact(double triangles) noexcept
{
    constexpr double kLog10Of2 = 0.30102999566398119521;
    return cost::log2Exactly(std::max(1.0, triangles)) * kLog10Of2;
}

Reach measureReach(const CameraView& view, std::span<const DepthTile> tiles, std::uint32_t tilesX, std::uint32_t tilesY,
                   const LightView& light)
{
    Reach reach{.distance = std::numeric_limits<float>::infinity(), .share = 0.0f};
    std::uint32_t reached = 0;
    for (std::uint32_t y = 0; y < tilesY; ++y)
        for (std::uint32_t x = 0; x < tilesX; ++x) {
            const DepthTile tile = tiles[y * tilesX + x];
            if (!(tile.nearest <= tile.farthest)) continue; // sky
            Aabb box{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(std::numeric_limits<float>::lowest())};
            float shortest = std::numeric_limits<float>::max();
            for (std::uint32_t corner = 0; corner < 4; ++corner) {
                const glm::vec2 pixel{static_cast<float>(view.area.offset.x) + float((x + (corner & 1)) * kTilePixels),
                                      static_cast<float>(view.area.offset.y) +
                                          float((y + (corner >> 1)) * kTilePixels)};
                const glm::vec3 ray = gpu::viewRayWs(view.constants, pixel);
                for (const float depth : {tile.nearest, tile.farthest}) {
                    box.lower = glm::min(box.lower, view.eye + ray * depth);
                    box.upper = glm::max(box.upper, view.eye + ray * depth);
                }
                shortest = std::min(shortest, glm::length(ray));
            }
            if (!reaches(light, box)) continue;
            ++reached;
            // The ray through the middle of the screen is the shortest of all; within a tile its corners bound it well.
            reach.distance = std::min(reach.distance, tile.nearest * std::max(1.0f, shortest * 0.999f));
        }
    const std::uint32_t all = tilesX * tilesY;
    reach.share = all ? static_cast<float>(reached) / static_cast<float>(all) : 0.0f;
    return reach;
}

float reachLowerBound(const CameraView& view, const LightView& light)
{
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return 0.0f;
    return std::max(0.0f, glm::length(light.position() - view.eye) - light.constants.range);
}

void MotionHistory::note(std::uint64_t now, const LightView& light, const LightCasters& casters)
{
    if (frame == now) return; // several views
    const bool first = frame == 0;
    const bool moved =
        lightRevision != light.revision || movingStamp != casters.movingStamp || staticStamp != casters.staticStamp;
    bits = (bits << 1) | (moved && !first ? 1u : 0u);
    lightRevision = light.revision;
    movingStamp = casters.movingStamp;
    staticStamp = casters.staticStamp;
    frame = now;
}

double MotionHistory::share() const
{
    constexpr std::uint64_t kLast60 = (1ull << 60) - 1;
    return static_cast<double>(std::popcount(bits & kLast60)) / 60.0;
}

float MedianOfFive::get() const
{
    const std::uint32_t n = std::min(count, 5u);
    if (n == 0) return 0.0f;
    std::array<float, 5> sorted = values;
    std::sort(sorted.begin(), sorted.begin() + n);
    return sorted[n / 2];
}

} // namespace gnomon
