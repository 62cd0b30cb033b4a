#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "rules/engine/concepts.hpp"
#include "rules/engine/engine.hpp"
#include "runtime/base/float_mode.hpp"

namespace gnomon::rules {
namespace {

/// The least number whose product with `width` is at least 1: 1 / width, or the number above it. A corner is then full
/// truth, not the number below 1.
double slopeOf(double width) noexcept
{
    if (!std::isfinite(width)) return 1.0; // a shoulder: any slope will do
    const double slope = 1.0 / width;
    return slope * width < 1.0 ? std::nextafter(slope, std::numeric_limits<double>::infinity()) : slope;
}

} // namespace

Flanks flanksOf(const Trapezoid& shape) noexcept
{
    // Infinite corners: inf - inf is NaN, which is not finite.
    return {shape.a, slopeOf(shape.b - shape.a), shape.d, slopeOf(shape.d - shape.c)};
}

Limited evaluateAntecedent(std::span<const CompiledOp> ops, std::span<const Truth> memberships,
                           Options::And conjunction, std::span<Limited> stack) noexcept
{
    std::size_t depth = 0;
    for (std::size_t i = 0; i < ops.size(); ++i) {
        const CompiledOp& op = ops[i];
        if (op.kind == Clause::Kind::Is) {
            const Truth& truth = memberships[op.membership];
            stack[depth++] = {truth, static_cast<uint32_t>(i), truth.low};
            continue;
        }
        if (op.kind == Clause::Kind::Not) {
            Limited& top = stack[depth - 1];
            top.truth = {1.0 - top.truth.high, 1.0 - top.truth.low};
            top.least = top.truth.low;
            continue;
        }
        const Limited right = stack[--depth];
        Limited& left = stack[depth - 1];
        const bool isAnd = op.kind == Clause::Kind::And;
        const bool rightLimits = isAnd ? right.least < left.least : right.truth.low > left.truth.low;
        if (rightLimits) left.clause = right.clause;
        if (isAnd && conjunction == Options::And::Product)
            left.truth = {left.truth.low * right.truth.low, left.truth.high * right.truth.high};
        else if (isAnd)
            left.truth = {std::min(left.truth.low, right.truth.low), std::min(left.truth.high, right.truth.high)};
        else
            left.truth = {std::max(left.truth.low, right.truth.low), std::max(left.truth.high, right.truth.high)};
        left.least = isAnd ? std::min(left.least, right.least) : left.truth.low;
    }
    return stack[0];
}

namespace {

/// evaluateAntecedent() for a chain, lower bound only: most of what an evaluation does.
Limited evaluateChain(std::span<const CompiledOp> ops, const Truth* memberships, Options::And conjunction) noexcept
{
    double truth = memberships[ops[0].membership].low;
    double least = truth; // of the clauses, which their product is below
    uint32_t clause = 0;
    for (uint32_t i = 1; i < ops.size(); i += 2) {
        const double next = memberships[ops[i].membership].low;
        const bool lower = next < least;
        clause = lower ? i : clause;
        least = lower ? next : least;
        truth = conjunction == Options::And::Product ? truth * next : least;
    }
    return {{truth, truth}, clause, least};
}

} // namespace

void Engine::evaluate(std::span<const double> facts, Inference& out) const noexcept
{
    assert(facts.size() == facts_.size() && out.rules.size() == compiled_.rules.size());
    const FloatMode mode;
    evaluateInMode(facts, out);
}

[[gnu::noinline]] void Engine::evaluateInMode(std::span<const double> facts, Inference& out) const noexcept
{
    std::copy(facts.begin(), facts.end(), out.facts.begin());
    std::fill(out.outputs.begin(), out.outputs.end(), OutputState{});
    std::fill(out.termStrength.begin(), out.termStrength.end(), 0.0);
    if (base_.options.aggregation == Options::Aggregation::Sum)
        std::fill(out.termSum.begin(), out.termSum.end(), uint64_t(0));
    fuzzify(facts, out);
    fire(out);
    defuzzify(out);
}

void Engine::fuzzify(std::span<const double> facts, Inference& out) const noexcept
{
    out.unknownFacts = 0;
    out.clampedFacts = 0;
    for (const CompiledVariable& variable : compiled_.variables) {
        const double given = facts[variable.fact];
        const bool known = !std::isnan(given);
        const double x = known ? std::clamp(given, variable.low, variable.high) : given;
        out.unknownFacts += known ? 0 : 1;
        out.clampedFacts += known && x != given ? 1 : 0;
        for (uint32_t i = variable.firstTerm; i < variable.firstTerm + variable.termCount; ++i) {
            const double membership = compiled_.flanks[i].membership(x);
            out.memberships[i] = known ? Truth{membership, membership} : Truth{0.0, 1.0};
        }
    }
}

void Engine::fire(Inference& out) const noexcept
{
    const double threshold = std::max(base_.options.minimumStrength, kNegligibleStrength);
    const Options::And conjunction = base_.options.conjunction;
    const auto rules = static_cast<uint32_t>(compiled_.rules.size());
    double strongest = 0.0;
    for (const uint32_t step : compiled_.steps) {
        if (step >= rules) {
            settleConcept(compiled_, compiled_.concepts[step - rules], base_.options.aggregation, out.strengths,
                          out.memberships);
            continue;
        }
        const CompiledRule& rule = compiled_.rules[step];
        const std::span<const CompiledOp> ops = compiled_.opsOf(rule);
        // The upper bound matters to concepts only.
        const Limited fired = rule.isChain && out.strengths.empty()
                                  ? evaluateChain(ops, out.memberships.data(), conjunction)
                                  : evaluateAntecedent(ops, out.memberships, conjunction, out.stack);
        const CompiledOp& limit = ops[fired.clause];
        const Truth strength = strengthOf(fired.truth, rule.weight, threshold);
        out.rules[step] = {strength.low, limit.variable, limit.term, out.memberships[limit.membership].low};
        if (!out.strengths.empty()) out.strengths[step] = strength;
        if (rule.effectCount != 0) // a pure veto or assertion says nothing about who is good
            strongest = std::max(strongest, strength.low);
    }
    if (compiled_.hasOtherwise) {
        out.rules.back() = {};
        out.rules.back().strength = strengthOf({1.0 - strongest, 1.0}, compiled_.rules.back().weight, threshold).low;
    }
    out.floorTruth = compiled_.floor.empty()
                         ? 0.0
                         : evaluateAntecedent(compiled_.floor, out.memberships, conjunction, out.stack).truth.low;
    concludeAll(out);
}

void Engine::concludeAll(Inference& out) const noexcept
{
    if (compiled_.byPriority.empty()) {
        for (uint32_t i = 0; i < out.rules.size(); ++i) {
            if (out.rules[i].strength > 0.0) conclude(i, out.rules[i].strength, out);
        }
        return;
    }
    std::fill(out.claimed.begin(), out.claimed.end(), 0.0);
    std::fill(out.claiming.begin(), out.claiming.end(), 0.0);
    uint32_t priority = kHighestPriority;
    for (const uint32_t i : compiled_.byPriority) {
        if (compiled_.rules[i].priority != priority) {
            priority = compiled_.rules[i].priority;
            std::copy(out.claiming.begin(), out.claiming.end(), out.claimed.begin());
        }
        conclude(i, out.rules[i].strength, out);
    }
    if (compiled_.hasOtherwise) // yields by its nature: it has what the strongest rule leaves
        conclude(compiled_.writtenRules(), out.rules.back().strength, out);
}

/// What rules of a higher priority leave to a conclusion: 1 - the strongest of them that says otherwise about the same
/// output.
double Engine::leftFor(uint32_t slot, const Inference& out) const noexcept
{
    const uint32_t terms = compiled_.suitabilityTerms;
    const uint32_t first = slot / terms * terms;
    double contrary = 0.0;
    for (uint32_t other = first; other < first + terms; ++other) {
        if (other != slot) contrary = std::max(contrary, out.claimed[other]);
    }
    return 1.0 - contrary;
}

void Engine::conclude(uint32_t index, double fired, Inference& out) const noexcept
{
    if (fired == 0.0) return;
    const CompiledRule& rule = compiled_.rules[index];
    for (const uint32_t slot : compiled_.effectsOf(rule)) {
        double strength = fired;
        if (!out.claimed.empty()) {
            strength = std::min(fired, leftFor(slot, out));
            out.claiming[slot] = std::max(out.claiming[slot], fired);
        }
        if (base_.options.aggregation == Options::Aggregation::Sum)
            out.termSum[slot] += static_cast<uint64_t>(strength * kSumScale);
        else
            out.termStrength[slot] = std::max(out.termStrength[slot], strength);
        OutputState& output = out.outputs[slot / compiled_.suitabilityTerms];
        if (strength > output.strongestStrength) {
            output.strongestStrength = strength;
            output.strongestRule = index;
        }
    }
    if (fired < base_.options.vetoAt) return;
    for (const uint32_t vetoed : compiled_.vetoesOf(rule)) {
        OutputState& output = out.outputs[vetoed];
        output.vetoRule = output.vetoed ? std::min(output.vetoRule, index) : index;
        output.vetoed = true;
    }
}

void Engine::defuzzify(Inference& out) const noexcept
{
    if (base_.options.aggregation == Options::Aggregation::Sum) {
        for (std::size_t i = 0; i < out.termSum.size(); ++i)
            out.termStrength[i] = std::min(1.0, static_cast<double>(out.termSum[i]) / kSumScale);
    }
    const std::size_t terms = compiled_.suitabilityTerms;
    for (std::size_t i = 0; i < out.outputs.size(); ++i) {
        if (out.outputs[i].strongestStrength == 0.0) continue; // no rule speaks about it, as OutputState{} says
        const Centroid centroid = centroidOf(std::span(out.termStrength).subspan(i * terms, terms));
        OutputState& output = out.outputs[i];
        output.hasOpinion = centroid.hasOpinion;
        if (centroid.hasOpinion) output.suitability = centroid.value;
        output.quantised = quantisedOf(centroid);
    }
}

Centroid Engine::centroidOf(std::span<const double> strengths) const noexcept
{
    const uint32_t samples = base_.options.samples;
    return samples == 0 ? suitability_.exact(strengths) : suitability_.sampled(strengths, samples);
}

int32_t Engine::quantisedOf(const Centroid& centroid) const noexcept
{
    if (!centroid.hasOpinion) return -1;
    const double low = base_.suitability.low;
    const double width = base_.suitability.high - low;
    return static_cast<int32_t>((centroid.value - low) / width * kSuitabilitySteps + 0.5);
}

} // namespace gnomon::rules
