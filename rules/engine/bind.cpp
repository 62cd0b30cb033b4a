#include <algorithm>
#include <numeric>
#include <unordered_map>
#include <unordered_set>

#include "rules/engine/concepts.hpp"
#include "rules/engine/engine.hpp"
#include "runtime/base/float_mode.hpp"

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
        made_.membershipCount = static_cast<uint32_t>(made_.terms.size());
        for (const Concept& concept_ : base_.concepts)
            compileConcept(concept_);
        for (const Rule& rule : base_.rules)
            compileRule(rule);
        if (base_.otherwise) compileRule(*base_.otherwise);
        made_.hasOtherwise = base_.otherwise.has_value();
        made_.floor = opsOf(base_.policy.floor.when);
        compileAssertions();
        compileSteps();
        compileKinds();
        for (const Monotony& promise : base_.monotony)
            compileMonotony(promise);
        const bool equal = std::all_of(base_.rules.begin(), base_.rules.end(),
                                       [&](const Rule& rule) { return rule.priority == base_.rules[0].priority; });
        if (!equal) made_.byPriority = rulesByPriority();
        return std::move(made_);
    }

private:
    void compileConcept(const Concept& concept_)
    {
        if (outputs_.contains(concept_.name) || knownOutputs_.contains(concept_.name))
            sink_.error("L01", concept_.at, inQuotes(concept_.name) + " is an output already, it cannot be a concept");
        CompiledConcept made;
        made.firstMembership = made_.membershipCount;
        made.termCount = static_cast<uint32_t>(concept_.terms.size());
        made_.membershipCount += made.termCount;
        concepts_.emplace(concept_.name, static_cast<uint32_t>(made_.concepts.size()));
        made_.concepts.push_back(made);
    }

    /// By falling priority, in the order of the rules within one.
    std::vector<uint32_t> rulesByPriority() const
    {
        std::vector<uint32_t> order(base_.rules.size());
        std::iota(order.begin(), order.end(), 0u);
        std::stable_sort(order.begin(), order.end(),
                         [&](uint32_t x, uint32_t y) { return base_.rules[x].priority > base_.rules[y].priority; });
        return order;
    }

    void compileAssertions()
    {
        std::vector<std::vector<CompiledAssertion>> found(base_.concepts.size());
        for (const uint32_t rule : rulesByPriority()) {
            for (const Consequent& consequent : base_.rules[rule].consequents) {
                if (consequent.kind != Consequent::Kind::Output) continue;
                const auto concept_ = concepts_.find(consequent.name);
                if (concept_ == concepts_.end()) continue;
                const uint32_t term = termIndex(base_.concepts[concept_->second], consequent.term);
                auto& list = found[concept_->second];
                const auto same = [&](const CompiledAssertion& a) { return a.rule == rule && a.term == term; };
                if (std::none_of(list.begin(), list.end(), same)) list.push_back({rule, term});
            }
        }
        for (std::size_t i = 0; i < found.size(); ++i) {
            made_.concepts[i].firstAssertion = static_cast<uint32_t>(made_.assertions.size());
            made_.concepts[i].assertionCount = static_cast<uint32_t>(found[i].size());
            made_.assertions.insert(made_.assertions.end(), found[i].begin(), found[i].end());
        }
    }

    /// Every concept behind the rules that assert it, which stand behind the concepts they ask for. Rules that assert
    /// nothing come last, in order.
    void compileSteps()
    {
        DiagnosticSink ignored(""); // validate() has reported cycles
        const auto order = orderConcepts(base_, ignored);
        std::vector<bool> done(made_.rules.size(), false);
        const auto fire = [&](uint32_t rule) {
            if (!done[rule]) made_.steps.push_back(rule);
            done[rule] = true;
        };
        for (const uint32_t index : order.value_or(std::vector<uint32_t>())) {
            const CompiledConcept& concept_ = made_.concepts[index];
            for (uint32_t i = 0; i < concept_.assertionCount; ++i)
                fire(made_.assertions[concept_.firstAssertion + i].rule);
            made_.steps.push_back(static_cast<uint32_t>(made_.rules.size()) + index);
        }
        for (uint32_t rule = 0; rule < base_.rules.size(); ++rule)
            fire(rule);
    }

    void compileVariable(const Variable& variable)
    {
        CompiledVariable made;
        const auto fact = std::find_if(vocabulary_.facts.begin(), vocabulary_.facts.end(),
                                       [&](const FactInfo& f) { return f.name == variable.name; });
        if (fact == vocabulary_.facts.end()) {
            std::vector<std::string_view> known;
            for (const FactInfo& known_ : vocabulary_.facts)
                known.push_back(known_.name);
            sink_.error("L01", variable.at,
                        "no fact is called " + inQuotes(variable.name) + suggestion(variable.name, known));
        } else {
            made.fact = static_cast<uint32_t>(fact - vocabulary_.facts.begin());
            if (!variable.unit.empty() && !fact->unit.empty() && variable.unit != fact->unit)
                sink_.error("L01", variable.at,
                            inQuotes(variable.name) + " is in " + inQuotes(fact->unit) + ", not in " +
                                inQuotes(variable.unit));
        }
        made.firstTerm = static_cast<uint32_t>(made_.terms.size());
        made.termCount = static_cast<uint32_t>(variable.terms.size());
        made.low = variable.low;
        made.high = variable.high;
        for (const Term& term : variable.terms) {
            made_.terms.push_back(term.shape);
            made_.flanks.push_back(flanksOf(term.shape));
        }
        variables_.emplace(variable.name, static_cast<uint32_t>(made_.variables.size()));
        made_.variables.push_back(made);
    }

    void compileKinds()
    {
        for (const Concept::Word& kind : base_.kinds) {
            Consequent any;
            any.kind = Consequent::Kind::Trait;
            any.name = kind.name;
            any.nameAt = kind.at;
            if (std::vector<uint32_t> outputs = targetsOf(any); !outputs.empty())
                made_.kinds.push_back(std::move(outputs));
        }
        if (!made_.kinds.empty()) return;
        made_.kinds.emplace_back(made_.outputCount);
        std::iota(made_.kinds[0].begin(), made_.kinds[0].end(), 0u);
    }

    void compileMonotony(const Monotony& promise)
    {
        Consequent about;
        about.kind = promise.isTrait ? Consequent::Kind::Trait : Consequent::Kind::Output;
        about.name = promise.name;
        about.nameAt = promise.nameAt;
        made_.monotony.push_back({variables_.at(promise.variable), targetsOf(about)});
    }

    void compileRule(const Rule& rule)
    {
        CompiledRule made;
        made.weight = rule.weight;
        made.priority = rule.priority;
        made.firstOp = static_cast<uint32_t>(made_.ops.size());
        const std::vector<CompiledOp> ops = opsOf(rule.antecedent);
        made_.ops.insert(made_.ops.end(), ops.begin(), ops.end());
        made.opCount = static_cast<uint32_t>(rule.antecedent.size());
        made.isChain = isChain(ops);
        made.firstEffect = static_cast<uint32_t>(made_.effects.size());
        made.firstVeto = static_cast<uint32_t>(made_.vetoes.size());
        compileConsequents(rule);
        made.effectCount = static_cast<uint32_t>(made_.effects.size()) - made.firstEffect;
        made.vetoCount = static_cast<uint32_t>(made_.vetoes.size()) - made.firstVeto;
        made_.rules.push_back(made);
    }

    static bool isChain(const std::vector<CompiledOp>& ops)
    {
        for (std::size_t i = 0; i < ops.size(); ++i) {
            if (ops[i].kind != (i > 0 && i % 2 == 0 ? Clause::Kind::And : Clause::Kind::Is)) return false;
        }
        return !ops.empty();
    }

    std::vector<CompiledOp> opsOf(const Antecedent& antecedent)
    {
        std::vector<CompiledOp> ops;
        uint32_t depth = 0;
        for (const Clause& clause : antecedent) {
            ops.push_back(opOf(clause));
            depth += clause.kind == Clause::Kind::Is ? 1u : clause.kind == Clause::Kind::Not ? 0u : ~0u;
            made_.stackDepth = std::max(made_.stackDepth, depth);
        }
        return ops;
    }

    CompiledOp opOf(const Clause& clause) const
    {
        CompiledOp op;
        op.kind = clause.kind;
        if (clause.kind != Clause::Kind::Is) return op;
        if (const auto found = concepts_.find(clause.variable); found != concepts_.end()) {
            op.variable = static_cast<uint32_t>(base_.variables.size()) + found->second;
            op.term = termIndex(base_.concepts[found->second], clause.term);
            op.membership = made_.concepts[found->second].firstMembership + op.term;
            return op;
        }
        op.variable = variables_.at(clause.variable); // validate() has seen it, and the term
        op.term = termIndex(base_.variables[op.variable], clause.term);
        op.membership = made_.variables[op.variable].firstTerm + op.term;
        return op;
    }

    /// In a variable or a concept.
    template <typename Owner>
    static uint32_t termIndex(const Owner& owner, std::string_view name)
    {
        const auto found =
            std::find_if(owner.terms.begin(), owner.terms.end(), [&](const auto& term) { return term.name == name; });
        return static_cast<uint32_t>(found - owner.terms.begin());
    }

    /// The present outputs a consequent speaks of, `others` excepted. Reports names nobody knows.
    std::vector<uint32_t> targetsOf(const Consequent& consequent)
    {
        std::vector<uint32_t> targets;
        if (consequent.kind == Consequent::Kind::Output && concepts_.contains(consequent.name)) return targets;
        if (consequent.kind == Consequent::Kind::Output || consequent.kind == Consequent::Kind::Never) {
            if (const auto found = outputs_.find(consequent.name); found != outputs_.end())
                targets.push_back(found->second);
            else if (!knownOutputs_.contains(consequent.name))
                sink_.error("L01", consequent.nameAt,
                            "unknown output " + inQuotes(consequent.name) + outputHint(consequent.name));
            return targets;
        }
        for (uint32_t i = 0; i < made_.outputCount; ++i) {
            const auto& traits = vocabulary_.outputs[i].traits;
            if (std::find(traits.begin(), traits.end(), consequent.name) != traits.end()) targets.push_back(i);
        }
        if (targets.empty() && !knownTraits_.contains(consequent.name))
            sink_.error("L01", consequent.nameAt,
                        "unknown trait " + inQuotes(consequent.name) +
                            suggestion(consequent.name, sorted(knownTraits_)));
        return targets;
    }

    std::string outputHint(const std::string& name) const
    {
        if (knownTraits_.contains(name)) return "; it is a trait, write 'any " + name + "'";
        std::unordered_set<std::string_view> known = knownOutputs_;
        for (const OutputInfo& output : vocabulary_.outputs)
            known.insert(output.name);
        for (const Concept& concept_ : base_.concepts)
            known.insert(concept_.name);
        return suggestion(name, sorted(known));
    }

    static std::vector<std::string_view> sorted(const std::unordered_set<std::string_view>& names)
    {
        std::vector<std::string_view> list(names.begin(), names.end());
        std::sort(list.begin(), list.end());
        return list;
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
    std::unordered_map<std::string_view, uint32_t> concepts_;
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
    const FloatMode mode; // of the coefficients that are made here
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
    made.memberships.resize(compiled_.membershipCount);
    if (!compiled_.concepts.empty()) made.strengths.resize(compiled_.rules.size());
    const std::size_t slots = std::size_t(compiled_.outputCount) * compiled_.suitabilityTerms;
    made.termStrength.resize(slots);
    made.termSum.resize(slots);
    if (!compiled_.byPriority.empty()) {
        made.claimed.resize(slots);
        made.claiming.resize(slots);
    }
    made.stack.resize(compiled_.stackDepth);
    return made;
}

std::string_view Engine::ruleId(uint32_t index) const noexcept
{
    if (index < base_.rules.size()) return base_.rules[index].id;
    return rule(index) ? std::string_view("otherwise") : std::string_view();
}

std::string_view Engine::variableName(uint32_t index) const noexcept
{
    const std::size_t variables = base_.variables.size();
    return index < variables ? base_.variables[index].name : base_.concepts[index - variables].name;
}

std::string_view Engine::termName(uint32_t index, uint32_t term) const noexcept
{
    const std::size_t variables = base_.variables.size();
    return index < variables ? base_.variables[index].terms[term].name
                             : base_.concepts[index - variables].terms[term].name;
}

const Rule* Engine::rule(uint32_t index) const noexcept
{
    if (index < base_.rules.size()) return &base_.rules[index];
    return index == base_.rules.size() && base_.otherwise ? &*base_.otherwise : nullptr;
}

} // namespace gnomon::rules
