#include "rules/engine/lint.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "rules/engine/lint_checks.hpp"

namespace gnomon::rules {
namespace {

constexpr std::array kChecks = {&checkPartitions, &checkCoverage, &checkDeadRules, &checkRedundancy};

/// A clause with its sign: membership index * 2, plus 1 under `not`.
using Literal = uint32_t;
using Conjunction = std::vector<Literal>; ///< Sorted.

/// An antecedent as alternatives of conjunctions, sorted, without alternatives that another one covers. Minimum,
/// maximum and 1 - x form a De Morgan algebra, so antecedents with one normal form have one strength everywhere; the
/// converse does not hold, and need not for a warning.
using NormalForm = std::vector<Conjunction>;

constexpr std::size_t kMostAlternatives = 64; ///< Beyond it an antecedent is compared with nothing.

bool includes(const Conjunction& whole, const Conjunction& part)
{
    return std::includes(whole.begin(), whole.end(), part.begin(), part.end());
}

void simplify(NormalForm& form, bool idempotent)
{
    for (Conjunction& conjunction : form) {
        std::sort(conjunction.begin(), conjunction.end());
        if (idempotent) // x and x is x under the minimum, weaker than x under the product
            conjunction.erase(std::unique(conjunction.begin(), conjunction.end()), conjunction.end());
    }
    std::sort(form.begin(), form.end());
    form.erase(std::unique(form.begin(), form.end()), form.end());
    const NormalForm all = form;
    std::erase_if(form, [&](const Conjunction& weaker) {
        return std::any_of(all.begin(), all.end(),
                           [&](const Conjunction& other) { return other != weaker && includes(weaker, other); });
    });
}

NormalForm allPairs(const NormalForm& left, const NormalForm& right)
{
    NormalForm result;
    for (const Conjunction& l : left) {
        for (const Conjunction& r : right) {
            Conjunction both = l;
            both.insert(both.end(), r.begin(), r.end());
            result.push_back(std::move(both));
        }
    }
    return result;
}

NormalForm either(NormalForm left, const NormalForm& right)
{
    left.insert(left.end(), right.begin(), right.end());
    return left;
}

/// Keeps every operand together with its negation, so that `not` is a swap.
std::optional<NormalForm> normalFormOf(std::span<const CompiledOp> ops, Options::And conjunction)
{
    const bool isMin = conjunction == Options::And::Min;
    struct Operand {
        NormalForm is, isNot;
        bool compound = false;
    };
    std::vector<Operand> stack;
    for (const CompiledOp& op : ops) {
        if (op.kind == Clause::Kind::Is) {
            stack.push_back({{{op.membership * 2}}, {{op.membership * 2 + 1}}, false});
            continue;
        }
        if (op.kind == Clause::Kind::Not) {
            if (stack.back().compound && !isMin) return std::nullopt; // De Morgan does not hold for the product
            std::swap(stack.back().is, stack.back().isNot);
            continue;
        }
        const Operand right = std::move(stack.back());
        stack.pop_back();
        Operand& left = stack.back();
        const bool isAnd = op.kind == Clause::Kind::And;
        if (isAnd ? left.is.size() * right.is.size() > kMostAlternatives
                  : isMin && left.isNot.size() * right.isNot.size() > kMostAlternatives)
            return std::nullopt;
        left.is = isAnd ? allPairs(left.is, right.is) : either(std::move(left.is), right.is);
        if (isMin) left.isNot = isAnd ? either(std::move(left.isNot), right.isNot) : allPairs(left.isNot, right.isNot);
        left.compound = true;
        simplify(left.is, isMin);
        simplify(left.isNot, isMin);
        if (left.is.size() > kMostAlternatives || left.isNot.size() > kMostAlternatives) return std::nullopt;
    }
    return std::move(stack.front().is);
}

/// Everywhere at most as strong: each alternative asks for all that some alternative of the other asks for.
bool isWeaker(const NormalForm& form, const NormalForm& than)
{
    return std::all_of(form.begin(), form.end(), [&](const Conjunction& conjunction) {
        return std::any_of(than.begin(), than.end(), [&](const Conjunction& c) { return includes(conjunction, c); });
    });
}

struct Comparable {
    std::optional<NormalForm> form;
    std::vector<uint32_t> effects;
    std::vector<uint32_t> vetoes;
    double weight = 1.0;
    uint32_t priority = 0;

    bool concludesNothing() const { return effects.empty() && vetoes.empty(); }
};

Comparable comparableOf(const Engine& engine, uint32_t index)
{
    const CompiledRules& compiled = engine.compiled();
    const CompiledRule& rule = compiled.rules[index];
    const auto effects = compiled.effectsOf(rule);
    const auto vetoes = compiled.vetoesOf(rule);
    Comparable made{normalFormOf(compiled.opsOf(rule), engine.base().options.conjunction),
                    {effects.begin(), effects.end()},
                    {vetoes.begin(), vetoes.end()},
                    rule.weight,
                    rule.priority};
    // Assertions count as effects behind those on outputs.
    for (const CompiledConcept& concept_ : compiled.concepts) {
        for (uint32_t a = concept_.firstAssertion; a < concept_.firstAssertion + concept_.assertionCount; ++a) {
            const CompiledAssertion& assertion = compiled.assertions[a];
            if (assertion.rule == index)
                made.effects.push_back(compiled.outputCount * compiled.suitabilityTerms + concept_.firstMembership +
                                       assertion.term);
        }
    }
    std::sort(made.effects.begin(), made.effects.end());
    std::sort(made.vetoes.begin(), made.vetoes.end());
    return made;
}

void comparePair(const Engine& engine, const std::vector<Comparable>& rules, std::size_t first, std::size_t second,
                 DiagnosticSink& sink)
{
    const Comparable& a = rules[first];
    const Comparable& b = rules[second];
    const auto& base = engine.base();
    const auto name = [&](std::size_t i) { return "rule '" + base.rules[i].id + "'"; };
    if (a.effects == b.effects && a.vetoes == b.vetoes && *a.form == *b.form) {
        const bool isSum = base.options.aggregation == Options::Aggregation::Sum;
        sink.warning("L05", base.rules[second].at,
                     name(second) + " says the same as " + name(first) + (isSum ? "; under 'sum' both count" : ""));
        return;
    }
    if (base.options.aggregation == Options::Aggregation::Sum) return; // every further rule adds strength
    const auto superfluous = [](const Comparable& weak, const Comparable& strong) {
        return weak.weight <= strong.weight && weak.priority <= strong.priority &&
               includes(strong.effects, weak.effects) && includes(strong.vetoes, weak.vetoes) &&
               isWeaker(*weak.form, *strong.form);
    };
    if (superfluous(b, a))
        sink.warning("L03", base.rules[second].at, name(second) + " changes nothing: " + name(first) + " covers it");
    else if (superfluous(a, b))
        sink.warning("L03", base.rules[first].at, name(first) + " changes nothing: " + name(second) + " covers it");
}

} // namespace

void checkRedundancy(const Engine& engine, DiagnosticSink& sink)
{
    std::vector<Comparable> rules;
    for (std::size_t i = 0; i < engine.base().rules.size(); ++i)
        rules.push_back(comparableOf(engine, static_cast<uint32_t>(i)));
    for (std::size_t second = 1; second < rules.size(); ++second) {
        for (std::size_t first = 0; first < second; ++first) {
            // A rule about absent outputs only is silent in this build, not wrong.
            if (rules[first].form && rules[second].form && !rules[first].concludesNothing() &&
                !rules[second].concludesNothing())
                comparePair(engine, rules, first, second, sink);
        }
    }
}

std::vector<Diagnostic> lint(const Engine& engine)
{
    DiagnosticSink sink(engine.base().file);
    for (const auto check : kChecks)
        check(engine, sink);
    return sink.take();
}

std::vector<Diagnostic> lint(const RuleBase& base, const Vocabulary& vocabulary)
{
    BindResult bound = Engine::bind(base, vocabulary);
    if (!bound.engine) return std::move(bound.diagnostics);
    std::vector<Diagnostic> all = std::move(bound.diagnostics);
    for (Diagnostic& finding : lint(*bound.engine))
        all.push_back(std::move(finding));
    return all;
}

} // namespace gnomon::rules
