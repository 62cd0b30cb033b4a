// What is tried where no plan keeps the budget.
#include <algorithm>

#include "runtime/plan/probe.hpp"

namespace gnomon::plan {

/// A method that is wrongly thought too dear would never be timed where nothing keeps the budget: no plan takes it, and
/// probes ask for time to spare. So kMostWaste of what lights take meanwhile is saved up, and after kBrokenFrames one
/// of them at a time serves by what no light was timed with and may be cheaper: of what the savings pay for, what needs
/// the least luck. Not where the budget would be broken even if every light had all luck that `probing.sigma` grants.
void PlanStep::tryDear(const PlanInput& input, PlanReport& report) noexcept
{
    const rules::Policy::Probing& probing = input.inForce().probing;
    if (report.feasible || isFresh(input) || probing.everyFrames == 0) {
        savedMs_ = 0.0, brokenFrames_ = 0;
        return;
    }
    for (uint32_t light = 0; light < lightCount_; ++light) {
        const LightMemory& memory = *input.lights[light].memory;
        if (!memory.onTrial || input.frame - memory.switchedAt >= kTrialFrames) continue;
        if (memory.incumbent >= methods_ || !allowed_[light].has(memory.incumbent)) continue;
        plans_[light].onTrial = true;
        return move(light, memory.incumbent);
    }
    double luckyMs = sumOf(current_).ms, least = probing.sigma, mostMs = 0.0;
    savedMs_ += kMostWaste * luckyMs;
    brokenFrames_ = std::min(brokenFrames_ + 1, kBrokenFrames);
    if (brokenFrames_ < kBrokenFrames) return;
    uint32_t tries = kNone, tried = kNone;
    for (uint32_t light = 0; light < lightCount_; ++light) {
        const LightMemory& memory = *input.lights[light].memory;
        const uint32_t own = current_[light];
        if (own == kNone || own != memory.incumbent || !isFamiliar(light, own)) continue;
        const double ownMs = costsMs_[at(light, own)];
        double luckMs = 0.0;
        for (const uint32_t m : allowed_[light]) {
            const Candidate& candidate = input.candidates[at(light, m)];
            if (candidate.familiar) continue;
            const Guess guess(candidate);
            luckMs = std::max(luckMs, ownMs - std::max(guess.ms - probing.sigma * guess.sigmaMs, 0.0));
            const double needed = guess.sigmasToWin(ownMs);
            const double overMs = candidate.ms + unpaidMs(m) - ownMs;
            const double wasteMs = kTrialFrames * std::max(overMs, 0.0) + candidate.firstFrameMs;
            const bool isBanned = m == memory.previous && input.frame < memory.bannedUntil;
            if (isBanned || needed < 0.0 || needed >= least || wasteMs > savedMs_) continue;
            tries = light, tried = m, least = needed, mostMs = wasteMs;
        }
        luckyMs -= luckMs;
    }
    if (tries == kNone || luckyMs > input.budgetMs) return;
    savedMs_ -= mostMs;
    plans_[tries].onTrial = true;
    move(tries, tried);
    report.cause = Cause::repaired;
}

} // namespace gnomon::plan
