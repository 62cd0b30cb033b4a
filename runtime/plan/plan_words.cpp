// What the plan says of itself: why a method is not a light's, and the words of logs and explanations.
#include "runtime/plan/plan.hpp"

namespace gnomon::plan {

/// Methods that would be worth more: is it time or hysteresis that stands in the way?
void PlanStep::explainLight(const PlanInput& input, uint32_t light, double usableMs, double planMs) noexcept
{
    LightPlan& plan = plans_[light];
    if (plan.chosen == kNone) return;
    const int32_t suitability = input.candidates[at(light, plan.chosen)].suitability;
    for (const uint32_t m : allowed_[light]) {
        Why& why = why_[at(light, m)];
        if (m == plan.chosen)
            why = Why::chosen;
        else if (input.allocation == rules::Options::Allocation::None)
            why = Why::outscored;
        else if (values_[at(light, m)] <= plan.benefit)
            why = input.candidates[at(light, m)].suitability > suitability && costsMs_[at(light, m)] > plan.ms
                      ? Why::price
                      : Why::outscored;
        else if (m == plan.wanted || planMs + moveMs(light, m) <= usableMs)
            why = Why::hysteresis;
        else
            why = Why::budget;
    }
    if (plan.wanted == plan.chosen) plan.hold = Hold::none;
}

const char* toText(Why why) noexcept
{
    static constexpr const char* kWords[] = {"chosen", "trait",  "pinned",     "never",     "no opinion",
                                             "floor",  "budget", "hysteresis", "outscored", "price"};
    return kWords[static_cast<size_t>(why)];
}

const char* toText(Hold hold) noexcept
{
    static constexpr const char* kWords[] = {"none", "threshold",   "quota", "spare time",
                                             "ban",  "first frame", "payers"};
    return kWords[static_cast<size_t>(hold)];
}

const char* toText(Cause cause) noexcept
{
    static constexpr const char* kWords[] = {"kept", "forced", "repaired", "gain", "fresh", "unbudgeted"};
    return kWords[static_cast<size_t>(cause)];
}

} // namespace gnomon::plan
