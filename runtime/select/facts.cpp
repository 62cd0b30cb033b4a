#include "runtime/select/facts.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>

#include "runtime/cost/exponent.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "runtime/scene/shadow_pixels.hpp"

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
    {"penumbraPixels", "px"},
    {"recorded", "flag"},
    {"texelPixels", "px"},
}};

double trianglesFact(double triangles) noexcept
{
    constexpr double kLog10Of2 = 0.30102999566398119521;
    return cost::log2Exactly(std::max(1.0, triangles)) * kLog10Of2;
}

namespace {

/// 60 degrees over 720 pixels.
constexpr float kUsualPixelAngle = 1.0f / 640.0f;

/// Where a pixel of a usual camera is as wide as all are without a perspective.
float orthographicDistance(const CameraView& view)
{
    return view.constants.pixelSize / kUsualPixelAngle;
}

/// Whether the front of the plane, which the eye sees, faces the light.
bool planeFaces(const CameraView& view, const LightView& light, const TileSample::Tile& tile)
{
    const gpu::ViewConstants& c = view.constants;
    const glm::vec2 middle = glm::vec2(view.area.offset.x, view.area.offset.y) + tile.place + gpu::PLANE_TILE_MIDDLE;
    const glm::vec3 normal = gpu::planeNormal(gpu::viewRayWs(c, middle), glm::vec3(c.rayDxWs), glm::vec3(c.rayDyWs),
                                              tile.plane.inverse, tile.plane.slopeX, tile.plane.slopeY);
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return glm::dot(normal, light.direction()) > 0.0f;
    return glm::dot(normal, light.position() - view.eye) < 1.0f;
}

float planarityOf(const CameraView& view, const LightView& light, std::span<const TileSample::Tile> tiles)
{
    std::uint32_t most = 0;
    // A plane that half of the tiles show is missed by 16 candidates once in 60 000 times, one of a quarter once in
    // 100.
    const std::size_t step = std::max<std::size_t>(1, tiles.size() / 16);
    for (std::size_t i = 0; i < tiles.size(); i += step) {
        if (tiles[i].plane.flatness == 0.0f || !planeFaces(view, light, tiles[i])) continue;
        std::uint32_t votes = 0;
        for (const TileSample::Tile& tile : tiles)
            votes += gpu::showsPlane(tile.plane, tiles[i].plane, tile.place - tiles[i].place, true);
        most = std::max(most, votes);
    }
    return tiles.empty() ? 0.0f : static_cast<float>(most) / static_cast<float>(tiles.size());
}

/// Of the tiles that show a plane.
float facingShare(const CameraView& view, const LightView& light, std::span<const TileSample::Tile> tiles)
{
    std::uint32_t flat = 0, facing = 0;
    for (const TileSample::Tile& tile : tiles) {
        if (tile.plane.flatness == 0.0f) continue;
        ++flat;
        facing += planeFaces(view, light, tile);
    }
    return flat == 0 ? 1.0f : static_cast<float>(facing) / static_cast<float>(flat);
}

/// The way from a receiver to a light, or for ever on towards a directional one.
struct WayToLight {
    glm::vec3 from{0.0f}, inverse{0.0f};
    float end = 0.0f;
    float own = 0.0f; ///< Up to there it is in what the receiver belongs to.

    /// Where it enters a box, 0 if it begins inside, and leaves it; 1 is the light, or a metre. Missed: after < before.
    struct Inside {
        float before, after;
    };
    Inside inside(const Aabb& box) const
    {
        const glm::vec3 a = (box.lower - from) * inverse, b = (box.upper - from) * inverse;
        const glm::vec3 in = glm::min(a, b), out = glm::max(a, b);
        return {std::max({in.x, in.y, in.z, 0.0f}), std::min({out.x, out.y, out.z, end})};
    }
};

/// Metres across the penumbra at a receiver, of what a way to the light meets at `entry`. Similar triangles: of a disc
/// of radius r at distance 1 a blocker at t throws 2 r t / (1 - t); of a directional light r is an angle.
float penumbraWidth(const LightView& light, float entry)
{
    constexpr float kNearSource = 0.95f; // what is nearer to the light hides all of it
    const float radius = light.constants.sourceRadius;
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return 2.0f * std::tan(std::min(radius, 1.5f)) * entry;
    const float t = std::min(entry, kNearSource);
    return 2.0f * radius * t / (1.0f - t);
}

/// @param distance from the eye to the receiver
WayToLight wayToLight(const LightView& light, glm::vec3 receiver, float distance)
{
    constexpr float kOwn = 0.01f; // of the distance: about the depth of a tile
    const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    const glm::vec3 ray = directional ? -light.direction() : light.position() - receiver;
    WayToLight way{.from = receiver,
                   .end = directional ? std::numeric_limits<float>::max() : 1.0f,
                   .own = kOwn * distance / std::max(glm::length(ray), 1e-20f)};
    for (int axis = 0; axis < 3; ++axis)
        way.inverse[axis] = 1.0f / (std::fabs(ray[axis]) < 1e-20f ? 1e-20f : ray[axis]);
    return way;
}

/// MapCoverage::nearness of a receiver in the middle of the tile.
float nearnessOf(const LightView& light, const ReceiverTile& tile)
{
    const float toEye = std::max(tile.distance, 1e-3f);
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return 1.0f / toEye;
    return std::min(glm::length(tile.box.center() - light.position()), light.constants.range) / toEye;
}

/// What a caster does to receivers at the end of a way that meets its bounds, spread evenly over the shadow of these.
struct Crossed {
    float edges = 0.0f;  ///< Metres of outline a square metre.
    float layers = 0.0f; ///< Faces that the way goes through.
};

/// @param entry of the way into the bounds: what is nearer to the light throws a larger shadow
Crossed crossedBy(const LightView& light, const Aabb& bounds, const Outline& outline, const WayToLight& way,
                  float entry)
{
    const glm::vec3 ray = glm::abs(1.0f / way.inverse), size = 2.0f * bounds.halfExtent();
    const float seen = (ray.x * size.y * size.z + ray.y * size.z * size.x + ray.z * size.x * size.y) /
                       std::max(glm::length(ray), 1e-20f); // square metres of the bounds
    const float spread = light.type == GN_LIGHT_TYPE_DIRECTIONAL ? 1.0f : std::max(1.0f - entry, 0.0f);
    const Crossed crossed{outline.length * spread / std::max(seen, 1e-12f), outline.area / std::max(seen, 1e-12f)};
    return std::isfinite(crossed.edges) && std::isfinite(crossed.layers) ? crossed : Crossed{}; // bounds without end
}

/// All that a way meets, as a Boolean model has it (D. Stoyan, W. S. Kendall, J. Mecke, "Stochastic Geometry and its
/// Applications", 1995): an outline is seen where nothing else hides it.
struct WayShadows {
    Crossed sum;

    void add(const Crossed& more)
    {
        sum.edges += more.edges;
        sum.layers += more.layers;
    }
    /// @param each one caster of so many was asked
    float edges(float each) const
    {
        constexpr float kLog2E = 1.44269504f;
        return each * sum.edges * static_cast<float>(cost::exp2Exactly(double{-kLog2E * each * sum.layers}));
    }
};

/// Reach::treeLevels of receivers that face the light, Reach::penumbraPixels and Reach::outlines.
struct Met {
    float levels = 0.0f, penumbraPixels = 0.0f, outlines = 0.0f;
};

Met metByWays(const CameraView& view, const LightView& light, std::span<const Caster* const> casters,
              std::span<const TileSample::Tile> tiles)
{
    // Ways times boxes at most, every eighth frame. Ways go first, down to a sixteenth of them, then boxes.
    constexpr std::size_t kMost = 2048;
    const std::size_t asked = tiles.size() * casters.size();
    if (asked == 0) return {};
    const std::size_t stepTiles = std::min<std::size_t>(1 + asked / kMost, 16);
    const std::size_t stepCasters = 1 + asked / stepTiles / kMost;
    constexpr float kNone = std::numeric_limits<float>::max();
    std::array<WayToLight, TileSample::kMost> ways;
    std::array<float, TileSample::kMost> nearest; // of what may cast on the receiver, in terms of the way
    std::array<WayShadows, TileSample::kMost> shadows;
    std::size_t count = 0;
    const auto distanceTo = [&](glm::vec3 place) {
        return gpu::isOrthographic(view.constants) ? orthographicDistance(view) : glm::length(place - view.eye);
    };
    for (std::size_t t = 0; t < tiles.size(); t += stepTiles) {
        nearest[count] = kNone;
        ways[count++] = wayToLight(light, tiles[t].middle, distanceTo(tiles[t].middle));
    }
    Met sum;
    for (std::size_t c = 0; c < casters.size(); c += stepCasters) {
        const Outline outline = outlineOf(*casters[c]);
        std::uint32_t met = 0;
        for (std::size_t way = 0; way < count; ++way) {
            const WayToLight::Inside box = ways[way].inside(casters[c]->bounds);
            if (box.after < box.before) continue;
            ++met;
            shadows[way].add(crossedBy(light, casters[c]->bounds, outline, ways[way], box.before));
            // Within the bounds, what casts is somewhere up to their end; where that is near the receiver lies on it.
            const float entry = box.before > 0.0f ? box.before : 0.5f * box.after;
            if (entry > ways[way].own) nearest[way] = std::min(nearest[way], entry);
        }
        const double triangles = casters[c]->mesh ? casters[c]->mesh->triangleCount() : 0.0;
        if (met > 0) sum.levels += static_cast<float>(met) * static_cast<float>(cost::log2Exactly(1.0 + triangles));
    }
    sum.levels *= static_cast<float>(stepCasters) / static_cast<float>(count);
    const auto pixelAt = [&](const WayToLight& way) { // metres across
        return pixelAngleOf(view) * std::max(distanceTo(way.from), 1e-3f);
    };
    for (std::size_t way = 0; way < count; ++way)
        sum.outlines += std::min(1.0f, shadows[way].edges(static_cast<float>(stepCasters)) * pixelAt(ways[way]));
    sum.outlines /= static_cast<float>(count);
    if (!(light.constants.sourceRadius > 0.0f)) return sum;
    std::uint32_t shadowed = 0;
    for (std::size_t way = 0; way < count; ++way) {
        if (nearest[way] == kNone) continue;
        ++shadowed;
        sum.penumbraPixels += penumbraWidth(light, nearest[way]) / pixelAt(ways[way]);
    }
    if (shadowed > 0) sum.penumbraPixels /= static_cast<float>(shadowed);
    return sum;
}

} // namespace

float pixelAngleOf(const CameraView& view)
{
    return gpu::isOrthographic(view.constants) ? kUsualPixelAngle : view.constants.pixelSize;
}

void receiverTiles(const CameraView& view, std::span<const DepthTile> tiles, std::uint32_t tilesX,
                   std::vector<ReceiverTile>& out)
{
    out.clear();
    for (std::uint32_t i = 0; i < tiles.size(); ++i) {
        const DepthTile& tile = tiles[i];
        if (!(tile.nearest <= tile.farthest)) continue; // sky
        const std::uint32_t x = i % tilesX, y = i / tilesX;
        Aabb box{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(std::numeric_limits<float>::lowest())};
        float shortest = std::numeric_limits<float>::max();
        for (std::uint32_t corner = 0; corner < 4; ++corner) {
            const glm::vec2 pixel{static_cast<float>(view.area.offset.x) + float((x + (corner & 1)) * kTilePixels),
                                  static_cast<float>(view.area.offset.y) + float((y + (corner >> 1)) * kTilePixels)};
            const glm::vec3 ray = gpu::viewRayWs(view.constants, pixel);
            for (const float distance : {tile.nearest, tile.farthest}) {
                const glm::vec3 place = view.eye + gpu::atDistanceWs(view.constants, ray, distance);
                box.lower = glm::min(box.lower, place);
                box.upper = glm::max(box.upper, place);
            }
            shortest = std::min(shortest, glm::length(ray));
        }
        out.push_back({.box = box,
                       // The ray through the middle of the screen is the shortest of all; within a tile its corners
                       // bound it well.
                       .distance = gpu::isOrthographic(view.constants)
                                       ? orthographicDistance(view)
                                       : tile.nearest * std::max(1.0f, shortest * 0.999f),
                       .x = x,
                       .y = y,
                       .plane = tile.plane,
                       .whole = (x + 1) * kTilePixels <= view.area.extent.width &&
                                (y + 1) * kTilePixels <= view.area.extent.height});
    }
}

void TileSample::add(const ReceiverTile& tile, float nearness)
{
    if (seen_++ % stride_ != 0) return;
    if (count_ == kMost) {
        count_ /= 2;
        for (std::uint32_t i = 0; i < count_; ++i)
            tiles_[i] = tiles_[2 * i];
        stride_ *= 2;
        if ((seen_ - 1) % stride_ != 0) return;
    }
    tiles_[count_++] = {tile.plane, glm::vec2(tile.x, tile.y) * static_cast<float>(kTilePixels), tile.box.center(),
                        nearness};
}

Reach measureReach(const CameraView& view, std::span<const ReceiverTile> tiles, std::uint32_t allTiles,
                   const LightView& light, std::span<const Caster* const> casters, TileSample& sample)
{
    Reach reach{.distance = std::numeric_limits<float>::infinity()};
    std::uint32_t reached = 0;
    double nearnesses = 0.0;
    for (const ReceiverTile& tile : tiles) {
        if (!reaches(light, tile.box)) continue;
        ++reached;
        const float nearness = nearnessOf(light, tile);
        if (tile.whole) sample.add(tile, nearness);
        reach.distance = std::min(reach.distance, tile.distance);
        reach.nearness = std::max(reach.nearness, nearness);
        nearnesses += double{nearness};
    }
    if (reached > 0) reach.meanNearness = static_cast<float>(nearnesses / reached);
    reach.share = allTiles ? static_cast<float>(reached) / static_cast<float>(allTiles) : 0.0f;
    reach.planarity = planarityOf(view, light, sample.tiles());
    const Met met = metByWays(view, light, casters, sample.tiles());
    reach.treeLevels = facingShare(view, light, sample.tiles()) * met.levels;
    reach.penumbraPixels = met.penumbraPixels;
    reach.outlines = met.outlines;
    return reach;
}

double penumbraPercent(double penumbraPixels, double height)
{
    // Length of all shadows' edges in a picture, in heights of it, and the share of a penumbra where a hard edge is off
    // by more than a tenth: 1.0 to 2.2 for the lights of views/soft_table (gnomon bench, 640x360).
    constexpr double kEdges = 1.6;
    constexpr double kUnseen = 2.0; // pixels: as narrow as a hard edge's own step from pixel to pixel
    constexpr double kMost = 50.0;
    const double width = std::max(penumbraPixels - kUnseen, 0.0);
    return height > 0.0 ? std::min(100.0 * kEdges * width / height, kMost) : 0.0;
}

float reachLowerBound(const CameraView& view, const LightView& light)
{
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return 0.0f;
    if (gpu::isOrthographic(view.constants)) return orthographicDistance(view);
    return std::max(0.0f, glm::length(light.position() - view.eye) - light.constants.range);
}

double guessedShare(const CameraView& view, const LightView& light)
{
    // Of the rectangle around a light, by GnLightType: the rest is sky, out of its range or beside its cone. Medians of
    // the moments in rules/knowledge/lavapipe.csv, a matter of scenes, not of devices.
    constexpr double kReached[] = {0.82, 0.31, 0.72};
    const VkExtent2D around = lightPixels(light, view).extent, all = view.area.extent;
    return kReached[light.type] * around.width * around.height / (double(all.width) * double(all.height));
}

void MotionHistory::note(std::uint64_t now, const LightView& light, const LightCasters& casters, bool shifted)
{
    if (frame == now) return; // several views
    const bool first = frame == 0;
    const bool moved =
        lightRevision != light.revision || dynamicStamp != casters.dynamicStamp || staticStamp != casters.staticStamp;
    bits = (bits << 1) | (shifted ? bits & 1u : moved && !first ? 1u : 0u);
    lightRevision = light.revision;
    dynamicStamp = casters.dynamicStamp;
    staticStamp = casters.staticStamp;
    frame = now;
    isNew = first;
}

bool MotionHistory::rests() const
{
    constexpr int kShortest = 4, kLongestRhythm = 16;
    if (bits == 0) return true;
    const int since = std::countr_zero(bits);
    if (since < kShortest) return false;
    const std::uint64_t before = bits >> since >> 1;
    const int apart = before != 0 ? std::countr_zero(before) + 1 : kLongestRhythm + 1;
    return apart > kLongestRhythm || since >= apart;
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
    std::fill(sorted.begin() + n, sorted.end(), std::numeric_limits<float>::infinity()); // places not yet used, last
    std::sort(sorted.begin(), sorted.end());
    return sorted[n / 2];
}

void TracedOutlines::add(float density, float texelPixels)
{
    // Of the first eight the mean; then the newest counts an eighth. What is said follows by steps of a seventh.
    constexpr std::uint32_t kMean = 8;
    constexpr float kSame = 0.15f;
    const bool first = count_ == 0;
    count_ = std::min(count_ + 1, kMean);
    const float share = 1.0f / static_cast<float>(count_);
    mean_ = first ? Outlines{} : mean_;
    mean_.density += (density - mean_.density) * share;
    mean_.texels += (density * texelPixels - mean_.texels) * share;
    const auto isSame = [](float a, float b) { return std::fabs(a - b) <= kSame * b; };
    if (first || !isSame(mean_.density, taken_.density) || !isSame(mean_.texels, taken_.texels)) taken_ = mean_;
}

float SecondOfEight::get() const
{
    std::array<float, 8> sorted = values;
    const auto end = sorted.begin() + std::min<std::ptrdiff_t>(count, std::ssize(sorted));
    std::partial_sort(sorted.begin(), std::min(sorted.begin() + 2, end), end, std::greater<>());
    return count > 1 ? sorted[1] : sorted[0];
}

float WeightedMedianOfFive::get() const
{
    std::array<cost::Weighted, 5> sorted = values;
    return static_cast<float>(cost::weightedMedian(std::span(sorted).first(std::min(count, 5u))));
}

} // namespace gnomon
