#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "rules/engine/engine.hpp"
#include "rules/engine/sentence.hpp"

/// Rule bases put together in C++, so that the engine is tested without YAML.
namespace gnomon::rules::test {

inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The same sequence on every machine, unlike std::uniform_real_distribution. xorshift64*.
class Random {
public:
    explicit Random(uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u + 1) {}
    uint64_t bits()
    {
        state_ ^= state_ >> 12;
        state_ ^= state_ << 25;
        state_ ^= state_ >> 27;
        return state_ * 0x2545f4914f6cdd1du;
    }
    double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    double between(double low, double high) { return low + (high - low) * unit(); }
    uint32_t below(uint32_t count) { return static_cast<uint32_t>(bits() % count); }

private:
    uint64_t state_;
};

/// "t7". Not "t" + to_string(7), in which gcc 12 sees an overlap that is not there.
inline std::string numbered(std::string_view prefix, std::size_t number)
{
    return std::string(prefix).append(std::to_string(number));
}

inline Variable variable(std::string name, double low, double high, std::vector<Term> terms, std::string unit = "")
{
    Variable made;
    made.name = std::move(name);
    made.low = low;
    made.high = high;
    made.terms = std::move(terms);
    made.unit = std::move(unit);
    return made;
}

/// One variable of two terms that cross at 0.5: `low` falls and `high` rises from 0 to 1 over the universe [0, 1].
inline Variable ramp(std::string name)
{
    return variable(std::move(name), 0, 1, {{"low", {-kInf, -kInf, 0, 1}, {}}, {"high", {0, 1, kInf, kInf}, {}}});
}

inline RuleBase baseOf(std::vector<Variable> variables, std::initializer_list<std::string_view> sentences,
                       std::string_view otherwise = {})
{
    RuleBase base;
    base.name = "test";
    base.file = "test";
    base.suitability = defaultSuitability();
    base.variables = std::move(variables);
    DiagnosticSink sink("test");
    for (const std::string_view sentence : sentences) {
        Rule rule;
        rule.id = numbered("R", base.rules.size() + 1);
        REQUIRE_MESSAGE(parseRule({sentence}, rule, sink), toText(sink.all().back()));
        base.rules.push_back(rule);
    }
    if (!otherwise.empty()) {
        base.otherwise.emplace();
        REQUIRE(parseOtherwise({otherwise}, *base.otherwise, sink));
    }
    return base;
}

/// Facts named like the variables of `base`, in their order.
inline std::vector<FactInfo> factsFor(const RuleBase& base)
{
    std::vector<FactInfo> facts;
    for (const Variable& v : base.variables)
        facts.push_back({v.name, v.unit});
    return facts;
}

inline Engine engineOf(const RuleBase& base, const std::vector<OutputInfo>& outputs,
                       const std::vector<OutputInfo>& absent = {})
{
    const std::vector<FactInfo> facts = factsFor(base);
    BindResult bound = Engine::bind(base, {.facts = facts, .outputs = outputs, .absent = absent, .traits = {}});
    for (const Diagnostic& d : bound.diagnostics)
        MESSAGE(toText(d));
    REQUIRE(bound.engine.has_value());
    return *bound.engine;
}

inline Inference inferenceOf(const Engine& engine, std::initializer_list<double> facts)
{
    Inference inference = engine.makeInference();
    engine.evaluate(std::vector<double>(facts), inference);
    return inference;
}

inline bool contains(const std::string& text, std::string_view part)
{
    return text.find(part) != std::string::npos;
}

/// The findings with that id, as "line:column message".
inline std::vector<std::string> findings(const std::vector<Diagnostic>& all, std::string_view id)
{
    std::vector<std::string> found;
    for (const Diagnostic& d : all) {
        if (d.id == id) found.push_back(std::to_string(d.line) + ":" + std::to_string(d.column) + " " + d.message);
    }
    return found;
}

} // namespace gnomon::rules::test
