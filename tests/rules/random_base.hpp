#pragma once

#include "rules_support.hpp"

namespace gnomon::rules::test {

/// A rule base of `rules` random rules over six ramps and four outputs.
inline RuleBase randomBase(Random& random, std::size_t rules)
{
    RuleBase base = baseOf({ramp("a"), ramp("b"), ramp("c"), ramp("d"), ramp("e"), ramp("f")}, {});
    const std::string_view terms[] = {"avoided", "acceptable", "favoured"};
    // One draw a statement: the order within an expression is the compiler's.
    const auto clause = [&] {
        const char name = static_cast<char>('a' + random.below(6));
        const bool negated = random.below(4) == 0;
        const bool low = random.below(2) == 0;
        return std::string(1, name).append(negated ? " is not " : " is ").append(low ? "low" : "high");
    };
    for (std::size_t i = 0; i < rules; ++i) {
        std::string text = std::string("if ").append(clause());
        for (uint32_t extra = random.below(3); extra > 0; --extra) {
            text += random.below(3) == 0 ? " or " : " and ";
            text += clause();
        }
        text.append(" then ").append(numbered("o", random.below(4)));
        text.append(" is ").append(terms[random.below(3)]);
        text.append(" with ").append(numbered("0.", 1 + random.below(9)));
        Rule rule;
        rule.id = numbered("R", i);
        DiagnosticSink sink("random");
        REQUIRE(parseRule({text}, rule, sink));
        base.rules.push_back(rule);
    }
    return base;
}

inline const std::vector<OutputInfo> kFour = {{"o0", {}}, {"o1", {}}, {"o2", {}}, {"o3", {}}};

inline std::vector<double> randomFacts(Random& random)
{
    std::vector<double> facts(6);
    for (double& fact : facts)
        fact = random.between(-0.2, 1.2);
    return facts;
}

/// The same with everything else a base may have, switched on at random: options, concepts, priorities, vetoes, traits,
/// `others`, `otherwise`, a floor, and terms of suitability in the closed and in the general form.
inline RuleBase anyBase(Random& random, std::size_t rules)
{
    RuleBase base = randomBase(random, rules);
    const auto one = [&](uint32_t in) { return random.below(in) == 0; };
    const auto add = [&](std::string_view sentence) {
        Rule rule;
        rule.id = numbered("S", base.rules.size());
        DiagnosticSink sink("random");
        REQUIRE_MESSAGE(parseRule({sentence}, rule, sink), sentence);
        base.rules.push_back(rule);
    };
    base.options.conjunction = one(3) ? Options::And::Product : Options::And::Min;
    base.options.aggregation = one(3) ? Options::Aggregation::Sum : Options::Aggregation::Max;
    if (one(4)) base.options.minimumStrength = 0.2;
    if (one(4)) base.options.samples = 10;
    if (one(4)) base.suitability.terms[0].shape = {-kInf, -kInf, 0.2, 0.7}; // reaches over its neighbour
    if (one(2)) {
        base.concepts = {{"scene", {{"calm", {}}, {"busy", {}}}, {}}, {"load", {{"heavy", {}}}, {}}};
        add("if load is heavy and not (e is low or scene is calm) then o0 is avoided and o3 is favoured");
        add("if scene is busy or f is high then load is heavy with 0.8");
        add("if a is high and b is low then scene is busy");
        add("if c is high then scene is calm and o1 is acceptable");
    }
    if (one(2)) {
        add("if not (a is low and (b is high or not c is low)) then never o1");
        add("if d is high and e is low then never any soft");
    }
    if (one(2)) add("if b is high then any soft is favoured and others are avoided with 0.5");
    if (one(3)) {
        for (Rule& rule : base.rules)
            rule.priority = random.below(3);
    }
    DiagnosticSink sink("random");
    if (one(2)) {
        base.otherwise.emplace();
        REQUIRE(parseOtherwise({"o0 is acceptable and o2 is acceptable with 0.4"}, *base.otherwise, sink));
    }
    if (one(2)) REQUIRE(parseCondition({"a is high and (b is low or not c is high)"}, base.policy.floor.when, sink));
    return base;
}

inline const std::vector<OutputInfo> kFourWithTrait = {{"o0", {}}, {"o1", {"soft"}}, {"o2", {"soft"}}, {"o3", {}}};

} // namespace gnomon::rules::test
