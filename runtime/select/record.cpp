#include "runtime/select/record.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "rules/engine/explain.hpp"

namespace gnomon {

namespace {

Replan replanOf(const LightDecision& decision, const FrameRecord& frame)
{
    if (decision.reason == GN_REASON_PINNED) return Replan::host;
    if (!frame.budgeted) return Replan::everyFrame;
    if (frame.measuring) return Replan::measuring;
    switch (frame.report.cause) {
    case plan::Cause::forced:
        return Replan::forced;
    case plan::Cause::repaired:
        return Replan::overBudget;
    case plan::Cause::gain:
        return Replan::gain;
    case plan::Cause::fresh:
        return frame.cut ? Replan::cut : Replan::first;
    case plan::Cause::kept:
        break;
    }
    return Replan::kept;
}

} // namespace

FiredRules strongestRules(const rules::Engine& engine, const rules::Inference& inference)
{
    FiredRules strongest{};
    const std::vector<double> counted = countedStrengths(engine, inference);
    for (std::uint32_t i = 0; i < inference.rules.size(); ++i) {
        const rules::RuleState& state = inference.rules[i];
        const auto strength = static_cast<float>(counted[i]);
        if (!(strength > strongest.back().strength)) continue;
        FiredRule entry{.rule = i,
                        .variable = state.limitingVariable,
                        .term = state.limitingTerm,
                        .strength = strength,
                        .membership = static_cast<float>(state.limitingMembership),
                        .weight = static_cast<float>(engine.compiled().rules[i].weight)};
        for (FiredRule& place : strongest)
            if (entry.strength > place.strength) std::swap(entry, place);
    }
    return strongest;
}

RecordHead makeRecord(const LightDecision& decision, const FrameRecord& frame, std::uint64_t measuredAt)
{
    RecordHead head;
    head.frame = frame.frame;
    head.ruleHash = frame.base ? frame.base->textHash : 0;
    head.knowledge = frame.knowledge;
    head.lightId = decision.lightId;
    head.method = decision.method;
    head.wanted = decision.wanted;
    head.incumbent = decision.incumbent;
    head.pinned = decision.pinned;
    head.methods = frame.methods;
    head.fallbacks = frame.fallbacks;
    head.distanceAge = decision.distanceMeasured ? static_cast<std::uint32_t>(frame.frame - measuredAt) : UINT32_MAX;
    head.reason = decision.reason;
    head.replan = replanOf(decision, frame);
    head.hold = decision.hold;
    head.budgeted = frame.budgeted;
    head.priced = frame.priced;
    head.guessed = decision.guessed;
    head.flatSource = decision.flatSource;
    head.asksHost = decision.asksHost;
    head.switched = decision.switched;
    head.floorUnmet = decision.floorUnmet;
    head.mapSide = static_cast<std::uint16_t>(decision.mapSide);
    head.wantedSide = static_cast<std::uint16_t>(decision.wantedSide);
    head.redrawEvery = static_cast<std::uint8_t>(decision.redrawEvery);
    head.mapAge = static_cast<std::uint8_t>(decision.mapAge);
    head.importance = decision.importance;
    head.suitability = decision.suitability;
    head.facts = decision.facts;
    if (frame.base && !frame.base->policy.floor.when.empty()) {
        head.floorTruth = static_cast<float>(decision.floorTruth);
        head.floorStrength = static_cast<float>(frame.base->policy.floor.atStrength);
        head.minimumQuality = decision.minimumQuality;
        head.floor = decision.floor;
    }
    if (frame.budgeted) {
        head.budgetMs = static_cast<float>(frame.budgetMs);
        head.usableMs = static_cast<float>(frame.report.usableMs);
        head.planMs = static_cast<float>(frame.report.predictedMs);
        head.leastMs = frame.report.feasible ? 0.0f : static_cast<float>(frame.report.cheapestMs);
        head.errorMs = static_cast<float>(frame.report.standardErrorMs);
        head.threshold = static_cast<float>(decision.threshold);
    }
    return head;
}

void RecordRing::grow(std::uint32_t lights, std::uint32_t methods)
{
    const std::uint32_t newLights = std::max(lights_, std::bit_ceil(lights));
    const std::uint32_t newMethods = std::max(methods_, methods);
    std::vector<RecordHead> heads(std::size_t{kFrames} * newLights);
    std::vector<Candidate> candidates(heads.size() * newMethods);
    for (std::size_t slot = 0; slot < kFrames; ++slot)
        for (std::uint32_t i = 0; i < slots_[slot].count; ++i) {
            const std::size_t from = slot * lights_ + i, to = slot * newLights + i;
            heads[to] = heads_[from];
            std::copy_n(candidates_.begin() + static_cast<std::ptrdiff_t>(from * methods_), methods_,
                        candidates.begin() + static_cast<std::ptrdiff_t>(to * newMethods));
        }
    heads_ = std::move(heads);
    candidates_ = std::move(candidates);
    lights_ = newLights;
    methods_ = newMethods;
}

void RecordRing::begin(std::uint64_t frame, std::uint32_t lights, std::uint32_t methods,
                       std::shared_ptr<const rules::Engine> rules)
{
    if (lights > lights_ || methods > methods_) grow(lights, methods);
    slots_[frame % kFrames] = {.frame = frame, .count = 0, .methods = methods, .rules = std::move(rules)};
    newest_ = frame;
}

void RecordRing::add(const RecordHead& head, std::span<const Candidate> candidates)
{
    Slot& slot = slots_[head.frame % kFrames];
    if (slot.frame != head.frame || slot.count >= lights_ || candidates.size() > methods_) return;
    const std::size_t place = cell(head.frame, slot.count++);
    heads_[place] = head;
    std::copy(candidates.begin(), candidates.end(),
              candidates_.begin() + static_cast<std::ptrdiff_t>(place * methods_));
}

void RecordRing::noteMeasured(std::uint64_t frame, std::uint32_t lightId, std::uint32_t method, float ms)
{
    for (std::uint32_t i = 0; i < lights(frame); ++i) {
        RecordHead& head = heads_[cell(frame, i)];
        if (head.lightId == lightId && head.method == method) head.measuredMs = ms;
    }
}

std::uint64_t RecordRing::oldest() const
{
    std::uint64_t oldest = newest_;
    for (const Slot& slot : slots_)
        if (slot.frame != 0 && slot.frame <= newest_ && newest_ - slot.frame < kFrames)
            oldest = std::min(oldest, slot.frame);
    return oldest;
}

bool RecordRing::has(std::uint64_t frame) const
{
    return frame != 0 && frame <= newest_ && slots_[frame % kFrames].frame == frame;
}

std::uint32_t RecordRing::lights(std::uint64_t frame) const
{
    return has(frame) ? slots_[frame % kFrames].count : 0;
}

std::uint32_t RecordRing::methods(std::uint64_t frame) const
{
    return has(frame) ? slots_[frame % kFrames].methods : 0;
}

std::shared_ptr<const rules::Engine> RecordRing::rules(std::uint64_t frame) const
{
    return has(frame) ? slots_[frame % kFrames].rules : nullptr;
}

DecisionRecord RecordRing::at(std::uint64_t frame, std::uint32_t index) const
{
    DecisionRecord out;
    const std::size_t place = cell(frame, index);
    static_cast<RecordHead&>(out) = heads_[place];
    if (const auto engine = rules(frame)) {
        rules::Inference inference = engine->makeInference();
        engine->evaluate(out.facts, inference);
        out.fired = strongestRules(*engine, inference);
    }
    const auto first = candidates_.begin() + static_cast<std::ptrdiff_t>(place * methods_);
    out.candidates.assign(first, first + static_cast<std::ptrdiff_t>(out.methods));
    return out;
}

bool RecordRing::find(std::uint64_t frame, std::uint32_t lightId, DecisionRecord& out) const
{
    for (std::uint32_t i = 0; i < lights(frame); ++i)
        if (heads_[cell(frame, i)].lightId == lightId) {
            out = at(frame, i);
            return true;
        }
    return false;
}

} // namespace gnomon
