#pragma once
// What the time of a method depends on, and the linear terms that the cost model makes of it.
#include <array>
#include <cstdint>
#include <string_view>

namespace gnomon::cost {

enum class Pass : uint8_t { update, resolve }; ///< What a cache can skip; what every pixel pays.
enum class Processor : uint8_t { gpu, cpu };   ///< On a software device both are the same cores.

inline constexpr uint32_t kTracks = 4; ///< Pass x Processor.
constexpr uint32_t trackOf(Pass pass, Processor processor)
{
    return static_cast<uint32_t>(pass) * 2 + static_cast<uint32_t>(processor);
}

/// Of one light, in one view, by one method.
struct Workload {
    double pixels = 0.0;                     ///< Reached by the light.
    double casterTriangles = 0.0;            ///< In range of the light.
    double mapTexels = 0.0;                  ///< Of the method's maps for this light; 0: none.
    double sharing = 1.0;                    ///< Lights of the frame.
    bool still = false;                      ///< Light and casters stand still: the update may be skipped.
    double drawnTriangles = 0.0;             ///< Of the casters', those an update draws; 0: all of them.
    double casters = 0.0;                    ///< Instances in range.
    bool directional = false, point = false; ///< Kind of light; neither: a spot light.
    double drawnPixels = 0.0;                ///< Of the screen rectangle around the light; 0: `pixels`.
    double viewPixels = 0.0;                 ///< Of the view; 0: `pixels`.
    double shadowPixels = 0.0;               ///< Covered by the sides of shadow volumes; 0 for methods that draw none.
    double softPixels = 0.0;  ///< Reached by a light with a radius; 0 for methods whose edges do not follow it.
    double mapFilled = 1.0;   ///< Of the map's texels, by the casters that an update draws; each counts. May exceed 1.
    double mapTouched = 1.0;  ///< Share of the maps (one, or six faces) that these casters touch.
    double treeLevels = 0.0;  ///< On the way of a reached pixel's ray; 0 for methods that do not trace every pixel.
    bool viewRests = true;    ///< So does the view: the update of a map that follows it may be skipped, too.
    double redrawEvery = 1.0; ///< Frames from one update to the next, of what is not still; >= 1.

    bool operator==(const Workload&) const = default;
};

/// What one pass of a method on one processor takes is a sum of these, each times a number of milliseconds that is
/// never negative: what the device does is a sum, too, and a sum of parts that grow never falls outside of what was
/// measured.
enum class Term : uint8_t {
    fixed,         ///< 1
    triangles,     ///< Millions: drawn by an update, in range for a resolve. There, of methods that trace every pixel,
                   ///< times the share of the view that is reached: a ray meets only what is on its way.
    instances,     ///< Thousands, likewise.
    texels,        ///< Millions, of the faces that are touched.
    filledTexels,  ///< Millions, that casters fill in an update.
    viewPixels,    ///< Millions.
    drawnPixels,   ///< Millions, of the screen rectangle.
    reachedPixels, ///< Millions.
    rayLevels,     ///< Millions: reached pixels times levels of trees.
    sidePixels,    ///< Millions, under sides of shadow volumes.
    softPixels,    ///< Millions: reached pixels that may lie in a penumbra.
};
inline constexpr uint32_t kTerms = 11;
using Terms = std::array<double, kTerms>;
/// Column names of a knowledge base, by Term.
inline constexpr std::array<std::string_view, kTerms> kTermNames = {
    "fixed_ms",           "ms_per_mtriangle",    "ms_per_kinstance",      "ms_per_mtexel",     "ms_per_mfilled_texel",
    "ms_per_mview_pixel", "ms_per_mdrawn_pixel", "ms_per_mreached_pixel", "ms_per_mray_level", "ms_per_mside_pixel",
    "ms_per_msoft_pixel"};

Terms termsOf(const Workload& workload, Pass pass) noexcept;

/// The milliseconds that numbers per term make of terms.
constexpr double sumOf(const Terms& ms, const Terms& terms) noexcept
{
    double sum = 0.0;
    for (uint32_t i = 0; i < kTerms; ++i)
        sum += ms[i] * terms[i];
    return sum;
}

} // namespace gnomon::cost
