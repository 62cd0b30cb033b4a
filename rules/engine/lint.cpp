#include "rules/engine/lint.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "rules/engine/lint_checks.hpp"
#include "rules/engine/normal_form.hpp"

namespace gnomon::rules {
namespace {

/// Behind checkPartitions().
struct Check {
    void (*run)(const Engine&, DiagnosticSink&);
    bool needsSoundTerms; ///< Where terms leave a hole it would report little but the hole's consequences.
};
constexpr std::array<Check, 6> kChecks = {{{&checkCoverage, true},
                                           {&checkDeadRules, false},
                                           {&checkRedundancy, false},
                                           {&checkContradictions, false},
                                           {&checkSamples, true},
                                           {&checkMonotony, true}}};

bool includes(const std::vector<uint32_t>& whole, const std::vector<uint32_t>& part)
{
    return std::includes(whole.begin(), whole.end(), part.begin(), part.end());
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

struct PairFindings {
    CappedFindings same, superfluous;
};

void comparePair(const Engine& engine, const std::vector<Comparable>& rules, std::size_t first, std::size_t second,
                 PairFindings& found)
{
    const Comparable& a = rules[first];
    const Comparable& b = rules[second];
    const auto& base = engine.base();
    const bool isSum = base.options.aggregation == Options::Aggregation::Sum;
    const auto name = [&](std::size_t i) { return "rule '" + base.rules[i].id + "'"; };
    const bool counts = a.weight == b.weight && a.priority == b.priority; // alike
    if (a.effects == b.effects && a.vetoes == b.vetoes && *a.form == *b.form && (isSum || counts)) {
        found.same.warning(base.rules[second].at, [&] {
            return name(second) + " says the same as " + name(first) + "; remove one of them" +
                   (isSum ? ": under 'sum' both count" : "");
        });
        return;
    }
    if (isSum) return; // every further rule adds strength
    const auto report = [&](std::size_t weak, std::size_t strong) {
        found.superfluous.warning(base.rules[weak].at,
                                  [&] { return name(weak) + " changes nothing: " + name(strong) + " covers it"; });
    };
    const auto superfluous = [](const Comparable& weak, const Comparable& strong) {
        return weak.weight <= strong.weight && weak.priority <= strong.priority &&
               includes(strong.effects, weak.effects) && includes(strong.vetoes, weak.vetoes) &&
               isWeaker(*weak.form, *strong.form);
    };
    if (superfluous(b, a))
        report(second, first);
    else if (superfluous(a, b))
        report(first, second);
}

} // namespace

void checkRedundancy(const Engine& engine, DiagnosticSink& sink)
{
    std::vector<Comparable> rules;
    for (std::size_t i = 0; i < engine.base().rules.size(); ++i)
        rules.push_back(comparableOf(engine, static_cast<uint32_t>(i)));
    PairFindings found{{"L05", sink}, {"L03", sink}};
    for (std::size_t second = 1; second < rules.size(); ++second) {
        for (std::size_t first = 0; first < second; ++first) {
            // A rule about absent outputs only is silent in this build, not wrong.
            if (rules[first].form && rules[second].form && !rules[first].concludesNothing() &&
                !rules[second].concludesNothing())
                comparePair(engine, rules, first, second, found);
        }
    }
    found.same.finish();
    found.superfluous.finish();
}

std::vector<Diagnostic> lint(const Engine& engine)
{
    DiagnosticSink sink(engine.base().file);
    const bool sound = checkPartitions(engine, sink);
    for (const Check& check : kChecks)
        if (sound || !check.needsSoundTerms) check.run(engine, sink);
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
