#include "runtime/plan/probe.hpp"

#include <algorithm>
#include <cmath>

namespace gnomon::plan {
namespace {

/// How many standard errors below its prediction a method must take to be cheaper than `ownMs`; < 0: its time is known.
double sigmasToWin(const Candidate& candidate, double ownMs) noexcept
{
    if (!std::isfinite(candidate.ms) || !(candidate.sigmaMs > kSure * candidate.ms)) return -1.0;
    return std::max(0.0, (candidate.ms - ownMs) / candidate.sigmaMs);
}

} // namespace

Probe chooseProbe(const PlanInput& input, const PlanStep& plan, const PlanReport& report, double sigmas) noexcept
{
    const double spareMs = report.usableMs - std::max(report.predictedMs, input.measuredMs - input.sharedMs);
    Probe best;
    double least = 0.0, nearest = 0.0;
    for (uint32_t light = 0; light < input.lights.size(); ++light) {
        const LightPlan& own = plan.lights()[light];
        const double importance = input.lights[light].importance;
        const bool settled = own.chosen != kNone && own.chosen == own.incumbent;
        if (!settled || input.lights[light].pinned != kNone || (best.light != kNone && importance > least)) continue;
        for (uint32_t m = 0; m < input.methods; ++m) {
            const Candidate& candidate = input.candidates[size_t{light} * input.methods + m];
            if (m == own.chosen || !plan.mayServe(light, m) || plan.benefitOf(light, m) < own.benefit) continue;
            const double needed = sigmasToWin(candidate, own.ms);
            if (needed < 0.0 || needed > sigmas) continue;
            const double extraMs = plan.unpaidMs(m);
            if (candidate.ms + sigmas * candidate.sigmaMs + extraMs > spareMs || candidate.firstFrameMs > spareMs)
                continue;
            if (best.light != kNone && importance == least && needed >= nearest) continue;
            best = {light, m};
            least = importance, nearest = needed;
        }
    }
    return best;
}

} // namespace gnomon::plan
