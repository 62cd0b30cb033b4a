#include "yaml_support.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "rules/engine/lint.hpp"
#include "rules/yaml/shipped.hpp"

using namespace gnomon::rules;
using namespace gnomon::rules::test;

namespace {

/// Facts of the thesis's two variables; it reads no others.
std::vector<double> factsOf(double dynamicLights, double viewerDistance)
{
    std::vector<double> facts(kFacts.size(), kNan);
    facts[0] = dynamicLights, facts[2] = viewerDistance;
    return facts;
}

struct Step {
    double dynamicLights, viewerDistance;
    const char* winner;
    double best, second;
};

/// Rautenbach 2008, 6.4. Suitabilities computed once with fuzzylite 6.0 at 20000 samples.
/// Near is 10 and far is 80 world units, well inside either term.
const Step kScenario[] = {
    {0, 10, "octree_volume", 0.844, 0.156}, // static lights
    {6, 10, "chan_durand", 0.824, 0.176},   {13, 80, "shadow_map", 0.601, 0.399},
    {14, 80, "chan_durand", 0.601, 0.399},  {15, 80, "chan_durand", 0.844, 0.156},
    {16, 80, "chan_durand", 0.844, 0.156},  {9, 10, "chan_durand", 0.844, 0.156},
};

RuleBase thesis()
{
    return parsed(shippedRuleBase("thesis"), "thesis.yaml");
}

std::string winnerAt(const Engine& engine, double lights, double distance)
{
    Inference inference = engine.makeInference();
    engine.evaluate(factsOf(lights, distance), inference);
    return winner(engine, inference);
}

} // namespace

TEST_CASE("the scripted scenario of Rautenbach 2008, 6.4, gives its methods and values")
{
    const Engine engine = bound(thesis());
    Inference inference = engine.makeInference();
    for (const Step& step : kScenario) {
        CAPTURE(step.dynamicLights);
        CAPTURE(step.viewerDistance);
        engine.evaluate(factsOf(step.dynamicLights, step.viewerDistance), inference);
        CHECK(winner(engine, inference) == step.winner);
        std::vector<double> values;
        for (const OutputState& output : inference.outputs)
            values.push_back(output.suitability);
        std::sort(values.rbegin(), values.rend());
        CHECK(std::abs(values[0] - step.best) < 0.0005);
        CHECK(std::abs(values[1] - step.second) < 0.0005);
    }
}

TEST_CASE("the scenario switches only where the thesis does, forward and reverse, under max and under sum")
{
    // 13 -> 14 far is the one change on the way to 16; 9 -> 16 near and back changes nothing.
    const std::vector<std::pair<double, double>> forward = {{0, 10},  {6, 10},  {13, 80}, {14, 80},
                                                            {15, 80}, {16, 80}, {9, 10}};
    const std::vector<std::pair<double, double>> reverse = {{9, 10},  {10, 10}, {11, 10}, {12, 10}, {13, 10}, {14, 10},
                                                            {15, 10}, {16, 10}, {13, 80}, {6, 10},  {0, 10}};
    const auto sequence = [](const Engine& engine, const auto& steps) {
        std::string text;
        std::string last;
        for (const auto& [lights, distance] : steps) {
            const std::string now = winnerAt(engine, lights, distance);
            text += now == last ? "" : now + " ";
            last = now;
        }
        return text;
    };
    for (const auto aggregation : {Options::Aggregation::Max, Options::Aggregation::Sum}) {
        RuleBase base = thesis();
        base.options.aggregation = aggregation;
        const Engine engine = bound(base);
        CHECK(sequence(engine, forward) == "octree_volume chan_durand shadow_map chan_durand ");
        CHECK(sequence(engine, reverse) == "chan_durand shadow_map chan_durand octree_volume ");
    }
}

TEST_CASE("one and two far lights, which table 6.1 forgets, get the shadow map")
{
    const Engine engine = bound(thesis());
    Inference inference = engine.makeInference();
    for (const double lights : {1.0, 2.0}) {
        engine.evaluate(factsOf(lights, 80), inference);
        CHECK(winner(engine, inference) == "shadow_map");
        CHECK(std::abs(inference.outputs[placeOf("shadow_map")].suitability - 0.844) < 0.0005);
    }
}

TEST_CASE("eight lights at 45 units are a tie to the last quantum: the incumbent decides")
{
    const Engine engine = bound(thesis());
    Inference inference = engine.makeInference();
    engine.evaluate(factsOf(8, 45), inference);
    const OutputState& map = inference.outputs[placeOf("shadow_map")];
    const OutputState& hybrid = inference.outputs[placeOf("chan_durand")];
    CHECK(map.suitability == doctest::Approx(0.5).epsilon(1e-12));
    CHECK(map.quantised == kSuitabilitySteps / 2);
    CHECK(hybrid.quantised == map.quantised);
}

TEST_CASE("thesis.yaml lints clean, and reads nothing but the two facts of the thesis")
{
    const RuleBase base = thesis();
    for (const Diagnostic& finding : lint(base, vocabulary()))
        FAIL_CHECK(toText(finding));
    CHECK(base.variables.size() == 2);
    CHECK(base.rules.size() == 5);
    CHECK(base.options.allocation == Options::Allocation::None);
    for (const Rule& rule : base.rules)
        CHECK_FALSE(rule.because.empty());
}

TEST_CASE("table 6.1 to the letter has one hole, and the linter draws it")
{
    const char* data = std::getenv("GNOMON_DATA_DIR");
    REQUIRE(data != nullptr);
    const std::string path = std::string(data) + "/tests/rules/thesis_crisp.yaml";
    const std::vector<Diagnostic> found = lint(parsed(readFile(path), "thesis_crisp.yaml"), vocabulary());
    REQUIRE(found.size() == 1);
    CHECK(toText(found[0]) == "thesis_crisp.yaml:7:3: warning: no rule speaks of any output where "
                              "1 <= dynamicLights <= 2 (upToEight), viewerDistance > 45 (far) [L02]");
}
