#include "rules/engine/rule_base.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <unordered_set>

#include "rules/engine/centroid.hpp"
#include "rules/engine/concepts.hpp"
#include "runtime/base/number_text.hpp"

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
    if (!isName(variable.name)) sink.error("R05", variable.at, inQuotes(variable.name) + " cannot be a name");
    const double width = variable.high - variable.low;
    if (!inRange(variable.low) || !inRange(variable.high) || !(width >= 1e-9)) {
        sink.error("R05", variable.at, "the universe of " + inQuotes(variable.name) + " must be two ascending numbers");
        return;
    }
    if (variable.terms.empty() || variable.terms.size() > kMaxTerms)
        sink.error("R05", variable.at,
                   inQuotes(variable.name) + " needs between 1 and " + std::to_string(kMaxTerms) + " terms");
    std::unordered_set<std::string_view> seen;
    for (const Term& term : variable.terms) {
        if (!isName(term.name)) sink.error("R05", term.at, inQuotes(term.name) + " cannot be a name");
        if (!seen.insert(term.name).second)
            sink.error("R05", term.at, "term " + inQuotes(term.name) + " is defined twice");
        if (const std::string fault = cornerFault(term.shape, width); !fault.empty())
            sink.error("R05", term.at, "term " + inQuotes(term.name) + ": " + fault);
    }
}

/// A term without width has a weight, one with width an area, and there is no measure for both: all have one, or none.
void checkWidths(const Variable& suitability, DiagnosticSink& sink)
{
    const Term* wide = nullptr;
    const Term* point = nullptr;
    for (const Term& term : suitability.terms) {
        const Trapezoid shape = withinUniverse(term.shape, suitability.low, suitability.high);
        if (shape.a < shape.d) {
            wide = &term;
        } else if (shape.a >= suitability.low && shape.a <= suitability.high) {
            point = &term;
        } else {
            sink.error("R05", term.at, "term " + inQuotes(term.name) + " lies outside the universe");
        }
    }
    if (wide && point)
        sink.error("R05", point->at,
                   "term " + inQuotes(point->name) + " of suitability has no width, so no weight beside the area of " +
                       inQuotes(wide->name) + "; give all terms a width, or none");
}

void checkConcept(const Concept& concept_, DiagnosticSink& sink)
{
    if (!isName(concept_.name)) sink.error("R05", concept_.at, inQuotes(concept_.name) + " cannot be a name");
    if (concept_.terms.empty() || concept_.terms.size() > kMaxTerms)
        sink.error("R05", concept_.at,
                   inQuotes(concept_.name) + " needs between 1 and " + std::to_string(kMaxTerms) + " terms");
    std::unordered_set<std::string_view> seen;
    for (const Concept::Word& word : concept_.terms) {
        if (!isName(word.name)) sink.error("R05", word.at, inQuotes(word.name) + " cannot be a name");
        if (!seen.insert(word.name).second)
            sink.error("R05", word.at, "term " + inQuotes(word.name) + " is defined twice");
    }
}

/// What a sentence may ask for.
struct Names {
    std::unordered_map<std::string_view, const Variable*> variables;
    std::unordered_map<std::string_view, const Concept*> concepts;
};

/// `Owner` is a variable or a concept.
template <typename Owner>
bool hasTerm(const Owner& owner, std::string_view name)
{
    return std::any_of(owner.terms.begin(), owner.terms.end(), [&](const auto& t) { return t.name == name; });
}

/// Names that sentences use and nobody defines: a finding for each, at its first place.
class UnknownNames {
public:
    template <typename Owner>
    void requireTerm(const Owner& owner, std::string_view name, SourceSpot at)
    {
        if (hasTerm(owner, name)) return;
        std::vector<std::string_view> known;
        for (const auto& term : owner.terms)
            known.push_back(term.name);
        add(inQuotes(owner.name) + " has no term " + inQuotes(name) + suggestion(name, known), at);
    }

    void variable(std::string_view name, SourceSpot at, const Names& names)
    {
        std::vector<std::string_view> known;
        for (const auto& [variable, ignored] : names.variables)
            known.push_back(variable);
        for (const auto& [concept_, ignored] : names.concepts)
            known.push_back(concept_);
        std::sort(known.begin(), known.end()); // the map has no order
        add("unknown variable " + inQuotes(name) + suggestion(name, known), at);
    }

    void report(DiagnosticSink& sink) const
    {
        for (const Finding& finding : findings_)
            sink.error("L01", finding.at,
                       finding.text +
                           (finding.places > 1 ? " (in " + std::to_string(finding.places) + " places)" : ""));
    }

private:
    struct Finding {
        std::string text;
        SourceSpot at;
        std::size_t places = 1;
    };

    void add(std::string text, SourceSpot at)
    {
        const auto same = [&](const Finding& finding) { return finding.text == text; };
        const auto found = std::find_if(findings_.begin(), findings_.end(), same);
        if (found != findings_.end())
            ++found->places;
        else
            findings_.push_back({std::move(text), at});
    }

    std::vector<Finding> findings_;
};

void checkAntecedent(const Antecedent& antecedent, const Names& names, UnknownNames& unknown)
{
    for (const Clause& clause : antecedent) {
        if (clause.kind != Clause::Kind::Is) continue;
        const auto variable = names.variables.find(clause.variable);
        const auto concept_ = names.concepts.find(clause.variable);
        if (variable != names.variables.end())
            unknown.requireTerm(*variable->second, clause.term, clause.termAt);
        else if (concept_ != names.concepts.end())
            unknown.requireTerm(*concept_->second, clause.term, clause.termAt);
        else
            unknown.variable(clause.variable, clause.variableAt, names);
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

/// Conclusions about concepts: which term, and what they may stand beside.
void checkConsequents(const Rule& rule, bool isOtherwise, const RuleBase& base, const Names& names,
                      UnknownNames& unknown, DiagnosticSink& sink)
{
    bool speaksOfOutputs = false;
    const Consequent* others = nullptr;
    for (const Consequent& consequent : rule.consequents) {
        const auto concept_ = names.concepts.find(consequent.name);
        const bool asserts = consequent.kind == Consequent::Kind::Output && concept_ != names.concepts.end();
        if (asserts && isOtherwise)
            sink.error("R06", consequent.nameAt, "'otherwise' speaks of outputs only: concepts are settled before it");
        if (asserts) {
            unknown.requireTerm(*concept_->second, consequent.term, consequent.termAt);
            continue;
        }
        if (consequent.kind == Consequent::Kind::Others)
            others = &consequent;
        else
            speaksOfOutputs = true;
        if (consequent.isVeto()) continue;
        unknown.requireTerm(base.suitability, consequent.term, consequent.termAt);
    }
    if (others && !speaksOfOutputs && rule.consequents.size() > 1)
        sink.error("R06", others->nameAt, "'others' needs a conclusion about an output; this sentence has none");
}

/// An id stands in messages and logs of one line, and "otherwise" there is the rule of that name.
void checkId(const Rule& rule, DiagnosticSink& sink)
{
    const auto isControl = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; };
    if (std::any_of(rule.id.begin(), rule.id.end(), isControl))
        sink.error("R05", rule.at, "the id of a rule holds a control character");
    else if (rule.id.size() > kMaxNameBytes)
        sink.error("R05", rule.at, "the id of a rule is longer than " + std::to_string(kMaxNameBytes) + " bytes");
    else if (rule.id == "otherwise")
        sink.error("R05", rule.at, "'otherwise' cannot be the id of a rule");
}

void checkRule(const Rule& rule, bool isOtherwise, const RuleBase& base, const Names& names, UnknownNames& unknown,
               DiagnosticSink& sink)
{
    if (!isOtherwise && !isWellFormed(rule.antecedent))
        sink.error("R06", rule.at, "the antecedent of rule " + inQuotes(rule.id) + " is not a postfix expression");
    if (!(rule.weight > 0.0 && rule.weight <= 1.0))
        sink.error("R05", rule.at, "the weight of rule " + inQuotes(rule.id) + " must be above 0 and at most 1");
    if (rule.priority > kHighestPriority)
        sink.error("R05", rule.at,
                   "the priority of rule " + inQuotes(rule.id) + " must be at most " +
                       std::to_string(kHighestPriority));
    if (rule.consequents.empty()) sink.error("R06", rule.at, "rule " + inQuotes(rule.id) + " concludes nothing");
    checkAntecedent(rule.antecedent, names, unknown);
    checkConsequents(rule, isOtherwise, base, names, unknown, sink);
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
    if (base.concepts.size() > kMaxConcepts)
        sink.error("R07", {}, "more than " + std::to_string(kMaxConcepts) + " concepts");
    Names names;
    for (const Variable& variable : base.variables) {
        checkVariable(variable, sink);
        if (!names.variables.emplace(variable.name, &variable).second)
            sink.error("R05", variable.at, "variable " + inQuotes(variable.name) + " is defined twice");
    }
    for (const Concept& concept_ : base.concepts) {
        checkConcept(concept_, sink);
        if (names.variables.contains(concept_.name) || !names.concepts.emplace(concept_.name, &concept_).second)
            sink.error("R05", concept_.at, "two variables or concepts are called " + inQuotes(concept_.name));
    }
    checkVariable(base.suitability, sink);
    checkWidths(base.suitability, sink);
    std::unordered_set<std::string_view> ids;
    UnknownNames unknown;
    for (const Rule& rule : base.rules) {
        if (!ids.insert(rule.id).second) sink.error("R05", rule.at, "two rules are called " + inQuotes(rule.id));
        checkId(rule, sink);
        checkRule(rule, false, base, names, unknown, sink);
    }
    if (base.otherwise) checkRule(*base.otherwise, true, base, names, unknown, sink);
    if (!base.policy.floor.when.empty() && !isWellFormed(base.policy.floor.when))
        sink.error("R06", {}, "the condition of the floor is not a postfix expression");
    checkAntecedent(base.policy.floor.when, names, unknown);
    for (const Monotony& promise : base.monotony) {
        if (!names.variables.contains(promise.variable)) unknown.variable(promise.variable, promise.variableAt, names);
    }
    unknown.report(sink);
    if (sink.errorCount() == before) orderConcepts(base, sink);
    return sink.errorCount() == before;
}

} // namespace gnomon::rules
