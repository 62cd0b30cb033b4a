#include "demo/theses/navratil_warps.hpp"

#include <algorithm>
#include <string_view>

#include <glm/geometric.hpp>

#include "demo/program/measure.hpp"
#include "demo/scene/scene_file.hpp"
#include "demo/theses/navratil_survey.hpp"

namespace gnomon::demo {
namespace {

constexpr double kWalkSeconds = 4.0;
constexpr double kTurn = 0.02; // of the light's direction in that time, radians

struct Method {
    const char* printed;
    const char* method;
    std::vector<SettingChoice> settings;
};

// Importance as in the thesis: of RTW the nearest receiver of a column (desired view and distance to the eye), of NoTW
// counts as they are.
const Method& methodOf(WarpRow row)
{
    static const std::array<Method, kWarpRows> all = {
        {{"SV", "stencil_volume", {}},
         {"SM", "shadow_map", {{"fit", 0}}},
         {"MIN-SM", "shadow_map", {{"fit", 1}}},
         {"NoTW-DV", "shadow_map", {{"fit", 2}}},
         {"RTW", "rectilinear_warp", {{"greatest", 1}, {"power", 1}, {"paraboloids", 0}}},
         {"NoTW", "nonorthogonal_warp", {{"power", 1}, {"paraboloids", 0}}}}};
    return all[size_t(row)];
}

const Method& methodOf(LampRow row)
{
    static const std::array<Method, kLampRows> all = {
        {{"SV", "stencil_volume", {}},
         {"CubeSM", "cube_map", {}},
         {"DPSM", "dual_paraboloid", {}},
         {"CubeSM w/ warping", "nonorthogonal_warp", {{"power", 1}, {"paraboloids", 0}}},
         {"DPSM w/ warping", "nonorthogonal_warp", {{"power", 1}, {"paraboloids", 1}}}}};
    return all[size_t(row)];
}

/// The scene's walk, in so many frames, under its first directional or spot light, which turns.
Scene underTurning(const char* name, uint32_t pairs)
{
    Scene scene = valueOf(loadScene(name));
    std::erase_if(scene.lights, [](const Light& light) { return light.kind == LightKind::Point; });
    scene.lights.resize(1);
    scene.framesPerSecond = pairs / kWalkSeconds;
    Light& light = scene.lights[0];
    light.isStatic = false;
    light.orbit = {};
    const glm::dvec3 later = glm::normalize(light.direction + glm::dvec3(kTurn, 0.0, 0.0));
    light.keys = {{0.0, light.position, light.direction}, {2.0 * kWalkSeconds, light.position, later}};
    return scene;
}

/// A lamp that moves in the middle of the view, so that no face and no half can be left out for long.
Scene underLamp(uint32_t pairs)
{
    Scene scene = valueOf(loadScene(kLampScene));
    std::erase_if(scene.lights, [](const Light& light) { return light.kind != LightKind::Point; });
    scene.lights.resize(1);
    scene.camera.resize(1);
    scene.framesPerSecond = pairs / kWalkSeconds;
    const CameraKey& eye = scene.camera[0];
    Light& lamp = scene.lights[0];
    lamp.isStatic = false;
    lamp.keys.clear();
    lamp.position = eye.eye + 6.0 * glm::normalize(eye.target - eye.eye) + glm::dvec3(0.0, 1.0, 0.0);
    lamp.range = 20.0f;
    lamp.orbit = {.center = lamp.position - glm::dvec3(0.5, 0.0, 0.0), .radiansPerSecond = 0.4};
    return scene;
}

/// Stages of a frame, from passes apart.
void addStages(Session& session, uint32_t frames, WarpTime& time)
{
    for (const PassTime& pass : timePasses(session, frames)) {
        const double ms = pass.gpuMs + pass.cpuMs;
        const std::string_view name = pass.name;
        if (name.ends_with(".resolve")) {
            time.lookupMs += ms;
            continue;
        }
        time.mapMs += ms;
        if (name.find(kCasterPasses) == std::string_view::npos) time.analysisMs += ms;
    }
}

WarpTime measure(Session& session, const Method& row, const WarpOptions& options, double* pictureMs = nullptr)
{
    for (const SettingChoice& setting : row.settings)
        expect(session.shadows.set(row.method, setting.name, setting.value));
    (void)session.shadows.set(row.method, kResolutionSetting, options.map); // volumes have none
    expect(session.shadows.pinAll(row.method));
    settle(session, row.method, frameTime(session.scene, 0), false);
    const PairTimes times = timePairs(session, options.pairs, false, nullptr);
    if (times.unpinned != 0) throw HostError(std::string(row.method) + " did not serve " + session.scene.name);
    WarpTime time{.frameMs = median(times.withMs), .shadowsMs = minimum(times.withMs) - minimum(times.withoutMs)};
    time.spread = quantile(times.withMs, 0.95) / time.frameMs - 1.0;
    time.mapDraws = casterPasses(session);
    addStages(session, options.pairs, time);
    if (pictureMs) *pictureMs = median(times.withoutMs);
    if (options.measured) options.measured(session.scene.name.c_str(), row.printed, time);
    return time;
}

Session makeSession(Device& device, const Scene& scene, uint32_t picture)
{
    return Session(
        device, scene,
        {.scene = {}, .size = {picture, picture}, .contextFlags = GN_CONTEXT_NO_BACKGROUND_BIT, .pinnedThreads = true});
}

} // namespace

const char* nameOf(WarpRow row) noexcept
{
    return methodOf(row).printed;
}

const char* nameOf(LampRow row) noexcept
{
    return methodOf(row).printed;
}

WarpSurvey measureWarps(Device& device, const WarpOptions& options)
{
    WarpSurvey survey;
    for (size_t s = 0; s < kWarpScenes.size(); ++s) {
        const Scene scene = underTurning(kWarpScenes[s], options.pairs);
        Session session = makeSession(device, scene, options.picture);
        survey.triangles[s] = static_cast<uint32_t>(triangleCount(scene));
        for (size_t row = 0; row < kWarpRows; ++row)
            survey.scenes[s][row] = measure(session, methodOf(WarpRow(row)), options, &survey.pictureMs[s]);
    }
    const Scene scene = underLamp(options.pairs);
    Session session = makeSession(device, scene, options.picture);
    for (size_t row = 0; row < kLampRows; ++row)
        survey.lamp[row] = measure(session, methodOf(LampRow(row)), options);
    return survey;
}

} // namespace gnomon::demo
