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
    const RuleBase weaker =
        with(base, "if y is not low and x is not low then left is acceptable with 0.5"); // less, so not the same
    CHECK(findings(lintOf(weaker), "L05").empty());
    CHECK(contains(findings(lintOf(weaker), "L03").at(0), "rule 'added' changes nothing: rule 'first' covers it"));
    RuleBase exception = weaker;
    exception.rules.back().priority = 1; // weaker, yet first to claim
    CHECK(findings(lintOf(exception), "L05").empty());
    CHECK(findings(lintOf(exception), "L03").empty());
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

TEST_CASE("L06: of counts beyond thousands every whole number matters, and nothing between them")
{
    const auto l06 = [](double low, double high, std::vector<Term> terms) {
        return findingsIn(variable("v", low, high, std::move(terms), "count"), "L06");
    };
    const Term few{"few", {-kInf, -kInf, 9000, 9000}, {}};
    CHECK(l06(0, 1e12, {few, {"many", {9001, 9001, kInf, kInf}, {}}}).empty());
    const auto found = l06(0, 1e12, {few, {"many", {9002, 9002, kInf, kInf}, {}}});
    REQUIRE(found.size() == 1);
    CHECK(contains(found[0], "leave a hole at 9001"));
    CHECK(l06(-1e12, 1e12, {{"few", {-kInf, -kInf, 1e6, 3e6}, {}}, {"many", {1e6, 3e6, kInf, kInf}, {}}}).empty());
}

TEST_CASE("findings that every pair of rules may give are counted beyond the first ones")
{
    std::string_view same = "if x is high then left is favoured", other = "if x is high then left is avoided";
    RuleBase base = soundBase();
    for (std::size_t i = 0; i < 40; ++i)
        base = with(with(base, same), other);
    for (std::size_t i = 0; i < base.rules.size(); ++i)
        base.rules[i].id = numbered("R", i);
    for (const char* id : {"L04", "L05"}) {
        const auto found = findings(lintOf(base), id);
        REQUIRE(found.size() == 65);
        CHECK(contains(found.back(), " more findings of this kind"));
    }
    CHECK(contains(findings(lintOf(base), "L05").back(), "1496 more")); // 2 x 780 pairs
}

TEST_CASE("L06: suitability terms outside the closed form are reported")
{
    RuleBase base = soundBase();
    base.suitability.terms[0].shape = {-kInf, -kInf, 0.2, 0.7};
    const auto found = findings(lintOf(base), "L06");
    REQUIRE(found.size() == 2);
    CHECK(contains(found[1], "slow general form"));
}

TEST_CASE("L02: situations that only a whisper speaks of are found by sampling, unless otherwise is there")
{
    const auto base = [](std::string_view otherwise) {
        return baseOf({ramp("x")},
                      {"if x is high then left is favoured and others are avoided",
                       "if x is low then right is favoured and others are avoided with 0.09"},
                      otherwise);
    };
    const auto found = findings(lintOf(base("")), "L02");
    REQUIRE(found.size() == 1);
    CHECK(contains(found[0], "no rule is stronger than 0.1 in"));
    CHECK(contains(found[0], "for example where x = 0"));
    CHECK(findings(lintOf(base("left is acceptable and right is acceptable")), "L02").empty());
}

TEST_CASE("L02: what minimumStrength silences is a hole, with its ends where the rules fall silent")
{
    RuleBase base = baseOf({ramp("x")}, {"if x is high then left is favoured and others are avoided with 0.5",
                                         "if x is low then right is favoured and others are avoided with 0.5"});
    CHECK(findings(lintOf(base), "L02").empty());
    base.options.minimumStrength = 0.375; // heard from a truth of 0.75 on
    const auto found = findings(lintOf(base), "L02");
    REQUIRE(found.size() == 1);
    INFO(found[0]);
    CHECK(contains(found[0], "0.25 < x < 0.75"));
    // `otherwise` speaks up there, unless it is too weak.
    RuleBase spoken = baseOf({ramp("x")},
                             {"if x is high then left is favoured and right is avoided with 0.5",
                              "if x is low then right is favoured and left is avoided with 0.5"},
                             "left is acceptable and right is acceptable");
    spoken.options.minimumStrength = 0.375;
    CHECK(findings(lintOf(spoken), "L02").empty());
    spoken.otherwise->weight = 0.25;
    CHECK(findings(lintOf(spoken), "L02").size() == 1);
    // Two partly true conditions may never be heard together.
    base = with(soundBase(), "if x is high and x is low then left is acceptable");
    CHECK(findings(lintOf(base), "L03").empty());
    base.options.minimumStrength = 0.6;
    CHECK(findings(lintOf(base), "L03").size() == 1);
}

TEST_CASE("L04: two rules that favour and avoid one output at once are found, a declared exception is not")
{
    RuleBase base = with(soundBase(), "if x is high and y is high then left is avoided");
    const auto found = findings(lintOf(base), "L04");
    REQUIRE(found.size() == 1);
    CHECK(contains(found[0], "rules 'R1' and 'added' favour and avoid left at once, with strength 1.00"));
    base.rules.back().priority = 1;
    CHECK(findings(lintOf(base), "L04").empty());
    // Neighbouring terms cross at one half; that much contradiction is in every rule base.
    CHECK(findings(lintOf(with(soundBase(), "if x is low and y is high then left is avoided")), "L04").empty());
    CHECK(findings(lintOf(with(soundBase(), "if x is high and y is high then left is acceptable")), "L04").empty());
    CHECK(
        findings(lintOf(with(soundBase(), "if x is high and y is high then left is avoided with 0.5")), "L04").empty());
    const auto half =
        findings(lintOf(with(soundBase(), "if not x is low and y is high then left is avoided with 0.7")), "L04");
    REQUIRE(half.size() == 1);
    CHECK(contains(half[0], "with strength 0.70"));
}

TEST_CASE("L04: crisp terms that share an edge contradict each other nowhere else, whole numbers only where they are")
{
    const auto crisp = [](double secondFrom, std::string unit) {
        return baseOf({variable("n", 0, 9,
                                {{"few", {-kInf, -kInf, 4, 4}, {}}, {"many", {secondFrom, secondFrom, kInf, kInf}, {}}},
                                std::move(unit))},
                      {"if n is few then left is favoured and right is avoided",
                       "if n is many then left is avoided and right is favoured"});
    };
    CHECK(findings(lintOf(crisp(4, "")), "L04").empty());
    CHECK(findings(lintOf(crisp(3.5, "")), "L04").size() == 1);
    CHECK(findings(lintOf(crisp(3.5, "count")), "L04").size() == 1); // 4 is both
    CHECK(findings(lintOf(crisp(4.5, "count")), "L04").empty());
}

TEST_CASE("L07: an output that is favoured but never wins, and ties that only order decides")
{
    const auto found = findings(lintOf(with(soundBase(), "if x is high and y is high then third is favoured with 0.3"),
                                       {{"left", {}}, {"right", {}}, {"third", {}}}),
                                "L07");
    REQUIRE(found.size() == 1);
    CHECK(contains(found[0], "third never wins, though rule 'added' favours it"));

    const RuleBase twins = baseOf({ramp("x")}, {"if x is high or low then left is favoured and right is favoured"});
    const auto ties = findings(lintOf(twins), "L07");
    REQUIRE(ties.size() == 1);
    CHECK(contains(ties[0], "only the order of the outputs decides in"));
    CHECK(contains(ties[0], "between left and right where x = "));
}

TEST_CASE("L07: only outputs of one kind compete")
{
    RuleBase base = soundBase();
    const std::vector<OutputInfo> outputs = {{"left", {"spot"}}, {"right", {"spot"}}, {"twin", {"point"}}};
    base = with(base, "if x is high or x is low then twin is favoured");
    CHECK(findings(lintOf(base, outputs), "L07").size() == 1); // ties with whoever wins
    base.kinds = {{"spot", {}}, {"point", {}}};
    CHECK(findings(lintOf(base, outputs), "L07").empty());
    base.kinds = {{"spotty", {}}};
    CHECK(contains(lintOf(base, outputs).at(0).message, "unknown trait 'spotty'"));
}

TEST_CASE("L08: a trace that lingers on a boundary closer than its noise is reported, one that stays away is not")
{
    const Engine engine = engineOf(soundBase(), kTwo); // changes over at x = 0.5, whatever y is
    const std::vector<double> noise = {0.02, 0.02};
    std::vector<double> lingering, away;
    for (int i = 0; i < 100; ++i) {
        lingering.insert(lingering.end(), {i < 8 ? 0.51 : 0.8, 0.5});
        away.insert(away.end(), {i < 4 ? 0.51 : 0.8, 0.5});
    }
    const auto found = findings(lintTrace(engine, {lingering, noise}), "L08");
    REQUIRE(found.size() == 1);
    CHECK(contains(found[0], "noise of 0.02 in 'x' overturns the decision in 8.0 % of the trace, first in frame 0"));
    CHECK(lintTrace(engine, {away, noise}).empty());
    CHECK(lintTrace(engine, {lingering, std::vector<double>{0.005, 0.02}}).empty());

    // Without numbers for the noise it is taken from the trace: frames that jump by 0.03.
    std::vector<double> jumping;
    for (int i = 0; i < 100; ++i)
        jumping.insert(jumping.end(), {0.49 + 0.03 * (i % 2), 0.5});
    CHECK(findings(lintTrace(engine, {jumping, {}}), "L08").size() == 1);
    CHECK(lintTrace(engine, {}).empty());

    // Of two lights one behind the other: the step from the last frame of one to the first of the next is no noise.
    std::vector<double> pair;
    std::vector<uint32_t> frames;
    for (uint32_t i = 0; i < 100; ++i) {
        pair.insert(pair.end(), {i % 2 ? 0.8 : 0.49, 0.5});
        frames.push_back(i % 2 ? i : 200 - i);
    }
    CHECK(findings(lintTrace(engine, {pair, {}}), "L08").size() == 1);
    CHECK(lintTrace(engine, {pair, {}, frames}).empty());
    frames = {17};
    CHECK(contains(lintTrace(engine, {std::vector<double>{0.49, 0.5}, noise, frames}).at(0).message, "in frame 17"));
}

TEST_CASE("L09: a promise that does not hold is reported with the facts that break it")
{
    const auto promising = [](std::string_view promise) {
        RuleBase base = soundBase(); // x high favours left
        base.monotony.emplace_back();
        DiagnosticSink sink("promise");
        REQUIRE(parseMonotony({promise}, base.monotony.back(), sink));
        return findings(lintOf(base), "L09");
    };
    CHECK(promising("more x never lowers left").empty());
    CHECK(promising("less x never raises left").empty());
    CHECK(promising("more y never raises right").empty());
    const auto found = promising("more x never raises left");
    REQUIRE(found.size() == 1);
    CHECK(contains(found[0], "1:6 'more x never raises left' does not hold: left goes from 0.16 to "));
    CHECK(promising("less x never lowers left").size() == 1);

    RuleBase base = soundBase();
    base.monotony = {{"z", true, true, false, "left", {}, {}, ""}};
    CHECK(contains(lintOf(base).at(0).message, "unknown variable 'z'"));
    base.monotony = {{"x", true, true, true, "soft", {}, {}, ""}};
    CHECK(contains(lintOf(base).at(0).message, "unknown trait 'soft'"));
}

TEST_CASE("L10: where the floor holds and every output is vetoed or too poor, the floor cannot be kept")
{
    RuleBase base = with(soundBase(), "if y is high then never left");
    DiagnosticSink sink("floor");
    REQUIRE(parseCondition({"x is high"}, base.policy.floor.when, sink));
    CHECK(findings(lintOf(base), "L10").empty()); // right is left, as far as anybody knows
    const std::vector<OutputInfo> poorRight = {{"left", {}, 0.9}, {"right", {}, 0.5}};
    const auto found = findings(lintOf(base, poorRight), "L10");
    REQUIRE(found.size() == 1);
    CHECK(contains(found[0], "1:1 the floor asks for quality 0.8, but none of left, right may serve in"));
    CHECK(findings(lintOf(soundBase(), poorRight), "L10").empty());
    base.policy.floor.minimumQuality = 0.4;
    CHECK(findings(lintOf(base, poorRight), "L10").empty());
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
