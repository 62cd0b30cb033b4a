#pragma once
// What the rules may ask about a light in a view: measured where it can be, a bound until then.
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "runtime/cost/weighted_median.hpp"
#include "runtime/scene/scene_view.hpp"
#include "shaders/shared/tile_plane.h"

namespace gnomon {

enum class Fact : std::uint8_t {
    dynamicLights,     ///< Count: lights of the view that are not static (GN_LIGHT_STATIC_BIT), or moved all the same.
    lightMotion,       ///< Share of the last 60 frames in which the light or a caster in its range moved.
    viewerDistance,    ///< Metres from the eye to the nearest visible receiver of the light.
    screenShare,       ///< Share of the view's tiles that the light reaches, median of 5 measurements.
    casterTriangles,   ///< log10 of the triangles in range.
    lightRadius,       ///< Metres.
    receiverPlanarity, ///< Share of the light's visible receivers on one plane; unknown (NaN) until measured.
    frameBudget,       ///< Predicted ms of the cheapest methods that may serve / budget; 0 without a budget.
    frameRate,         ///< Hz, mean over the last 30 frames.
    penumbraPixels, ///< Predicted width of the light's penumbrae, pixels; 0 of a point source, unknown until measured.
    recorded,       ///< 1: the frame is recorded into the host's command buffer, without the CPU between its passes.
    texelPixels,    ///< Pixels across a texel of a plain map of 1024, mean over the light's receivers; unknown (NaN)
                    ///< until measured.
    count
};
constexpr std::size_t kFactCount = static_cast<std::size_t>(Fact::count);

struct FactName {
    const char* name;
    const char* unit;
};
/// In the order of Fact.
extern const std::array<FactName, kFactCount> kFactNames;

using FactValues = std::array<double, kFactCount>;

/// Fact::casterTriangles; fewer than one counts as one. From + - * / alone: libm's logarithms differ between machines.
double trianglesFact(double triangles) noexcept;

/// Nearest and farthest linear depth of one tile; nearest > farthest where there is only sky.
struct DepthTile {
    float nearest;
    float farthest;
    gpu::TilePlane plane;
};
constexpr std::uint32_t kTilePixels = gpu::PLANE_TILE; ///< Side of a tile.

/// A tile that shows more than sky: what every light is asked about it.
struct ReceiverTile {
    Aabb box;              ///< Around the piece of the frustum between its two depths.
    float distance = 0.0f; ///< From the eye to that piece; never farther than the true nearest receiver. Metres.
    std::uint32_t x = 0, y = 0;
    gpu::TilePlane plane;
    bool whole = false; ///< Within the picture; others were not asked for their plane.
};

/// Width of a pixel at 1 m; orthographic: of one of a usual camera, at whose distance receivers are said to be.
float pixelAngleOf(const CameraView& view);

/// The tiles of a depth grid, row by row, without sky; in place of what `out` holds.
void receiverTiles(const CameraView& view, std::span<const DepthTile> tiles, std::uint32_t tilesX,
                   std::vector<ReceiverTile>& out);

/// Some of the whole tiles that a light reaches, spread over all of them: the stride doubles whenever there are too
/// many.
class TileSample {
public:
    struct Tile {
        gpu::TilePlane plane;
        glm::vec2 place; ///< Of its corner in the drawn area, pixels.
        glm::vec3 middle;
        float nearness; ///< MapCoverage::nearness of a receiver there.
    };
    void add(const ReceiverTile& tile, float nearness);
    std::span<const Tile> tiles() const { return std::span(tiles_).first(count_); }
    // A share of 256 tiles is known to 3 %, a quarter of what divides flat from rough in the shipped rules.
    static constexpr std::uint32_t kMost = 256;

private:
    std::array<Tile, kMost> tiles_;
    std::uint32_t count_ = 0, stride_ = 1, seen_ = 0;
};

/// What the newest depth grid says about a light.
struct Reach {
    float distance = 0.0f;     ///< Eye to the nearest receiver, metres; infinite if none is visible.
    float share = 0.0f;        ///< Of the tiles.
    float nearness = 0.0f;     ///< MapCoverage::nearness, of the middles of tiles.
    float meanNearness = 0.0f; ///< The same, on average.
    float planarity = 0.0f;    ///< Share of those tiles that show the plane which most of them show, facing the light.
    /// Levels of trees that a ray towards the light goes through, on average over these receivers: log2 of the
    /// triangles of every caster whose bounds it meets; none where a receiver faces away.
    float treeLevels = 0.0f;
    /// Pixels across the penumbra of a source with a radius: the mean over receivers whose way to the light meets the
    /// bounds of a caster, the nearest one taken for what casts.
    float penumbraPixels = 0.0f;
    /// Pixels of shadows' outlines a pixel of these receivers: of every caster whose bounds a way to the light meets, a
    /// pixel at most. What a map shows wrongly lies along them. An estimate for where rays do not tell (outlines.hpp).
    float outlines = 0.0f;
};

/// Outlines of a light's shadows on what a view sees, as rays tell them.
struct ShadowOutlines {
    float density = 0.0f;  ///< Pixels of outline a pixel that the light may reach.
    float nearness = 0.0f; ///< MapCoverage::nearness where the outlines are, on average; 0: there are none.
};

/// Pixels, in percent of those that the light falls on, where a hard edge in place of a penumbra is off by more than a
/// tenth: what adds to the wrong ones of a method whose edges are hard.
/// @param height of the picture, pixels
double penumbraPercent(double penumbraPixels, double height);

/// Receivers of a tile lie in the frustum piece between its two depths; a tile counts if the light may reach that
/// piece. Exact up to the tile: never farther than the true nearest receiver.
/// @param allTiles Of the grid, sky included. @param casters Of the light. @param sample Empty; gets
/// what it holds of the tiles.
Reach measureReach(const CameraView& view, std::span<const ReceiverTile> tiles, std::uint32_t allTiles,
                   const LightView& light, std::span<const Caster* const> casters, TileSample& sample);

/// Distance below which no receiver of the light can lie: to its range.
float reachLowerBound(const CameraView& view, const LightView& light);

/// Share of the picture that a light is taken to reach until that is measured.
double guessedShare(const CameraView& view, const LightView& light);

/// One bit per frame, newest first.
struct MotionHistory {
    std::uint64_t bits = 0;
    std::uint64_t lightRevision = 0, dynamicStamp = 0, staticStamp = 0;
    std::uint64_t frame = 0;
    bool isNew = true; ///< Noted once at most: nobody knows yet whether it moves.

    /// @param shifted the frame's origin has moved: revisions are others, whatever has moved besides is not told
    void note(std::uint64_t now, const LightView& light, const LightCasters& casters, bool shifted = false);
    double share() const;
    /// Nothing has moved for four frames, nor for as long as passed between the last two moves, if these were no more
    /// than sixteen frames apart: what moves in every so many frames does not rest between.
    bool rests() const;
};

/// Median of the last five values.
struct MedianOfFive {
    std::array<float, 5> values{};
    std::uint32_t count = 0;
    void add(float value) { values[count++ % 5] = value; }
    float get() const;
    void reset() { count = 0; }
};

/// What rays have told of a light's outlines.
class TracedOutlines {
public:
    /// @param texelPixels across a texel of a plain map of 1024 at those outlines
    void add(float density, float texelPixels);
    void reset() { count_ = 0; }
    bool known() const { return count_ > 0; }
    float density() const { return taken_.density; }
    /// 0: no outlines.
    float texelPixels() const { return taken_.density > 0.0f ? taken_.texels / taken_.density : 0.0f; }

private:
    struct Outlines {
        float density = 0.0f;
        float texels = 0.0f; ///< density times texelPixels.
    };
    std::uint32_t count_ = 0;
    Outlines mean_, taken_; ///< Of what was added, and as it is said.
};

/// The second largest of the last eight values: what recurs among them, but not what stands out once.
struct SecondOfEight {
    std::array<float, 8> values{};
    std::uint32_t count = 0;
    void add(float value) { values[count++ % values.size()] = value; }
    float get() const; ///< The only one while there is no second; 0 without any.
};

/// Weighted median of the last five values.
struct WeightedMedianOfFive {
    std::array<cost::Weighted, 5> values{};
    std::uint32_t count = 0;
    void add(float value, float weight) { values[count++ % 5] = {double{value}, double{weight}}; }
    float get() const; ///< 0 where nothing has a weight.
};

} // namespace gnomon
