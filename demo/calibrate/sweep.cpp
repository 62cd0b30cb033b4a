#include "demo/calibrate/sweep.hpp"

#include <algorithm>
#include <chrono>

#include "demo/program/measure.hpp"

namespace gnomon::demo {
namespace {

using Clock = std::chrono::steady_clock;

constexpr uint32_t kPointsPerKind = 40;
constexpr double kFrameStep = 1.0 / 60.0;
constexpr uint32_t kSceneSamples = 3; // of each alternation

GnTraits traitOf(LightKind kind)
{
    return kind == LightKind::Directional ? GN_TRAIT_DIRECTIONAL_BIT
           : kind == LightKind::Spot      ? GN_TRAIT_SPOT_BIT
                                          : GN_TRAIT_POINT_BIT;
}

double secondsSince(Clock::time_point start)
{
    return std::chrono::duration<double>(Clock::now() - start).count();
}

SessionOptions measuring(VkExtent2D size, uint32_t maxLights = 0)
{
    return {.scene = {},
            .size = size,
            .maxLights = maxLights,
            .framesInFlight = kCalibrationFramesInFlight,
            .pinnedThreads = true};
}

} // namespace

Outcome<std::vector<SweepMethod>> sweepMethods(Device& device, const std::vector<std::string>& wanted)
{
    const Scene empty = makeSweep(1).scene;
    Session session(device, empty, measuring({16, 16}, kSweepLights));
    std::vector<SweepMethod> methods;
    for (const GnMethodInfo& info : session.shadows.methods()) {
        const bool asked = std::find(wanted.begin(), wanted.end(), info.pName) != wanted.end();
        if (info.pUnavailable || (!wanted.empty() && !asked)) continue;
        const bool hasMap =
            std::any_of(info.pSettings, info.pSettings + info.settingCount, [](const GnSettingInfo& setting) {
                return std::string_view(setting.pName) == kResolutionSetting;
            });
        methods.push_back({info.pName, info.pAlgorithm, info.traits, hasMap});
    }
    for (const std::string& name : wanted)
        if (std::none_of(methods.begin(), methods.end(), [&](const SweepMethod& m) { return m.name == name; }))
            return Outcome<std::vector<SweepMethod>>::failure("no method '" + name + "' that this device can run");
    return methods;
}

Sweeper::Sweeper(Device& device)
    : device_(device), sweep_(makeSweep(kPointsPerKind)),
      session_(device, sweep_.scene, measuring({640, 360}, kSweepLights))
{
    expect(session_.shadows.warmUp(kTruthMethod));
    session_.wakeDevice(0.0);
}

void Sweeper::proceed(SweepRun& run, const SweepMethod& method, double seconds, uint32_t leastPoints)
{
    const Clock::time_point start = Clock::now();
    const double before = run.seconds;
    useMethod(session_.shadows, method.name);
    expect(session_.shadows.warmUp(method.name));
    for (; run.next < sweep_.points.size(); ++run.next) {
        const SweepPoint& point = sweep_.points[run.next];
        if (!(method.traits & traitOf(point.kind))) continue;
        run.seconds = before + secondsSince(start);
        // The next point takes about as long as those before it.
        const double expected = run.points > 0 ? run.seconds * (run.points + 1) / run.points : 0.0;
        if (expected > seconds && run.points >= leastPoints) break;
        session_.renderer.resize({point.width, point.height});
        if (method.hasMap) expect(session_.shadows.set(method.name, kResolutionSetting, point.mapSide));
        // What is left, over the points that there must be: one that took longer is made good by the others.
        const double left = std::max(seconds - run.seconds, 0.0);
        const uint32_t owed = leastPoints - std::min(run.points, leastPoints - 1);
        const Moment moment{.time = point.time,
                            .step = point.motion == SweepMotion::nothing ? 0.0 : kFrameStep,
                            .seconds = std::min(left / owed, seconds / leastPoints)};
        const MomentTimes times = measureMoment(session_, method.name, moment);
        std::vector<Sample> rows = rowsOf(times, method.algorithm, device_);
        // The truth is that of hard shadows. Errors vary slowly over the sweep; every second point tells enough of
        // them.
        if (method.name != kTruthMethod && !point.soft) measureErrors(rows, times);
        run.rows.insert(run.rows.end(), rows.begin(), rows.end());
        addShared(run.shared, times);
        ++run.points;
    }
    run.seconds = before + secondsSince(start);
}

/// The wrong share of the point's first light goes into its rows. False where this build has no ray tracing.
bool Sweeper::measureErrors(std::vector<Sample>& rows, const MomentTimes& times)
{
    if (times.lights.empty()) return false;
    Renderer& renderer = session_.renderer;
    const Image8 visibility = renderer.readVisibility().front();
    const FrameSurfaces surfaces{renderer.readDepth(), renderer.readNormals()};
    const uint32_t light = renderer.state().present.front();
    if (times.lights.front().light != light) return false; // it was not timed
    for (const uint32_t present : renderer.state().present)
        if (!session_.shadows.pin(present, kTruthMethod)) return false;
    const CameraState camera = session_.camera(times.lastTime);
    renderer.draw({.time = times.lastTime, .cameras = {&camera, 1}, .shadows = &session_.shadows});
    const Image8 truth = renderer.readVisibility().front();
    for (const uint32_t present : renderer.state().present)
        expect(session_.shadows.pin(present, {}));
    const std::vector<uint8_t> counted = countedPixels(session_.scene, renderer.camera(), surfaces,
                                                       session_.scene.lights[light], renderer.state().lights[light]);
    const ErrorCount errors = compare(visibility, truth, counted);
    if (errors.counted == 0) return false;
    // The rows of the first light end with its resolve.
    for (Sample& row : rows) {
        row.wrongPercent = errors.percent(errors.wrong());
        if (row.pass == cost::Pass::resolve) break;
    }
    return true;
}

std::vector<Sample> measureScene(Device& device, const Scene& scene, const SweepMethod& method, VkExtent2D size,
                                 uint32_t moments)
{
    std::vector<Sample> rows;
    const Scene served = onlyServed(scene, method.traits);
    if (served.lights.empty()) return rows;
    Session session(device, served, measuring(size));
    expect(session.shadows.warmUp(method.name));
    useMethod(session.shadows, method.name);
    session.wakeDevice(frameTime(scene, 0));
    const double step = 1.0 / scene.framesPerSecond;
    for (uint32_t i = 0; i < moments; ++i) {
        const double time = frameTime(scene, scene.frames * i / moments);
        const MomentTimes times =
            measureMoment(session, method.name, {.time = time, .step = step, .samples = kSceneSamples});
        const std::vector<Sample> more = rowsOf(times, method.algorithm, device);
        rows.insert(rows.end(), more.begin(), more.end());
    }
    return rows;
}

} // namespace gnomon::demo
