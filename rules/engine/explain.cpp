#include "rules/engine/explain.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "rules/engine/number_text.hpp"

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

/// One line per asserted term of every concept, with the rule that asserts it most strongly:
/// "concept scene overlyComplex 0.62: rule C1: ...".
std::string conceptLines(const Engine& engine, const Inference& inference)
{
    const CompiledRules& compiled = engine.compiled();
    std::string text;
    for (std::size_t i = 0; i < compiled.concepts.size(); ++i) {
        const CompiledConcept& concept_ = compiled.concepts[i];
        for (uint32_t term = 0; term < concept_.termCount; ++term) {
            const double truth = inference.memberships[concept_.firstMembership + term].low;
            if (truth == 0.0) continue;
            uint32_t strongest = kNoRule;
            for (uint32_t a = concept_.firstAssertion; a < concept_.firstAssertion + concept_.assertionCount; ++a) {
                const CompiledAssertion& assertion = compiled.assertions[a];
                if (assertion.term == term && (strongest == kNoRule || inference.rules[assertion.rule].strength >
                                                                           inference.rules[strongest].strength))
                    strongest = assertion.rule;
            }
            text += "concept " + engine.base().concepts[i].name + " " + engine.base().concepts[i].terms[term].name +
                    " " + fixedText(truth, 2) + ": " + explainRule(engine, inference, strongest) + "\n";
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
    std::vector<uint32_t> fired;
    for (uint32_t i = 0; i < inference.rules.size(); ++i) {
        if (inference.rules[i].strength > 0.0 && conclusionFor(engine, i, output)) fired.push_back(i);
    }
    std::stable_sort(fired.begin(), fired.end(),
                     [&](uint32_t x, uint32_t y) { return inference.rules[x].strength > inference.rules[y].strength; });
    return fired;
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
    return explainRuleFor(engine, inference, state.strongestRule, output);
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
            text += isVeto ? explainRule(engine, inference, rule) : explainRuleFor(engine, inference, rule, output);
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
