#pragma once
// The counts of which the tables of Morais's thesis are made: per view and size of map, what the hybrid methods are
// certain of and what they trace. Of light-facing pixels that are not grazing.

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "demo/theses/thesis_view.hpp"

namespace gnomon::demo {

/// The thesis's three, and ours that are never wrong.
enum class MapMethod : uint8_t { pcf, crsm, crsma, guaranteed, sheets };
inline constexpr size_t kMapMethods = 5;
const char* nameOf(MapMethod method) noexcept;

struct CertainCounts {
    uint64_t lit = 0, dark = 0;             ///< Certain.
    uint64_t wrongLit = 0, wrongDark = 0;   ///< Among these.
    uint64_t tracedLit = 0, tracedDark = 0; ///< By what their rays say.

    uint64_t traced() const { return tracedLit + tracedDark; }
    uint64_t wrong() const { return wrongLit + wrongDark; }
    uint64_t all() const { return lit + dark + traced(); }
};

inline constexpr uint32_t kCensusMaps[] = {512, 1024, 2048, 4096};

inline constexpr uint32_t kMiddleMap = 1024;

struct MapView {
    const char* scene; ///< The thesis's.
    Look look;
    uint32_t map = 0;                               ///< The thesis's.
    uint64_t facing = 0, dark = 0;                  ///< Light-facing pixels, and those in shadow by the truth.
    uint64_t plainWrongLit = 0, plainWrongDark = 0; ///< By the plain map.
    std::array<CertainCounts, kMapMethods> methods{};

    uint64_t plainWrong() const { return plainWrongLit + plainWrongDark; }
    /// CRSM and CRSMA with edges moved by a texel's extent, half its diagonal, its diagonal (setting `lambda`);
    /// measured at kMiddleMap.
    std::array<std::array<CertainCounts, 2>, 3> byLambda{};
    const CertainCounts& of(MapMethod method) const { return methods[size_t(method)]; }
};

struct CensusScene {
    const char* printed;
    ViewScene view;
};
inline constexpr std::array<CensusScene, 4> kCensusScenes = {
    {{"bench", kBenchView}, {"flowers", kFlowersView}, {"trees", kFoliageView}, {"sponza", kColonnadeView}}};

/// Texels per side of our maps for one of the thesis's, whose maps lie around scenes of a size that it does not tell.
/// With half as many the plain map is as wrong as his (README.md).
inline constexpr double kTexelsPerPrinted = 0.5;

struct MapCensusOptions {
    uint32_t picture = 1024; ///< Pixels a side; shares hardly depend on it.
    std::vector<uint32_t> maps{std::begin(kCensusMaps), std::end(kCensusMaps)};
    std::vector<MapMethod> methods{MapMethod::pcf, MapMethod::crsm, MapMethod::crsma, MapMethod::guaranteed,
                                   MapMethod::sheets};
    bool lambdas = false;
    std::function<void(const MapView&)> measured;
};
/// All looks of one scene, a map after the other.
std::vector<MapView> measureMaps(ThesisView& stage, const char* scene, const MapCensusOptions& options);
std::vector<MapView> measureMaps(Device& device, const MapCensusOptions& options);

} // namespace gnomon::demo
