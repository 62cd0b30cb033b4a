// Which methods a light may have at all: step 1 of README.md.
#include <algorithm>
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
    MethodSet able, unvetoed, spoken;
    for (uint32_t m = 0; m < methods_; ++m) {
        const Candidate& candidate = input.candidates[at(light, m)];
        terms_[m] = {candidate.suitability, qualityOf(candidate), candidate.eligibility == Eligibility::eligible};
        const bool known = std::isfinite(candidate.ms) && candidate.ms >= 0.0;
        costsMs_[at(light, m)] = known ? candidate.ms : 0.0;
        if (candidate.eligibility != Eligibility::trait && known) able.add(m);
        if (candidate.eligibility != Eligibility::never) unvetoed.add(m);
        if (candidate.suitability >= 0) spoken.add(m);
    }
    const std::span all = std::span<const UtilityTerms>(terms_).first(methods_);
    for (uint32_t m = 0; m < methods_; ++m)
        values_[at(light, m)] = request.importance * utility(sharedTerms(all, m));
    const bool pinned = request.pinned < methods_ && able.has(request.pinned);
    MethodSet allowed = able & unvetoed;
    if (allowed.meets(spoken)) allowed &= spoken; // where nobody has an opinion, all are equally unloved
    if (pinned) allowed = MethodSet{request.pinned};
    for (uint32_t m = 0; m < methods_; ++m) {
        why_[at(light, m)] = !able.has(m)                    ? Why::trait
                             : pinned && m != request.pinned ? Why::pinned
                             : pinned                        ? Why::outscored
                             : !unvetoed.has(m)              ? Why::never
                             : !allowed.has(m)               ? Why::noOpinion
                                                             : Why::outscored;
    }
    allowed_[light] = allowed;
    if (pinned) return;
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
    for (const uint32_t m : allowed_[light])
        best = std::max(best, qualityOf(input.candidates[at(light, m)]));
    plans_[light].floorUnmet = !allowed_[light].empty() && best < minimum;
    const float limit = std::min(minimum, best);
    for (const uint32_t m : allowed_[light]) {
        if (qualityOf(input.candidates[at(light, m)]) >= limit) continue;
        allowed_[light].remove(m);
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
