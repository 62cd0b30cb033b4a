#include "rules/engine/explain.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "runtime/base/number_text.hpp"

namespace gnomon::rules {
namespace {

std::string padded(std::string_view text, std::size_t width)
{
    std::string result(text);
    result.resize(std::max(width, result.size()), ' ');
    return result;
}

std::string stateText(const OutputState& state)
{
    if (state.vetoed) return "vetoed";
    return state.hasOpinion ? fixedText(state.suitability, 2) : "no opinion";
}

/// Eligible outputs by falling suitability, then those without an opinion, then vetoed ones; registry order among
/// equals.
std::vector<uint32_t> ranking(const Inference& inference)
{
    std::vector<uint32_t> order(inference.outputs.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto rank = [&](uint32_t i) { return inference.outputs[i].vetoed ? -2 : inference.outputs[i].quantised; };
    std::stable_sort(order.begin(), order.end(), [&](uint32_t x, uint32_t y) { return rank(x) > rank(y); });
    return order;
}

/// The term a rule concludes for an output, or null if it says nothing about it.
const Term* conclusionFor(const Engine& engine, uint32_t rule, uint32_t output)
{
    const CompiledRules& compiled = engine.compiled();
    for (const uint32_t slot : compiled.effectsOf(compiled.rules[rule])) {
        if (slot / compiled.suitabilityTerms == output)
            return &engine.base().suitability.terms[slot % compiled.suitabilityTerms];
    }
    return nullptr;
}

/// Calls `visit(rule, slot, counts, yieldsTo)` for every conclusion about an output of every rule that fired, by
/// falling priority: with what it counts as beside higher priorities (as in Engine::conclude()) and the rule it yields
/// to.
template <typename Visit>
void forEachConclusion(const Engine& engine, const Inference& inference, Visit&& visit)
{
    struct Claim {
        double strength = 0.0;
        uint32_t rule = kNoRule;
    };
    const CompiledRules& compiled = engine.compiled();
    const uint32_t terms = compiled.suitabilityTerms;
    std::vector<Claim> claimed(inference.termStrength.size()), claiming = claimed;
    std::vector<uint32_t> order = compiled.byPriority;
    if (order.empty()) {
        order.resize(compiled.writtenRules());
        std::iota(order.begin(), order.end(), 0u);
    }
    if (compiled.hasOtherwise) order.push_back(compiled.writtenRules()); // it has what the strongest leaves in any case
    uint32_t priority = kHighestPriority;
    for (const uint32_t rule : order) {
        const double fired = inference.rules[rule].strength;
        if (fired == 0.0) continue;
        if (compiled.rules[rule].priority != priority) {
            priority = compiled.rules[rule].priority;
            claimed = claiming;
        }
        for (const uint32_t slot : compiled.effectsOf(compiled.rules[rule])) {
            Claim contrary;
            for (uint32_t other = slot / terms * terms; other < slot / terms * terms + terms; ++other)
                if (other != slot && claimed[other].strength > contrary.strength) contrary = claimed[other];
            const double counts = std::min(fired, 1.0 - contrary.strength);
            visit(rule, slot, counts, counts < fired ? contrary.rule : kNoRule);
            if (fired > claiming[slot].strength) claiming[slot] = {fired, rule};
        }
    }
}

/// What a rule that fired counts as for one output, and the rule of a higher priority that it yields to.
struct Voice {
    uint32_t rule = kNoRule;
    double counts = 0.0;
    uint32_t yieldsTo = kNoRule;
};

/// Strongest first, then by falling priority, then as written: the first is OutputState::strongestRule.
std::vector<Voice> voicesOf(const Engine& engine, const Inference& inference, uint32_t output)
{
    std::vector<Voice> voices;
    forEachConclusion(engine, inference, [&](uint32_t rule, uint32_t slot, double counts, uint32_t yieldsTo) {
        if (slot / engine.compiled().suitabilityTerms != output) return;
        if (voices.empty() || voices.back().rule != rule)
            voices.push_back({rule, counts, yieldsTo});
        else if (counts > voices.back().counts) // a second conclusion about it
            voices.back() = {rule, counts, yieldsTo};
    });
    std::stable_sort(voices.begin(), voices.end(), [](const Voice& x, const Voice& y) { return x.counts > y.counts; });
    return voices;
}

std::string yieldText(const Engine& engine, const Voice& voice)
{
    if (voice.yieldsTo == kNoRule) return {};
    return ", yields to " + std::string(engine.ruleId(voice.yieldsTo)) + ", counts " + fixedText(voice.counts, 2);
}

/// What an assertion counts as beside those of other terms and of a higher priority, as in settleConcept().
Voice voiceOf(const Engine& engine, const Inference& inference, std::span<const CompiledAssertion> all,
              const CompiledAssertion& assertion)
{
    const auto& rules = engine.compiled().rules;
    double contrary = 0.0;
    uint32_t strongest = kNoRule;
    for (const CompiledAssertion& other : all) { // by falling priority
        if (rules[other.rule].priority <= rules[assertion.rule].priority) break;
        const double strength = inference.strengths[other.rule].high;
        if (other.term != assertion.term && strength > contrary) contrary = strength, strongest = other.rule;
    }
    const double fired = inference.rules[assertion.rule].strength;
    const double counts = std::min(fired, 1.0 - contrary);
    return {assertion.rule, counts, counts < fired ? strongest : kNoRule};
}

/// One line per asserted term of every concept, with the rule that asserts it most strongly:
/// "concept scene overlyComplex 0.62: rule C1: ...".
std::string conceptLines(const Engine& engine, const Inference& inference)
{
    const CompiledRules& compiled = engine.compiled();
    std::string text;
    for (std::size_t i = 0; i < compiled.concepts.size(); ++i) {
        const CompiledConcept& concept_ = compiled.concepts[i];
        const auto all = std::span(compiled.assertions).subspan(concept_.firstAssertion, concept_.assertionCount);
        for (uint32_t term = 0; term < concept_.termCount; ++term) {
            const double truth = inference.memberships[concept_.firstMembership + term].low;
            if (truth == 0.0) continue;
            Voice strongest;
            for (const CompiledAssertion& assertion : all) {
                if (assertion.term != term) continue;
                const Voice voice = voiceOf(engine, inference, all, assertion);
                if (strongest.rule == kNoRule || voice.counts > strongest.counts) strongest = voice;
            }
            text += "concept " + engine.base().concepts[i].name + " " + engine.base().concepts[i].terms[term].name +
                    " " + fixedText(truth, 2) + ": " + explainRule(engine, inference, strongest.rule) +
                    yieldText(engine, strongest) + "\n";
        }
    }
    return text;
}

std::string because(const Engine& engine, uint32_t rule, std::size_t indent)
{
    const Rule* found = engine.rule(rule);
    return found && !found->because.empty() ? std::string(indent, ' ') + "because " + found->because + "\n" : "";
}

/// Per op of an antecedent whether an odd number of `not` stands over it: `not (a or b)` says not a and not b.
std::vector<bool> negatedOps(std::span<const CompiledOp> ops)
{
    std::vector<bool> negated(ops.size(), false);
    std::vector<std::size_t> first; // op of every operand that waits for its connective
    for (std::size_t i = 0; i < ops.size(); ++i) {
        if (ops[i].kind == Clause::Kind::Is)
            first.push_back(i);
        else if (ops[i].kind != Clause::Kind::Not)
            first.pop_back(); // two operands become one
        else
            for (std::size_t k = first.back(); k < i; ++k)
                negated[k] = !negated[k];
    }
    return negated;
}

} // namespace

std::vector<uint32_t> rulesBehind(const Engine& engine, const Inference& inference, uint32_t output)
{
    std::vector<uint32_t> behind;
    for (const Voice& voice : voicesOf(engine, inference, output))
        behind.push_back(voice.rule);
    return behind;
}

std::string yieldText(const Engine& engine, const Inference& inference, uint32_t rule, uint32_t output)
{
    for (const Voice& voice : voicesOf(engine, inference, output)) {
        if (voice.rule == rule) return yieldText(engine, voice);
    }
    return {};
}

std::vector<double> countedStrengths(const Engine& engine, const Inference& inference)
{
    const CompiledRules& compiled = engine.compiled();
    std::vector<double> counted(compiled.rules.size());
    for (std::size_t i = 0; i < counted.size(); ++i)
        counted[i] =
            compiled.byPriority.empty() || compiled.rules[i].effectCount == 0 ? inference.rules[i].strength : 0.0;
    if (compiled.byPriority.empty()) return counted;
    forEachConclusion(engine, inference, [&](uint32_t rule, uint32_t, double counts, uint32_t) {
        counted[rule] = std::max(counted[rule], counts);
    });
    return counted;
}

std::string explainRuleFor(const Engine& engine, const Inference& inference, uint32_t rule, uint32_t output)
{
    std::string text = explainRule(engine, inference, rule);
    const Term* term = conclusionFor(engine, rule, output);
    if (!term || term == &engine.base().suitability.terms.back()) return text;
    return text.insert(std::min(text.find(':'), text.size()), " (" + term->name + ")");
}

uint32_t silentRuleFor(const Engine& engine, const Inference& inference, uint32_t output)
{
    uint32_t best = kNoRule;
    const Term* bestTerm = nullptr;
    for (uint32_t i = 0; i < engine.compiled().writtenRules(); ++i) {
        if (inference.rules[i].strength > 0.0) continue;
        const Term* term = conclusionFor(engine, i, output);
        if (term && (!bestTerm || term > bestTerm)) best = i, bestTerm = term; // terms ascend with suitability
    }
    return best;
}

std::string explainFact(const Engine& engine, const Inference& inference, uint32_t fact)
{
    const auto& variables = engine.compiled().variables;
    for (std::size_t i = 0; i < variables.size(); ++i) {
        if (variables[i].fact != fact) continue;
        const Variable& variable = engine.base().variables[i];
        const double value = inference.facts[fact];
        if (std::isnan(value)) return variable.name + " unknown";
        std::string text = variable.name + " " + fixedText(value, variable.isCount() ? 0 : 2);
        if (!variable.unit.empty() && !variable.isCount()) text += " " + variable.unit;
        std::vector<std::pair<double, uint32_t>> terms;
        for (uint32_t t = 0; t < variables[i].termCount; ++t)
            terms.emplace_back(-inference.memberships[variables[i].firstTerm + t].low, t);
        std::sort(terms.begin(), terms.end());
        std::string_view separator = ": ";
        for (std::size_t k = 0; k < std::min<std::size_t>(2, terms.size()); ++k) {
            if (terms[k].first == 0.0) break;
            text.append(separator).append(variable.terms[terms[k].second].name).append(" ");
            text += fixedText(-terms[k].first, 2);
            separator = ", ";
        }
        return value < variable.low || value > variable.high ? text + " (outside its universe)" : text;
    }
    return {};
}

std::string explainRule(const Engine& engine, const Inference& inference, uint32_t index)
{
    if (engine.rule(index) == nullptr) return {};
    const RuleState& state = inference.rules[index];
    const CompiledRules& compiled = engine.compiled();
    const CompiledRule& rule = compiled.rules[index];
    if (rule.opCount == 0) return "otherwise: strength " + fixedText(state.strength, 2);

    std::string text = "rule " + std::string(engine.ruleId(index)) + ":";
    const auto& ops = compiled.opsOf(rule);
    const auto clauses = std::count_if(ops.begin(), ops.end(), [](auto& op) { return op.kind == Clause::Kind::Is; });
    const std::vector<bool> negations = negatedOps(ops);
    std::string_view separator = " ";
    for (std::size_t i = 0; i < ops.size(); ++i) {
        const CompiledOp& op = ops[i];
        if (op.kind != Clause::Kind::Is) continue;
        const bool negated = negations[i];
        const bool limiting = op.variable == state.limitingVariable && op.term == state.limitingTerm;
        const double membership = inference.memberships[op.membership].low;
        const bool unknown = inference.memberships[op.membership].high != membership;
        const double truth = negated ? 1.0 - membership : membership;
        if (truth == 0.0 && state.strength > 0.0 && !limiting) continue; // an alternative that the rule did not need
        text.append(separator).append(engine.variableName(op.variable)).append(negated ? " not " : " ");
        text.append(engine.termName(op.variable, op.term))
            .append(" ")
            .append(unknown ? "unknown" : fixedText(truth, 2));
        text.append(limiting && clauses > 1 ? "*" : "");
        separator = ", ";
    }
    return rule.weight == 1.0 ? text : text + ", weight " + shortestText(rule.weight);
}

std::string reasonFor(const Engine& engine, const Inference& inference, uint32_t output)
{
    const OutputState& state = inference.outputs[output];
    if (state.vetoed) return "vetoed by " + explainRule(engine, inference, state.vetoRule);
    if (!state.hasOpinion) return "no rule that fires speaks of it";
    return explainRuleFor(engine, inference, state.strongestRule, output) +
           yieldText(engine, inference, state.strongestRule, output);
}

std::string explain(const Engine& engine, const Inference& inference, const ExplainOptions& options)
{
    std::size_t nameWidth = 0;
    for (const OutputInfo& output : engine.outputs())
        nameWidth = std::max(nameWidth, output.name.size());
    constexpr std::size_t kStateWidth = 13; // "no opinion" and three spaces
    const std::size_t indent = nameWidth + 2 + kStateWidth;

    std::string text;
    for (const uint32_t output : ranking(inference)) {
        const OutputState& state = inference.outputs[output];
        std::string line = padded(engine.outputs()[output].name, nameWidth + 2) + padded(stateText(state), kStateWidth);
        std::vector<uint32_t> rules = rulesBehind(engine, inference, output);
        rules.resize(std::min<std::size_t>(rules.size(), options.rulesPerOutput));
        if (state.vetoed) rules.insert(rules.begin(), state.vetoRule);
        for (const uint32_t rule : rules) {
            const bool isVeto = state.vetoed && rule == state.vetoRule;
            text += line;
            text += isVeto
                        ? explainRule(engine, inference, rule)
                        : explainRuleFor(engine, inference, rule, output) + yieldText(engine, inference, rule, output);
            text += '\n';
            if (options.because) text += because(engine, rule, indent);
            line.assign(indent, ' ');
        }
        if (rules.empty()) text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
    text += conceptLines(engine, inference);
    for (const CompiledVariable& variable : engine.compiled().variables) {
        if (std::isnan(inference.facts[variable.fact]))
            text += "unknown fact: " + engine.facts()[variable.fact].name + "\n";
    }
    return text;
}

} // namespace gnomon::rules
