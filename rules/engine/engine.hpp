#pragma once

/// A rule base tied to the facts and outputs of one host, ready to evaluate.
///
///     BindResult bound = Engine::bind(base, {.facts = facts, .outputs = methods, .absent = notBuiltIn});
///     Inference inference = bound.engine->makeInference();
///     bound.engine->evaluate(values, inference);           // values in the order of `facts`
///     inference.outputs[i].quantised                       // in the order of `outputs`
///
/// An engine is immutable: threads may share it, each with an Inference of its own.

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rules/engine/centroid.hpp"
#include "rules/engine/compiled.hpp"
#include "rules/engine/diagnostic.hpp"
#include "rules/engine/rule_base.hpp"

namespace gnomon::rules {

/// A number the host supplies. An empty unit matches any.
struct FactInfo {
    std::string name;
    std::string unit;
};

/// Something the rules may favour or avoid, by name or by one of its traits.
struct OutputInfo {
    std::string name;
    std::vector<std::string> traits;
    /// 0..1, where the host knows it: what Policy::Floor::minimumQuality is compared with. For the linter.
    double quality = std::numeric_limits<double>::quiet_NaN();
};

/// What a host has. A name that appears in none of these lists is an error; one that is known but absent makes the
/// conclusions about it silent, so that one rule base serves builds with more and with fewer outputs.
struct Vocabulary {
    std::span<const FactInfo> facts;
    std::span<const OutputInfo> outputs;
    std::span<const OutputInfo> absent;  ///< Known, but not in this build.
    std::span<const std::string> traits; ///< Known traits that no output above need carry.
};

inline constexpr uint32_t kNoRule = std::numeric_limits<uint32_t>::max();

/// Suitability in steps of 1/4096 of its universe: what decisions compare, so that the last bits of a division never
/// decide between equals.
inline constexpr int32_t kSuitabilitySteps = 4096;

/// What the rules think of one output.
struct OutputState {
    double suitability = 0.0;         ///< In the universe of suitability; meaningless without an opinion.
    int32_t quantised = -1;           ///< 0..kSuitabilitySteps, -1 without an opinion.
    bool hasOpinion = false;          ///< False: no rule that fired says anything about this output.
    bool vetoed = false;              ///< Independent of the opinion. The host must not choose a vetoed output.
    uint32_t vetoRule = kNoRule;      ///< First rule that vetoed.
    uint32_t strongestRule = kNoRule; ///< First among the strongest rules that speak about it, vetoes excluded.
    double strongestStrength = 0.0;
};

/// How one rule fired.
struct RuleState {
    double strength = 0.0; ///< Weight included. 0 below the threshold of the rule base.
    /// The one `variable is term` that set the strength: the smallest under `and`, the largest under `or`.
    /// kNoRule for `otherwise`.
    uint32_t limitingVariable = kNoRule; ///< Index into RuleBase::variables, then concepts; Engine::variableName().
    uint32_t limitingTerm = 0;           ///< Index into the terms of either; Engine::termName().
    double limitingMembership = 0.0;     ///< Of the term, before any `not`.
};

/// One evaluation. Made by Engine::makeInference(), so that evaluate() need not allocate.
struct Inference {
    std::vector<OutputState> outputs;
    std::vector<RuleState> rules; ///< One per rule, and a last one for `otherwise` where there is one.
    std::vector<double> facts;    ///< As given.
    uint32_t unknownFacts = 0;    ///< NaN facts among those the rule base has variables for.
    uint32_t clampedFacts = 0;    ///< Facts outside their universe, counted as its nearest edge.

    /// How true the condition of Policy::floor is: as surely as the known facts allow. 0 where there is no floor.
    double floorTruth = 0.0;

    /// Scratch, valid after evaluate().
    std::vector<Truth> memberships;   ///< One per term of every input variable, then of every concept.
    std::vector<Truth> strengths;     ///< One per rule. Empty without concepts.
    std::vector<double> termStrength; ///< outputs x terms of suitability.
    std::vector<uint64_t> termSum;    ///< The same in steps of 2^-50, for aggregation `sum`.
    std::vector<double> claimed;      ///< Strongest rule of a higher priority, per output and term. Empty where all
    std::vector<double> claiming;     ///< priorities are equal; so is this one, which takes in the present priority.
    std::vector<Limited> stack;
};

struct BindResult;

class Engine {
public:
    /// Resolves every name of `base`. Never throws for what a rule base may contain; std::bad_alloc passes through.
    static BindResult bind(RuleBase base, const Vocabulary& vocabulary);

    Inference makeInference() const;

    /// Evaluates all rules for one set of facts, in the order of Vocabulary::facts (`facts.size()` must match it).
    /// Allocates nothing, and uses only + - * / on doubles: the same inputs give the same bits everywhere, in whatever
    /// floating-point mode the calling thread is.
    void evaluate(std::span<const double> facts, Inference& out) const noexcept;

    /// The last steps of evaluate() alone: centre of gravity of one output from the strengths of its terms, and that in
    /// steps of 1 / kSuitabilitySteps (-1 without an opinion).
    Centroid centroidOf(std::span<const double> strengths) const noexcept;
    int32_t quantisedOf(const Centroid& centroid) const noexcept;

    const RuleBase& base() const noexcept { return base_; }
    const std::vector<FactInfo>& facts() const noexcept { return facts_; }
    const std::vector<OutputInfo>& outputs() const noexcept { return outputs_; }
    const CompiledRules& compiled() const noexcept { return compiled_; }
    const CentroidTerms& suitability() const noexcept { return suitability_; }

    /// Name of a rule index as it appears in Inference: the id of the rule, "otherwise", or "" for kNoRule.
    std::string_view ruleId(uint32_t rule) const noexcept;
    /// Names behind RuleState::limitingVariable and limitingTerm, and those of CompiledOp.
    std::string_view variableName(uint32_t variableOrConcept) const noexcept;
    std::string_view termName(uint32_t variableOrConcept, uint32_t term) const noexcept;
    /// The rule behind such an index, or null for kNoRule.
    const Rule* rule(uint32_t rule) const noexcept;

private:
    Engine(RuleBase base, const Vocabulary& vocabulary, CompiledRules compiled);

    void evaluateInMode(std::span<const double> facts, Inference& out) const noexcept;
    void fuzzify(std::span<const double> facts, Inference& out) const noexcept;
    void fire(Inference& out) const noexcept;
    void concludeAll(Inference& out) const noexcept;
    void conclude(uint32_t rule, double strength, Inference& out) const noexcept;
    double leftFor(uint32_t slot, const Inference& out) const noexcept;
    void defuzzify(Inference& out) const noexcept;

    RuleBase base_;
    std::vector<FactInfo> facts_;
    std::vector<OutputInfo> outputs_;
    CompiledRules compiled_;
    CentroidTerms suitability_;
};

struct BindResult {
    std::optional<Engine> engine;        ///< Empty when there was an error.
    std::vector<Diagnostic> diagnostics; ///< Errors L01, R05 to R07.
};

} // namespace gnomon::rules
