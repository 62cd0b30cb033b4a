#include "exactness/stage.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "demo/program/ambiguity.hpp"
#include "demo/program/measure.hpp"
#include "demo/scene/scene_file.hpp"
#include "device/small_scenes.hpp"
#include "runtime/registry.hpp"

namespace gnomon::exact {

using namespace demo;

// Every method after another, each for all lights: 910 MiB of moments in `rooms`, beside what the one before has left.
constexpr VkDeviceSize kMemory = VkDeviceSize{4} << 30;
// Rays of the device are judged wherever it has them; devices without are judged by those of the CPU.
constexpr GnContextCreateFlags kFlags = GN_CONTEXT_NO_BACKGROUND_BIT | GN_CONTEXT_DEVICE_RAYS_BIT;

Stage::Stage(Scene scene, VkExtent2D extent, double time)
    : scene_(std::move(scene)),
      session_(test::device(), scene_, {.scene = {}, .size = extent, .contextFlags = kFlags, .memoryLimit = kMemory})
{
    for (const GnMethodInfo& info : methods()) {
        traits_[info.pName] = info.traits;
        for (uint32_t i = 0; i < info.settingCount; ++i)
            defaults_[info.pName].emplace_back(info.pSettings[i].pName, info.pSettings[i].value);
    }
    goTo(time);
}

void Stage::goTo(double time)
{
    time_ = time;
    state = stateAt(scene_, time);
    present = state.present;
    truth = draw(kTruthMethod);
    camera = session_.renderer.camera();
    surfaces = {session_.renderer.readDepth(), session_.renderer.readNormals()};
    counted.clear();
    for (uint32_t light : present)
        counted.push_back(countedPixels(scene_, camera, surfaces, scene_.lights[light], state.lights[light]));
}

std::vector<GnMethodInfo> Stage::methods() const
{
    std::vector<GnMethodInfo> all = session_.shadows.methods();
    std::erase_if(all, [](const GnMethodInfo& method) { return method.pUnavailable != nullptr; });
    return all;
}

void Stage::apply(const std::string& method, const Settings& settings)
{
    for (const auto& [name, value] : defaults_[method])
        expect(session_.shadows.set(method, name, value));
    for (const Setting& setting : settings)
        expect(session_.shadows.set(method, setting.name, setting.value));
}

void Stage::pin(const std::string& method)
{
    for (uint32_t light = 0; light < scene_.lights.size(); ++light) {
        const bool served = exact::serves(traits_.at(method), scene_.lights[light].kind);
        expect(session_.shadows.pin(light, served ? method : kTruthMethod));
    }
}

bool Stage::served(const std::string& method)
{
    for (const uint32_t light : present) {
        if (!exact::serves(traits_.at(method), scene_.lights[light].kind)) continue;
        if (!servedByPin(session_, light, method)) return false;
    }
    return true;
}

Pictures Stage::draw(const std::string& method, const Settings& settings)
{
    REQUIRE(traits_.contains(method));
    GnContext context = session_.shadows.context();
    if (warm_.insert(method).second)
        REQUIRE_MESSAGE(gnWarmUpMethod(context, method.c_str()) >= 0, gnGetLastError(context));
    apply(method, settings);
    pin(method);
    const CameraState eye = session_.camera(time_);
    // Memory that the method before has left is given back within a few frames.
    for (uint32_t tries = 0; tries == 0 || (tries < 8 && !served(method)); ++tries)
        session_.renderer.draw({.time = time_, .cameras = {&eye, 1}, .shadows = &session_.shadows});
    REQUIRE_MESSAGE(served(method), method, " in ", scene_.name);
    Pictures pictures = session_.renderer.readVisibility();
    REQUIRE(pictures.size() == present.size());
    for (size_t i = 0; i < present.size(); ++i)
        if (!exact::serves(traits_.at(method), scene_.lights[present[i]].kind)) pictures[i] = {};
    return pictures;
}

VkExtent2D testSize()
{
    return std::getenv("GNOMON_TEST_FULL") ? VkExtent2D{1280, 720} : VkExtent2D{640, 360};
}

double edgePercent(double at1280)
{
    return at1280 * 1280.0 / testSize().width;
}

Scene shippedScene(const std::string& name)
{
    return valueOf(loadScene(name));
}

const std::vector<std::string>& sceneNames()
{
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const Scene& scene : test::smallShippedScenes())
            if (scene.name != "scenario_reverse") all.push_back(scene.name);
        return all;
    }();
    return names;
}

bool servedByPin(const demo::Session& session, uint32_t light, const std::string& method)
{
    GnDecision decision{};
    gnGetDecision(session.shadows.context(), session.shadows.view(0), session.shadows.light(light), &decision);
    return decision.reason == GN_REASON_PINNED && decision.pMethod == method;
}

double defaultOf(const std::string& method, std::string_view setting, double otherwise)
{
    for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms)
        for (const SettingSpec& spec : algorithm.entry->settings)
            if (method == algorithm.entry->name && setting == spec.name) return spec.standard;
    return otherwise;
}

bool serves(GnTraits traits, LightKind kind)
{
    for (const KindOfLight& known : kKinds)
        if (known.kind == kind) return (traits & known.trait) != 0;
    return false;
}

ErrorCount pooled(const Stage& stage, const Pictures& pictures, GnTraits onlyKinds)
{
    ErrorCount sum;
    for (size_t i = 0; i < pictures.size(); ++i) {
        if (pictures[i].width == 0 || !serves(onlyKinds, stage.scene().lights[stage.present[i]].kind)) continue;
        sum += compare(pictures[i], stage.truth[i], stage.counted[i]);
    }
    return sum;
}

uint64_t clearlyWrong(const Scene& scene, const Seen& seen, const Image8& picture, size_t layer)
{
    std::vector<uint8_t> wrong(seen.counted[layer].size());
    for (size_t i = 0; i < wrong.size(); ++i)
        wrong[i] = seen.counted[layer][i] == 1 && isWrong(picture.texels[i], seen.truth[layer].texels[i]);
    if (std::count(wrong.begin(), wrong.end(), uint8_t(1)) == 0) return 0; // no scene to flatten, no rays
    const uint32_t light = seen.state.present[layer];
    const std::vector<uint8_t> ambiguous = ambiguousPixels(scene, seen.state, seen.camera, seen.surfaces,
                                                           scene.lights[light], seen.state.lights[light], wrong);
    return compare(picture, seen.truth[layer], wrong, ambiguous).wrongClear;
}

std::string percentText(double percent)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.4f %%", percent);
    return text;
}

std::string inWords(const ErrorCount& error)
{
    return percentText(error.percent(error.wrong())) + " of " + std::to_string(error.counted) + " (false lit " +
           std::to_string(error.falseLit) + ", false shadow " + std::to_string(error.falseShadow) + ")";
}

} // namespace gnomon::exact
