#pragma once

/// Runs policies over a trace and counts what they are worth.
///
///     value    = sum over lights of importance * suitability * quality
///     V*       = value of the best plan with the true times, re-planned every frame, without hysteresis
///     regret   = 1 - sum V / sum V*; a frame over its budget adds nothing to V
///     picks    = share of (frame, light) whose choice is worth at least 99 % of what the oracle gave the light
///     over     = share of frames whose true time exceeds the budget although a plan would have fitted
///     flip     = A-B-A within 30 frames

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "demo/replay/trace.hpp"
#include "rules/engine/rule_base.hpp"
#include "runtime/base/method_set.hpp"
#include "runtime/cost/knowledge_base.hpp"

namespace gnomon::demo {

/// importance * suitability * quality of a method for a light; 0 without opinion.
double valueOf(const Trace& trace, uint32_t frame, uint32_t slot, uint32_t method) noexcept;
/// Those that can serve, are not vetoed, and keep the floor as far as any does.
MethodSet eligibleMethods(const Trace& trace, uint32_t frame, uint32_t slot) noexcept;

struct ReplayOptions {
    rules::Policy policy;
    /// Of the rule base: whether predicted times have a say, or the best suitability serves whatever it takes.
    rules::Options::Allocation allocation = rules::Options::Allocation::Budget;
    double budgetMs = 0.0;                            ///< 0: the trace's own.
    uint32_t latencyFrames = 2;                       ///< Timings are read so many frames late.
    bool rawTimes = false;                            ///< A world of times drawn from the spread, not the minima.
    bool noisyTimings = false;                        ///< A world of minima, but what policies measure is raw.
    uint64_t seed = 1;                                ///< Of the noise.
    const cost::DeviceKnowledge* knowledge = nullptr; ///< Where the plan's cost model starts; null: guesses.
    /// Knowledge of another device: every time of it is a twentieth, and of every other method 1.6 times that or less.
    bool foreign = false;
};

/// Something that chooses. Sees a frame's facts and budget, never its times; those come later through observe().
class ReplayPolicy {
public:
    virtual ~ReplayPolicy() = default;
    virtual std::string name() const = 0;
    /// One method per slot, kNone where no light is.
    virtual void decide(const Trace& trace, uint32_t frame, double budgetMs, std::span<uint32_t> chosen) = 0;
    /// Measured times of a past frame: the minima times the noise of that frame.
    struct Timing {
        uint32_t slot, method;
        double noise;
    };
    virtual void observe(const Trace&, uint32_t /*frame*/, std::span<const Timing>) {}
};

/// What a method of a light had to do in a recorded frame.
cost::Workload workloadOf(const Trace& trace, const TraceLight& light, uint32_t method);
/// The knowledge that a policy starts from: the options' base, else what 40 places of `calibration`, a trace of the
/// same methods in other situations, show; neither: nothing. As another device's where the options say foreign.
cost::DeviceKnowledge knownAtFirst(const ReplayOptions& options, const Trace* calibration);
/// The plan step with the cost model, as the runtime has them. The model starts from knownAtFirst().
std::unique_ptr<ReplayPolicy> planPolicy(const Trace& trace, const ReplayOptions& options, const Trace* calibration);
/// The same method for every light that can have it.
std::unique_ptr<ReplayPolicy> fixedPolicy(uint32_t method);
/// The obvious way: a table of smoothed times per light and method, the best plan of it every frame.
std::unique_ptr<ReplayPolicy> tablePolicy(const Trace& trace);

struct ReplayMetrics {
    std::string policy;
    double regret = 0.0, picks = 0.0;
    double over = 0.0, overTenth = 0.0, worst = 0.0; ///< Shares of frames; largest time over budget.
    double switchesPerLightSecond = 0.0;             ///< From the second second on.
    uint32_t flips = 0;
    double flipsPerMinute = 0.0;
    uint32_t floorViolations = 0; ///< (frame, light) below the floor although a method reaches it.
    uint32_t infeasible = 0;      ///< Frames for which no plan fits; they count nowhere else.
    uint32_t longestOver = 0;     ///< Frames in a row over budget: the way back after a step.
    double meanMs = 0.0, meanError = 0.0;
    double decisionP50Us = 0.0, decisionP99Us = 0.0; ///< Per light. Wall clock: not deterministic.
    /// Methods in the order in which they served, an entry a change; empty where lights of one frame had different
    /// ones.
    std::vector<uint32_t> sequence;
};

/// What the oracle makes of a trace; the same for all policies.
struct Oracle {
    std::vector<double> values;    ///< Per frame.
    std::vector<uint8_t> feasible; ///< Per frame.
    std::vector<uint32_t> chosen;  ///< frames x lights
};
Oracle findOracle(const Trace& trace, const ReplayOptions& options);

ReplayMetrics replay(const Trace& trace, const Oracle& oracle, ReplayPolicy& policy, const ReplayOptions& options);

/// All policies over one trace: plan (from what is known, then cold), table, every fixed method.
std::vector<ReplayMetrics> compare(const Trace& trace, const ReplayOptions& options, const Trace* calibration);
/// One line per policy.
std::string toTable(std::span<const ReplayMetrics> metrics);

} // namespace gnomon::demo
