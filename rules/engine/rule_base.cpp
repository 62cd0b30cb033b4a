#include "rules/engine/rule_base.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <unordered_set>

#include "rules/engine/number_text.hpp"

namespace gnomon::rules {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Flanks must be vertical or at least this share of the universe: below, (x - a) / (b - a) loses its meaning, and with
/// denormals flushed to zero it could become 0 / 0.
constexpr double kNarrowestFlank = 1e-9;

bool inRange(double value) noexcept
{
    return value >= -kMaxMagnitude && value <= kMaxMagnitude;
}

std::string cornerFault(const Trapezoid& shape, double width)
{
    const std::array<double, 4> corners = {shape.a, shape.b, shape.c, shape.d};
    for (const double corner : corners) {
        if (std::isnan(corner) || (std::isfinite(corner) && !inRange(corner)))
            return "a corner is not a number within +-" + shortestText(kMaxMagnitude);
    }
    if (!std::is_sorted(corners.begin(), corners.end())) return "corners must ascend: a <= b <= c <= d";
    if (shape.a == kInfinity || shape.d == -kInfinity || shape.b == kInfinity || shape.c == -kInfinity)
        return "the core lies at infinity";
    if ((shape.a == -kInfinity) != (shape.b == -kInfinity) || (shape.c == kInfinity) != (shape.d == kInfinity))
        return "a shoulder needs both corners infinite: a = b = -.inf or c = d = .inf";
    const auto tooThin = [width](double from, double to) {
        return from != to && std::isfinite(from) && std::isfinite(to) && to - from < kNarrowestFlank * width;
    };
    if (tooThin(shape.a, shape.b) || tooThin(shape.c, shape.d))
        return "a flank is neither vertical nor at least 1e-9 of the universe wide";
    return {};
}

void checkVariable(const Variable& variable, DiagnosticSink& sink)
{
    if (!isName(variable.name)) sink.error("R05", variable.at, quoted(variable.name) + " cannot be a name");
    const double width = variable.high - variable.low;
    if (!inRange(variable.low) || !inRange(variable.high) || !(width >= 1e-9)) {
        sink.error("R05", variable.at, "the universe of " + quoted(variable.name) + " must be two ascending numbers");
        return;
    }
    if (variable.terms.empty() || variable.terms.size() > kMaxTerms)
        sink.error("R05", variable.at,
                   quoted(variable.name) + " needs between 1 and " + std::to_string(kMaxTerms) + " terms");
    std::unordered_set<std::string_view> seen;
    for (const Term& term : variable.terms) {
        if (!isName(term.name)) sink.error("R05", term.at, quoted(term.name) + " cannot be a name");
        if (!seen.insert(term.name).second)
            sink.error("R05", term.at, "term " + quoted(term.name) + " is defined twice");
        if (const std::string fault = cornerFault(term.shape, width); !fault.empty())
            sink.error("R05", term.at, "term " + quoted(term.name) + ": " + fault);
    }
}

using VariableIndex = std::unordered_map<std::string_view, const Variable*>;

bool hasTerm(const Variable& variable, std::string_view name)
{
    return std::any_of(variable.terms.begin(), variable.terms.end(), [&](const Term& t) { return t.name == name; });
}

std::string unknownTerm(const Variable& variable, std::string_view name)
{
    std::string text = quoted(variable.name) + " has no term " + quoted(name) + "; it has";
    for (const Term& term : variable.terms)
        text += " " + term.name;
    return text;
}

void checkAntecedent(const Antecedent& antecedent, const VariableIndex& variables, DiagnosticSink& sink)
{
    for (const Clause& clause : antecedent) {
        if (clause.kind != Clause::Kind::Is) continue;
        const auto found = variables.find(clause.variable);
        if (found == variables.end())
            sink.error("L01", clause.variableAt, "unknown variable " + quoted(clause.variable));
        else if (!hasTerm(*found->second, clause.term))
            sink.error("L01", clause.termAt, unknownTerm(*found->second, clause.term));
    }
}

/// Parsed antecedents are well formed by construction; one that a program put together may not be.
bool isWellFormed(const Antecedent& antecedent)
{
    std::size_t depth = 0;
    for (const Clause& clause : antecedent) {
        const bool binary = clause.kind == Clause::Kind::And || clause.kind == Clause::Kind::Or;
        const std::size_t operands = binary ? 2 : clause.kind == Clause::Kind::Not ? 1 : 0;
        if (depth < operands) return false;
        depth = depth - operands + 1;
    }
    return depth == 1;
}

void checkRule(const Rule& rule, bool isOtherwise, const RuleBase& base, const VariableIndex& variables,
               DiagnosticSink& sink)
{
    if (!isOtherwise && !isWellFormed(rule.antecedent))
        sink.error("R06", rule.at, "the antecedent of rule " + quoted(rule.id) + " is not a postfix expression");
    if (!(rule.weight > 0.0 && rule.weight <= 1.0))
        sink.error("R05", rule.at, "the weight of rule " + quoted(rule.id) + " must be above 0 and at most 1");
    if (rule.consequents.empty()) sink.error("R06", rule.at, "rule " + quoted(rule.id) + " concludes nothing");
    checkAntecedent(rule.antecedent, variables, sink);
    for (const Consequent& consequent : rule.consequents) {
        if (!consequent.isVeto() && !hasTerm(base.suitability, consequent.term))
            sink.error("L01", consequent.termAt, unknownTerm(base.suitability, consequent.term));
    }
}

void checkOptions(const Options& options, DiagnosticSink& sink)
{
    if (!(options.minimumStrength >= 0.0 && options.minimumStrength < 1.0))
        sink.error("R05", {}, "minimumStrength must be in [0, 1)");
    if (!(options.vetoAt > 0.0 && options.vetoAt <= 1.0)) sink.error("R05", {}, "vetoAt must be in (0, 1]");
}

} // namespace

Variable defaultSuitability()
{
    Variable made;
    made.name = "suitability";
    made.terms = {{"avoided", {-kInfinity, -kInfinity, 0.2, 0.4}, {}},
                  {"acceptable", {0.2, 0.4, 0.6, 0.8}, {}},
                  {"favoured", {0.6, 0.8, kInfinity, kInfinity}, {}}};
    return made;
}

bool validate(const RuleBase& base, DiagnosticSink& sink)
{
    const uint32_t before = sink.errorCount();
    checkOptions(base.options, sink);
    if (base.variables.size() > kMaxVariables)
        sink.error("R07", {}, "more than " + std::to_string(kMaxVariables) + " variables");
    if (base.rules.size() > kMaxRules) sink.error("R07", {}, "more than " + std::to_string(kMaxRules) + " rules");
    VariableIndex variables;
    for (const Variable& variable : base.variables) {
        checkVariable(variable, sink);
        if (!variables.emplace(variable.name, &variable).second)
            sink.error("R05", variable.at, "variable " + quoted(variable.name) + " is defined twice");
    }
    checkVariable(base.suitability, sink);
    std::unordered_set<std::string_view> ids;
    for (const Rule& rule : base.rules) {
        if (!ids.insert(rule.id).second) sink.error("R05", rule.at, "two rules are called " + quoted(rule.id));
        checkRule(rule, false, base, variables, sink);
    }
    if (base.otherwise) checkRule(*base.otherwise, true, base, variables, sink);
    if (!base.policy.floor.when.empty() && !isWellFormed(base.policy.floor.when))
        sink.error("R06", {}, "the condition of the floor is not a postfix expression");
    checkAntecedent(base.policy.floor.when, variables, sink);
    return sink.errorCount() == before;
}

} // namespace gnomon::rules
