#pragma once
// What the bounds are about, measured once per shipped scene and shared by the test cases of a program: every method
// with its defaults, and the resolutions that are compared with each other.
#include "exactness/stage.hpp"

namespace gnomon::exact {

/// A scene without its device: the truth, and what the methods said.
struct SceneResults : Seen {
    std::string name;
    Scene scene;
    std::vector<std::string> names;
    std::vector<GnTraits> traits;
    std::map<std::string, Pictures> pictures; ///< By key().

    const demo::Light& light(size_t layer) const { return scene.lights[state.present[layer]]; }
    const Pictures& of(const std::string& method, uint32_t resolution = 0) const;
    bool has(LightKind kind) const;
    /// Lights of these kinds only.
    ErrorCount pooled(const Pictures& pictures, GnTraits onlyKinds = ~GnTraits(0)) const;
    GnTraits traitsOf(const std::string& method) const;
};

/// Measured when first asked for; validation must stay silent meanwhile. The bounds are about time 0.
const SceneResults& resultsOf(const std::string& scene);
/// Later, when everything has moved: smaller pictures, defaults only, of every second method. Not kept.
SceneResults laterResultsOf(const std::string& scene, bool odd);

constexpr uint32_t kMapSizes[] = {512, 1024, 2048, 4096};
constexpr uint32_t kRowCounts[] = {75, 150, 300, 600};
constexpr uint32_t kWideFilter = 5; ///< In place of a resolution: boxes of 5 x 5 texels averaged, default resolution.
constexpr const char* kAveraging[] = {"shadow_map", "cube_map", "dual_paraboloid"};
constexpr uint32_t kCoarse = 64; ///< Texels as large as casters.

} // namespace gnomon::exact
