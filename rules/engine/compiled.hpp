#pragma once

/// Rules with every name replaced by an index: what evaluation and lint run on.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "rules/engine/rule_base.hpp"

namespace gnomon::rules {

/// Bounds on a degree of truth. A known fact gives low == high. A NaN fact could be anything, so its terms are [0, 1],
/// and the bounds are carried through the rule; a rule fires with the *lower* bound, as strongly as it must whatever
/// the value is. Hence NaN belongs to no term, `not` of a NaN term is not true either, and an unknown fact vetoes
/// nothing.
struct Truth {
    double low = 0.0;
    double high = 0.0;
};

/// A degree of truth and the clause that set its lower bound.
struct Limited {
    Truth truth;
    uint32_t clause = 0; ///< Index into CompiledRules::ops.
    double least = 0.0;  ///< Lower bound of the operand with that clause: a product is lower than each of them.
};

struct CompiledVariable {
    uint32_t fact = 0; ///< Index into the host's facts.
    uint32_t firstTerm = 0;
    uint32_t termCount = 0;
    double low = 0.0;
    double high = 1.0;
};

/// A trapezoid as evaluation wants it: no division, no branch. Exact at its corners: 0 at a and d, 1 from b
/// to c; on the flanks within three units in the last place of Trapezoid::membership().
struct Flanks {
    double a = 0.0, perRise = 1.0; ///< The least number that takes b - a to 1; inf for a vertical edge.
    double d = 0.0, perFall = 1.0;

    /// Of a known fact. A vertical edge gives 0 * inf = NaN on the edge itself, and NaN yields to the 1 beside it.
    double membership(double x) const noexcept
    {
        return std::max(0.0, std::min(std::min(1.0, (x - a) * perRise), (d - x) * perFall));
    }
};
Flanks flanksOf(const Trapezoid& shape) noexcept;

struct CompiledOp {
    Clause::Kind kind = Clause::Kind::Is;
    uint32_t variable = 0;   ///< Kind::Is only. Concepts are counted on behind the variables.
    uint32_t term = 0;       ///< Within the variable or concept.
    uint32_t membership = 0; ///< Among all terms of all variables, then of all concepts.
};

/// A rule that asserts a term of a concept.
struct CompiledAssertion {
    uint32_t rule = 0;
    uint32_t term = 0; ///< Within the concept.
};

struct CompiledConcept {
    uint32_t firstMembership = 0;
    uint32_t termCount = 0;
    uint32_t firstAssertion = 0; ///< By falling priority, then in the order of the rules.
    uint32_t assertionCount = 0;
};

struct CompiledRule {
    uint32_t firstOp = 0;
    uint32_t opCount = 0; ///< 0 for `otherwise`.
    uint32_t firstEffect = 0;
    uint32_t effectCount = 0;
    uint32_t firstVeto = 0;
    uint32_t vetoCount = 0;
    double weight = 1.0;
    uint32_t priority = 0;
    /// `term and term and ...`, as most rules are: ops 0, 1, 3, 5, ... are the terms.
    bool isChain = false;
};

struct CompiledMonotony {
    uint32_t variable = 0;
    std::vector<uint32_t> outputs;
};

struct CompiledRules {
    std::vector<CompiledVariable> variables; ///< As in RuleBase::variables.
    std::vector<Trapezoid> terms;            ///< Of all variables, in order.
    std::vector<Flanks> flanks;              ///< As terms.
    std::vector<CompiledOp> ops;             ///< Antecedents in postfix order.
    std::vector<CompiledRule> rules;         ///< As in RuleBase::rules, then `otherwise` where there is one.
    std::vector<CompiledConcept> concepts;   ///< As in RuleBase::concepts.
    std::vector<CompiledAssertion> assertions;
    /// What to do in which order, so that every concept is settled before a rule asks for it: a rule by its index, or
    /// a concept by rules.size() + its index. Without concepts the rules in order.
    std::vector<uint32_t> steps;
    std::vector<uint32_t> byPriority; ///< Rules, `otherwise` excepted, by falling priority. Empty where all are equal.
    std::vector<CompiledOp> floor;    ///< Policy::Floor::when. Empty: no floor.
    std::vector<uint32_t> effects;    ///< output * suitability terms + term.
    std::vector<uint32_t> vetoes;     ///< Outputs.
    std::vector<std::vector<uint32_t>> kinds; ///< Outputs that compete. At least one entry.
    std::vector<CompiledMonotony> monotony;   ///< As in RuleBase::monotony.
    uint32_t outputCount = 0;
    uint32_t suitabilityTerms = 0;
    uint32_t membershipCount = 0; ///< Terms of all variables and concepts.
    uint32_t stackDepth = 0;      ///< Deepest antecedent.
    bool hasOtherwise = false;

    /// Rules as written, without `otherwise`.
    uint32_t writtenRules() const noexcept { return static_cast<uint32_t>(rules.size()) - (hasOtherwise ? 1 : 0); }

    std::span<const CompiledOp> opsOf(const CompiledRule& rule) const noexcept
    {
        return std::span(ops).subspan(rule.firstOp, rule.opCount);
    }
    std::span<const uint32_t> effectsOf(const CompiledRule& rule) const noexcept
    {
        return std::span(effects).subspan(rule.firstEffect, rule.effectCount);
    }
    std::span<const uint32_t> vetoesOf(const CompiledRule& rule) const noexcept
    {
        return std::span(vetoes).subspan(rule.firstVeto, rule.vetoCount);
    }
};

/// Strengths below this count as 0. Far below anything a person could mean, far above where products become denormal,
/// so that a host which flushes denormals to zero gets the same opinions.
inline constexpr double kNegligibleStrength = 0x1p-40;

/// Strengths are added as whole steps of 2^-50, because integers may be added in any order: permuting the rules must
/// not change a bit. 4096 rules of strength 1 reach 2^62. Truncation keeps the rounding mode out of it.
inline constexpr double kSumScale = 0x1p50;

/// Bounds on the strength of a rule from those of its antecedent: weight, then threshold.
inline Truth strengthOf(Truth antecedent, double weight, double threshold) noexcept
{
    const auto counted = [=](double truth) { return truth * weight < threshold ? 0.0 : truth * weight; };
    return {counted(antecedent.low), counted(antecedent.high)};
}

/// Truth of an antecedent, without weight. `memberships` holds one entry per term, `stack` at least stackDepth.
/// Ties between operands go to the left one.
Limited evaluateAntecedent(std::span<const CompiledOp> ops, std::span<const Truth> memberships,
                           Options::And conjunction, std::span<Limited> stack) noexcept;

} // namespace gnomon::rules
