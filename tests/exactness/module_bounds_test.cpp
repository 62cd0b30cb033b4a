// What every module says of its own error, held against the shipped scenes: new algorithms are measured here unasked.
#include <algorithm>

#include "demo/program/measure.hpp"
#include "exactness/results.hpp"
#include "runtime/registry.hpp"

namespace gnomon::exact {
namespace {

// Authors round to two digits, and drivers' rasterisers differ in single pixels.
constexpr double kRounding = 1.25, kPixels = 0.005;

/// Entries speak of maps of 1024 texels a side in pictures of 1280x720, and in smaller ones sides are smaller as well
/// (results.cpp); the error goes down as the side goes up.
double perSide(const AlgorithmEntry& entry)
{
    for (const SettingSpec& setting : entry.settings)
        if (std::string_view(setting.name) == demo::kResolutionSetting) return edgePercent(1024.0 / setting.standard);
    return 1.0;
}

} // namespace

TEST_CASE(
    "no algorithm is more wrong than its entry says on a scene with reversed depth, and exact ones say next to nothing")
{
    for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms) {
        const AlgorithmEntry& entry = *algorithm.entry;
        CAPTURE(std::string(entry.name));
        double worst = 0.0;
        std::string where = "none";
        for (const std::string& name : sceneNames()) {
            const SceneResults& results = resultsOf(name);
            if (results.scene.depth.convention == demo::DepthConvention::Standard) continue; // it has bounds of its own
            if (std::ranges::find(results.names, entry.name) == results.names.end()) continue; // not on this device
            const ErrorCount error = results.pooled(results.of(entry.name), entry.traits);
            if (error.counted == 0 || error.percent(error.wrong()) <= worst) continue;
            worst = error.percent(error.wrong());
            where = name;
        }
        MESSAGE(std::string(entry.name), ": wrong ", worst, " % in ", where, ", says ", entry.typicalWrongPercent,
                " %");
        CHECK(worst <= kRounding * perSide(entry) * double{entry.typicalWrongPercent} + kPixels);
        if (entry.traits & GN_TRAIT_EXACT_BIT) CHECK(entry.typicalWrongPercent <= 0.05f);
    }
}

} // namespace gnomon::exact
