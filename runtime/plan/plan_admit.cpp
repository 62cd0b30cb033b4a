// Which methods a light may have at all: step 1 of README.md.
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>

#include "runtime/plan/plan.hpp"
#include "runtime/plan/utility.hpp"

namespace gnomon::plan {

namespace {

float qualityOf(const Candidate& candidate) noexcept
{
    return std::isfinite(candidate.quality) ? std::clamp(candidate.quality, 0.0f, 1.0f) : 0.0f;
}

} // namespace

/// Capability, pin, never, opinion: which methods a light may have before quality is looked at.
void PlanStep::admitLight(const PlanInput& input, uint32_t light) noexcept
{
    const LightRequest& request = input.lights[light];
    uint32_t able = 0, unvetoed = 0, spoken = 0;
    std::array<UtilityTerms, kMaxMethods> terms;
    for (uint32_t m = 0; m < methods_; ++m) {
        const Candidate& candidate = input.candidates[at(light, m)];
        const uint32_t bit = 1u << m;
        terms[m] = {candidate.suitability, qualityOf(candidate), candidate.eligibility == Eligibility::eligible};
        const bool known = std::isfinite(candidate.ms) && candidate.ms >= 0.0;
        costsMs_[at(light, m)] = known ? candidate.ms : 0.0;
        if (candidate.eligibility != Eligibility::trait && known) able |= bit;
        if (candidate.eligibility != Eligibility::never) unvetoed |= bit;
        if (candidate.suitability >= 0) spoken |= bit;
    }
    const std::span all = std::span<const UtilityTerms>(terms).first(methods_);
    for (uint32_t m = 0; m < methods_; ++m)
        values_[at(light, m)] = request.importance * utility(sharedTerms(all, m));
    const uint32_t pin = request.pinned < methods_ ? able & (1u << request.pinned) : 0;
    uint32_t allowed = able & unvetoed;
    if (allowed & spoken) allowed &= spoken; // where nobody has an opinion, all are equally unloved
    if (pin) allowed = pin;
    for (uint32_t m = 0; m < methods_; ++m) {
        const uint32_t bit = 1u << m;
        why_[at(light, m)] = !(able & bit)         ? Why::trait
                             : pin && !(pin & bit) ? Why::pinned
                             : pin                 ? Why::outscored
                             : !(unvetoed & bit)   ? Why::never
                             : !(allowed & bit)    ? Why::noOpinion
                                                   : Why::outscored;
    }
    allowed_[light] = allowed;
    if (pin) return;
    LightMemory& memory = *request.memory;
    if (input.cut) memory.nearUntil = 0;
    if (request.floor) {
        memory.nearUntil = input.frame + input.inForce().hysteresis.flipWindowFrames;
        memory.nearQuality = request.minimumQuality;
    }
    // A condition that hovers about its threshold would change the method with every crossing.
    if (request.floor || input.frame < memory.nearUntil) applyFloor(input, light, memory.nearQuality);
}

/// Lights that are near, or were a moment ago, get nothing below the floor. Where nothing reaches it, the best there
/// is, and the plan says so.
void PlanStep::applyFloor(const PlanInput& input, uint32_t light, float minimum) noexcept
{
    plans_[light].floor = true;
    float best = 0.0f;
    for (uint32_t mask = allowed_[light]; mask; mask &= mask - 1)
        best = std::max(best, qualityOf(input.candidates[at(light, std::countr_zero(mask))]));
    plans_[light].floorUnmet = allowed_[light] != 0 && best < minimum;
    const float limit = std::min(minimum, best);
    for (uint32_t mask = allowed_[light]; mask; mask &= mask - 1) {
        const auto m = static_cast<uint32_t>(std::countr_zero(mask));
        if (qualityOf(input.candidates[at(light, m)]) >= limit) continue;
        allowed_[light] &= ~(1u << m);
        why_[at(light, m)] = Why::floor;
    }
}

void PlanStep::admit(const PlanInput& input) noexcept
{
    lightCount_ = static_cast<uint32_t>(input.lights.size());
    methods_ = input.methods;
    assert(methods_ <= kMaxMethods && lightCount_ <= plans_.size());
    for (uint32_t light = 0; light < lightCount_; ++light) {
        plans_[light] = {.incumbent = input.lights[light].memory->incumbent};
        admitLight(input, light);
    }
    problem_ = {lightCount_, methods_, values_, costsMs_, allowed_, input.parts, 0.0};
}

} // namespace gnomon::plan
