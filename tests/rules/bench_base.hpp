#pragma once

/// The rule base that evaluation is timed on: 6 facts, 24 terms, 40 rules of 2 to 4 conditions and 3 conclusions each,
/// 12 outputs where nothing else is asked for. About the size of a full rule base for shadows.

#include <cstdlib>
#include <string>
#include <vector>

#include "rules/engine/engine.hpp"
#include "rules/engine/sentence.hpp"

namespace gnomon::rules::test {

inline std::vector<OutputInfo> benchOutputs(int count = 12)
{
    std::vector<OutputInfo> outputs;
    for (int i = 0; i < count; ++i)
        outputs.push_back({std::string("o").append(std::to_string(i)), {}});
    return outputs;
}

/// `draw(n)` gives a number below n. `rules` is 40 for timing; the linter is timed on 64.
template <typename Draw>
RuleBase benchBase(Draw&& draw, std::size_t rules, uint32_t outputs = 12)
{
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    RuleBase base;
    base.name = "bench";
    base.suitability = defaultSuitability();
    const char* const terms[] = {"t0", "t1", "t2", "t3"};
    for (int i = 0; i < 6; ++i) {
        Variable v;
        v.name = std::string("x").append(std::to_string(i));
        v.terms = {{"t0", {-kInfinity, -kInfinity, 0.1, 0.3}, {}},
                   {"t1", {0.1, 0.3, 0.4, 0.6}, {}},
                   {"t2", {0.4, 0.6, 0.7, 0.9}, {}},
                   {"t3", {0.7, 0.9, kInfinity, kInfinity}, {}}};
        base.variables.push_back(v);
    }
    while (base.rules.size() < rules) {
        std::string text = "if ";
        const uint32_t first = draw(6), conditions = 2 + draw(3);
        for (uint32_t c = 0; c < conditions; ++c) {
            text.append(c == 0 ? "" : " and ").append(base.variables[(first + c) % 6].name);
            text.append(" is ").append(terms[draw(4)]);
        }
        const uint32_t output = draw(outputs);
        for (uint32_t c = 0; c < 3; ++c) {
            const char* const names[] = {"avoided", "acceptable", "favoured"};
            text.append(c == 0 ? " then o" : " and o").append(std::to_string((output + 5 * c) % outputs));
            text.append(" is ").append(names[draw(3)]);
        }
        Rule rule;
        rule.id = std::string("R").append(std::to_string(base.rules.size()));
        DiagnosticSink sink("bench");
        if (!parseRule({text}, rule, sink)) std::abort();
        base.rules.push_back(rule);
    }
    return base;
}

} // namespace gnomon::rules::test
