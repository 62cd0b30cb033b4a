#include <algorithm>
#include <array>

#include "demo/calibrate/fit.hpp"
#include "demo/replay/best_plan.hpp"
#include "demo/replay/replay.hpp"
#include "runtime/cost/teach.hpp"
#include "runtime/plan/plan.hpp"
#include "runtime/plan/utility.hpp"

namespace gnomon::demo {

namespace {

using plan::kNone;

/// All methods in some of a trace's places.
Samples samplesOf(const Trace& from)
{
    constexpr uint32_t kPlaces = 40;
    std::vector<size_t> present;
    for (size_t i = 0; i < from.lightStates.size(); ++i)
        if (from.lightStates[i].present) present.push_back(i);
    Samples samples;
    for (uint32_t place = 0; place < kPlaces && !present.empty(); ++place) {
        // Steps of the golden ratio: spread evenly whatever the number of lights (Weyl).
        const double share = place * 0.6180339887498949;
        const size_t cell =
            present[static_cast<size_t>((share - static_cast<uint32_t>(share)) * static_cast<double>(present.size()))];
        for (uint32_t m = 0; m < from.methods.size(); ++m) {
            const TraceMethod& measured = from.measures[cell * from.methods.size() + m];
            Sample sample{.algorithm = from.methods[m], .workload = workloadOf(from, from.lightStates[cell], m)};
            sample.pass = cost::Pass::update;
            sample.gpuMsMin = double{measured.updateGpuMs}, sample.cpuMsMin = double{measured.updateCpuMs};
            samples.rows.push_back(sample);
            sample.pass = cost::Pass::resolve;
            sample.gpuMsMin = double{measured.resolveGpuMs}, sample.cpuMsMin = double{measured.resolveCpuMs};
            samples.rows.push_back(sample);
        }
    }
    return samples;
}

class PlanPolicy : public ReplayPolicy {
public:
    PlanPolicy(const Trace& trace, const ReplayOptions& options, const Trace* calibration)
        : options_(options), methods_(static_cast<uint32_t>(trace.methods.size())), foreign_(options.foreign)
    {
        model_.setSharedCores(true); // a trace adds both processors up
        model_.resize(methods_, trace.lights);
        plan_.reserve(trace.lights, methods_);
        memories_.resize(trace.lights);
        ages_.resize(trace.lights);
        teach(knownAtFirst(options, calibration), trace.methods);
    }
    std::string name() const override { return foreign_ ? "plan_foreign" : "plan"; }

    void decide(const Trace& trace, uint32_t frame, double budgetMs, std::span<uint32_t> chosen) override
    {
        requests_.clear(), candidates_.clear(), slots_.clear();
        for (uint32_t slot = 0; slot < trace.lights; ++slot) {
            chosen[slot] = kNone;
            const TraceLight& light = trace.lightStates[trace.cell(frame, slot)];
            if (light.fresh || !light.present) {
                memories_[slot] = {}, ages_[slot] = 0;
                model_.forgetLight(slot);
            }
            if (!light.present) continue;
            if (options_.allocation == rules::Options::Allocation::None)
                chosen[slot] = memories_[slot].incumbent = bestSuited(trace, frame, slot);
            else
                addLight(trace, frame, slot);
        }
        if (requests_.empty()) return;
        plan_.step({.frame = frame,
                    .lights = requests_,
                    .candidates = candidates_,
                    .methods = methods_,
                    .budgetMs = budgetMs,
                    .cut = trace.cuts[frame] != 0,
                    .policy = &options_.policy});
        for (size_t i = 0; i < slots_.size(); ++i) {
            const plan::LightPlan& light = plan_.lights()[i];
            chosen[slots_[i]] = light.chosen;
            ages_[slots_[i]] = light.switched ? 0 : ages_[slots_[i]] + 1;
        }
    }

    void observe(const Trace& trace, uint32_t frame, std::span<const Timing> timings) override
    {
        for (const Timing& timing : timings) {
            // Timings of a method the light has left are of use too, but their age is not known any more.
            const bool left = memories_[timing.slot].incumbent != timing.method;
            const uint32_t age =
                ages_[timing.slot] > options_.latencyFrames ? ages_[timing.slot] - options_.latencyFrames : 0;
            const TraceLight& light = trace.lightStates[trace.cell(frame, timing.slot)];
            const TraceMethod& measured = trace.measure(frame, timing.slot, timing.method);
            cost::Observation seen{.light = timing.slot,
                                   .method = timing.method,
                                   .workload = workloadOf(trace, light, timing.method),
                                   .framesSinceSwitch = left ? 0 : age};
            seen.pass = cost::Pass::update;
            seen.gpuMs = double{measured.updateGpuMs} * timing.noise;
            seen.cpuMs = double{measured.updateCpuMs} * timing.noise;
            if (seen.gpuMs + seen.cpuMs > 0.0) model_.observe(seen);
            seen.pass = cost::Pass::resolve;
            seen.gpuMs = double{measured.resolveGpuMs} * timing.noise;
            seen.cpuMs = double{measured.resolveCpuMs} * timing.noise;
            model_.observe(seen);
        }
        model_.endFrame();
    }

private:
    void teach(const cost::DeviceKnowledge& knowledge, const std::vector<std::string>& names)
    {
        if (knowledge.algorithms.empty()) return;
        std::vector<cost::TaughtMethod> methods;
        for (const std::string& name : names)
            methods.push_back({name});
        cost::teach(model_, knowledge, methods);
        model_.setKinship(foreign_ ? cost::Kinship::foreign : cost::Kinship::same);
    }

    /// Without a plan: the incumbent on ties, then registry order.
    uint32_t bestSuited(const Trace& trace, uint32_t frame, uint32_t slot) const
    {
        uint32_t best = kNone;
        for (const uint32_t m : eligibleMethods(trace, frame, slot)) {
            const auto suitability = trace.measure(frame, slot, m).suitability;
            const auto most = best == kNone ? suitability : trace.measure(frame, slot, best).suitability;
            if (best == kNone || suitability > most || (suitability == most && m == memories_[slot].incumbent))
                best = m;
        }
        return best;
    }

    void addLight(const Trace& trace, uint32_t frame, uint32_t slot)
    {
        const TraceLight& light = trace.lightStates[trace.cell(frame, slot)];
        slots_.push_back(slot);
        requests_.push_back({.memory = &memories_[slot],
                             .importance = light.importance,
                             .floor = light.floor,
                             .minimumQuality = light.minimumQuality});
        for (uint32_t m = 0; m < methods_; ++m) {
            const TraceMethod& measured = trace.measure(frame, slot, m);
            const cost::Prediction prediction = model_.predict(slot, m, workloadOf(trace, light, m), light.still);
            candidates_.push_back({.eligibility = measured.suitability == kTraceVetoed   ? plan::Eligibility::never
                                                  : measured.suitability == kTraceUnable ? plan::Eligibility::trait
                                                                                         : plan::Eligibility::eligible,
                                   .suitability = measured.suitability,
                                   .quality = measured.quality,
                                   .ms = prediction.sureMs(),
                                   .likelyMs = prediction.ms,
                                   .sigmaMs = prediction.measured ? prediction.sigmaMs : 0.0,
                                   .familiar = prediction.familiar});
        }
    }

    ReplayOptions options_;
    uint32_t methods_;
    bool foreign_;
    cost::CostModel model_;
    plan::PlanStep plan_;
    std::vector<plan::LightMemory> memories_;
    std::vector<uint32_t> ages_; ///< Frames since the light's last switch.
    std::vector<plan::LightRequest> requests_;
    std::vector<plan::Candidate> candidates_;
    std::vector<uint32_t> slots_;
};

class FixedPolicy : public ReplayPolicy {
public:
    explicit FixedPolicy(uint32_t method) : method_(method) {}
    std::string name() const override { return "fixed"; }
    void decide(const Trace& trace, uint32_t frame, double, std::span<uint32_t> chosen) override
    {
        for (uint32_t slot = 0; slot < trace.lights; ++slot) {
            const bool able = trace.lightStates[trace.cell(frame, slot)].present &&
                              trace.measure(frame, slot, method_).suitability != kTraceUnable;
            chosen[slot] = able ? method_ : kNone;
        }
    }

private:
    uint32_t method_;
};

class TablePolicy : public ReplayPolicy {
public:
    explicit TablePolicy(const Trace& trace)
        : methods_(static_cast<uint32_t>(trace.methods.size())), plans_(trace.lights, methods_)
    {
        const size_t cells = size_t{trace.lights} * methods_;
        smoothedMs_.assign(cells, 1.0); // nothing is known: everything costs a millisecond
        values_.resize(cells);
        allowed_.resize(trace.lights);
    }
    std::string name() const override { return "table"; }
    void decide(const Trace& trace, uint32_t frame, double budgetMs, std::span<uint32_t> chosen) override
    {
        for (uint32_t slot = 0; slot < trace.lights; ++slot) {
            const TraceLight& light = trace.lightStates[trace.cell(frame, slot)];
            allowed_[slot] = light.present ? eligibleMethods(trace, frame, slot) : MethodSet{};
            for (uint32_t m = 0; m < methods_; ++m)
                values_[slot * methods_ + m] = valueOf(trace, frame, slot, m);
        }
        plans_.find({trace.lights, methods_, values_, smoothedMs_, allowed_, budgetMs}, chosen);
    }
    void observe(const Trace& trace, uint32_t frame, std::span<const Timing> timings) override
    {
        for (const Timing& timing : timings) {
            double& smoothed = smoothedMs_[timing.slot * methods_ + timing.method];
            smoothed += 0.2 * (trace.measure(frame, timing.slot, timing.method).ms() * timing.noise - smoothed);
        }
    }

private:
    uint32_t methods_;
    BestPlans plans_;
    std::vector<double> smoothedMs_, values_;
    std::vector<MethodSet> allowed_;
};

} // namespace

cost::Workload workloadOf(const Trace& trace, const TraceLight& light, uint32_t method)
{
    return {.pixels = double{light.pixels},
            .casterTriangles = double{light.casterTriangles},
            .mapTexels = double{trace.mapTexels[method]} * (light.point ? 6.0 : 1.0), // the faces of a cube
            .sharing = double{light.sharing},
            .still = light.still,
            .drawnTriangles = double{light.drawnTriangles},
            .casters = double{light.casters},
            .directional = light.directional,
            .point = light.point,
            .drawnPixels = double{light.drawnPixels},
            .viewPixels = double{light.viewPixels},
            .shadowPixels = trace.drawsVolumes[method] ? double{light.shadowPixels} : 0.0,
            .treeLevels = trace.tracesPixels[method] ? double{light.treeLevels} : 0.0};
}

cost::DeviceKnowledge knownAtFirst(const ReplayOptions& options, const Trace* calibration)
{
    cost::DeviceKnowledge knowledge;
    if (options.knowledge)
        knowledge = *options.knowledge;
    else if (calibration)
        knowledge = fitKnowledge(samplesOf(*calibration), "software");
    constexpr double kFactor = 1.0 / 20.0, kOdd = 1.6;
    for (size_t i = 0; options.foreign && i < knowledge.algorithms.size(); ++i)
        for (cost::TrackCost& track : knowledge.algorithms[i].tracks)
            for (double& ms : track.ms)
                ms *= i % 2 ? kFactor * kOdd : kFactor / kOdd;
    return knowledge;
}

double valueOf(const Trace& trace, uint32_t frame, uint32_t slot, uint32_t method) noexcept
{
    const auto methods = static_cast<uint32_t>(trace.methods.size());
    std::vector<plan::UtilityTerms> terms(methods);
    for (uint32_t m = 0; m < methods; ++m) {
        const TraceMethod& measured = trace.measure(frame, slot, m);
        terms[m] = {measured.suitability, measured.quality, measured.suitability >= kTraceNoOpinion};
    }
    if (method >= methods || terms[method].suitability < 0) return 0.0;
    const std::span all = std::span<const plan::UtilityTerms>(terms).first(methods);
    return double{trace.lightStates[trace.cell(frame, slot)].importance} *
           plan::utility(plan::sharedTerms(all, method));
}

/// The same admission as the plan step's, without pins.
MethodSet eligibleMethods(const Trace& trace, uint32_t frame, uint32_t slot) noexcept
{
    const TraceLight& light = trace.lightStates[trace.cell(frame, slot)];
    MethodSet able, spoken;
    for (uint32_t m = 0; m < trace.methods.size(); ++m) {
        const int16_t suitability = trace.measure(frame, slot, m).suitability;
        if (suitability >= kTraceNoOpinion) able.add(m);
        if (suitability >= 0) spoken.add(m);
    }
    if (!spoken.empty()) able = spoken;
    if (!light.floor) return able;
    float best = 0.0f;
    auto quality = [&](uint32_t m) { return trace.measure(frame, slot, m).quality; };
    for (const uint32_t m : able)
        best = std::max(best, quality(m));
    for (const uint32_t m : able)
        if (quality(m) < std::min(best, light.minimumQuality)) able.remove(m);
    return able;
}

std::unique_ptr<ReplayPolicy> planPolicy(const Trace& trace, const ReplayOptions& options, const Trace* calibration)
{
    return std::make_unique<PlanPolicy>(trace, options, calibration);
}
std::unique_ptr<ReplayPolicy> fixedPolicy(uint32_t method)
{
    return std::make_unique<FixedPolicy>(method);
}
std::unique_ptr<ReplayPolicy> tablePolicy(const Trace& trace)
{
    return std::make_unique<TablePolicy>(trace);
}

} // namespace gnomon::demo
