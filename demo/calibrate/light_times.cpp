#include "demo/calibrate/light_times.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <utility>

namespace gnomon::demo {
namespace {

constexpr uint32_t kDiscarded = 3;      // after a switch: caches, allocation, clocks
constexpr uint32_t kLeastDiscarded = 2; // of frames that take long: the first one, and what it left behind
constexpr uint32_t kLate = kCalibrationFramesInFlight; // frames until timings are known

double percentile(std::vector<double> values, double share)
{
    if (values.empty()) return 0.0;
    std::sort(values.begin(), values.end());
    return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

cost::Workload workloadOf(const GnLightWorkload& workload)
{
    return {.pixels = workload.pixels,
            .casterTriangles = workload.casterTriangles,
            .mapTexels = workload.mapTexels,
            .sharing = workload.sharing,
            .still = workload.still == VK_TRUE,
            .drawnTriangles = workload.drawnTriangles,
            .casters = workload.casters,
            .directional = workload.type == GN_LIGHT_TYPE_DIRECTIONAL,
            .point = workload.type == GN_LIGHT_TYPE_POINT,
            .drawnPixels = workload.drawnPixels,
            .viewPixels = workload.viewPixels,
            .shadowPixels = workload.shadowPixels,
            .softPixels = workload.softPixels,
            .mapFilled = workload.mapFilled,
            .mapTouched = workload.mapTouched,
            .treeLevels = workload.treeLevels};
}

double drawFrame(Session& session, double time, bool timed, bool cut)
{
    const CameraState camera = session.camera(time);
    const auto start = std::chrono::steady_clock::now();
    session.renderer.draw({.time = time,
                           .cameras = {&camera, 1},
                           .shadows = &session.shadows,
                           .flags = timed ? GnFrameFlags{GN_FRAME_TIMED_BIT} : GnFrameFlags{0},
                           .cameraCut = cut});
    session.renderer.waitForFrame();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Collects what is new about every light.
class Collector {
public:
    Collector(Session& session, std::string method) : session_(session), method_(std::move(method))
    {
        for (const uint32_t light : session.renderer.state().present)
            lights_.push_back({.light = light});
        seen_.resize(lights_.size());
        note(false); // what was timed before counts as seen
    }

    void note(bool keep)
    {
        for (size_t i = 0; i < lights_.size(); ++i) {
            GnLightTiming timing{};
            GnLightWorkload workload{};
            const ShadowHost& shadows = session_.shadows;
            const GnLight handle = shadows.light(lights_[i].light);
            if (gnGetLightTiming(shadows.context(), shadows.view(0), handle, &timing) < 0 ||
                gnGetLightWorkload(shadows.context(), shadows.view(0), handle, &workload) < 0)
                continue;
            if (timing.frame <= seen_[i]) continue;
            seen_[i] = timing.frame;
            if (!keep || method_ != timing.pMethod) continue;
            LightTimes& light = lights_[i];
            light.workload = workloadOf(workload);
            if (timing.updated) {
                light.updateGpuMs.push_back(double(timing.updateGpuMs));
                light.updateCpuMs.push_back(double(timing.updateCpuMs));
            }
            light.resolveGpuMs.push_back(double(timing.resolveGpuMs));
            light.resolveCpuMs.push_back(double(timing.resolveCpuMs));
        }
        noteShared(keep);
    }

    /// Fastest times of the passes that lights share, as timed: with the barriers of a timed frame.
    std::vector<SharedSample> takeShared() { return std::move(shared_); }

    std::vector<LightTimes> take()
    {
        std::erase_if(lights_, [](const LightTimes& light) { return light.resolveGpuMs.empty(); });
        return std::move(lights_);
    }

private:
    void noteShared(bool keep)
    {
        const GnContext context = session_.shadows.context();
        uint64_t frame = 0;
        uint32_t count = 0;
        if (gnGetPassTimings(context, &frame, &count, nullptr) < 0) return;
        passes_.resize(count);
        if (gnGetPassTimings(context, &frame, &count, passes_.data()) < 0) return;
        if (frame <= std::exchange(sharedSeen_, std::max(frame, sharedSeen_)) || !keep) return;
        const VkExtent2D extent = session_.renderer.extent();
        for (const GnPassTiming& pass : passes_) {
            if (!pass.shared) continue;
            auto part = std::find_if(shared_.begin(), shared_.end(),
                                     [&](const SharedSample& known) { return known.pass == pass.pName; });
            const double gpuMs = double(pass.gpuMs), cpuMs = double(pass.cpuMs);
            if (part == shared_.end()) {
                shared_.push_back({.pass = pass.pName,
                                   .viewPixels = double(extent.width) * double(extent.height),
                                   .gpuMs = gpuMs,
                                   .cpuMs = cpuMs});
            } else {
                part->gpuMs = std::min(part->gpuMs, gpuMs);
                part->cpuMs = std::min(part->cpuMs, cpuMs);
            }
        }
    }

    Session& session_;
    std::string method_;
    std::vector<GnPassTiming> passes_;
    std::vector<SharedSample> shared_;
    uint64_t sharedSeen_ = 0;
    std::vector<LightTimes> lights_;
    std::vector<uint64_t> seen_;
};

std::string today()
{
    char text[16] = "";
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    if (gmtime_r(&now, &parts)) std::strftime(text, sizeof text, "%Y-%m-%d", &parts);
    return text;
}

/// A moment's frames: some that are not timed, then timed and untimed ones in turn, then those that timings are late
/// by.
struct FramePlan {
    uint32_t discarded = kDiscarded, samples = 1;
    uint32_t frames() const { return discarded + 2 * samples - 1 + kLate; }
    bool isTimed(uint32_t frame) const
    {
        return frame >= discarded && frame + kLate < frames() && (frame - discarded) % 2 == 0;
    }
};

/// As many samples as the moment asks for and has the time for. What takes long is disturbed by less.
FramePlan planFrames(const Moment& moment, double frameMs)
{
    FramePlan plan{.samples = moment.samples};
    const auto takesTooLong = [&] { return plan.frames() * frameMs > 1000.0 * moment.seconds; };
    while (plan.samples > 1 && takesTooLong())
        --plan.samples;
    if (takesTooLong()) plan.discarded = kLeastDiscarded;
    return plan;
}

} // namespace

void useMethod(ShadowHost& shadows, const std::string& method)
{
    const std::string rules = "version: 1\n"
                              "name: one_method\n"
                              "options: {allocation: none}\n"
                              "variables: {lightRadius: {universe: [0, 2], unit: m, "
                              "terms: {known: [-.inf, -.inf, .inf, .inf]}}}\n"
                              "suitability: {universe: [0, 1], terms: {low: [-.inf, -.inf, 0.2, 0.8], "
                              "high: [0.2, 0.8, .inf, .inf]}}\n"
                              "rules: [{id: C1, rule: \"if lightRadius is known then " +
                              method + " is high\"}]\n";
    expect(shadows.loadRules(rules, "calibration"));
}

MomentTimes measureMoment(Session& session, const std::string& method, const Moment& moment)
{
    FramePlan plan{.samples = moment.samples};
    std::vector<double> frameMs;
    frameMs.push_back(drawFrame(session, moment.time, false, true));
    Collector collector(session, method);
    for (uint32_t i = 1; i < plan.frames(); ++i) {
        const bool timed = plan.isTimed(i);
        const double ms = drawFrame(session, moment.time + i * moment.step, timed, false);
        if (!timed) frameMs.push_back(ms);
        if (i + 1 == kLeastDiscarded) plan = planFrames(moment, ms);
        collector.note(i >= plan.discarded);
    }
    MomentTimes times;
    times.lights = collector.take();
    if (!times.lights.empty()) times.shared = collector.takeShared(); // by the method that was asked for
    times.lastTime = moment.time + (plan.frames() - 1) * moment.step;
    times.firstFrameMs =
        std::max(0.0, frameMs.front() - percentile(std::vector<double>(frameMs.begin() + 1, frameMs.end()), 0.5));
    return times;
}

void addShared(std::vector<SharedSample>& sums, const MomentTimes& times)
{
    for (const SharedSample& point : times.shared) {
        auto sum = std::find_if(sums.begin(), sums.end(), [&](const auto& known) { return known.pass == point.pass; });
        if (sum == sums.end()) sum = sums.insert(sum, {.pass = point.pass});
        sum->viewPixels += point.viewPixels;
        sum->gpuMs += point.gpuMs;
        sum->cpuMs += point.cpuMs;
        ++sum->samples;
    }
}

std::vector<SharedSample> meansOf(std::vector<SharedSample> sums, const std::string& algorithm, const Device& device)
{
    for (SharedSample& part : sums) {
        part.device = device.properties.deviceName;
        part.driver = device.driver;
        part.algorithm = algorithm;
        part.date = today();
        for (double* sum : {&part.viewPixels, &part.gpuMs, &part.cpuMs})
            *sum /= part.samples;
    }
    std::erase_if(sums, [](const SharedSample& part) { return !(part.gpuMs + part.cpuMs > 0.0); });
    return sums;
}

std::vector<Sample> rowsOf(const MomentTimes& times, const std::string& algorithm, const Device& device)
{
    std::vector<Sample> rows;
    for (const LightTimes& light : times.lights) {
        const auto add = [&](cost::Pass pass, const std::vector<double>& gpu, const std::vector<double>& cpu) {
            Sample row;
            row.device = device.properties.deviceName;
            row.driver = device.driver;
            row.algorithm = algorithm;
            row.pass = pass;
            row.workload = light.workload;
            row.samples = static_cast<uint32_t>(gpu.size());
            row.gpuMsMin = percentile(gpu, 0.0);
            row.gpuMsP50 = percentile(gpu, 0.5);
            row.gpuMsP95 = percentile(gpu, 0.95);
            row.cpuMsMin = percentile(cpu, 0.0);
            row.cpuMsP50 = percentile(cpu, 0.5);
            row.firstFrameMs = times.firstFrameMs;
            row.date = today();
            if (row.gpuMsP50 > 0.0 || row.cpuMsP50 > 0.0) rows.push_back(row);
        };
        add(cost::Pass::update, light.updateGpuMs, light.updateCpuMs);
        add(cost::Pass::resolve, light.resolveGpuMs, light.resolveCpuMs);
    }
    return rows;
}

} // namespace gnomon::demo
