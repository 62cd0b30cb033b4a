// `gnomon trace`: a scene with every method measured on every frame for every light, as one file for `gnomon replay`.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>

#include "demo/host/pin_thread.hpp"
#include "demo/io/file.hpp"
#include "demo/program/checks.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/measure.hpp"
#include "demo/program/rule_support.hpp"
#include "demo/replay/budget.hpp"
#include "demo/scene/scene_file.hpp"
#include "runtime/registry.hpp"

namespace gnomon::demo {
namespace {

// Timings come two frames late; with frames waited for, the next frame knows. One more for safety.
constexpr uint32_t kFlushFrames = 3;
// What the runtime smooths is full by then: five looks at the depth grid, one in eight frames.
constexpr uint32_t kSettleFrames = 41;

double secondsPerFrame(const Scene& scene, uint32_t frames)
{
    return static_cast<double>(scene.frames) / scene.framesPerSecond / frames;
}

/// The first of the trace's frames in which a light is there.
uint32_t firstLit(const Scene& scene, uint32_t frames)
{
    for (uint32_t frame = 0; frame < frames; ++frame)
        if (lightCountAt(scene, frame * secondsPerFrame(scene, frames), false) > 0) return frame;
    throw HostError("scene '" + scene.name + "' has no light in any frame of the trace");
}

/// Texels; 0: the method has no map. A trace has one side for all lights and frames: where it would follow screen
/// coverage, that of lights whose receivers are not measured.
double fixedMapSide(const GnMethodInfo& method)
{
    for (uint32_t i = 0; i < method.settingCount; ++i)
        if (method.pSettings[i].value >= method.pSettings[i].minimum &&
            std::string_view(method.pSettings[i].pName) == kResolutionSetting)
            return method.pSettings[i].value;
    for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms)
        for (const SettingSpec& setting : algorithm.entry->settings)
            if (setting.byCoverage && std::string_view(method.pAlgorithm) == algorithm.entry->name)
                return setting.standard;
    return 0.0;
}

/// Runs a scene again and again, and fills in a trace.
class Tracer {
public:
    /// \param firstLit of the frames.
    Tracer(const TraceOptions& options, const Scene& scene, uint32_t firstLit, Device& device, VkExtent2D size)
        : options_(options), scene_(scene), secondsPerFrame_(secondsPerFrame(scene, options.frames)),
          session_(device, scene,
                   {.size = size,
                    .contextFlags = GN_CONTEXT_TIME_EVERY_FRAME_BIT | GN_CONTEXT_NO_BACKGROUND_BIT,
                    .pinnedThreads = true}),
          firstLit_(firstLit)
    {
        expect(session_.shadows.warmUp());
        chooseMethods();
        trace_.frames = options.frames;
        trace_.lights = static_cast<uint32_t>(scene.lights.size());
        trace_.frameSeconds = static_cast<float>(secondsPerFrame_);
    }

    Trace run()
    {
        readFacts();
        countErrors();
        session_.wakeDevice(0.0);
        for (uint32_t sweep = 0; sweep < options_.sweeps; ++sweep)
            for (uint32_t m = 0; m < trace_.methods.size(); ++m)
                time(m);
        noteStill();
        return std::move(trace_);
    }

private:
    using FrameNumbers = std::vector<std::pair<uint64_t, uint32_t>>; ///< Of the runtime, and of the trace.

    void chooseMethods()
    {
        const std::vector<std::string> asked = parseNames(options_.methods);
        for (const GnMethodInfo& info : session_.shadows.methods()) {
            const bool wanted = asked.empty() || std::find(asked.begin(), asked.end(), info.pName) != asked.end();
            if (!wanted) continue;
            const Status pinned = session_.shadows.pinAll(info.pName); // fails where it serves none of these lights
            if (info.pUnavailable || !pinned) {
                if (!asked.empty())
                    std::fprintf(stderr, "note: %s is left out: %s\n", info.pName,
                                 info.pUnavailable ? info.pUnavailable : pinned.error().c_str());
                continue;
            }
            trace_.methods.emplace_back(info.pName);
            const double side = fixedMapSide(info);
            if (side > 0.0) expect(session_.shadows.set(info.pName, kResolutionSetting, side));
            trace_.mapTexels.push_back(static_cast<float>(side * side));
            trace_.drawsVolumes.push_back((info.traits & GN_TRAIT_TOPOLOGY_BIT) != 0);
            trace_.tracesPixels.push_back((info.traits & GN_TRAIT_RAYS_BIT) != 0 && side == 0.0);
        }
        if (trace_.methods.empty()) throw HostError("no method serves a light of this scene");
    }

    /// Draws the frame and waits for it. @return gnomon's number of it.
    uint64_t draw(uint32_t frame)
    {
        const double time = frame * secondsPerFrame_;
        const CameraState camera = session_.camera(time);
        session_.renderer.draw({.time = time,
                                .cameras = {&camera, 1},
                                .shadows = &session_.shadows,
                                .flags = GN_FRAME_TIMED_BIT,
                                .cameraCut = frame > 0 && cutBefore(frame)});
        session_.renderer.waitForFrame();
        return session_.shadows.stats().frame;
    }
    bool cutBefore(uint32_t frame) const
    {
        return cameraCutsBetween(scene_, (frame - 1) * secondsPerFrame_, frame * secondsPerFrame_);
    }
    void pinAll(const std::string& method)
    {
        for (uint32_t light = 0; light < scene_.lights.size(); ++light)
            expect(session_.shadows.pin(light, {}));
        if (!method.empty()) expect(session_.shadows.pinAll(method));
    }
    bool servedBy(uint32_t light, const std::string& method)
    {
        GnDecision decision{};
        gnGetDecision(session_.shadows.context(), session_.shadows.view(0), session_.shadows.light(light), &decision);
        return decision.reason == GN_REASON_PINNED && method == decision.pMethod;
    }

    /// One run by the rules: what they know of every light.
    void readFacts()
    {
        const RuleText rules = valueOf(findRules(options_.rules));
        expect(session_.shadows.loadRules(rules.text, rules.name, rules.preset));
        pinAll({});
        for (uint32_t i = 0; i < kSettleFrames; ++i)
            draw(firstLit_);
        nameFacts();
        FrameNumbers numbers;
        for (uint32_t frame = 0; frame < trace_.frames; ++frame) {
            numbers.emplace_back(draw(frame), frame);
            takeWorkloads(numbers);
            trace_.cuts[frame] = frame == 0 || cutBefore(frame);
            for (const uint32_t light : session_.renderer.state().present)
                readLight(frame, light);
        }
        for (uint32_t i = 0; i < kFlushFrames; ++i) {
            draw(trace_.frames - 1);
            takeWorkloads(numbers);
        }
    }

    /// What the cost model knew of the lights in the newest timed frame.
    void takeWorkloads(const FrameNumbers& numbers)
    {
        for (uint32_t slot = 0; slot < trace_.lights; ++slot) {
            GnLightWorkload workload{};
            if (gnGetLightWorkload(session_.shadows.context(), session_.shadows.view(0), session_.shadows.light(slot),
                                   &workload) < 0)
                continue;
            const auto found =
                std::find_if(numbers.begin(), numbers.end(), [&](const auto& n) { return n.first == workload.frame; });
            if (found == numbers.end()) continue;
            TraceLight& light = trace_.lightStates[trace_.cell(found->second, slot)];
            light.pixels = static_cast<float>(workload.pixels);
            light.casterTriangles = static_cast<float>(workload.casterTriangles);
            light.drawnTriangles = static_cast<float>(workload.drawnTriangles);
            light.casters = static_cast<float>(workload.casters);
            light.drawnPixels = static_cast<float>(workload.drawnPixels);
            light.viewPixels = static_cast<float>(workload.viewPixels);
            light.sharing = static_cast<float>(workload.sharing);
        }
    }

    std::vector<GnFact> factsOf(uint32_t light)
    {
        uint32_t count = 0;
        GnContext context = session_.shadows.context();
        gnGetFacts(context, session_.shadows.view(0), session_.shadows.light(light), &count, nullptr);
        std::vector<GnFact> facts(count);
        gnGetFacts(context, session_.shadows.view(0), session_.shadows.light(light), &count, facts.data());
        return facts;
    }
    /// Of the newest frame, in which a light is there: the same for all.
    void nameFacts()
    {
        for (const GnFact& fact : factsOf(session_.renderer.state().present.front()))
            trace_.facts.emplace_back(fact.pName);
        if (!fitsTrace(trace_.frames, trace_.lights, trace_.methods.size(), trace_.facts.size()))
            throw HostError(std::to_string(trace_.frames) + " frames of " + std::to_string(trace_.lights) +
                            " lights by " + std::to_string(trace_.methods.size()) +
                            " methods are more than a trace may hold; take fewer frames");
        trace_.allocate();
    }

    void readLight(uint32_t frame, uint32_t slot)
    {
        const size_t cell = trace_.cell(frame, slot);
        TraceLight& light = trace_.lightStates[cell];
        light.present = true;
        light.fresh = frame == 0 || !trace_.lightStates[trace_.cell(frame - 1, slot)].present;
        light.importance = scene_.lights[slot].importance > 0.0f ? scene_.lights[slot].importance : 1.0f;
        light.directional = scene_.lights[slot].kind == LightKind::Directional;
        light.point = scene_.lights[slot].kind == LightKind::Point;
        const std::vector<GnFact> facts = factsOf(slot);
        for (size_t i = 0; i < facts.size(); ++i)
            trace_.factValues[cell * trace_.facts.size() + i] = static_cast<float>(facts[i].value);
        uint32_t count = 0;
        GnContext context = session_.shadows.context();
        gnGetCandidates(context, session_.shadows.view(0), session_.shadows.light(slot), &count, nullptr);
        std::vector<GnCandidate> candidates(count);
        gnGetCandidates(context, session_.shadows.view(0), session_.shadows.light(slot), &count, candidates.data());
        for (uint32_t m = 0; m < trace_.methods.size(); ++m)
            for (const GnCandidate& candidate : candidates)
                if (trace_.methods[m] == candidate.pMethod) {
                    trace_.measure(frame, slot, m).suitability = static_cast<int16_t>(candidate.suitability);
                    trace_.measure(frame, slot, m).quality = candidate.quality;
                }
    }

    /// One run of every method with the pictures read back, the truth first.
    void countErrors()
    {
        struct Answer {
            std::vector<uint8_t> counted;
            Image8 visibility;
        };
        std::vector<Answer> truth(size_t{trace_.frames} * trace_.lights);
        pinAll(kTruthMethod);
        draw(0);
        for (uint32_t frame = 0; frame < trace_.frames; ++frame) {
            draw(frame);
            const FrameSurfaces surfaces{session_.renderer.readDepth(), session_.renderer.readNormals()};
            const std::vector<Image8> pictures = session_.renderer.readVisibility();
            const SceneState& state = session_.renderer.state();
            for (size_t layer = 0; layer < state.present.size(); ++layer) {
                const uint32_t light = state.present[layer];
                truth[trace_.cell(frame, light)] = {countedPixels(scene_, session_.renderer.camera(), surfaces,
                                                                  scene_.lights[light], state.lights[light]),
                                                    pictures[layer]};
            }
        }
        for (uint32_t m = 0; m < trace_.methods.size(); ++m) {
            pinAll(trace_.methods[m]);
            draw(0);
            for (uint32_t frame = 0; frame < trace_.frames; ++frame) {
                draw(frame);
                const std::vector<Image8> pictures = session_.renderer.readVisibility();
                const std::vector<uint32_t>& present = session_.renderer.state().present;
                for (size_t layer = 0; layer < present.size(); ++layer) {
                    if (!servedBy(present[layer], trace_.methods[m])) continue;
                    const Answer& answer = truth[trace_.cell(frame, present[layer])];
                    const ErrorCount errors = compare(pictures[layer], answer.visibility, answer.counted);
                    trace_.measure(frame, present[layer], m).error =
                        static_cast<float>(errors.percent(errors.wrong()) / 100.0);
                }
            }
        }
    }

    /// One sweep of one method over the whole animation; the fastest sweep of a frame stays.
    void time(uint32_t method)
    {
        pinAll(trace_.methods[method]);
        for (uint32_t i = 0; i < kFlushFrames; ++i)
            draw(0);
        FrameNumbers numbers;
        std::vector<uint8_t> served(size_t{trace_.frames} * trace_.lights);
        for (uint32_t frame = 0; frame < trace_.frames + kFlushFrames; ++frame) {
            const uint32_t shown = std::min(frame, trace_.frames - 1);
            const uint64_t number = draw(shown);
            if (frame < trace_.frames) {
                numbers.emplace_back(number, frame);
                for (const uint32_t light : session_.renderer.state().present)
                    served[trace_.cell(frame, light)] = servedBy(light, trace_.methods[method]);
            }
            takeTimings(method, numbers, served);
        }
    }

    void takeTimings(uint32_t method, const FrameNumbers& numbers, const std::vector<uint8_t>& served)
    {
        GnContext context = session_.shadows.context();
        uint64_t number = 0;
        uint32_t count = 0;
        gnGetPassTimings(context, &number, &count, nullptr);
        const auto found =
            std::find_if(numbers.begin(), numbers.end(), [&](const auto& n) { return n.first == number; });
        if (found == numbers.end() || number == taken_) return;
        taken_ = number;
        passes_.resize(count);
        gnGetPassTimings(context, nullptr, &count, passes_.data());
        for (uint32_t light = 0; light < trace_.lights; ++light)
            if (served[trace_.cell(found->second, light)]) {
                keepFastest(found->second, light, method);
                noteShape(found->second, number, light);
            }
    }

    /// The parts of a workload that only some methods are told: with volumes, or with a ray for every pixel.
    void noteShape(uint32_t frame, uint64_t number, uint32_t light)
    {
        GnLightWorkload workload{};
        if (gnGetLightWorkload(session_.shadows.context(), session_.shadows.view(0), session_.shadows.light(light),
                               &workload) >= 0 &&
            workload.frame == number) {
            TraceLight& state = trace_.lightStates[trace_.cell(frame, light)];
            if (workload.shadowPixels > 0.0) state.shadowPixels = static_cast<float>(workload.shadowPixels);
            if (workload.treeLevels > 0.0) state.treeLevels = static_cast<float>(workload.treeLevels);
        }
    }

    void keepFastest(uint32_t frame, uint32_t light, uint32_t method)
    {
        TraceMethod now;
        for (const GnPassTiming& pass : passes_) {
            if (pass.light != session_.shadows.light(light)) continue;
            const bool update = pass.view == VK_NULL_HANDLE; // light scope: what is kept while nothing moves
            (update ? now.updateGpuMs : now.resolveGpuMs) += pass.gpuMs;
            (update ? now.updateCpuMs : now.resolveCpuMs) += pass.cpuMs;
        }
        TraceMethod& kept = trace_.measure(frame, light, method);
        const double before = kept.ms(), ms = now.ms();
        if (!(ms > 0.0)) return;
        const double slowest = std::max(before * double{kept.spread}, ms);
        if (before == 0.0 || ms < before) {
            kept.updateGpuMs = now.updateGpuMs, kept.updateCpuMs = now.updateCpuMs;
            kept.resolveGpuMs = now.resolveGpuMs, kept.resolveCpuMs = now.resolveCpuMs;
        }
        kept.spread = static_cast<float>(slowest / kept.ms());
    }

    /// A light rests in a frame in which no method had anything to update.
    void noteStill()
    {
        for (uint32_t frame = 0; frame < trace_.frames; ++frame)
            for (uint32_t light = 0; light < trace_.lights; ++light) {
                bool still = true;
                for (uint32_t m = 0; m < trace_.methods.size(); ++m)
                    still = still && trace_.measure(frame, light, m).updateGpuMs == 0.0f;
                trace_.lightStates[trace_.cell(frame, light)].still = still;
            }
    }

    const TraceOptions& options_;
    const Scene& scene_;
    double secondsPerFrame_;
    Session session_;
    uint32_t firstLit_;
    Trace trace_;
    std::vector<GnPassTiming> passes_;
    uint64_t taken_ = 0;
};

} // namespace

int traceCommand(const TraceOptions& options)
{
    const auto start = std::chrono::steady_clock::now();
    Scene scene = valueOf(loadScene(options.scene));
    if (options.lights > 0) limitLights(scene, options.lights);
    const VkExtent2D size = valueOf(parseSize(options.size));
    requireMethods(parseNames(options.methods));
    const uint32_t lit = firstLit(scene, options.frames);
    const rules::RuleBase rules = parseRules(options.rules);
    const std::vector<BudgetPart> budgets = valueOf(parseBudgets(options.budget));
    requireWritable(options.out);
    const std::unique_ptr<Device> device = Device::create({});
    pinThread(0);
    Trace trace = Tracer(options, scene, lit, *device, size).run();
    applyRulesAloud(trace, rules);
    setBudgets(trace, budgets);
    const std::string bytes = writeTrace(trace);
    expect(writeFile(options.out, bytes));
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    std::printf("%s: %u frames of %.3f s, %u lights, %zu methods, %zu bytes, in %.0f s\n", options.out.c_str(),
                trace.frames, double{trace.frameSeconds}, trace.lights, trace.methods.size(), bytes.size(),
                took.count());
    return 0;
}

} // namespace gnomon::demo
