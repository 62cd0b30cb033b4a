#include "runtime/select/outlines.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

namespace gnomon {

namespace {

// Corners of a square about the middle of a tile, in ring order, by its side. On a tile that shows one plane the side,
// in pixels, is as long as stays within the tile: it meets more outlines, and few tiles tell how dense they are. On
// others only what is close to the middle is on the plane there.
constexpr std::array<glm::vec2, 4> kPlaces = {{{-0.5f, -0.5f}, {0.5f, -0.5f}, {0.5f, 0.5f}, {-0.5f, 0.5f}}};
constexpr float kSide = 12.0f, kRoughSide = 2.0f;
// On a tile that shows no one plane: so many outlines count as one. Some are where a round surface turns away from the
// light; there maps are not asked. By the fit that kUsualTraced (frame_plan_quality.cpp) is from; 0.3 to 0.7 fit alike.
constexpr float kRoughWeight = 0.5f;
// And rays start so much farther away than elsewhere, in pixels: what bulges is above the plane through its middle.
constexpr float kBulge = 1.0f / 8.0f;

/// The rays of one tile, and which of them there are.
struct TileRays {
    std::array<ShadowRay, kPlaces.size()> rays{};
    std::array<bool, kPlaces.size()> reached{};
    float weight = 0.0f; ///< Of an outline, in sides of kSide pixels.
};

/// @param normal of the plane, planeNormal()
ShadowRay rayFrom(const CameraView& view, const LightView& light, glm::vec3 viewRay, float w, glm::vec3 normal,
                  float more)
{
    const gpu::ViewConstants& c = view.constants;
    const float depth = (c.depthScale / w - c.depthAdd) / c.depthMul;
    const glm::vec3 receiver = view.eye + w * viewRay, away = -glm::normalize(normal);
    const float offset =
        gpu::receiverOffset(c, light.constants, depth, viewRay, receiver, away) + more * w * c.pixelSize;
    const gpu::LightRay ray = gpu::lightRay(light.constants, receiver, away, offset, std::numeric_limits<float>::max());
    return {.origin = ray.start, .tfar = ray.end, .direction = ray.along};
}

TileRays raysOf(const CameraView& view, const LightView& light, const TileSample::Tile& tile)
{
    TileRays found;
    if (!(tile.plane.inverse > 0.0f)) return found; // sky in the middle
    const bool flat = tile.plane.flatness > 0.0f;
    const float side = flat ? kSide : kRoughSide;
    found.weight = (flat ? 1.0f : kRoughWeight) * kSide / side;
    const gpu::ViewConstants& c = view.constants;
    const glm::vec2 corner = glm::vec2(view.area.offset.x, view.area.offset.y) + tile.place;
    const glm::vec2 middle = corner + gpu::PLANE_TILE_MIDDLE;
    const glm::vec3 normal = gpu::planeNormal(gpu::viewRayWs(c, middle), glm::vec3(c.rayDxWs), glm::vec3(c.rayDyWs),
                                              tile.plane.inverse, tile.plane.slopeX, tile.plane.slopeY);
    for (std::size_t i = 0; i < kPlaces.size(); ++i) {
        const glm::vec3 viewRay = gpu::viewRayWs(c, middle + side * kPlaces[i]);
        const float w = 1.0f / gpu::planeInverse(tile.plane, side * kPlaces[i]);
        if (!(w > 0.0f) || !gpu::lightReaches(light.constants, view.eye + w * viewRay)) continue;
        found.rays[i] = rayFrom(view, light, viewRay, w, normal, flat ? 0.0f : kBulge);
        // The normal points away from the eye.
        found.reached[i] = glm::dot(normal, found.rays[i].direction) < 0.0f && found.rays[i].tfar > 0.0f;
    }
    return found;
}

/// Sides of the square that have an outline between their ends.
std::size_t outlinesOf(const TileRays& tile, std::span<const std::uint8_t> blocked)
{
    std::size_t found = 0;
    for (std::size_t i = 0; i < kPlaces.size(); ++i) {
        const std::size_t next = (i + 1) % kPlaces.size();
        found += tile.reached[i] && tile.reached[next] && blocked[i] != blocked[next];
    }
    return found;
}

} // namespace

bool raysTellOutlines(const LightCasters& casters)
{
    return std::ranges::all_of(casters.all,
                               [](const Caster* caster) { return castsRays(*caster) && !opacityOf(*caster); });
}

std::optional<ShadowOutlines> outlinesByRays(const CameraView& view, const LightView& light,
                                             std::span<const TileSample::Tile> tiles, const RayScene& rays)
{
    if (tiles.empty() || gpu::isOrthographic(view.constants)) return std::nullopt;
    constexpr std::size_t kTogether = RayPacket::kWidth / kPlaces.size();
    std::array<TileRays, kTogether> some;
    std::array<ShadowRay, RayPacket::kWidth> asked;
    std::array<std::uint8_t, RayPacket::kWidth> blocked;
    float sum = 0.0f, nearness = 0.0f;
    for (std::size_t first = 0; first < tiles.size(); first += kTogether) {
        const std::size_t count = std::min(kTogether, tiles.size() - first), lanes = count * kPlaces.size();
        for (std::size_t t = 0; t < count; ++t) {
            some[t] = raysOf(view, light, tiles[first + t]);
            for (std::size_t i = 0; i < kPlaces.size(); ++i) {
                ShadowRay& ray = asked[t * kPlaces.size() + i] = some[t].rays[i];
                if (!some[t].reached[i]) ray.tfar = -1.0f; // no ray
            }
        }
        rays.occluded(std::span(asked).first(lanes), light.mask, std::span(blocked).first(lanes));
        for (std::size_t t = 0; t < count; ++t) {
            const auto ends = std::span(blocked).subspan(t * kPlaces.size(), kPlaces.size());
            const float found = some[t].weight * static_cast<float>(outlinesOf(some[t], ends));
            sum += found;
            nearness += found * tiles[first + t].nearness;
        }
    }
    // Of lines in all directions so many cross a segment: 2 / pi of its length times their density (Buffon, 1777).
    const float length = kSide * static_cast<float>(tiles.size() * kPlaces.size());
    return ShadowOutlines{.density = sum / length * (std::numbers::pi_v<float> / 2.0f),
                          .nearness = sum > 0.0f ? nearness / sum : 0.0f};
}

} // namespace gnomon
