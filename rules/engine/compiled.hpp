#pragma once

/// Rules with every name replaced by an index: what evaluation and lint run on.

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
};

struct CompiledVariable {
    uint32_t fact = 0; ///< Index into the host's facts.
    uint32_t firstTerm = 0;
    uint32_t termCount = 0;
    double low = 0.0;
    double high = 1.0;
};

struct CompiledOp {
    Clause::Kind kind = Clause::Kind::Is;
    uint32_t variable = 0;   ///< Kind::Is only.
    uint32_t term = 0;       ///< Within the variable.
    uint32_t membership = 0; ///< Among all terms of all variables.
};

struct CompiledRule {
    uint32_t firstOp = 0;
    uint32_t opCount = 0; ///< 0 for `otherwise`.
    uint32_t firstEffect = 0;
    uint32_t effectCount = 0;
    uint32_t firstVeto = 0;
    uint32_t vetoCount = 0;
    double weight = 1.0;
};

struct CompiledRules {
    std::vector<CompiledVariable> variables; ///< As in RuleBase::variables.
    std::vector<Trapezoid> terms;            ///< Of all variables, in order.
    std::vector<CompiledOp> ops;             ///< Antecedents in postfix order.
    std::vector<CompiledRule> rules;         ///< As in RuleBase::rules, then `otherwise` where there is one.
    std::vector<uint32_t> effects;           ///< output * suitability terms + term.
    std::vector<uint32_t> vetoes;            ///< Outputs.
    uint32_t outputCount = 0;
    uint32_t suitabilityTerms = 0;
    uint32_t stackDepth = 0; ///< Deepest antecedent.
    bool hasOtherwise = false;

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

/// Truth of an antecedent, without weight. `memberships` holds one entry per term, `stack` at least stackDepth.
/// Ties between operands go to the left one.
Limited evaluateAntecedent(std::span<const CompiledOp> ops, std::span<const Truth> memberships,
                           Options::And conjunction, std::span<Limited> stack) noexcept;

} // namespace gnomon::rules
