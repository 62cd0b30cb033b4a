// What is left of a plan: what lights remember, and why a method is not a light's.
#include "runtime/plan/plan.hpp"

namespace gnomon::plan {

/// Writes the decision into the lights' memories; finds flips.
void PlanStep::remember(const PlanInput& input, PlanReport& report) noexcept
{
    const rules::Policy::Hysteresis& hysteresis = input.inForce().hysteresis;
    for (uint32_t light = 0; light < lightCount_; ++light) {
        LightMemory& memory = *input.lights[light].memory;
        LightPlan& plan = plans_[light];
        plan.chosen = current_[light];
        plan.wanted = target_[light];
        if (plan.chosen != kNone) {
            plan.benefit = values_[at(light, plan.chosen)];
            plan.ms = costsMs_[at(light, plan.chosen)];
            report.value += plan.benefit;
        }
        report.floorsUnmet += plan.floorUnmet;
        if (input.cut) memory.previous = kNone;
        if (plan.chosen == memory.incumbent || plan.chosen == kNone) continue;
        plan.switched = memory.incumbent != kNone;
        plan.flipped = plan.switched && plan.chosen == memory.previous &&
                       input.frame - memory.switchedAt <= hysteresis.flipWindowFrames;
        report.switches += plan.switched;
        report.flips += plan.flipped;
        memory.previous = input.cut || plan.onTrial ? kNone : memory.incumbent;
        memory.incumbent = plan.chosen;
        memory.onTrial = plan.onTrial;
        memory.switchedAt = input.frame;
        memory.bannedUntil = input.frame + 1 + (plan.flipped ? hysteresis.flipBanFrames : hysteresis.flipWindowFrames);
    }
}

/// Methods that would be worth more: is it time or hysteresis that stands in the way?
void PlanStep::explainLight(const PlanInput& input, uint32_t light, const PlanReport& report) noexcept
{
    LightPlan& plan = plans_[light];
    if (plan.chosen == kNone) return;
    const std::span candidates = methodsOf(candidates_, light);
    const std::span values = methodsOf(values_, light), costsMs = methodsOf(costsMs_, light);
    const std::span why = methodsOf(why_, light);
    const int32_t suitability = candidates[plan.chosen].suitability;
    uint32_t held = kNone;
    for (const uint32_t m : allowed_[light]) {
        if (values[m] <= plan.benefit) { // outscored, as admitted
            if (costsMs[m] > plan.ms && candidates[m].suitability > suitability) why[m] = Why::price;
        } else if (m != plan.wanted && report.predictedMs + moveMs(light, m) > report.usableMs) {
            why[m] = Why::budget;
        } else {
            why[m] = Why::hysteresis;
            if (held == kNone || values[m] > values[held]) held = m;
        }
    }
    why[plan.chosen] = Why::chosen;
    if (held == kNone || plan.onTrial)
        plan.hold = Hold::none;
    else if (plan.hold == Hold::none || values_[at(light, plan.wanted)] <= plan.benefit) {
        const LightMemory& memory = *input.lights[light].memory;
        const double marginMs = changedMs(light, held) - costsMs_[at(light, held)];
        const bool banned = held == memory.previous && input.frame < memory.bannedUntil;
        const bool fits = report.predictedMs + moveMs(light, held) + marginMs <= report.usableMs;
        plan.hold = banned ? Hold::ban : waitsWith(light, held) ? Hold::trial : fits ? Hold::threshold : Hold::margin;
        plan.wanted = held;
    }
}

} // namespace gnomon::plan
