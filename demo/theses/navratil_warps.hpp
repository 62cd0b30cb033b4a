#pragma once
// The comparisons of chapter 5 of Navratil's thesis, repeated: maps that are warped or cut to the view beside plain
// ones and volumes, on a short walk under a light that moves in every frame.

#include <array>
#include <functional>

#include "demo/program/session.hpp"
#include "demo/program/setting_choices.hpp"

namespace gnomon::demo {

/// A row of his tables.
enum class WarpRow : uint8_t { volumes, map, minimal, desired, rectilinear, nonorthogonal };
inline constexpr size_t kWarpRows = 6;
const char* nameOf(WarpRow row) noexcept; ///< His.

/// The same of a lamp in view.
enum class LampRow : uint8_t { volumes, cube, discs, warpedCube, warpedDiscs };
inline constexpr size_t kLampRows = 5;
const char* nameOf(LampRow row) noexcept;

/// Scenes that stand in for the conference room, Sponza and the observatory of table 5.1. Table 5.3 does not name its
/// scene; its pictures are of the observatory.
inline constexpr std::array<const char*, 3> kWarpScenes = {"room", "colonnade", "bunny"};
/// Under which a lamp hangs in view, for table 5.2, which does not name its scene either.
inline constexpr const char* kLampScene = "colonnade";

struct WarpTime {
    double frameMs = 0.0;    ///< Median, the picture without shadows included.
    double spread = 0.0;     ///< Of frames: the 95th percentile over the median, less 1.
    double shadowsMs = 0.0;  ///< Least frame, less the least without shadows.
    double mapMs = 0.0;      ///< Passes that make the map, the analysis of the view included; of volumes, all.
    double analysisMs = 0.0; ///< Of these, those that look at the view or make tables.
    double lookupMs = 0.0;   ///< Passes that ask the map.
    uint32_t mapDraws = 0;   ///< Passes that draw casters into a map, in the last frame.
};

struct WarpSurvey {
    std::array<double, kWarpScenes.size()> pictureMs{}; ///< Frames without shadows: his G-buffer.
    std::array<uint32_t, kWarpScenes.size()> triangles{};
    std::array<std::array<WarpTime, kWarpRows>, kWarpScenes.size()> scenes{}; ///< By scene and WarpRow.
    std::array<WarpTime, kLampRows> lamp{};                                   ///< By LampRow.
};

struct WarpOptions {
    uint32_t picture = 1024; ///< Pixels a side.
    uint32_t map = 512;      ///< Texels a side: half of the picture's, as in his figure 5.2.
    uint32_t pairs = 6;      ///< Frames that count.
    std::function<void(const char* scene, const char* row, const WarpTime&)> measured;
};
WarpSurvey measureWarps(Device& device, const WarpOptions& options);

} // namespace gnomon::demo
