#include "rules_support.hpp"

#include "rules/engine/lint.hpp"

using namespace gnomon::rules;
using namespace gnomon::rules::test;

namespace {

const std::vector<OutputInfo> kTwo = {{"left", {}}, {"right", {}}};

std::vector<Diagnostic> lintOf(const RuleBase& base, const std::vector<OutputInfo>& outputs = kTwo)
{
    const std::vector<FactInfo> facts = factsFor(base);
    return lint(base, {.facts = facts, .outputs = outputs, .absent = {}, .traits = {}});
}

/// Two rules that leave nothing open; failing examples add to it.
RuleBase soundBase()
{
    return baseOf({ramp("x"), ramp("y")}, {"if x is high then left is favoured and others are avoided",
                                           "if x is low then right is favoured and others are avoided"});
}

RuleBase with(RuleBase base, std::string_view sentence)
{
    Rule rule;
    rule.id = "added";
    DiagnosticSink sink("added");
    REQUIRE(parseRule({sentence}, rule, sink));
    base.rules.push_back(rule);
    return base;
}

std::vector<std::string> findingsIn(const Variable& variable, std::string_view id)
{
    RuleBase base = soundBase();
    base.variables.push_back(variable);
    return findings(lintOf(base), id);
}

} // namespace

TEST_CASE("a sound rule base lints clean")
{
    CHECK(lintOf(soundBase()).empty());
}

TEST_CASE("L01: unknown names and units end the lint")
{
    const std::vector<Diagnostic> found = lintOf(with(soundBase(), "if z is high then up is favoured"));
    REQUIRE(found.size() == 1);
    CHECK(found[0].id == "L01");
    CHECK(found[0].severity == Severity::Error);
    CHECK(contains(found[0].message, "unknown variable 'z'"));
    CHECK(
        contains(lintOf(with(soundBase(), "if x is hihg then left is favoured"))[0].message, "'x' has no term 'hihg'"));
    CHECK(contains(lintOf(with(soundBase(), "if x is high then left is good"))[0].message, "no term 'good'"));
}

TEST_CASE("L02: a region without a rule is reported as a box")
{
    const RuleBase base = baseOf(
        {ramp("x"),
         variable("n", 0, 20,
                  {{"none", {-kInf, -kInf, 0, 0}, {}}, {"some", {1, 1, 8, 8}, {}}, {"many", {9, 9, kInf, kInf}, {}}},
                  "count")},
        {"if n is none or many then left is favoured and others are avoided",
         "if n is some and x is low then right is favoured and others are avoided"});
    CHECK(findings(lintOf(base), "L02") ==
          std::vector<std::string>{"0:0 no rule speaks of any output where x >= 1 (high), 1 <= n <= 8 (some)"});
}

TEST_CASE("L02: an output that the rules forget somewhere is named, the others are not")
{
    const std::vector<std::string> found =
        findings(lintOf(baseOf({ramp("x")}, {"if x is high then left is favoured and right is avoided",
                                             "if x is low then right is favoured"})),
                 "L02");
    CHECK(found == std::vector<std::string>{"0:0 no rule speaks of left where x <= 0 (low)"});
}

TEST_CASE("L02: otherwise closes a hole, except where a fully true rule silences it")
{
    const auto base = [](std::string_view sentence) {
        return baseOf({ramp("x"), ramp("y")}, {sentence}, "left is acceptable and right is acceptable with 0.1");
    };
    CHECK(findings(lintOf(base("if x is high then left is favoured and right is avoided")), "L02").empty());
    const std::vector<std::string> found =
        findings(lintOf(base("if x is high and y is high then left is favoured")), "L02");
    CHECK(found == std::vector<std::string>{"0:0 no rule speaks of right where x >= 1 (high), y >= 1 (high)"});
    CHECK(findings(lintOf(base("if x is high and y is high then left is favoured with 0.9")), "L02").empty());
}

TEST_CASE("L03: a rule whose conditions exclude each other never fires")
{
    Variable n = variable("n", 0, 10, {{"few", {-kInf, -kInf, 3, 4}, {}}, {"many", {6, 7, kInf, kInf}, {}}});
    RuleBase base = soundBase();
    base.variables.push_back(n);
    const auto dead =
        findings(lintOf(with(base, "if y is high and n is few and n is many then left is avoided")), "L03");
    REQUIRE(dead.size() == 1);
    CHECK(contains(dead[0], "rule 'added' can never fire"));
    CHECK(findings(lintOf(with(base, "if n is few or n is many then left is acceptable")), "L03").empty());
    base.options.minimumStrength = 0.3;
    CHECK(findings(lintOf(with(base, "if n is few then left is acceptable with 0.2")), "L03").size() == 1);
}

TEST_CASE("L03: a rule that a broader one covers changes nothing, and a stronger one is kept")
{
    const auto l03 = [](std::string_view sentence) { return findings(lintOf(with(soundBase(), sentence)), "L03"); };
    const auto found = l03("if x is high and y is high then left is favoured with 0.9");
    REQUIRE(found.size() == 1);
    CHECK(contains(found[0], "rule 'added' changes nothing: rule 'R1' covers it"));
    CHECK(l03("if x is high and y is high then left is acceptable").empty());
    CHECK(l03("if x is high or y is high then left is favoured").empty());
    RuleBase sum = with(soundBase(), "if x is high and y is high then left is favoured");
    sum.options.aggregation = Options::Aggregation::Sum;
    CHECK(findings(lintOf(sum), "L03").empty());
}

TEST_CASE("L05: rules that say the same in other words are found")
{
    RuleBase base = with(soundBase(), "if not (x is low or y is low) then left is acceptable");
    base.rules.back().id = "first";
    const auto found = findings(lintOf(with(base, "if y is not low and x is not low then left is acceptable")), "L05");
    REQUIRE(found.size() == 1);
    CHECK(contains(found[0], "rule 'added' says the same as rule 'first'"));
    CHECK(findings(lintOf(with(base, "if y is not low and x is not low then left is favoured")), "L05").empty());
    CHECK(findings(lintOf(with(base, "if y is not low or x is not low then left is acceptable")), "L05").empty());
    CHECK(findings(
              lintOf(with(
                  base, "if y is not low and (x is not low and (x is not low or y is high)) then left is acceptable")),
              "L05")
              .size() == 1);
}

TEST_CASE("L06: holes, piles, empty terms, cut flanks and disorder of terms are found")
{
    const auto l06 = [](std::vector<Term> terms, std::string unit = "") {
        return findingsIn(variable("v", 0, 10, std::move(terms), std::move(unit)), "L06");
    };
    const Term low{"low", {-kInf, -kInf, 4, 6}, {}}, high{"high", {4, 6, kInf, kInf}, {}};
    CHECK(l06({low, high}).empty());
    const auto one = [&](const std::vector<std::string>& found, std::string_view text) {
        REQUIRE(found.size() == 1);
        CHECK_MESSAGE(contains(found[0], text), found[0]);
    };
    one(l06({low, {"high", {7, 8, kInf, kInf}, {}}}), "leave a hole at 6: the best membership there is 0.00");
    one(l06({low, {"high", {5, 6, kInf, kInf}, {}}}), "leave a hole at 5.3333333"); // crossing at one third
    one(l06({low, {"mid", {4, 5, 5, 6}, {}}, high}), "more than two terms of 'v' overlap");
    one(l06({low, high, {"beyond", {11, 12, 13, 14}, {}}}), "contains no value");
    one(l06({low, {"high", {4, 6, 9, 11}, {}}}), "still rising or falling at the edge of the universe, 10");
    one(l06({high, low}), "out of order");
    one(l06({{"low", {-kInf, -kInf, 4, 4}, {}}, {"high", {4.5, 4.5, kInf, kInf}, {}}}), "hole at 4");
    CHECK(l06({{"low", {-kInf, -kInf, 4, 4}, {}}, {"high", {5, 5, kInf, kInf}, {}}}, "count").empty());
    one(l06({{"low", {-kInf, -kInf, 4, 4}, {}}, {"odd", {4.2, 4.2, 4.8, 4.8}, {}}, {"high", {5, 5, kInf, kInf}, {}}},
            "count"),
        "contains no value");
}

TEST_CASE("L06: suitability terms outside the closed form are reported")
{
    RuleBase base = soundBase();
    base.suitability.terms[0].shape = {-kInf, -kInf, 0.2, 0.7};
    const auto found = findings(lintOf(base), "L06");
    REQUIRE(found.size() == 2);
    CHECK(contains(found[1], "slow general form"));
}

TEST_CASE("values that make no variable are refused before anything is evaluated")
{
    const auto refused = [](const Variable& v) {
        RuleBase base = soundBase();
        base.variables.push_back(v);
        const std::vector<Diagnostic> found = lintOf(base);
        return found.size() == 1 && found[0].id == "R05" && found[0].severity == Severity::Error;
    };
    const auto shape = [](Trapezoid t) { return variable("v", 0, 1, {{"t", t, {}}}); };
    CHECK(refused(shape({0.5, 0.4, 0.6, 0.7})));
    CHECK(refused(shape({kNan, 0.4, 0.6, 0.7})));
    CHECK(refused(shape({-kInf, 0.4, 0.6, 0.7})));
    CHECK(refused(shape({0.1, 0.4, 0.6, kInf})));
    CHECK(refused(shape({kInf, kInf, kInf, kInf})));
    CHECK(refused(shape({0.1, 0.1 + 1e-12, 0.6, 0.7})));
    CHECK(refused(shape({0.1, 0.2, 0.6, 1e13})));
    CHECK(refused(variable("v", 1, 1, {{"t", {0, 0, 1, 1}, {}}})));
    CHECK(refused(variable("v", 0, kInf, {{"t", {0, 0, 1, 1}, {}}})));
    CHECK(refused(variable("v", 0, 1, {})));
    CHECK(refused(variable("others", 0, 1, {{"t", {0, 0, 1, 1}, {}}})));
    CHECK(refused(variable("v", 0, 1, {{"t", {0, 0, 1, 1}, {}}, {"t", {0, 0, 1, 1}, {}}})));
}
