#include <algorithm>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "rules/engine/engine.hpp"

namespace gnomon::rules {
namespace {

/// Resolves names in the order the rule base has them; the first pass over the host's lists is the only lookup by text.
class Compiler {
public:
    Compiler(const RuleBase& base, const Vocabulary& vocabulary, DiagnosticSink& sink)
        : base_(base), vocabulary_(vocabulary), sink_(sink)
    {
        for (const OutputInfo& output : vocabulary.absent) {
            knownOutputs_.insert(output.name);
            knownTraits_.insert(output.traits.begin(), output.traits.end());
        }
        for (const OutputInfo& output : vocabulary.outputs)
            knownTraits_.insert(output.traits.begin(), output.traits.end());
        knownTraits_.insert(vocabulary.traits.begin(), vocabulary.traits.end());
        for (std::size_t i = 0; i < vocabulary.outputs.size(); ++i)
            outputs_.emplace(vocabulary.outputs[i].name, static_cast<uint32_t>(i));
    }

    CompiledRules compile()
    {
        made_.outputCount = static_cast<uint32_t>(vocabulary_.outputs.size());
        made_.suitabilityTerms = static_cast<uint32_t>(base_.suitability.terms.size());
        for (const Variable& variable : base_.variables)
            compileVariable(variable);
        for (const Rule& rule : base_.rules)
            compileRule(rule);
        if (base_.otherwise) compileRule(*base_.otherwise);
        made_.hasOtherwise = base_.otherwise.has_value();
        return std::move(made_);
    }

private:
    void compileVariable(const Variable& variable)
    {
        CompiledVariable made;
        const auto fact = std::find_if(vocabulary_.facts.begin(), vocabulary_.facts.end(),
                                       [&](const FactInfo& f) { return f.name == variable.name; });
        if (fact == vocabulary_.facts.end()) {
            sink_.error("L01", variable.at, "no fact is called " + quoted(variable.name));
        } else {
            made.fact = static_cast<uint32_t>(fact - vocabulary_.facts.begin());
            if (!variable.unit.empty() && !fact->unit.empty() && variable.unit != fact->unit)
                sink_.error("L01", variable.at,
                            quoted(variable.name) + " is in " + quoted(fact->unit) + ", not in " +
                                quoted(variable.unit));
        }
        made.firstTerm = static_cast<uint32_t>(made_.terms.size());
        made.termCount = static_cast<uint32_t>(variable.terms.size());
        made.low = variable.low;
        made.high = variable.high;
        for (const Term& term : variable.terms)
            made_.terms.push_back(term.shape);
        variables_.emplace(variable.name, static_cast<uint32_t>(made_.variables.size()));
        made_.variables.push_back(made);
    }

    void compileRule(const Rule& rule)
    {
        CompiledRule made;
        made.weight = rule.weight;
        made.firstOp = static_cast<uint32_t>(made_.ops.size());
        uint32_t depth = 0;
        for (const Clause& clause : rule.antecedent) {
            made_.ops.push_back(opOf(clause));
            depth += clause.kind == Clause::Kind::Is ? 1u : clause.kind == Clause::Kind::Not ? 0u : ~0u;
            made_.stackDepth = std::max(made_.stackDepth, depth);
        }
        made.opCount = static_cast<uint32_t>(rule.antecedent.size());
        made.firstEffect = static_cast<uint32_t>(made_.effects.size());
        made.firstVeto = static_cast<uint32_t>(made_.vetoes.size());
        compileConsequents(rule);
        made.effectCount = static_cast<uint32_t>(made_.effects.size()) - made.firstEffect;
        made.vetoCount = static_cast<uint32_t>(made_.vetoes.size()) - made.firstVeto;
        made_.rules.push_back(made);
    }

    CompiledOp opOf(const Clause& clause) const
    {
        CompiledOp op;
        op.kind = clause.kind;
        if (clause.kind != Clause::Kind::Is) return op;
        op.variable = variables_.at(clause.variable); // validate() has seen it, and the term
        op.term = termIndex(base_.variables[op.variable], clause.term);
        op.membership = made_.variables[op.variable].firstTerm + op.term;
        return op;
    }

    static uint32_t termIndex(const Variable& variable, std::string_view name)
    {
        const auto found = std::find_if(variable.terms.begin(), variable.terms.end(),
                                        [&](const Term& term) { return term.name == name; });
        return static_cast<uint32_t>(found - variable.terms.begin());
    }

    /// The present outputs a consequent speaks of, `others` excepted. Reports names nobody knows.
    std::vector<uint32_t> targetsOf(const Consequent& consequent)
    {
        std::vector<uint32_t> targets;
        if (consequent.kind == Consequent::Kind::Output || consequent.kind == Consequent::Kind::Never) {
            if (const auto found = outputs_.find(consequent.name); found != outputs_.end())
                targets.push_back(found->second);
            else if (!knownOutputs_.contains(consequent.name))
                sink_.error("L01", consequent.nameAt,
                            "unknown output " + quoted(consequent.name) + traitHint(consequent));
            return targets;
        }
        for (uint32_t i = 0; i < made_.outputCount; ++i) {
            const auto& traits = vocabulary_.outputs[i].traits;
            if (std::find(traits.begin(), traits.end(), consequent.name) != traits.end()) targets.push_back(i);
        }
        if (targets.empty() && !knownTraits_.contains(consequent.name))
            sink_.error("L01", consequent.nameAt, "unknown trait " + quoted(consequent.name));
        return targets;
    }

    std::string traitHint(const Consequent& consequent) const
    {
        return knownTraits_.contains(consequent.name) ? "; it is a trait, write 'any " + consequent.name + "'" : "";
    }

    void compileConsequents(const Rule& rule)
    {
        std::vector<bool> named(made_.outputCount, false);
        std::vector<uint32_t> slots;
        bool speaksOfPresent = false;
        for (const Consequent& consequent : rule.consequents) {
            if (consequent.kind == Consequent::Kind::Others) continue;
            for (const uint32_t output : targetsOf(consequent)) {
                named[output] = true;
                speaksOfPresent = true;
                if (consequent.isVeto())
                    made_.vetoes.push_back(output);
                else
                    slots.push_back(slotOf(output, consequent));
            }
        }
        for (const Consequent& consequent : rule.consequents) {
            // Where all that the sentence names is absent, it has nobody to prefer: its `others` are silent too,
            // or a missing output would drag every present one down.
            if (consequent.kind != Consequent::Kind::Others || !speaksOfPresent) continue;
            for (uint32_t output = 0; output < made_.outputCount; ++output) {
                if (!named[output]) slots.push_back(slotOf(output, consequent));
            }
        }
        // A rule counts once per conclusion, even if a name and a trait both lead to it.
        std::sort(slots.begin(), slots.end());
        slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
        made_.effects.insert(made_.effects.end(), slots.begin(), slots.end());
    }

    uint32_t slotOf(uint32_t output, const Consequent& consequent) const
    {
        return output * made_.suitabilityTerms + termIndex(base_.suitability, consequent.term);
    }

    const RuleBase& base_;
    const Vocabulary& vocabulary_;
    DiagnosticSink& sink_;
    CompiledRules made_;
    std::unordered_map<std::string_view, uint32_t> variables_;
    std::unordered_map<std::string_view, uint32_t> outputs_;
    std::unordered_set<std::string_view> knownOutputs_;
    std::unordered_set<std::string_view> knownTraits_;
};

} // namespace

Engine::Engine(RuleBase base, const Vocabulary& vocabulary, CompiledRules compiled)
    : base_(std::move(base)), facts_(vocabulary.facts.begin(), vocabulary.facts.end()),
      outputs_(vocabulary.outputs.begin(), vocabulary.outputs.end()), compiled_(std::move(compiled)),
      suitability_(base_.suitability)
{
}

BindResult Engine::bind(RuleBase base, const Vocabulary& vocabulary)
{
    BindResult result;
    DiagnosticSink sink(base.file);
    if (validate(base, sink)) {
        CompiledRules compiled = Compiler(base, vocabulary, sink).compile();
        if (sink.errorCount() == 0) result.engine = Engine(std::move(base), vocabulary, std::move(compiled));
    }
    result.diagnostics = sink.take();
    return result;
}

Inference Engine::makeInference() const
{
    Inference made;
    made.outputs.resize(compiled_.outputCount);
    made.rules.resize(compiled_.rules.size());
    made.facts.resize(facts_.size());
    made.memberships.resize(compiled_.terms.size());
    const std::size_t slots = std::size_t(compiled_.outputCount) * compiled_.suitabilityTerms;
    made.termStrength.resize(slots);
    made.termSum.resize(slots);
    made.stack.resize(compiled_.stackDepth);
    return made;
}

std::string_view Engine::ruleId(uint32_t index) const noexcept
{
    if (index < base_.rules.size()) return base_.rules[index].id;
    return rule(index) ? std::string_view("otherwise") : std::string_view();
}

const Rule* Engine::rule(uint32_t index) const noexcept
{
    if (index < base_.rules.size()) return &base_.rules[index];
    return index == base_.rules.size() && base_.otherwise ? &*base_.otherwise : nullptr;
}

} // namespace gnomon::rules
