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

} // namespace

/// Capability, pin, never, opinion: which methods a light may have before quality is looked at.
void PlanStep::admitLight(const PlanInput& input, uint32_t light) noexcept
{
    const LightRequest& request = input.lights[light];
    const std::span candidates = input.candidates.subspan(at(light, 0), methods_);
    const uint32_t incumbent = request.memory->incumbent;
    const bool holds = incumbent < methods_ && !isFresh(input);
    MethodSet able, vetoed, spoken, familiar;
    for (uint32_t m = 0; m < methods_; ++m) {
        const Candidate& candidate = candidates[m];
        const bool known = candidate.ms >= 0.0 && candidate.ms <= std::numeric_limits<double>::max();
        terms_[m] = {candidate.suitability, qualityOf(candidate), candidate.eligibility == Eligibility::eligible};
        // Where nothing holds, nothing spreads first frames over many: this one pays them.
        const double firstMs = holds || m == incumbent ? 0.0 : candidate.firstFrameMs;
        costsMs_[at(light, m)] = known ? candidate.ms + firstMs : 0.0;
        able.addIf(m, known && candidate.eligibility != Eligibility::trait);
        vetoed.addIf(m, candidate.eligibility == Eligibility::never);
        spoken.addIf(m, candidate.suitability >= 0);
        familiar.addIf(m, candidate.familiar);
    }
    familiar_[light] = familiar;
    const std::span all = std::span<const UtilityTerms>(terms_).first(methods_);
    const std::span values = std::span(values_).subspan(at(light, 0), methods_);
    sharedUtilities(all, std::span(orders_).subspan(at(light, 0), methods_), values);
    for (double& value : values)
        value *= request.importance;

    const bool pinned = request.pinned < methods_ && able.has(request.pinned);
    MethodSet allowed = able - vetoed;
    if (allowed.meets(spoken)) allowed &= spoken; // where nobody has an opinion, all are equally unloved
    if (pinned) allowed = MethodSet{request.pinned};
    for (uint32_t m = 0; m < methods_; ++m)
        why_[at(light, m)] = allowed.has(m)  ? Why::outscored
                             : !able.has(m)  ? Why::trait
                             : pinned        ? Why::pinned
                             : vetoed.has(m) ? Why::never
                                             : Why::noOpinion;
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
    const auto quality = [&](uint32_t m) { return qualityOf(input.candidates[at(light, m)]); };
    const MethodSet within = withinFloor(allowed_[light], minimum, quality);
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
/// until its time is known; else, in turns, the one that gains most, and any. What comes anew does not try anything.
/// @return whether one waits that would change
bool PlanStep::gateTrials(const PlanInput& input) noexcept
{
    const auto isServed = [&](uint32_t light) {
        return current_[light] != kNone || allowed_[light].meets(familiar_[light]);
    };
    const auto enters = [&](uint32_t light) {
        const uint32_t to = target_[light];
        return to != kNone && to != current_[light] && !familiar_[light].has(to) && isServed(light);
    };
    uint32_t entering = 0, settled = 0, running = kNone, best = kNone;
    double most = -1.0;
    for (uint32_t light = 0; light < lightCount_; ++light) {
        const uint32_t own = current_[light];
        const bool isNew = own != kNone && !familiar_[light].has(own) &&
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
    return plans_[light].waits && method != current_[light] && !familiar_[light].has(method);
}

/// Whether nothing is worth as much for clearly less, first frame included. Of the parts that it shares with others the
/// light pays as much as they: so they may leave them together, where alone none saves them.
bool PlanStep::isWorthKeeping(const PlanInput& input, uint32_t light) const noexcept
{
    const uint32_t own = current_[light];
    double ownMs = costsMs_[at(light, own)];
    for (uint32_t rest = greedy_.partsOf(own); rest; rest &= rest - 1) {
        const auto part = static_cast<size_t>(std::countr_zero(rest));
        ownMs += parts_[part].ms / users_[part];
    }
    for (const uint32_t m : allowed_[light]) {
        const Candidate& candidate = input.candidates[at(light, m)];
        if (m != own && !waitsWith(light, m) && values_[at(light, m)] >= values_[at(light, own)] &&
            changePriceMs(candidate.ms + sharedMs(light, m), candidate.firstFrameMs) < ownMs / (1.0 + kClearlyLess) &&
            isPriceKnown(candidate.ms, candidate.sigmaMs))
            return false;
    }
    return true;
}

/// What there must be room for where another method is to serve: Option::price.
double PlanStep::changedMs(const PlanInput& input, uint32_t light, uint32_t method) const noexcept
{
    const size_t cell = at(light, method);
    const Candidate& candidate = input.candidates[cell];
    return roomForChangeMs(costsMs_[cell], candidate.likelyMs, candidate.firstFrameMs);
}

/// Whether `method` can never be better than `own`, which has been offered: neither cheaper nor worth more.
bool PlanStep::isBeaten(uint32_t light, uint32_t method, uint32_t own) const noexcept
{
    return costsMs_[at(light, method)] >= costsMs_[at(light, own)] &&
           values_[at(light, method)] <= worths_[at(light, own)] && !(greedy_.partsOf(own) & ~greedy_.partsOf(method));
}

/// What the search may give a light. Hysteresis is here: the incumbent counts for more by the plan gain, another method
/// brings its first frame, and what the light has just left, or must not try yet, counts for nothing.
void PlanStep::offer(const PlanInput& input, uint32_t light) noexcept
{
    const bool settled = current_[light] != kNone && !isFresh(input);
    const LightMemory& memory = *input.lights[light].memory;
    const uint32_t banned = settled && input.frame < memory.bannedUntil ? memory.previous : kNone;
    const bool keeps = settled && isWorthKeeping(input, light);
    const rules::Policy::Hysteresis& hysteresis = input.inForce().hysteresis;
    // The longer the incumbent has served, the less it must be surpassed by: what a change gains grows with its stay.
    const double window = std::max(hysteresis.flipWindowFrames, 1u);
    const double served = static_cast<double>(input.frame - memory.switchedAt);
    const double threshold = keeps ? hysteresis.planGain * window / std::max(served, window) : 0.0;
    plans_[light].threshold = threshold;
    greedy_.addLight();
    const uint32_t own = settled ? current_[light] : kNone;
    const auto offerAt = [&](uint32_t m, double price, double worth, bool isBanned) {
        worths_[at(light, m)] = worth;
        greedy_.add({.ms = costsMs_[at(light, m)],
                     .price = price,
                     .worth = worth,
                     .method = static_cast<uint16_t>(m),
                     .banned = isBanned});
    };
    if (settled) offerAt(own, costsMs_[at(light, own)], (1.0 + threshold) * values_[at(light, own)], false);
    for (const uint32_t m : allowed_[light]) {
        const size_t cell = at(light, m);
        if (m == own || (settled && isBeaten(light, m, own))) continue;
        const bool isBanned = m == banned || waitsWith(light, m);
        offerAt(m, settled ? changedMs(input, light, m) : costsMs_[cell], isBanned ? 0.0 : values_[cell], isBanned);
    }
}

} // namespace gnomon::plan
