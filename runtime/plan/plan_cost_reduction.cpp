// Less time for the same picture: step 3 of README.md.
#include <algorithm>

#include "runtime/plan/plan.hpp"
#include "runtime/plan/utility.hpp"

namespace gnomon::plan {

/// Whether the best plan shows each light as well, for clearly less in all. Lights that share a part leave it together
/// or not at all: alone none of them saves it.
bool PlanStep::cheaperTogether(const PlanInput& input, const PlanReport& report) const noexcept
{
    if (problem_.parts.empty()) return false;
    double priceMs = report.bestMs;
    for (uint32_t light = 0; light < lightCount_; ++light) {
        const uint32_t from = current_[light], to = best_[light];
        if (from == to || from == kNone || to == kNone) continue;
        const Candidate& candidate = input.candidates[at(light, to)];
        if (values_[at(light, to)] < values_[at(light, from)] || !isPriceKnown(candidate.ms, candidate.sigmaMs) ||
            isHeld(input, light, to))
            return false;
        priceMs = changePriceMs(priceMs, candidate.firstFrameMs);
    }
    return priceMs < sums_.costMs / (1.0 + 2.0 * kNoDearer);
}

/// What shows as much for clearly less: a plan within its budget saves time too where that takes nothing from the
/// picture. A few lights at a time, but what they share at once, and none before its first frame would be earned back.
void PlanStep::economise(const PlanInput& input, PlanReport& report) noexcept
{
    if (cheaperTogether(input, report)) {
        std::copy_n(best_.begin(), lightCount_, current_.begin());
        countUsers();
        report.cause = Cause::gain;
        return;
    }
    const rules::Policy::Hysteresis& hysteresis = input.inForce().hysteresis;
    for (uint32_t light = 0; light < lightCount_ && report.upgrades < hysteresis.upgradesPerFrame; ++light) {
        const uint32_t from = current_[light];
        if (from == kNone || input.lights[light].pinned != kNone) continue;
        const uint32_t to = cheaperMethod(input, light, from);
        if (to == kNone) continue;
        move(light, to);
        ++report.upgrades;
        report.cause = Cause::gain;
    }
}

/// The cheapest method that is worth what `from` is and takes clearly less, its first frame spread over the stay, and
/// what of shared parts the light alone would be the reason for, counted with either.
uint32_t PlanStep::cheaperMethod(const PlanInput& input, uint32_t light, uint32_t from) const noexcept
{
    const auto msOf = [&](uint32_t m) { return costsMs_[at(light, m)] + sharedMs(light, m); };
    double enough = msOf(from) / (1.0 + 2.0 * kNoDearer);
    uint32_t best = kNone;
    for (const uint32_t m : allowed_[light]) {
        const Candidate& candidate = input.candidates[at(light, m)];
        const double priceMs = changePriceMs(msOf(m), candidate.firstFrameMs);
        if (m == from || !(priceMs < enough) || values_[at(light, m)] < values_[at(light, from)]) continue;
        if (!isPriceKnown(candidate.ms, candidate.sigmaMs)) continue;
        if (isHeld(input, light, m)) continue;
        best = m, enough = priceMs;
    }
    return best;
}

/// Every plan breaks the budget, and `best` is the cheapest: of what is no dearer, each light takes what is worth most,
/// and stays with what it has where that is worth as much.
void PlanStep::reduceCost(const PlanInput& input, std::span<uint32_t> best) noexcept
{
    std::ranges::fill(otherUsers_, 0);
    for (const uint32_t method : best)
        if (method != kNone) ++otherUsers_[method];
    for (uint32_t light = 0; light < lightCount_; ++light) {
        if (best[light] == kNone) continue;
        --otherUsers_[best[light]];
        MethodSet others;
        for (uint32_t m = 0; m < methods_; ++m)
            if (otherUsers_[m] > 0) others.add(m);
        const auto msOf = [&](uint32_t m) { return costsMs_[at(light, m)] + addedMs(others, m); };
        const double cheapestMs = msOf(best[light]);
        uint32_t most = best[light];
        for (const uint32_t m : allowed_[light]) {
            if (msOf(m) <= (1.0 + kNoDearer) * cheapestMs && values_[at(light, m)] > values_[at(light, most)]) most = m;
        }
        const uint32_t incumbent = input.lights[light].memory->incumbent;
        const bool stays =
            incumbent < methods_ && allowed_[light].has(incumbent) &&
            msOf(incumbent) <= (1.0 + 2.0 * kNoDearer) * cheapestMs &&
            values_[at(light, incumbent)] >= (1.0 - input.inForce().hysteresis.planGain) * values_[at(light, most)];
        best[light] = stays ? incumbent : most;
        ++otherUsers_[best[light]];
    }
}

} // namespace gnomon::plan
