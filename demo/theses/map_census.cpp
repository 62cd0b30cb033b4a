#include "demo/theses/map_census.hpp"

#include <algorithm>

#include "shaders/hybrid/reasons.h"

namespace gnomon::demo {
namespace {

struct Asked {
    const char* method;
    std::vector<SettingChoice> settings;
};

Asked askedOf(MapMethod method, double side, double lambda)
{
    std::vector<SettingChoice> settings{{"resolution", side}, {"reasons", 1.0}};
    if (method == MapMethod::pcf) return {"pcf_hybrid", settings};
    const bool thesis = method == MapMethod::crsm || method == MapMethod::crsma;
    settings.push_back({"mode", thesis ? 1.0 : 0.0});
    settings.push_back({"lambda", lambda});
    const bool alone = method == MapMethod::crsm || method == MapMethod::guaranteed;
    return {alone ? "conservative_map" : "conservative_map_adjacency", settings};
}

CertainCounts countReasons(const Image8& reasons, const Image8& truth, const std::vector<uint8_t>& counted)
{
    CertainCounts counts;
    for (size_t i = 0; i < counted.size(); ++i) {
        if (counted[i] != 1) continue;
        const uint8_t reason = reasons.texels[i];
        const bool lit = truth.texels[i] >= 128;
        const bool certainLit = reason == gpu::REASON_MAP_LIT || reason == gpu::REASON_TC_LIT;
        const bool certainDark = reason == gpu::REASON_MAP_SHADOW || reason == gpu::REASON_TC_SHADOW;
        counts.lit += certainLit;
        counts.wrongLit += certainLit && !lit;
        counts.dark += certainDark;
        counts.wrongDark += certainDark && lit;
        counts.tracedLit += reason == gpu::REASON_RT_LIT;
        counts.tracedDark += reason == gpu::REASON_RT_SHADOW;
    }
    return counts;
}

void countPlain(ThesisView& stage, double side, MapView& view)
{
    const Image8 picture = stage.draw("shadow_map", {{"resolution", side}, {"filter", 1.0}});
    const ErrorCount error = compare(picture, stage.truth(), stage.counted());
    view.facing = error.counted;
    view.plainWrongLit = error.falseLit;
    view.plainWrongDark = error.falseShadow;
    for (size_t i = 0; i < stage.counted().size(); ++i)
        view.dark += stage.counted()[i] == 1 && stage.truth().texels[i] < 128;
}

} // namespace

const char* nameOf(MapMethod method) noexcept
{
    constexpr const char* names[] = {"PCF", "CRSM", "CRSMA", "guaranteed", "sheets"};
    return names[size_t(method)];
}

std::vector<MapView> measureMaps(ThesisView& stage, const char* scene, const MapCensusOptions& options)
{
    std::vector<MapView> views;
    for (const uint32_t map : options.maps) {
        const size_t first = views.size();
        const double side = kTexelsPerPrinted * map;
        for (const Look look : kLooks) {
            stage.look(look);
            views.push_back({.scene = scene, .look = look, .map = map});
            countPlain(stage, side, views.back());
        }
        // A method's map is made once for the three cameras.
        const auto measure = [&](MapMethod method, double lambda, auto&& countsOf) {
            const Asked asked = askedOf(method, side, lambda);
            for (size_t i = 0; i < std::size(kLooks); ++i) {
                stage.look(kLooks[i]);
                countsOf(views[first + i]) =
                    countReasons(stage.draw(asked.method, asked.settings), stage.truth(), stage.counted());
            }
        };
        for (const MapMethod method : options.methods)
            measure(method, 1.0, [method](MapView& view) -> CertainCounts& { return view.methods[size_t(method)]; });
        for (size_t lambda = 0; options.lambdas && map == kMiddleMap && lambda < 3; ++lambda)
            for (const size_t form : {0u, 1u})
                measure(form == 0 ? MapMethod::crsm : MapMethod::crsma, double(lambda),
                        [=](MapView& view) -> CertainCounts& { return view.byLambda[lambda][form]; });
        if (options.measured) std::for_each(views.begin() + std::ptrdiff_t(first), views.end(), options.measured);
    }
    return views;
}

std::vector<MapView> measureMaps(Device& device, const MapCensusOptions& options)
{
    std::vector<MapView> all;
    for (const CensusScene& scene : kCensusScenes) {
        ThesisView stage(device, scene.view, options.picture);
        const std::vector<MapView> views = measureMaps(stage, scene.printed, options);
        all.insert(all.end(), views.begin(), views.end());
    }
    return all;
}

} // namespace gnomon::demo
