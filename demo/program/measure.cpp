#include "demo/program/measure.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include <glm/trigonometric.hpp>

namespace gnomon::demo {
namespace {

using Clock = std::chrono::steady_clock;

double timedFrame(Session& session, const FrameRequest& request)
{
    const Clock::time_point start = Clock::now();
    session.renderer.draw(request);
    session.renderer.waitForFrame();
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

bool isServed(const Light& light, GnTraits traits)
{
    const GnTraits bit = light.kind == LightKind::Directional ? GN_TRAIT_DIRECTIONAL_BIT
                         : light.kind == LightKind::Spot      ? GN_TRAIT_SPOT_BIT
                                                              : GN_TRAIT_POINT_BIT;
    return (traits & bit) != 0;
}

bool hasLight(const std::vector<Light>& lights, const std::string& name)
{
    return std::any_of(lights.begin(), lights.end(), [&](const Light& light) { return light.name == name; });
}

} // namespace

bool servesOne(const Scene& scene, GnTraits traits)
{
    return std::any_of(scene.lights.begin(), scene.lights.end(),
                       [traits](const Light& light) { return isServed(light, traits); });
}

Scene onlyServed(const Scene& scene, GnTraits traits)
{
    Scene out = scene;
    std::erase_if(out.lights, [traits](const Light& light) { return !isServed(light, traits); });
    return out;
}

void setSourceSizes(Scene& scene, const SourceSizes& sizes)
{
    for (Light& light : scene.lights) {
        const bool isSun = light.kind == LightKind::Directional;
        if (isSun && sizes.radiusDegrees) light.radius = static_cast<float>(glm::radians(*sizes.radiusDegrees));
        if (isSun || !sizes.radius) continue;
        light.radius = static_cast<float>(*sizes.radius);
        light.rectangle = glm::vec2(0.0f);
    }
}

void requireLight(const Scene& scene, const std::string& name)
{
    if (hasLight(scene.lights, name)) return;
    std::string known;
    for (const Light& light : scene.lights)
        known += (known.empty() ? "" : ", ") + light.name;
    if (hasLight(scene.spareLights, name))
        throw HostError("light '" + name + "' of scene '" + scene.name + "' is not among the first " +
                        std::to_string(scene.lights.size()) + ", which are used: " + known);
    throw HostError("scene '" + scene.name + "' has no light '" + name + "'; there are " + known);
}

std::string absentLights(const Scene& scene, double time)
{
    std::string names;
    for (const Light& light : scene.lights)
        if (!lightAt(light, time).present) names += (names.empty() ? "" : ", ") + light.name;
    return names;
}

void keepLights(Scene& scene, const std::vector<std::string>& names)
{
    for (const std::string& name : names)
        requireLight(scene, name);
    std::erase_if(scene.lights,
                  [&](const Light& light) { return std::find(names.begin(), names.end(), light.name) == names.end(); });
}

const Image8* Truth::find(const std::string& light, const std::vector<uint8_t>** countedPixels) const
{
    const auto found = std::find(lights.begin(), lights.end(), light);
    if (found == lights.end()) return nullptr;
    const auto layer = static_cast<size_t>(found - lights.begin());
    *countedPixels = &counted[layer];
    return &visibility[layer];
}

namespace {

/// A light of the newest frame that is not served by its own method.
std::optional<uint32_t> unpinnedLight(const Session& session)
{
    for (uint32_t light : session.renderer.state().present) {
        GnDecision decision{};
        gnGetDecision(session.shadows.context(), session.shadows.view(0), session.shadows.light(light), &decision);
        if (decision.reason != GN_REASON_PINNED) return light;
    }
    return std::nullopt;
}

/// Truth::soft. \pre the truth's method is pinned, and ready
std::vector<Image8> softTruth(Session& session, double time)
{
    const std::vector<uint32_t> present = session.renderer.state().present;
    const auto isSoft = [&](uint32_t light) { return session.scene.lights[light].radius > 0.0f; };
    if (std::none_of(present.begin(), present.end(), isSoft)) return std::vector<Image8>(present.size());
    expect(session.shadows.set(kTruthMethod, kSamplesSetting, kTruthSamples));
    drawOnce(session, time, false);
    if (unpinnedLight(session))
        throw HostError("the radius of a light of scene '" + session.scene.name + "' is too large to be sampled");
    std::vector<Image8> pictures = session.renderer.readVisibility();
    for (size_t layer = 0; layer < present.size(); ++layer)
        if (!isSoft(present[layer])) pictures[layer] = {};
    return pictures;
}

} // namespace

void drawOnce(Session& session, double time, bool recorded)
{
    const CameraState camera = session.camera(time);
    session.renderer.draw({.time = time, .cameras = {&camera, 1}, .shadows = &session.shadows, .recorded = recorded});
    session.renderer.waitForFrame();
}

std::optional<Truth> measureTruth(Device& device, const Scene& scene, VkExtent2D size, double time)
{
    Session session(device, scene, {.scene = {}, .size = size});
    if (!session.shadows.pinAll(kTruthMethod)) return std::nullopt;
    settle(session, kTruthMethod, time, false);
    Truth truth;
    truth.surfaces = {session.renderer.readDepth(), session.renderer.readNormals()};
    truth.camera = session.renderer.camera();
    truth.state = session.renderer.state();
    truth.visibility = session.renderer.readVisibility();
    truth.soft = softTruth(session, time);
    for (uint32_t light : truth.state.present) {
        truth.lights.push_back(scene.lights[light].name);
        truth.counted.push_back(
            countedPixels(scene, truth.camera, truth.surfaces, scene.lights[light], truth.state.lights[light]));
    }
    return truth;
}

void settle(Session& session, const std::string& method, double time, bool recorded)
{
    expect(session.shadows.warmUp(method));
    constexpr uint32_t patience = 64; // frames; workers need far fewer after a warm-up
    for (uint32_t i = 0; i < patience; ++i) {
        drawOnce(session, time, recorded);
        if (i + 1 >= kWarmFrames && !unpinnedLight(session)) return;
    }
    throw HostError(session.shadows.whyNot(*unpinnedLight(session), method));
}

void noteLeftOut(const std::string& scene, const std::string& method, const HostError& error)
{
    std::fprintf(stderr, "note: %s: %s is left out: %s\n", scene.c_str(), method.c_str(), error.what());
}

PairTimes timePairs(Session& session, uint32_t pairs, bool recorded, OtherShadows* other)
{
    PairTimes times;
    session.wakeDevice(frameTime(session.scene, 0));
    for (uint32_t i = 0; i < kWarmFrames + pairs; ++i) {
        const double time = frameTime(session.scene, i);
        const CameraState camera = session.camera(time);
        const FrameRequest without{.time = time, .cameras = {&camera, 1}};
        FrameRequest with = without;
        with.shadows = other ? nullptr : &session.shadows;
        with.other = other;
        with.recorded = recorded;
        const double withoutMs = timedFrame(session, without);
        const double withMs = timedFrame(session, with);
        if (i < kWarmFrames) continue;
        times.withoutMs.push_back(withoutMs);
        times.withMs.push_back(withMs);
        const GnFrameStats stats = other ? GnFrameStats{} : session.shadows.stats();
        times.gpuMs.push_back(double(stats.gpuMs));
        times.cpuMs.push_back(double(stats.cpuMs));
        times.raysMs.push_back(double(stats.raysMs));
        times.pagesEvicted += stats.pagesEvicted;
        times.pagesWithoutRoom += stats.pagesWithoutRoom;
        if (const auto light = other ? std::nullopt : unpinnedLight(session)) {
            ++times.unpinned;
            times.unpinnedLight = *light;
            times.unpinnedFrame = stats.frame;
        }
    }
    return times;
}

std::vector<PassTime> timePasses(Session& session, uint32_t frames)
{
    std::vector<PassTime> best;
    std::vector<GnPassTiming> timings;
    for (uint32_t i = 0; i < frames; ++i) {
        const double time = frameTime(session.scene, i);
        const CameraState camera = session.camera(time);
        timedFrame(session,
                   {.time = time, .cameras = {&camera, 1}, .shadows = &session.shadows, .flags = GN_FRAME_TIMED_BIT});
        uint32_t count = 0;
        gnGetPassTimings(session.shadows.context(), nullptr, &count, nullptr);
        timings.resize(count);
        gnGetPassTimings(session.shadows.context(), nullptr, &count, timings.data());
        std::vector<PassTime> now;
        for (const GnPassTiming& timing : timings) {
            auto found =
                std::find_if(now.begin(), now.end(), [&](const PassTime& p) { return p.name == timing.pName; });
            if (found == now.end()) found = now.insert(now.end(), {.name = timing.pName});
            ++found->count;
            found->gpuMs += double(timing.gpuMs);
            found->cpuMs += double(timing.cpuMs);
        }
        for (const PassTime& pass : now) {
            auto found = std::find_if(best.begin(), best.end(), [&](const PassTime& p) { return p.name == pass.name; });
            if (found == best.end())
                best.push_back(pass);
            else if (pass.gpuMs + pass.cpuMs < found->gpuMs + found->cpuMs)
                *found = pass;
        }
    }
    return best;
}

double minimum(const std::vector<double>& values)
{
    return *std::min_element(values.begin(), values.end());
}

double median(std::vector<double> values)
{
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double quantile(std::vector<double> values, double share)
{
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * double(values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

} // namespace gnomon::demo
