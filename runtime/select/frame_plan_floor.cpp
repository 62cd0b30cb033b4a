#include <algorithm>
#include <cmath>

#include "runtime/cost/exponent.hpp"
#include "runtime/select/frame_plan.hpp"

// What near quality asks of each light.
namespace gnomon {

namespace {

// What is seen is wrong pixels, not wrong lights, so the floor is of all near lights together. A light that reaches
// less than this share of what they reach on average may be wrong on as many pixels as a light of this share: all of
// them together add at most this share to what the floor allows, times kTooMuch meanwhile.
constexpr double kFewPixels = 0.25;
// With maps of a side s a light is wrong on w / s of its pixels, and they take a + b s^2. What all take is least for so
// many wrong pixels in all where s goes by w^(1/3), so what is allowed goes by w^(2/3).
constexpr double kAllowedPower = 2.0 / 3.0;
// The wrong pixels of a scene's lights together are up to so many times what is expected of them (1.5 in forest_walk,
// the most of 14 scenes: demo/theses/measurements/2026-11-cost.md#outlines).
constexpr double kScenesDiffer = 1.5;
// Lights of hardly any outline are held to this share of what the floor allows at least; w counts in these bounds.
constexpr double kLeastAllowed = 1.0 / 8.0, kLeastHard = 1.0 / 64.0, kMostHard = 64.0;
// What is allowed follows the pixels once it is this much too much, or this much more would do. A light in a doorway
// does not change its method with every step.
constexpr double kTooMuch = 1.25, kMoreWouldDo = 1.5;

/// What a light may be wrong in, over what others may.
double allowanceOf(const FramePlan::Coarseness& light)
{
    const double hard = std::clamp(light.texels * light.outlines, kLeastHard, kMostHard);
    return cost::exp2Exactly(kAllowedPower * cost::log2Exactly(hard));
}

float lessWanted(double minimumQuality, double times)
{
    return static_cast<float>(1.0 / (1.0 + times * (1.0 / minimumQuality - 1.0)));
}

} // namespace

/// Of the plan step, and of choices by price: who is near, and how right each light has to be then.
void FramePlan::requestLights(const rules::RuleBase* base, const Budget& budget)
{
    lights_.resize(requests_.size());
    const rules::Policy::Floor* const floor = base && !base->policy.floor.when.empty() ? &base->policy.floor : nullptr;
    const double most = floor ? floor->oneLightTimes : 1.0;
    double pixels = 0.0, near = 0.0, allowed = 0.0;
    for (std::size_t i = 0; i < requests_.size(); ++i) {
        Request& request = requests_[i];
        request.coarseness = coarsenessOf(*request.memory, request.height);
        if (most > 1.0) request.allowance = allowanceOf(request.coarseness);
        lights_[i] = {.memory = &request.memory->plan, .importance = request.importance, .pinned = request.pinned};
        lights_[i].floor = floor && request.decision->floorTruth >= floor->atStrength;
        if (!lights_[i].floor) continue;
        pixels += request.memory->workload.pixels;
        allowed += request.memory->workload.pixels * request.allowance;
        near += 1.0;
    }
    if (!floor) return;
    const double few = kFewPixels * pixels / std::max(near, 1.0);
    for (std::size_t i = 0; i < requests_.size(); ++i) {
        LightMemory& memory = *requests_[i].memory;
        const double reached = std::max(memory.workload.pixels, 1.0);
        if (memory.measured && std::isinf(memory.distance)) memory.plan.nearUntil = 0; // no receiver of it is visible
        double times = 1.0;
        if (memory.measured && most > 1.0) {
            const double fair =
                allowed > 0.0 ? std::max(requests_[i].allowance * pixels / allowed, kLeastAllowed) : 1.0;
            times = std::min(fair * std::max(few / reached, 1.0), most) / kScenesDiffer;
        }
        const bool follows = times * kTooMuch < memory.floorTimes || times > memory.floorTimes * kMoreWouldDo;
        if (follows || budget.cut || times == 1.0) memory.floorTimes = times;
        lights_[i].minimumQuality = requests_[i].decision->minimumQuality =
            lessWanted(floor->minimumQuality, memory.floorTimes);
    }
}

/// Near shadows are exact whatever time says: where the near floor holds, what suits best is sought among what reaches
/// it. Who was near a moment ago keeps what reaches it: a condition that hovers about its threshold would change the
/// method with every crossing.
void FramePlan::holdFloor(Request& request, const plan::LightRequest& light, const rules::Policy& policy,
                          const Budget& budget)
{
    LightDecision& decision = *request.decision;
    plan::LightMemory& memory = request.memory->plan;
    request.suited = decision.method;
    if (budget.cut) memory.nearUntil = 0;
    if (light.floor) {
        memory.nearUntil = budget.frame + policy.hysteresis.flipWindowFrames;
        memory.nearQuality = light.minimumQuality;
    }
    if (!isByRules(decision.reason) || decision.method >= methods_.size()) return;
    const std::span all = std::span<const Candidate>(decision.candidates).first(methods_.size());
    const std::uint32_t own = request.memory->incumbent;
    const bool keeps = budget.frame < memory.nearUntil && own < methods_.size() &&
                       withinFloor(all, decision.method, memory.nearQuality).has(own);
    decision.floor = light.floor || keeps;
    if (!decision.floor) return;
    const bool reaches = all[decision.method].quality >= memory.nearQuality;
    if (!reaches) request.suited = light.floor ? suitedWithinFloor(all, decision.method, memory.nearQuality) : own;
    decision.floorUnmet = all[request.suited].quality < memory.nearQuality;
}

} // namespace gnomon
