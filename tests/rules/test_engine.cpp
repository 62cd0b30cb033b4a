#include "random_base.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "allocation_count.hpp"
#include "rules/engine/explain.hpp"

using namespace gnomon;
using namespace gnomon::rules;
using namespace gnomon::rules::test;

namespace {

const std::vector<OutputInfo> kTwo = {{"left", {}}, {"right", {}}};

void checkSame(const Inference& x, const Inference& y)
{
    for (std::size_t i = 0; i < x.outputs.size(); ++i) {
        CHECK(x.outputs[i].hasOpinion == y.outputs[i].hasOpinion);
        CHECK(x.outputs[i].suitability == y.outputs[i].suitability); // bit for bit
        CHECK(x.outputs[i].quantised == y.outputs[i].quantised);
    }
}

} // namespace

TEST_CASE("the worked example of Rautenbach 2008, 5.3, in both arithmetics")
{
    const auto partition = [](std::string name, double high, Trapezoid low, Trapezoid average, Trapezoid most) {
        return variable(std::move(name), 0, high, {{"low", low, {}}, {"average", average, {}}, {"high", most, {}}});
    };
    RuleBase base =
        baseOf({partition("lights", 100, {0, 0, 0, 50}, {30, 50, 50, 70}, {50, 100, 100, 100}),
                partition("rate", 80, {0, 0, 0, 30}, {20, 40, 40, 60}, {50, 80, 80, 80}),
                partition("polygons", 1000, {0, 0, 0, 600}, {200, 500, 500, 800}, {600, 1000, 1000, 1000})},
               {"if lights is low then shadow_map is favoured",
                "if lights is high and polygons is average and rate is low then stencil is favoured",
                "if lights is average and polygons is high and rate is average then shadow_map is favoured"});
    const Inference inference = inferenceOf(engineOf(base, {{"shadow_map", {}}, {"stencil", {}}}), {60, 28, 550});

    // Printed memberships; the thesis has 0.7 for an average rate, which is 0.4.
    const double memberships[] = {0, 0.5, 0.2, 0.0666667, 0.4, 0, 0.0833333, 0.8333333, 0};
    for (std::size_t i = 0; i < std::size(memberships); ++i)
        CHECK(inference.memberships[i].low == doctest::Approx(memberships[i]).epsilon(1e-6));
    // Printed strengths are 0.5, 0.067, 0; rule 1 took the membership in "average", its own term has 0.
    CHECK(inference.rules[0].strength == 0.0);
    CHECK(inference.rules[1].strength == doctest::Approx(0.0666667).epsilon(1e-6));
    CHECK(inference.rules[2].strength == 0.0);

    // Its output set: the stencil conclusion everywhere, the shadow map conclusion a ramp over 0..100.
    const CentroidTerms output(variable(
        "algorithm", 0, 100, {{"stencil", {-kInf, -kInf, kInf, kInf}, {}}, {"map", {0, 100, kInf, kInf}, {}}}));
    const double stencil = 0.067; // rounded as printed
    const auto centreOf = [](auto&& membershipAt) {
        double area = 0, moment = 0;
        for (int x = 5; x <= 100; x += 5) {
            area += membershipAt(x);
            moment += membershipAt(x) * x;
        }
        return moment / area;
    };
    const auto cut = [&](double at) {
        return [&output, at, stencil](double x) { return output.membership(x, std::array{stencil, at}); };
    };
    CHECK(centreOf(cut(1.0)) == doctest::Approx(68.231).epsilon(1e-5)); // as printed: the ramp is not cut at 0.5
    CHECK(centreOf(cut(0.5)) == doctest::Approx(62.294).epsilon(1e-5)); // as the text says
    const auto summed = [&](double x) {
        return output.membership(x, std::array{stencil, 0.0}) + output.membership(x, std::array{0.0, 0.5});
    };
    CHECK(centreOf(summed) == doctest::Approx(60.957).epsilon(1e-5));
    const Centroid continuous = output.exact(std::array{stencil, 0.5});
    CHECK(continuous.value == doctest::Approx(60.761).epsilon(1e-5));
    CHECK(output.sampled(std::array{stencil, 0.5}, 20'000).value == doctest::Approx(continuous.value).epsilon(1e-7));
}

TEST_CASE("permuting the rules or the outputs changes no bit, under max and under sum")
{
    Random random(11);
    for (const auto aggregation : {Options::Aggregation::Max, Options::Aggregation::Sum}) {
        for (int round = 0; round < 20; ++round) {
            RuleBase base = randomBase(random, 40);
            base.options.aggregation = aggregation;
            RuleBase shuffled = base;
            for (std::size_t i = shuffled.rules.size(); i > 1; --i)
                std::swap(shuffled.rules[i - 1], shuffled.rules[random.below(static_cast<uint32_t>(i))]);
            const std::vector<OutputInfo> reversed(kFour.rbegin(), kFour.rend());
            const Engine engine = engineOf(base, kFour), other = engineOf(shuffled, reversed);
            Inference x = engine.makeInference(), y = other.makeInference();
            for (int i = 0; i < 50; ++i) {
                const std::vector<double> facts = randomFacts(random);
                engine.evaluate(facts, x);
                other.evaluate(facts, y);
                std::reverse(y.outputs.begin(), y.outputs.end());
                checkSame(x, y);
            }
        }
    }
}

TEST_CASE("a duplicated rule changes nothing under max and adds its strength under sum")
{
    RuleBase once = baseOf({ramp("x")}, {"if x is high then left is favoured", "if x is low then left is avoided"});
    RuleBase twice = once;
    twice.rules.push_back(twice.rules[0]);
    twice.rules.back().id = "again";
    checkSame(inferenceOf(engineOf(once, kTwo), {0.3}), inferenceOf(engineOf(twice, kTwo), {0.3}));

    once.options.aggregation = twice.options.aggregation = Options::Aggregation::Sum;
    const Inference x = inferenceOf(engineOf(twice, kTwo), {0.3});
    CHECK(x.termStrength[2] == doctest::Approx(0.6).epsilon(1e-12));         // favoured, added before it is cut
    CHECK(inferenceOf(engineOf(twice, kTwo), {0.9}).termStrength[2] == 1.0); // bounded
    CHECK(x.outputs[0].suitability > inferenceOf(engineOf(once, kTwo), {0.3}).outputs[0].suitability);
}

TEST_CASE("and is the minimum or the product, or the maximum, and the limiting clause is the one that set it")
{
    RuleBase base = baseOf({ramp("x"), ramp("y")}, {"if x is high and y is high then left is favoured",
                                                    "if x is high or y is high then left is favoured",
                                                    "if x is high and not y is high then left is favoured"});
    const Inference inference = inferenceOf(engineOf(base, kTwo), {0.7, 0.4});
    CHECK(inference.rules[0].strength == doctest::Approx(0.4));
    CHECK(inference.rules[0].limitingVariable == 1);
    CHECK(inference.rules[0].limitingMembership == doctest::Approx(0.4));
    CHECK(inference.rules[1].strength == doctest::Approx(0.7));
    CHECK(inference.rules[1].limitingVariable == 0);
    CHECK(inference.rules[2].strength == doctest::Approx(0.6));
    CHECK(inference.rules[2].limitingVariable == 1);
    base.options.conjunction = Options::And::Product;
    CHECK(inferenceOf(engineOf(base, kTwo), {0.7, 0.4}).rules[0].strength == doctest::Approx(0.28));
}

TEST_CASE("the product, too, is limited by its smallest operand")
{
    const auto limiting = [](const char* sentence) {
        RuleBase base = baseOf({ramp("x"), ramp("y"), ramp("z")}, {sentence});
        base.options.conjunction = Options::And::Product;
        const Engine engine = engineOf(base, kTwo);
        return std::string(engine.variableName(inferenceOf(engine, {0.5, 0.5, 0.3}).rules[0].limitingVariable));
    };
    CHECK(limiting("if x is high and y is high and z is high then left is favoured") == "z"); // 0.3 is above 0.25
    CHECK(limiting("if x is high and y is high and not z is low then left is favoured") == "z");
    CHECK(limiting("if (x is high and z is high) and (y is high and y is high) then left is favoured") == "z");
}

TEST_CASE("terms of suitability without width are weights at their places, the same in every form")
{
    RuleBase base = baseOf({ramp("x"), ramp("y")}, {"if x is high then left is favoured",
                                                    "if y is high then left is avoided and right is favoured"});
    base.suitability.terms = {{"avoided", {0.1, 0.1, 0.1, 0.1}, {}}, {"favoured", {0.9, 0.9, 0.9, 0.9}, {}}};
    for (const uint32_t samples : {0u, 100u}) {
        base.options.samples = samples;
        const Engine engine = engineOf(base, kTwo);
        const Inference inference = inferenceOf(engine, {0.25, 0.75});
        CHECK(inference.outputs[0].suitability == (0.75 * 0.1 + 0.25 * 0.9) / (0.75 + 0.25));
        CHECK(inference.outputs[1].suitability == doctest::Approx(0.9));
        CHECK(inference.outputs[1].quantised > 0);
        CHECK_FALSE(inferenceOf(engine, {0.0, 0.0}).outputs[0].hasOpinion);
    }
    CHECK(engineOf(base, kTwo).suitability().exactGeneral(std::array{0.5, 0.5}).value == doctest::Approx(0.5));
}

TEST_CASE("a term of suitability without width is refused beside one with, as is one outside the universe")
{
    const auto errorOf = [](Trapezoid shape) {
        RuleBase base = baseOf({ramp("x")}, {"if x is high then left is favoured"});
        base.suitability.terms.back().shape = shape;
        DiagnosticSink sink("test");
        if (validate(base, sink)) return std::string("none");
        return sink.all()[0].id + " " + sink.all()[0].message;
    };
    CHECK(errorOf({0.9, 0.9, 0.9, 0.9}) == "R05 term 'favoured' of suitability has no width, so no weight beside the "
                                           "area of 'acceptable'; give all terms a width, or none");
    CHECK(contains(errorOf({1.0, 1.0, kInf, kInf}), "has no width")); // within the universe
    CHECK(errorOf({1.5, 1.5, 1.5, 1.5}) == "R05 term 'favoured' lies outside the universe");
    CHECK(errorOf({0.8, 0.9, 0.9, 1.0}) == "none");
}

TEST_CASE("an unknown fact belongs to no term, its negation neither, and it vetoes nothing")
{
    const RuleBase base = baseOf({ramp("x"), ramp("y")},
                                 {"if x is high then left is favoured", "if not x is high then right is favoured",
                                  "if x is high or y is high then left is favoured", "if not x is low then never right",
                                  "if not (x is low and y is high) then right is acceptable"});
    const Engine engine = engineOf(base, kTwo);
    const Inference inference = inferenceOf(engine, {kNan, 0.25});
    CHECK(inference.unknownFacts == 1);
    CHECK(inference.rules[0].strength == 0.0);
    CHECK(inference.rules[1].strength == 0.0);
    CHECK(inference.rules[2].strength == 0.25);
    CHECK(inference.rules[3].strength == 0.0);
    CHECK_FALSE(inference.outputs[1].vetoed);
    CHECK(inference.rules[4].strength == 0.75); // true whatever x is: the conjunction is at most 0.25
    CHECK(contains(explain(engine, inference), "unknown fact: x"));
    const Inference known = inferenceOf(engine, {0.5, 0.25});
    CHECK(known.unknownFacts == 0);
}

TEST_CASE("facts outside their universe count as its nearest edge and are counted")
{
    const Engine engine = engineOf(baseOf({ramp("x")}, {"if x is high then left is favoured"}), kTwo);
    const Inference far = inferenceOf(engine, {kInf});
    CHECK(far.clampedFacts == 1);
    checkSame(far, inferenceOf(engine, {1.0}));
    CHECK(inferenceOf(engine, {-kInf}).outputs[0].hasOpinion == false);
    CHECK(inferenceOf(engine, {1.0}).clampedFacts == 0);
}

TEST_CASE("a veto holds from vetoAt on, names its rule, and leaves the suitability alone")
{
    RuleBase base = baseOf({ramp("x")}, {"if x is low or high then left is favoured", "if x is high then never left"});
    const Engine engine = engineOf(base, kTwo);
    CHECK_FALSE(inferenceOf(engine, {0.4999}).outputs[0].vetoed);
    const OutputState vetoed = inferenceOf(engine, {0.5}).outputs[0];
    CHECK(vetoed.vetoed);
    CHECK(vetoed.vetoRule == 1);
    CHECK(vetoed.hasOpinion);
    CHECK(vetoed.strongestRule == 0);
    base.options.vetoAt = 0.9;
    CHECK_FALSE(inferenceOf(engineOf(base, kTwo), {0.5}).outputs[0].vetoed);
}

TEST_CASE("otherwise fires with one minus the strongest rule; a pure veto does not silence it")
{
    const RuleBase base =
        baseOf({ramp("x")}, {"if x is high then left is favoured with 0.5", "if x is high then never right"},
               "right is acceptable with 0.8");
    const Engine engine = engineOf(base, kTwo);
    const Inference inference = inferenceOf(engine, {1.0});
    REQUIRE(inference.rules.size() == 3);
    CHECK(inference.rules[2].strength == doctest::Approx(0.4)); // (1 - 0.5) * 0.8
    CHECK(engine.ruleId(2) == "otherwise");
    CHECK(inferenceOf(engine, {kNan}).rules[2].strength == doctest::Approx(0.8));
}

TEST_CASE("no rule, no opinion: a state, not a number")
{
    const Inference inference =
        inferenceOf(engineOf(baseOf({ramp("x")}, {"if x is high then left is favoured"}), kTwo), {1});
    CHECK(inference.outputs[0].hasOpinion);
    CHECK_FALSE(inference.outputs[1].hasOpinion);
    CHECK(inference.outputs[1].quantised == -1);
    CHECK(inference.outputs[1].strongestRule == kNoRule);
}

TEST_CASE("traits reach every output that has them, and 'others' are those a sentence does not mean")
{
    const std::vector<OutputInfo> outputs = {{"a", {"soft"}}, {"b", {"soft", "exact"}}, {"c", {}}, {"d", {}}};
    const Engine engine = engineOf(
        baseOf({ramp("x")}, {"if x is high then any soft is favoured and c is acceptable and others are avoided",
                             "if x is high then never any exact"}),
        outputs);
    const Inference inference = inferenceOf(engine, {1});
    CHECK(inference.outputs[0].quantised == inference.outputs[1].quantised);
    CHECK(inference.outputs[0].suitability > 0.8);
    CHECK(inference.outputs[2].suitability == doctest::Approx(0.5).epsilon(1e-12));
    CHECK(inference.outputs[3].suitability < 0.2);
    CHECK(inference.outputs[1].vetoed);
    CHECK_FALSE(inference.outputs[0].vetoed);
}

TEST_CASE("a known but absent output silences its sentence; an unknown one is an error at its place")
{
    const RuleBase base = baseOf({ramp("x")}, {"if x is high then octree is favoured and others are avoided",
                                               "if x is high then never any ancient"});
    const Engine engine = engineOf(base, kTwo, {{"octree", {"ancient"}}});
    CHECK_FALSE(inferenceOf(engine, {1}).outputs[0].hasOpinion); // 'others' stay silent with it

    const std::vector<FactInfo> facts = factsFor(base);
    const BindResult refused = Engine::bind(base, {.facts = facts, .outputs = kTwo, .absent = {}, .traits = {}});
    CHECK_FALSE(refused.engine.has_value());
    CHECK(findings(refused.diagnostics, "L01") ==
          std::vector<std::string>{"1:19 unknown output 'octree'; known: left, right", "1:29 unknown trait 'ancient'"});
}

TEST_CASE("a variable without a fact, and one in another unit, are errors naming it")
{
    RuleBase base = baseOf({ramp("x"), ramp("y")}, {"if x is high then left is favoured"});
    base.variables[0].unit = "m";
    const std::vector<FactInfo> facts = {{"x", "count"}};
    const BindResult refused = Engine::bind(base, {.facts = facts, .outputs = kTwo, .absent = {}, .traits = {}});
    CHECK_FALSE(refused.engine.has_value());
    const std::vector<std::string> found = findings(refused.diagnostics, "L01");
    REQUIRE(found.size() == 2);
    CHECK(contains(found[0], "'x' is in 'count', not in 'm'"));
    CHECK(contains(found[1], "no fact is called 'y'"));
}

TEST_CASE("evaluation allocates nothing")
{
    Random random(21);
    for (const auto aggregation : {Options::Aggregation::Max, Options::Aggregation::Sum}) {
        RuleBase base = randomBase(random, 60);
        base.options.aggregation = aggregation;
        const Engine engine = engineOf(base, kFour);
        Inference inference = engine.makeInference();
        std::vector<std::vector<double>> facts;
        for (int i = 0; i < 100; ++i)
            facts.push_back(randomFacts(random));
        facts[7][2] = kNan;
        const std::size_t before = allocationCount();
        for (const std::vector<double>& f : facts)
            engine.evaluate(f, inference);
        CHECK(allocationCount() == before);
    }
    CHECK(allocationCount() > 0); // the counter is really in place
}

TEST_CASE("an inference carries nothing over from the evaluation before")
{
    Random random(22);
    const Engine engine = engineOf(randomBase(random, 40), kFour);
    Inference reused = engine.makeInference();
    for (int i = 0; i < 100; ++i) {
        const std::vector<double> facts = randomFacts(random);
        engine.evaluate(facts, reused);
        Inference fresh = engine.makeInference();
        engine.evaluate(facts, fresh);
        checkSame(reused, fresh);
    }
}

TEST_CASE("scaling the unit of a variable together with its terms changes nothing a decision sees")
{
    // By 1024, a power of two: every quotient is the same, bit for bit.
    Variable metres =
        variable("x", 0, 2, {{"low", {-kInf, -kInf, 0.3, 0.8}, {}}, {"high", {0.3, 0.8, kInf, kInf}, {}}});
    Variable scaled = variable(
        "x", 0, 2048,
        {{"low", {-kInf, -kInf, 0.3 * 1024, 0.8 * 1024}, {}}, {"high", {0.3 * 1024, 0.8 * 1024, kInf, kInf}, {}}});
    const auto sentences = {std::string_view("if x is high then left is favoured and right is avoided"),
                            std::string_view("if x is low then right is favoured")};
    const Engine a = engineOf(baseOf({metres}, sentences), kTwo), b = engineOf(baseOf({scaled}, sentences), kTwo);
    for (int i = 0; i <= 200; ++i)
        checkSame(inferenceOf(a, {i * 0.01}), inferenceOf(b, {i * 0.01 * 1024}));
}

TEST_CASE("an explanation shows suitability, rules by strength, the limiting clause and the weight")
{
    RuleBase base = baseOf({ramp("lightRadius"), ramp("frameBudget")},
                           {"if lightRadius is high and frameBudget is high then left is favoured",
                            "if lightRadius is high or frameBudget is low then right is avoided with 0.8"});
    base.rules[1].because = "measured";
    const Engine engine = engineOf(base, {{"left", {}}, {"right", {}}, {"unsaid", {}}});
    const Inference inference = inferenceOf(engine, {0.75, 0.62});
    CHECK(explain(engine, inference, {.because = true}) ==
          "left    0.83         rule R1: lightRadius high 0.75, frameBudget high 0.62*\n"
          "right   0.17         rule R2 (avoided): lightRadius high 0.75*, frameBudget low 0.38, weight 0.8\n"
          "                     because measured\n"
          "unsaid  no opinion\n");
    CHECK(reasonFor(engine, inference, 0) == "rule R1: lightRadius high 0.75, frameBudget high 0.62*");
    CHECK(reasonFor(engine, inference, 2) == "no rule that fires speaks of it");
}

TEST_CASE("an explanation names what decided first, and says what a rule yields to")
{
    RuleBase base = baseOf({ramp("p"), ramp("q")},
                           {"if p is high then left is favoured", "if not p is low then left is favoured",
                            "if p is high then left is avoided with 0.9", "if p is high then right is acceptable",
                            "if q is high then scene is busy", "if p is high then scene is calm with 0.75"});
    base.concepts = {{"scene", {{"calm", {}}, {"busy", {}}}, {}}};
    base.rules[2].id = "EX";
    base.rules[2].priority = base.rules[5].priority = 1;
    const Engine engine = engineOf(base, {{"left", {}}, {"right", {}}});
    const Inference inference = inferenceOf(engine, {1.0, 1.0});
    CHECK(explain(engine, inference, {.rulesPerOutput = 2}) ==
          "right  0.50         rule R4 (acceptable): p high 1.00\n"
          "left   0.24         rule EX (avoided): p high 1.00, weight 0.9\n"
          "                    rule R1: p high 1.00, yields to EX, counts 0.10\n"
          "concept scene calm 0.75: rule R6: p high 1.00, weight 0.75\n"
          "concept scene busy 0.25: rule R5: q high 1.00, yields to R6, counts 0.25\n");
    CHECK(rulesBehind(engine, inference, 0) == std::vector<uint32_t>{2, 0, 1});
    CHECK(rulesBehind(engine, inference, 0).front() == inference.outputs[0].strongestRule);
    CHECK(countedStrengths(engine, inference)[0] == 1.0 - 0.9);
    CHECK(countedStrengths(engine, inference)[4] == 1.0); // speaks of no output
}

TEST_CASE("of the rules behind an output the strongest is the one that the engine names")
{
    Random random(17);
    for (int round = 0; round < 200; ++round) {
        const Engine engine = engineOf(anyBase(random, 12), kFourWithTrait);
        Inference inference = engine.makeInference();
        engine.evaluate(randomFacts(random), inference);
        for (uint32_t output = 0; output < inference.outputs.size(); ++output) {
            const std::vector<uint32_t> behind = rulesBehind(engine, inference, output);
            const OutputState& state = inference.outputs[output];
            CHECK((behind.empty() ? kNoRule : behind.front()) == state.strongestRule);
            if (!behind.empty()) CHECK(countedStrengths(engine, inference)[behind.front()] >= state.strongestStrength);
        }
    }
}

TEST_CASE("a negated group is explained by what it says: not a and not b, each with its own truth")
{
    const auto explained = [](const char* sentence, std::initializer_list<double> facts) {
        const Engine engine = engineOf(baseOf({ramp("x"), ramp("y")}, {sentence}), {{"left", {}}});
        return explainRule(engine, inferenceOf(engine, facts), 0);
    };
    CHECK(explained("if not (x is high or y is high) then left is favoured", {0.25, 0.4}) ==
          "rule R1: x not high 0.75, y not high 0.60*");
    CHECK(explained("if not (x is high and not y is high) then left is favoured", {0.75, 0.9}) ==
          "rule R1: x not high 0.25, y high 0.90*");
    CHECK(explained("if y is high and not (not (x is high)) then left is favoured", {0.75, 0.9}) ==
          "rule R1: y high 0.90, x high 0.75*");
}
