// Which methods a light may have, and what each counts: steps 1 and 2 of README.md.
#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "runtime/plan/plan.hpp"
#include "runtime/plan/utility.hpp"

namespace gnomon::plan {

namespace {

float qualityOf(const Candidate& candidate) noexcept
{
    return std::isfinite(candidate.quality) ? std::clamp(candidate.quality, 0.0f, 1.0f) : 0.0f;
}

bool isTimeKnown(const Candidate& candidate) noexcept
{
    return (candidate.ms >= 0.0) & (candidate.ms <= std::numeric_limits<double>::max());
}

} // namespace

/// Capability, pin, never, opinion: which methods a light may have before quality is looked at.
void PlanStep::admitLight(const PlanInput& input, uint32_t light) noexcept
{
    const LightRequest& request = input.lights[light];
    const std::span candidates = methodsOf(candidates_, light);
    const std::span costsMs = methodsOf(costsMs_, light);
    const std::span terms = std::span(terms_).first(methods_);
    for (size_t m = 0; m < candidates.size(); ++m) {
        const Candidate& candidate = candidates[m];
        terms[m] = {candidate.suitability, qualityOf(candidate), candidate.eligibility == Eligibility::eligible};
        costsMs[m] = candidate.ms;
    }
    // Where nothing holds, nothing spreads first frames over many: this one pays them.
    const uint32_t incumbent = request.memory->incumbent;
    for (size_t m = 0; (incumbent >= methods_ || isFresh(input)) && m < candidates.size(); ++m)
        if (m != incumbent) costsMs[m] += candidates[m].firstFrameMs;
    const std::span values = methodsOf(values_, light);
    sharedUtilities(terms, methodsOf(orders_, light), values);
    for (double& value : values)
        value *= request.importance;

    const auto isAble = [&](uint32_t m) {
        return isTimeKnown(candidates[m]) && candidates[m].eligibility != Eligibility::trait;
    };
    const bool pinned = request.pinned < methods_ && isAble(request.pinned);
    const auto eligible = [&](int32_t leastSuitability) {
        return MethodSet::where(methods_, [&](uint32_t m) {
            return isTimeKnown(candidates[m]) && candidates[m].eligibility == Eligibility::eligible &&
                   candidates[m].suitability >= leastSuitability;
        });
    };
    MethodSet allowed = eligible(0);
    // Where nobody has an opinion, all are equally unloved.
    if (allowed.empty()) allowed = eligible(std::numeric_limits<int32_t>::min());
    if (pinned) allowed = MethodSet{request.pinned};
    const std::span why = methodsOf(why_, light);
    std::fill(why.begin(), why.end(), Why::outscored);
    for (const uint32_t m : MethodSet::below(methods_) - allowed)
        why[m] = !isAble(m)                                        ? Why::trait
                 : pinned                                          ? Why::pinned
                 : candidates[m].eligibility == Eligibility::never ? Why::never
                                                                   : Why::noOpinion;
    allowed_[light] = allowed;
    if (pinned) return;
    LightMemory& memory = *request.memory;
    if (input.cut) memory.nearUntil = 0;
    if (request.floor) {
        memory.nearUntil = input.frame + input.inForce().hysteresis.flipWindowFrames;
        memory.nearQuality = request.minimumQuality;
    }
    if (request.floor || input.frame < memory.nearUntil) applyFloor(light, memory.nearQuality, request.floor);
}

/// Lights that are near get nothing below the floor. Where nothing reaches it, the best there is, and the plan says so.
/// Lights that were near a moment ago keep what reaches it: a condition that hovers about its threshold would change
/// the method with every crossing. What does not reach it is no reason for more.
void PlanStep::applyFloor(uint32_t light, float minimum, bool asked) noexcept
{
    const auto quality = [&](uint32_t m) { return qualityOf(candidates_[at(light, m)]); };
    const MethodSet within = withinFloor(allowed_[light], minimum, quality);
    const uint32_t incumbent = plans_[light].incumbent;
    if (!asked && (incumbent >= methods_ || !within.has(incumbent))) return;
    plans_[light].floor = true;
    plans_[light].floorUnmet = !within.empty() && quality(*within.begin()) < minimum;
    for (const uint32_t m : allowed_[light] - within)
        why_[at(light, m)] = Why::floor;
    allowed_[light] = within;
}

void PlanStep::admit(const PlanInput& input) noexcept
{
    lightCount_ = static_cast<uint32_t>(input.lights.size());
    methods_ = input.methods;
    if (orderedMethods_ != methods_) {
        for (size_t cell = 0; cell < orders_.size(); ++cell)
            orders_[cell] = static_cast<uint8_t>(cell % methods_);
        orderedMethods_ = methods_;
    }
    candidates_ = input.candidates;
    parts_ = input.parts;
    assert(methods_ <= kMaxMethods && lightCount_ <= plans_.size() && parts_.size() <= kMaxParts);
    greedy_.begin(methods_, parts_);
    for (uint32_t light = 0; light < lightCount_; ++light) {
        const uint32_t incumbent = input.lights[light].memory->incumbent;
        plans_[light] = {.incumbent = incumbent};
        admitLight(input, light);
        current_[light] = incumbent < methods_ && allowed_[light].has(incumbent) ? incumbent : kNone;
    }
    countUsers();
    offerAll(input);
}

void PlanStep::offerAll(const PlanInput& input) noexcept
{
    for (uint32_t light = 0; light < lightCount_; ++light)
        offer(input, light);
}

/// Where the target has lights change to what no light was timed with, all but one wait: the one that has just done so,
/// until its time is known; else, in turns, the one that gains most, and any. A new light does not try anything.
/// @return whether one waits that would change
bool PlanStep::gateTrials(const PlanInput& input) noexcept
{
    const auto isServed = [&](uint32_t light) {
        if (current_[light] != kNone) return true;
        for (const uint32_t m : allowed_[light])
            if (isFamiliar(light, m)) return true;
        return false;
    };
    const auto enters = [&](uint32_t light) {
        const uint32_t to = target_[light];
        return to != kNone && to != current_[light] && !isFamiliar(light, to) && isServed(light);
    };
    uint32_t entering = 0, settled = 0, running = kNone, best = kNone;
    double most = -1.0;
    for (uint32_t light = 0; light < lightCount_; ++light) {
        const uint32_t own = current_[light];
        const bool isNew = own != kNone && !isFamiliar(light, own) &&
                           input.frame - input.lights[light].memory->switchedAt < kTrialFrames;
        if (isNew && running == kNone) running = light;
        if (!enters(light)) continue;
        ++entering;
        if (own == kNone) continue;
        ++settled;
        const double gain = values_[at(light, target_[light])] - values_[at(light, own)];
        if (gain > most) most = gain, best = light;
    }
    uint32_t tries = running != kNone ? running : best;
    const bool takesTurns = running == kNone && settled > 1 && input.frame % 2 == 1;
    uint64_t turn = takesTurns ? input.frame / 2 % settled : 0;
    for (uint32_t light = 0; takesTurns && light < lightCount_; ++light)
        if (current_[light] != kNone && enters(light) && turn-- == 0) tries = light;
    if (entering == 0 || (entering == 1 && tries != kNone && enters(tries))) return false;
    for (uint32_t light = 0; light < lightCount_; ++light)
        plans_[light].waits = light != tries && isServed(light);
    return true;
}

/// Whether no light was timed with the method, and this light is not the one to try it.
bool PlanStep::waitsWith(uint32_t light, uint32_t method) const noexcept
{
    return plans_[light].waits && method != current_[light] && !isFamiliar(light, method);
}

/// Whether nothing is worth as much for clearly less, first frame included. Of the parts that it shares with others the
/// light pays as much as they: so they may leave them together, where alone none saves them.
bool PlanStep::isWorthKeeping(uint32_t light) const noexcept
{
    const uint32_t own = current_[light];
    double ownMs = costsMs_[at(light, own)];
    for (uint32_t rest = greedy_.partsOf(own); rest; rest &= rest - 1) {
        const auto part = static_cast<size_t>(std::countr_zero(rest));
        ownMs += parts_[part].ms / users_[part];
    }
    const std::span candidates = methodsOf(candidates_, light);
    const std::span values = methodsOf(values_, light);
    for (const uint32_t m : allowed_[light]) {
        if (!(values[m] >= values[own]) || m == own || waitsWith(light, m)) continue;
        const Candidate& candidate = candidates[m];
        if (changePriceMs(candidate.ms + sharedMs(light, m), candidate.firstFrameMs) < ownMs / (1.0 + kClearlyLess) &&
            isPriceKnown(candidate.ms, candidate.sigmaMs))
            return false;
    }
    return true;
}

/// What there must be room for where another method is to serve: Option::price.
double PlanStep::changedMs(uint32_t light, uint32_t method) const noexcept
{
    const Candidate& candidate = candidates_[at(light, method)];
    return roomForChangeMs(candidate.ms, candidate.likelyMs, candidate.firstFrameMs);
}

/// What the search may give a light. Hysteresis is here: the incumbent counts for more by the plan gain, another method
/// brings its first frame, and what the light has just left, or must not try yet, counts for nothing.
void PlanStep::offer(const PlanInput& input, uint32_t light) noexcept
{
    const bool settled = current_[light] != kNone && !isFresh(input);
    const LightMemory& memory = *input.lights[light].memory;
    const uint32_t banned = settled && input.frame < memory.bannedUntil ? memory.previous : kNone;
    const bool keeps = settled && isWorthKeeping(light);
    const rules::Policy::Hysteresis& hysteresis = input.inForce().hysteresis;
    // The longer the incumbent has served, the less it must be surpassed by: what a change gains grows with its stay.
    const double window = std::max(hysteresis.flipWindowFrames, 1u);
    const double served = static_cast<double>(input.frame - memory.switchedAt);
    const double threshold = keeps ? hysteresis.planGain * window / std::max(served, window) : 0.0;
    plans_[light].threshold = threshold;
    greedy_.addLight();
    const std::span costsMs = methodsOf(costsMs_, light), values = methodsOf(values_, light);
    const std::span worths = methodsOf(worths_, light);
    const auto offerAt = [&](uint32_t m, double price, double worth, bool isBanned) {
        worths[m] = worth;
        greedy_.add(
            {.ms = costsMs[m], .price = price, .worth = worth, .method = static_cast<uint16_t>(m), .banned = isBanned});
    };
    const uint32_t own = settled ? current_[light] : kNone;
    const double ownMs = settled ? costsMs[own] : 0.0, ownWorth = settled ? (1.0 + threshold) * values[own] : 0.0;
    const uint32_t ownParts = settled ? greedy_.partsOf(own) : 0;
    // Neither cheaper than what serves nor worth more.
    const auto isBeaten = [&](uint32_t m) {
        return costsMs[m] >= ownMs && values[m] <= ownWorth && !(ownParts & ~greedy_.partsOf(m));
    };
    if (settled) offerAt(own, ownMs, ownWorth, false);
    for (const uint32_t m : allowed_[light]) {
        if ((settled && isBeaten(m)) || m == own) continue;
        const bool isBanned = m == banned || waitsWith(light, m);
        offerAt(m, settled ? changedMs(light, m) : costsMs[m], isBanned ? 0.0 : values[m], isBanned);
    }
}

} // namespace gnomon::plan
