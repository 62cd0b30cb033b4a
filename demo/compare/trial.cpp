#include "demo/compare/trial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "demo/program/measure.hpp"
#include "demo/program/progress.hpp"

namespace gnomon::demo {
namespace {

/// One of so many frames with a truth is one of a trial, too.
constexpr size_t kEvery = 3;
/// Frames before and with that one. The first makes what is kept; times of the second and third are known one frame
/// later, and the lesser counts: what others take of the processors is only ever added.
constexpr uint32_t kFrames = 4;

/// By light, one time per frame with a truth.
using LightTimes = std::vector<std::vector<double>>;

/// \param least by light, so far \return false if another method served a light
bool noteTimes(const Session& session, const std::string& method, std::vector<double>& least)
{
    for (const uint32_t light : session.renderer.state().present) {
        GnDecision decision{};
        gnGetDecision(session.shadows.context(), session.shadows.view(0), session.shadows.light(light), &decision);
        if (!decision.pMethod) continue; // nothing of it can be seen
        if (decision.pMethod != method) return false;
        if (decision.measuredMs > 0.0f) least[light] = std::min(least[light], double(decision.measuredMs));
    }
    return true;
}

/// Draws to a frame of the path, and that one. \return as noteTimes()
bool timeFrames(Session& session, const Stage& stage, uint32_t last, const std::string& method, LightTimes& times)
{
    std::vector<double> least(times.size(), std::numeric_limits<double>::infinity());
    for (uint32_t before = kFrames; before-- > 0;) {
        drawFrame(session, stage, last > before ? last - before : 0, 0.0f, GN_FRAME_TIMED_BIT);
        if (before < 2 && !noteTimes(session, method, least)) return false;
    }
    for (size_t light = 0; light < times.size(); ++light)
        if (std::isfinite(least[light])) times[light].push_back(least[light]);
    return true;
}

void takeTimes(const Scene& scene, const LightTimes& times, MethodTrial& trial)
{
    for (KindTrial& kind : trial.kinds)
        kind.ms = 0.0;
    for (size_t light = 0; light < times.size(); ++light)
        if (!times[light].empty()) trial.kinds[size_t(scene.lights[light].kind)].ms += medianOf(times[light]);
}

/// \return what went wrong; empty: nothing
std::string tryMethod(const Stage& all, const Truths& truths, const EqualQuality& quality,
                      const std::vector<MethodTrial>& earlier, const TriedMethod& method, MethodTrial& trial)
{
    const Scene scene = onlyServed(all.scene, method.traits);
    const Stage stage{
        .device = all.device, .scene = scene, .size = all.size, .path = {scene, all.path}, .recorded = all.recorded};
    Session session(stage.device, scene, {.scene = {}, .size = stage.size, .pinnedThreads = true});
    prepareMethod(session, all, method);
    std::vector<std::string> refused;
    if (const Status pinned = session.shadows.pinAll(method.name, &refused); !pinned) return pinned.error();
    if (!refused.empty()) return refused.front();
    session.wakeDevice(stage.path.time(0));
    for (const Light& light : scene.lights)
        trial.kinds[size_t(light.kind)].served = true;
    LightTimes times(scene.lights.size());
    size_t index = 0;
    for (const auto& [frame, truth] : truths) {
        if (index++ % kEvery != 0) continue;
        if (!timeFrames(session, stage, frame, method.name, times)) return "another method served in its place";
        takeTimes(scene, times, trial);
        const std::array<NearFar, kLightKinds> errors = countErrors(session, truth);
        for (size_t kind = 0; kind < kLightKinds; ++kind)
            trial.kinds[kind].errors += errors[kind];
        const double over = overBest(trial, earlier, quality);
        if (over > kCut) {
            trial.overBest = over;
            break;
        }
    }
    return "";
}

} // namespace

std::vector<TriedMethod> withSides(const std::vector<TriedMethod>& methods, std::span<const uint32_t> sides)
{
    std::vector<TriedMethod> out;
    for (const TriedMethod& method : methods) {
        out.push_back(method);
        if (!method.resolution) continue;
        for (const double side : sides) {
            const GnSettingInfo& setting = *method.resolution;
            if (side == setting.value || side < setting.minimum || side > setting.maximum) continue;
            TriedMethod variant = method;
            variant.side = static_cast<uint32_t>(side);
            variant.name.append("_").append(std::to_string(variant.side));
            out.push_back(std::move(variant));
        }
    }
    return out;
}

bool followsCoverage(const TriedMethod& method)
{
    return method.side == 0 && method.resolution && method.resolution->value == 0.0;
}

void prepareMethod(Session& session, const Stage& stage, const TriedMethod& method)
{
    const GnContext context = session.shadows.context();
    if (method.side > 0) {
        if (gnAddMethod(context, method.name.c_str(), method.algorithm.c_str()) < 0)
            throw HostError(method.name + ": " + gnGetLastError(context));
        expect(session.shadows.set(method.name, kResolutionSetting, double(method.side)));
    }
    if (followsCoverage(method))
        expect(session.shadows.loadRules(stage.rules.text, stage.rules.name, stage.rules.preset));
    expect(session.shadows.warmUp(method.name)); // no other one is asked for
}

std::vector<MethodTrial> tryMethods(const Stage& stage, const Truths& truths, const EqualQuality& quality,
                                    const std::vector<TriedMethod>& methods, std::vector<std::string>& notes)
{
    // The truth first: it is of equal quality by definition, so that slow methods are cut from the beginning.
    std::vector<TriedMethod> order = methods;
    std::stable_partition(order.begin(), order.end(),
                          [](const TriedMethod& method) { return method.name == kTruthMethod; });
    std::vector<MethodTrial> trials;
    Progress progress(static_cast<uint32_t>(order.size()));
    uint32_t done = 0;
    for (const TriedMethod& method : order) {
        MethodTrial trial{.method = method.name};
        std::string wrong = "needs the CPU between its passes and cannot be recorded";
        try {
            if (!stage.recorded || method.roundTrips == 0)
                wrong = tryMethod(stage, truths, quality, trials, method, trial);
        } catch (const HostError& error) { // such as maps beyond the memory limit: one choice less
            wrong = error.what();
        }
        if (wrong.empty())
            trials.push_back(std::move(trial));
        else
            notes.push_back(method.name + ": " + wrong);
        progress.show(++done, "trial of " + method.name);
    }
    return trials;
}

} // namespace gnomon::demo
