#include "demo/replay/replay.hpp"

#include <algorithm>
#include <chrono>
#include <deque>

#include "demo/io/number.hpp"
#include "demo/replay/best_plan.hpp"
#include "runtime/cost/exponent.hpp"

namespace gnomon::demo {

namespace {

using plan::kNone;

constexpr uint32_t kFlipFrames = 30;
constexpr double kSettleSeconds = 2.0; ///< Switches are counted from here on.

/// A number in [0, 1) from where it is needed: the noise of a frame does not depend on what was chosen before.
double noiseAt(uint64_t seed, uint64_t frame, uint64_t slot, uint64_t method)
{
    uint64_t z = seed * 0x9e3779b97f4a7c15u + frame * 0xbf58476d1ce4e5b9u + slot * 0x94d049bb133111ebu + method + 1;
    for (int i = 0; i < 2; ++i) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        z ^= z >> 31;
    }
    return static_cast<double>(z >> 11) * 0x1p-53;
}

/// What one sweep would have measured over the minimum: within the spread, and a spike of x2 to x6 in 1 of 200.
double rawFactor(const TraceMethod& measured, uint64_t seed, uint32_t frame, uint32_t slot, uint32_t method)
{
    const double within = noiseAt(seed, frame, slot, method);
    const double factor = cost::exp2Exactly(within * cost::log2Exactly(std::max(1.0f, measured.spread)));
    const double spike = noiseAt(seed + 1, frame, slot, method);
    return spike < 0.005 ? factor * (2.0 + 4.0 * spike / 0.005) : factor;
}

/// One run: what is remembered from frame to frame.
class Run {
public:
    Run(const Trace& trace, const Oracle& oracle, ReplayPolicy& policy, const ReplayOptions& options)
        : trace_(trace), oracle_(oracle), policy_(policy), options_(options), chosen_(trace.lights, kNone),
          last_(trace.lights, kNone), beforeLast_(trace.lights, kNone), switchedAt_(trace.lights, 0)
    {
    }

    ReplayMetrics all()
    {
        metrics_.policy = policy_.name();
        for (uint32_t frame = 0; frame < trace_.frames; ++frame)
            step(frame);
        const double seconds = trace_.frames * double{trace_.frameSeconds};
        const double counted = std::max(1u, feasible_);
        metrics_.regret = oracleValue_ > 0.0 ? 1.0 - value_ / oracleValue_ : 0.0;
        metrics_.picks = static_cast<double>(picked_) / static_cast<double>(std::max<uint64_t>(1, pickable_));
        metrics_.over = over_ / counted;
        metrics_.overTenth = overTenth_ / counted;
        metrics_.switchesPerLightSecond = settledLightSeconds_ > 0.0 ? switches_ / settledLightSeconds_ : 0.0;
        metrics_.flipsPerMinute = seconds > 0.0 ? metrics_.flips * 60.0 / seconds : 0.0;
        metrics_.meanMs = totalMs_ / std::max(1u, trace_.frames);
        metrics_.meanError = error_ / static_cast<double>(std::max<uint64_t>(1, served_));
        if (!mixed_) metrics_.sequence = std::move(sequence_);
        std::sort(decisionUs_.begin(), decisionUs_.end());
        if (!decisionUs_.empty()) {
            metrics_.decisionP50Us = decisionUs_[decisionUs_.size() / 2];
            metrics_.decisionP99Us = decisionUs_[decisionUs_.size() * 99 / 100];
        }
        return metrics_;
    }

private:
    void step(uint32_t frame)
    {
        const double budgetMs = options_.budgetMs > 0.0 ? options_.budgetMs : double{trace_.budgetsMs[frame]};
        const auto start = std::chrono::steady_clock::now();
        policy_.decide(trace_, frame, budgetMs, chosen_);
        const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
        uint32_t present = 0;
        double frameMs = 0.0, frameValue = 0.0;
        std::vector<ReplayPolicy::Timing> timings;
        for (uint32_t slot = 0; slot < trace_.lights; ++slot) {
            if (!trace_.lightStates[trace_.cell(frame, slot)].present) continue;
            ++present;
            frameValue += countLight(frame, slot);
            if (chosen_[slot] == kNone) continue;
            const TraceMethod& measured = trace_.measure(frame, slot, chosen_[slot]);
            const double raw = rawFactor(measured, options_.seed, frame, slot, chosen_[slot]);
            frameMs += measured.ms() * (options_.rawTimes ? raw : 1.0);
            timings.push_back({slot, chosen_[slot], options_.rawTimes || options_.noisyTimings ? raw : 1.0});
        }
        if (present > 0) decisionUs_.push_back(took.count() / present);
        noteSequence(frame);
        judge(frame, frameMs, frameValue, budgetMs);
        late_.push_back(std::move(timings));
        if (late_.size() > options_.latencyFrames) {
            policy_.observe(trace_, frame - options_.latencyFrames, late_.front());
            late_.pop_front();
        }
    }

    void noteSequence(uint32_t frame)
    {
        uint32_t first = kNone;
        for (uint32_t slot = 0; slot < trace_.lights; ++slot) {
            if (!trace_.lightStates[trace_.cell(frame, slot)].present || chosen_[slot] == kNone) continue;
            if (first == kNone) first = chosen_[slot];
            mixed_ = mixed_ || chosen_[slot] != first;
        }
        if (first != kNone && (sequence_.empty() || sequence_.back() != first)) sequence_.push_back(first);
    }

    void judge(uint32_t frame, double frameMs, double frameValue, double budgetMs)
    {
        totalMs_ += frameMs;
        if (!oracle_.feasible[frame]) {
            ++metrics_.infeasible;
            overInARow_ = 0;
            return;
        }
        ++feasible_;
        const double ratio = budgetMs > 0.0 ? frameMs / budgetMs : 0.0;
        const bool over = ratio > 1.0 + 1e-9;
        over_ += over;
        overTenth_ += ratio > 1.1;
        overInARow_ = over ? overInARow_ + 1 : 0;
        metrics_.longestOver = std::max(metrics_.longestOver, overInARow_);
        metrics_.worst = std::max(metrics_.worst, ratio);
        oracleValue_ += oracle_.values[frame];
        if (!over) value_ += frameValue;
    }

    /// Picks, floors, switches and flips of one light; returns its value.
    double countLight(uint32_t frame, uint32_t slot)
    {
        const uint32_t method = chosen_[slot];
        const TraceLight& light = trace_.lightStates[trace_.cell(frame, slot)];
        const double value = method == kNone ? 0.0 : valueOf(trace_, frame, slot, method);
        const uint32_t ideal = oracle_.chosen[trace_.cell(frame, slot)];
        if (oracle_.feasible[frame] && ideal != kNone) {
            ++pickable_;
            picked_ += value >= 0.99 * valueOf(trace_, frame, slot, ideal);
        }
        const MethodSet eligible = eligibleMethods(trace_, frame, slot);
        if (light.floor && !eligible.empty() && (method == kNone || !eligible.has(method))) ++metrics_.floorViolations;
        if (method != kNone) error_ += trace_.measure(frame, slot, method).error, ++served_;
        if (light.fresh) last_[slot] = beforeLast_[slot] = kNone;
        const bool settled = frame * double{trace_.frameSeconds} >= kSettleSeconds;
        if (settled) settledLightSeconds_ += trace_.frameSeconds;
        if (method == last_[slot]) return value;
        if (last_[slot] != kNone) {
            switches_ += settled;
            const bool back = method == beforeLast_[slot] && frame - switchedAt_[slot] <= kFlipFrames;
            metrics_.flips += back && !trace_.cuts[frame]; // a cut ends what was before
        }
        beforeLast_[slot] = trace_.cuts[frame] ? kNone : last_[slot];
        last_[slot] = method;
        switchedAt_[slot] = frame;
        return value;
    }

    const Trace& trace_;
    const Oracle& oracle_;
    ReplayPolicy& policy_;
    const ReplayOptions& options_;
    ReplayMetrics metrics_;
    std::vector<uint32_t> chosen_, last_, beforeLast_, switchedAt_;
    std::deque<std::vector<ReplayPolicy::Timing>> late_;
    std::vector<double> decisionUs_;
    std::vector<uint32_t> sequence_;
    bool mixed_ = false; ///< Lights of one frame had different methods.
    double value_ = 0.0, oracleValue_ = 0.0, totalMs_ = 0.0, error_ = 0.0, settledLightSeconds_ = 0.0;
    uint64_t picked_ = 0, pickable_ = 0, served_ = 0;
    uint32_t over_ = 0, overTenth_ = 0, overInARow_ = 0, feasible_ = 0, switches_ = 0;
};

} // namespace

Oracle findOracle(const Trace& trace, const ReplayOptions& options)
{
    constexpr uint32_t kOracleBins = 2048, kOracleTableLights = 16;
    const auto methods = static_cast<uint32_t>(trace.methods.size());
    BestPlans plans(trace.lights, methods, kOracleTableLights, kOracleBins);
    Oracle oracle;
    oracle.values.resize(trace.frames);
    oracle.feasible.resize(trace.frames);
    oracle.chosen.resize(size_t{trace.frames} * trace.lights, kNone);
    std::vector<double> values(size_t{trace.lights} * methods), costs(values.size());
    std::vector<MethodSet> allowed(trace.lights);
    for (uint32_t frame = 0; frame < trace.frames; ++frame) {
        for (uint32_t slot = 0; slot < trace.lights; ++slot) {
            const bool present = trace.lightStates[trace.cell(frame, slot)].present;
            allowed[slot] = present ? eligibleMethods(trace, frame, slot) : MethodSet{};
            for (uint32_t m = 0; m < methods; ++m) {
                values[slot * methods + m] = valueOf(trace, frame, slot, m);
                costs[slot * methods + m] = trace.measure(frame, slot, m).ms();
            }
        }
        const double budgetMs = options.budgetMs > 0.0 ? options.budgetMs : double{trace.budgetsMs[frame]};
        const auto chosen = std::span(oracle.chosen).subspan(trace.cell(frame, 0), trace.lights);
        const BestPlan best = plans.find({trace.lights, methods, values, costs, allowed, budgetMs}, chosen);
        oracle.values[frame] = best.value;
        oracle.feasible[frame] = best.fits;
    }
    return oracle;
}

ReplayMetrics replay(const Trace& trace, const Oracle& oracle, ReplayPolicy& policy, const ReplayOptions& options)
{
    return Run(trace, oracle, policy, options).all();
}

std::vector<ReplayMetrics> compare(const Trace& trace, const ReplayOptions& options, const Trace* calibration)
{
    const Oracle oracle = findOracle(trace, options);
    std::vector<ReplayMetrics> all;
    ReplayOptions foreign = options;
    foreign.foreign = true;
    for (const auto& policy :
         {planPolicy(trace, options, calibration), planPolicy(trace, foreign, calibration), tablePolicy(trace)})
        all.push_back(replay(trace, oracle, *policy, options));
    for (uint32_t m = 0; m < trace.methods.size(); ++m) {
        all.push_back(replay(trace, oracle, *fixedPolicy(m), options));
        all.back().policy = trace.methods[m];
    }
    return all;
}

std::string toTable(std::span<const ReplayMetrics> metrics)
{
    std::string out = "policy           regret %  picks %   over %  >10 %   worst  row  sw/l/s   flips  floor   ms     "
                      "error %  p50 us  p99 us\n";
    for (const ReplayMetrics& m : metrics) {
        out += m.policy + std::string(m.policy.size() < 16 ? 16 - m.policy.size() : 1, ' ');
        auto cell = [&](double value, int decimals, size_t width) {
            std::string text;
            appendFixed(text, value, decimals);
            out += std::string(text.size() < width ? width - text.size() : 1, ' ') + text;
        };
        cell(100 * m.regret, 2, 9), cell(100 * m.picks, 1, 9), cell(100 * m.over, 2, 9), cell(100 * m.overTenth, 2, 8);
        cell(m.worst, 2, 7), cell(m.longestOver, 0, 5), cell(m.switchesPerLightSecond, 3, 8), cell(m.flips, 0, 7);
        cell(m.floorViolations, 0, 7), cell(m.meanMs, 2, 8), cell(100 * m.meanError, 2, 8);
        cell(m.decisionP50Us, 2, 8), cell(m.decisionP99Us, 2, 8);
        out += '\n';
    }
    return out;
}

} // namespace gnomon::demo
