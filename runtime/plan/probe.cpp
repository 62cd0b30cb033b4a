#include "runtime/plan/probe.hpp"

#include <algorithm>
#include <cmath>

namespace gnomon::plan {

Guess::Guess(const Candidate& candidate) noexcept
    : ms(candidate.likelyMs > 0.0 ? std::min(candidate.likelyMs, candidate.ms) : candidate.ms),
      sigmaMs(std::max(candidate.ms - ms, candidate.sigmaMs))
{
}

double Guess::sigmasToWin(double ownMs) const noexcept
{
    if (!std::isfinite(ms) || !(sigmaMs > kSure * ms)) return -1.0;
    return std::max(0.0, (ms - ownMs) / sigmaMs);
}

Probe chooseProbe(const PlanInput& input, const PlanStep& plan, const PlanReport& report,
                  const ProbeLimits& limits) noexcept
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
            const Guess guess(candidate);
            const double needed = guess.sigmasToWin(own.ms);
            if (needed < 0.0 || needed > limits.sigmas) continue;
            const double upperMs = std::max(candidate.ms, guess.ms + limits.sigmas * guess.sigmaMs);
            const double wasteMs =
                limits.frames * std::max(upperMs + plan.unpaidMs(m) - own.ms, 0.0) + candidate.firstFrameMs;
            if (upperMs + plan.unpaidMs(m) > spareMs || candidate.firstFrameMs > spareMs ||
                wasteMs > kMostWaste * limits.lastSecondMs)
                continue;
            if (best.light != kNone && importance == least && needed >= nearest) continue;
            best = {light, m};
            least = importance, nearest = needed;
        }
    }
    return best;
}

} // namespace gnomon::plan
