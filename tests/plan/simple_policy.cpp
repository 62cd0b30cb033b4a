#include "tests/plan/simple_policy.hpp"

#include <algorithm>

#include "demo/replay/budget.hpp"
#include "runtime/plan/greedy.hpp"
#include "runtime/plan/utility.hpp"

namespace gnomon::test {

namespace {

using plan::kNone;

constexpr uint64_t kFlipFrames = 30; // in which a change back would be a flip
constexpr double kAsMuch = 0.99;     // of the most that a method is worth
constexpr double kClearlyLess = 0.9; // of what serves

class SimplePolicy : public demo::ReplayPolicy {
public:
    SimplePolicy(const demo::Trace& trace, const cost::DeviceKnowledge& known, const SimpleTuning& tuning)
        : tuning_(tuning), methods_(static_cast<uint32_t>(trace.methods.size())),
          times_(known, trace.methods, trace.lights, tuning), served_(trace.lights, kNone),
          before_(trace.lights, kNone), since_(trace.lights, 0), target_(trace.lights, kNone), allowed_(trace.lights),
          values_(size_t{trace.lights} * methods_), costsMs_(values_.size()), orders_(values_.size()), terms_(methods_)
    {
        greedy_.reserve(trace.lights, methods_);
        for (size_t cell = 0; cell < orders_.size(); ++cell)
            orders_[cell] = static_cast<uint8_t>(cell % methods_);
    }
    std::string name() const override { return "simple"; }

    void decide(const demo::Trace& trace, uint32_t frame, double budgetMs, std::span<uint32_t> chosen) override
    {
        for (uint32_t slot = 0; slot < trace.lights; ++slot)
            admit(trace, frame, slot);
        if (budgetMs < demo::kMostBudget)
            withinBudget(trace, frame, budgetMs);
        else
            for (uint32_t slot = 0; slot < trace.lights; ++slot)
                take(frame, slot, cheapestOfBest(slot));
        std::copy(served_.begin(), served_.end(), chosen.begin());
    }

    void observe(const demo::Trace& trace, uint32_t frame, std::span<const Timing> timings) override
    {
        for (const Timing& timing : timings) {
            const demo::TraceLight& light = trace.lightStates[trace.cell(frame, timing.slot)];
            const demo::TraceMethod& took = trace.measure(frame, timing.slot, timing.method);
            const cost::Workload workload = workloadOf(trace, light, timing.method);
            const auto tell = [&](cost::Pass pass, float gpuMs, float cpuMs) {
                times_.observe(timing.slot, timing.method, pass, workload,
                               (double{gpuMs} + double{cpuMs}) * timing.noise);
            };
            tell(cost::Pass::update, took.updateGpuMs, took.updateCpuMs);
            tell(cost::Pass::resolve, took.resolveGpuMs, took.resolveCpuMs);
        }
        times_.endFrame();
    }

private:
    size_t at(uint32_t slot, uint32_t method) const { return size_t{slot} * methods_ + method; }

    /// What the light may have, what each is worth and takes.
    void admit(const demo::Trace& trace, uint32_t frame, uint32_t slot)
    {
        const demo::TraceLight& light = trace.lightStates[trace.cell(frame, slot)];
        allowed_[slot] = {};
        if (light.fresh || !light.present) {
            served_[slot] = kNone;
            times_.forget(slot);
        }
        if (!light.present) return;
        allowed_[slot] = eligibleMethods(trace, frame, slot);
        for (uint32_t m = 0; m < methods_; ++m) {
            const demo::TraceMethod& measured = trace.measure(frame, slot, m);
            terms_[m] = {measured.suitability, measured.quality, measured.suitability >= demo::kTraceNoOpinion};
            costsMs_[at(slot, m)] = allowed_[slot].has(m) ? times_.ms(slot, m, workloadOf(trace, light, m)) : 0.0;
        }
        const std::span values = std::span(values_).subspan(at(slot, 0), methods_);
        plan::sharedUtilities(terms_, std::span(orders_).subspan(at(slot, 0), methods_), values);
        for (double& value : values)
            value *= light.importance;
        if (served_[slot] != kNone && !allowed_[slot].has(served_[slot])) served_[slot] = kNone;
    }

    double worth(uint64_t frame, uint32_t slot, uint32_t method) const
    {
        if (isFlip(frame, slot, method)) return 0.0;
        return (method == served_[slot] ? 1.0 + tuning_.gain : 1.0) * values_[at(slot, method)];
    }
    bool isFlip(uint64_t frame, uint32_t slot, uint32_t method) const
    {
        return served_[slot] != kNone && method == before_[slot] && frame - since_[slot] <= kFlipFrames;
    }
    struct Sums {
        double worth = 0.0, ms = 0.0;
    };
    Sums sumOf(uint64_t frame, std::span<const uint32_t> plan) const
    {
        Sums sums;
        for (uint32_t slot = 0; slot < plan.size(); ++slot)
            if (plan[slot] != kNone) {
                sums.worth += worth(frame, slot, plan[slot]);
                sums.ms += costsMs_[at(slot, plan[slot])];
            }
        return sums;
    }

    void withinBudget(const demo::Trace& trace, uint32_t frame, double budgetMs)
    {
        const bool fresh = trace.cuts[frame] != 0;
        if (fresh) std::fill(served_.begin(), served_.end(), kNone);
        greedy_.begin(methods_, {});
        for (uint32_t slot = 0; slot < served_.size(); ++slot) {
            greedy_.addLight();
            for (const uint32_t m : allowed_[slot]) {
                const double ms = costsMs_[at(slot, m)];
                const bool changes = served_[slot] != kNone && m != served_[slot];
                greedy_.add({.ms = ms,
                             .price = changes ? (1.0 + tuning_.margin) * ms : ms,
                             .worth = worth(frame, slot, m),
                             .method = static_cast<uint16_t>(m),
                             .banned = isFlip(frame, slot, m)});
            }
        }
        greedy_.cheapestMs();
        greedy_.solve((1.0 - tuning_.headroom) * budgetMs, 0, 0, 0, target_);
        const Sums now = sumOf(frame, served_), target = sumOf(frame, target_);
        const bool broken = now.ms > (1.0 - tuning_.kept * tuning_.headroom) * budgetMs;
        for (uint32_t slot = 0; slot < served_.size(); ++slot)
            if (served_[slot] == kNone || broken || target.worth > now.worth) take(frame, slot, target_[slot]);
    }

    uint32_t cheapestOfBest(uint32_t slot) const
    {
        double most = 0.0;
        for (const uint32_t m : allowed_[slot])
            most = std::max(most, values_[at(slot, m)]);
        const auto isAsGood = [&](uint32_t m) { return values_[at(slot, m)] >= kAsMuch * most; };
        uint32_t best = kNone;
        for (const uint32_t m : allowed_[slot])
            if (isAsGood(m) && (best == kNone || costsMs_[at(slot, m)] < costsMs_[at(slot, best)])) best = m;
        const uint32_t own = served_[slot];
        const bool stays =
            own != kNone && isAsGood(own) && costsMs_[at(slot, best)] > kClearlyLess * costsMs_[at(slot, own)];
        return stays ? own : best;
    }

    void take(uint64_t frame, uint32_t slot, uint32_t method)
    {
        if (method == served_[slot]) return;
        before_[slot] = served_[slot];
        since_[slot] = frame;
        served_[slot] = method;
    }

    SimpleTuning tuning_;
    uint32_t methods_;
    SimpleTimes times_;
    plan::Greedy greedy_;
    std::vector<uint32_t> served_, before_;
    std::vector<uint64_t> since_; ///< Frame.
    std::vector<uint32_t> target_;
    std::vector<MethodSet> allowed_;
    std::vector<double> values_, costsMs_; ///< lights x methods
    std::vector<uint8_t> orders_;          ///< Of sharedUtilities().
    std::vector<plan::UtilityTerms> terms_;
};

} // namespace

std::unique_ptr<demo::ReplayPolicy> simplePolicy(const demo::Trace& trace, const cost::DeviceKnowledge& known,
                                                 const SimpleTuning& tuning)
{
    return std::make_unique<SimplePolicy>(trace, known, tuning);
}

} // namespace gnomon::test
