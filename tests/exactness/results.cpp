#include "exactness/results.hpp"

#include <algorithm>

#include "demo/program/measure.hpp"

namespace gnomon::exact {
namespace {

/// \param resolution 0: the defaults; or kWideFilter.
std::string key(const std::string& method, uint32_t resolution)
{
    return resolution == 0 ? method : method + " " + std::to_string(resolution);
}

/// Pictures of half the width have maps of half the side.
Settings fittingMaps(const std::string& method)
{
    const double side = defaultOf(method, demo::kResolutionSetting, 0.0);
    if (side == 0.0 || testSize().width >= 1280) return {};
    return {{demo::kResolutionSetting, 0.5 * side}};
}

/// The scene, its truth, and every method with its defaults, or every second one.
SceneResults resultsWithDefaults(const std::string& name, Stage& stage, size_t first = 0, size_t step = 1)
{
    SceneResults results;
    static_cast<Seen&>(results) = stage;
    results.name = name;
    results.scene = stage.scene();
    const std::vector<GnMethodInfo> methods = stage.methods();
    for (size_t i = first; i < methods.size(); i += step) {
        const GnMethodInfo& info = methods[i];
        results.names.emplace_back(info.pName);
        results.traits.push_back(info.traits);
        results.pictures[info.pName] = stage.draw(info.pName, fittingMaps(info.pName));
    }
    return results;
}

SceneResults measure(const std::string& name)
{
    const test::DeviceTest silence;
    Stage stage(shippedScene(name), testSize());
    SceneResults results = resultsWithDefaults(name, stage);
    const auto draw = [&](const char* method, uint32_t resolution) {
        const double texels = resolution;
        results.pictures[key(method, resolution)] = stage.draw(method, {{demo::kResolutionSetting, texels}});
    };
    for (const uint32_t resolution : kMapSizes)
        draw("shadow_map", resolution);
    for (const uint32_t rows : kRowCounts)
        results.pictures[key("angular_spans", rows)] =
            stage.draw("angular_spans", {{demo::kRowsSetting, double(rows)}});
    for (const char* method : kAveraging)
        results.pictures[key(method, kWideFilter)] = stage.draw(method, {{"filter", 5.0}});
    draw("shadow_map", kCoarse);
    draw("pcf_hybrid", kCoarse);
    draw("chan_durand", 512);
    draw("pcf_hybrid", 1024);
    if (results.has(LightKind::Point)) {
        draw("cube_map", 256);
        draw("cube_map", 1024);
        draw("dual_paraboloid", 1024);
    }
    return results;
}

} // namespace

const Pictures& SceneResults::of(const std::string& method, uint32_t resolution) const
{
    return pictures.at(key(method, resolution));
}

bool SceneResults::has(LightKind kind) const
{
    return std::any_of(state.present.begin(), state.present.end(),
                       [&](uint32_t index) { return scene.lights[index].kind == kind; });
}

ErrorCount SceneResults::pooled(const Pictures& of, GnTraits onlyKinds) const
{
    ErrorCount sum;
    for (size_t layer = 0; layer < of.size(); ++layer)
        if (of[layer].width > 0 && serves(onlyKinds, light(layer).kind))
            sum += demo::compare(of[layer], truth[layer], counted[layer]);
    return sum;
}

GnTraits SceneResults::traitsOf(const std::string& method) const
{
    const auto found = std::find(names.begin(), names.end(), method);
    return found == names.end() ? 0 : traits[static_cast<size_t>(found - names.begin())];
}

const SceneResults& resultsOf(const std::string& scene)
{
    static std::map<std::string, SceneResults> all;
    const auto found = all.find(scene);
    return found != all.end() ? found->second : all.emplace(scene, measure(scene)).first->second;
}

SceneResults laterResultsOf(const std::string& scene, bool odd)
{
    constexpr double later = 3.1; // seconds: all keys have moved on, the scenario has changed its lights
    const test::DeviceTest silence;
    Stage stage(shippedScene(scene), {640, 360}, later);
    return resultsWithDefaults(scene, stage, odd ? 1 : 0, 2);
}

} // namespace gnomon::exact
