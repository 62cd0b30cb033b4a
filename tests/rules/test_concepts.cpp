#include "rules_support.hpp"

#include <algorithm>

#include "allocation_count.hpp"
#include "rules/engine/explain.hpp"
#include "rules/engine/lint.hpp"

using namespace gnomon::rules;
using namespace gnomon::rules::test;

namespace {

const std::vector<OutputInfo> kTwo = {{"left", {}}, {"right", {}}};

RuleBase baseWith(std::vector<Concept> concepts, std::initializer_list<std::string_view> sentences,
                  std::string_view otherwise = {})
{
    RuleBase base = baseOf({ramp("x"), ramp("y"), ramp("z")}, sentences, otherwise);
    base.concepts = std::move(concepts);
    return base;
}

Concept concept_(std::string name, std::initializer_list<const char*> words)
{
    Concept made{std::move(name), {}, {}};
    for (const char* word : words)
        made.terms.push_back({word, {}});
    return made;
}

/// The thesis's own example: many lights and many polygons make a scene overly complex.
RuleBase complexScene()
{
    return baseWith({concept_("scene", {"overlyComplex"})},
                    {"if scene is overlyComplex then left is favoured", // asked for before it is concluded
                     "if x is high and y is high then scene is overlyComplex",
                     "if not scene is overlyComplex then left is avoided"});
}

std::vector<std::string> refusals(const RuleBase& base, const std::vector<OutputInfo>& outputs = kTwo)
{
    const std::vector<FactInfo> facts = factsFor(base);
    const BindResult bound = Engine::bind(base, {.facts = facts, .outputs = outputs, .absent = {}, .traits = {}});
    CHECK(bound.engine.has_value() == bound.diagnostics.empty());
    std::vector<std::string> texts;
    for (const Diagnostic& d : bound.diagnostics)
        texts.push_back(std::to_string(d.line) + ":" + std::to_string(d.column) + " " + d.id + " " + d.message);
    return texts;
}

std::vector<std::string> l03(const RuleBase& base)
{
    const std::vector<FactInfo> facts = factsFor(base);
    return findings(lint(base, {.facts = facts, .outputs = kTwo, .absent = {}, .traits = {}}), "L03");
}

} // namespace

TEST_CASE("a concluded concept fires the rules that ask for it, wherever they stand")
{
    const Engine engine = engineOf(complexScene(), kTwo);
    const Inference inference = inferenceOf(engine, {0.75, 0.625, 0});
    CHECK(inference.rules[1].strength == 0.625);
    CHECK(inference.rules[0].strength == 0.625);
    CHECK(inference.rules[2].strength == 0.375);
    CHECK(inference.termStrength == std::vector<double>{0.375, 0, 0.625, 0, 0, 0});
    CHECK(engine.variableName(inference.rules[0].limitingVariable) == "scene");
    CHECK(engine.termName(inference.rules[0].limitingVariable, inference.rules[0].limitingTerm) == "overlyComplex");
}

TEST_CASE("a chain of concepts gives what one rule with everything written out gives")
{
    const Engine chained = engineOf(
        baseWith({concept_("late", {"yes"}), concept_("early", {"yes"})},
                 {"if late is yes and z is low then left is favoured", "if early is yes or z is high then late is yes",
                  "if x is high and y is low then early is yes with 0.5"}),
        kTwo);
    Random random(51);
    Inference inference = chained.makeInference();
    for (int i = 0; i < 200; ++i) {
        const double x = random.unit(), y = random.unit(), z = random.unit();
        chained.evaluate(std::vector<double>{x, y, z}, inference);
        const double early = std::min(x, 1 - y) * 0.5;
        CHECK(inference.rules[0].strength == std::min(std::max(early, z), 1 - z));
    }
}

TEST_CASE("assertions of one term join like the terms of an output")
{
    RuleBase base =
        baseWith({concept_("scene", {"busy"})}, {"if x is high then scene is busy", "if y is high then scene is busy",
                                                 "if scene is busy then left is favoured"});
    CHECK(inferenceOf(engineOf(base, kTwo), {0.25, 0.5, 0}).rules[2].strength == 0.5);
    base.options.aggregation = Options::Aggregation::Sum;
    CHECK(inferenceOf(engineOf(base, kTwo), {0.25, 0.5, 0}).rules[2].strength == 0.75);
    CHECK(inferenceOf(engineOf(base, kTwo), {0.75, 0.5, 0}).rules[2].strength == 1.0);
}

TEST_CASE("an unknown fact makes the concept unknown, and neither it nor its negation fires")
{
    const Engine engine = engineOf(complexScene(), kTwo);
    const Inference unknown = inferenceOf(engine, {kNan, 0.625, 0});
    CHECK(unknown.rules[0].strength == 0.0);
    CHECK(unknown.rules[2].strength == 0.375); // at most 0.625, whatever x is
    CHECK(inferenceOf(engine, {kNan, 0, 0}).rules[2].strength == 1.0);
}

TEST_CASE("an assertion does not silence otherwise, and concepts allocate nothing")
{
    const Engine engine =
        engineOf(baseWith({concept_("scene", {"busy"})},
                          {"if x is high then scene is busy", "if scene is busy and y is high then left is favoured"},
                          "right is acceptable"),
                 kTwo);
    Inference inference = engine.makeInference();
    const std::vector<double> facts = {1, 0.25, 0};
    const std::size_t before = allocationCount();
    engine.evaluate(facts, inference);
    CHECK(allocationCount() == before);
    CHECK(inference.rules[2].strength == 0.75);
}

TEST_CASE("a concept concluded from itself is refused where the circle closes, with the way round")
{
    CHECK(refusals(baseWith({concept_("scene", {"busy", "calm"}), concept_("load", {"heavy"})},
                            {"if scene is busy then load is heavy", "if x is high and load is heavy then scene is calm",
                             "if x is low then scene is busy"})) ==
          std::vector<std::string>{
              "1:4 R08 concept 'scene' is concluded from itself: scene <- load <- scene, closed by rule 'R1'; "
              "take 'scene' out of that rule's condition"});
    CHECK(refusals(baseWith({concept_("scene", {"busy"})}, {"if not scene is busy then scene is busy"})) ==
          std::vector<std::string>{
              "1:8 R08 concept 'scene' is concluded from itself: scene <- scene, closed by rule 'R1'; "
              "take 'scene' out of that rule's condition"});
}

TEST_CASE("a concept's names are checked like any other, and it is no output")
{
    const std::vector<Concept> scene = {concept_("scene", {"busy"})};
    CHECK(refusals(baseWith(scene, {"if x is high then scene is bsuy"})) ==
          std::vector<std::string>{"1:28 L01 'scene' has no term 'bsuy'; did you mean 'busy'? Known: busy"});
    CHECK(refusals(baseWith(scene, {"if scene is calm then left is favoured"})) ==
          std::vector<std::string>{"1:13 L01 'scene' has no term 'calm'; known: busy"});
    CHECK(contains(refusals(baseWith(scene, {"if x is high then scene is busy and others are avoided"})).at(0),
                   "'others' needs a conclusion about an output"));
    CHECK(contains(refusals(baseWith(scene, {"if x is high then never scene"})).at(0), "unknown output 'scene'"));
    CHECK(contains(refusals(baseWith(scene, {"if x is high then scene is busy"}, "scene is busy")).at(0),
                   "concepts are settled before it"));
    CHECK(contains(refusals(baseWith(scene, {"if x is high then scene is busy"}), {{"scene", {}}}).at(0),
                   "is an output already"));
    CHECK(contains(refusals(baseWith({concept_("x", {"a"})}, {"if x is high then left is favoured"})).at(0),
                   "two variables or concepts are called 'x'"));
    CHECK(contains(refusals(baseWith({concept_("c", {})}, {"if x is high then left is favoured"})).at(0),
                   "needs between 1 and 16 terms"));
}

TEST_CASE("a rule of higher priority leaves to contrary rules what it is not sure of")
{
    RuleBase base =
        baseWith({}, {"if x is high then left is avoided", "if y is high then left is favoured and right is favoured",
                      "if z is high then left is avoided"});
    base.rules[0].priority = 2;
    const Engine engine = engineOf(base, kTwo);
    const Inference inference = inferenceOf(engine, {0.75, 1, 0.5});
    CHECK(inference.termStrength == std::vector<double>{0.75, 0, 0.25, 0, 0, 1}); // avoided, acceptable, favoured
    CHECK(inference.rules[1].strength == 1.0);                                    // as it fired
    CHECK(inference.outputs[0].strongestRule == 0);
    CHECK(inference.outputs[1].strongestRule == 1);
    const Inference sure = inferenceOf(engine, {1, 1, 1});
    CHECK(sure.termStrength[2] == 0.0);
    base.rules[0].priority = 0;
    CHECK(inferenceOf(engineOf(base, kTwo), {0.75, 1, 0.5}).termStrength == std::vector<double>{0.75, 0, 1, 0, 0, 1});
}

TEST_CASE("a priority settles contrary assertions about a concept too, and never stops a veto")
{
    RuleBase base = baseWith({concept_("scene", {"calm", "busy"})},
                             {"if x is high then scene is busy", "if y is high then scene is calm",
                              "if scene is busy then left is avoided", "if scene is calm then left is favoured",
                              "if y is high then never right"});
    base.rules[0].priority = 1;
    const Inference inference = inferenceOf(engineOf(base, kTwo), {0.75, 1, 0});
    CHECK(inference.rules[2].strength == 0.75);
    CHECK(inference.rules[3].strength == 0.25);
    CHECK(inference.outputs[1].vetoed);
    // Unknown how busy: the calm that remains is what is left at worst.
    const Inference unknown = inferenceOf(engineOf(base, kTwo), {kNan, 1, 0});
    CHECK(unknown.rules[3].strength == 0.0);
    base.rules[0].priority = 10;
    CHECK(contains(refusals(base).at(0), "must be at most 9"));
}

TEST_CASE("permuting rules with concepts and priorities changes no bit")
{
    Random random(52);
    RuleBase base = baseWith({concept_("scene", {"calm", "busy"})},
                             {"if x is high or y is low then scene is busy", "if y is high then scene is calm with 0.7",
                              "if scene is busy and z is high then left is avoided and right is favoured",
                              "if scene is not calm then right is acceptable", "if z is low then left is favoured"});
    base.rules[1].priority = 3;
    base.rules[3].priority = 1;
    for (const auto aggregation : {Options::Aggregation::Max, Options::Aggregation::Sum}) {
        base.options.aggregation = aggregation;
        RuleBase turned = base;
        std::reverse(turned.rules.begin(), turned.rules.end());
        const Engine engine = engineOf(base, kTwo), other = engineOf(turned, kTwo);
        for (int i = 0; i < 200; ++i) {
            const std::initializer_list<double> facts = {random.unit(), random.unit(), random.unit()};
            CHECK(inferenceOf(engine, facts).termStrength == inferenceOf(other, facts).termStrength);
        }
    }
}

TEST_CASE("an explanation says where a concept comes from")
{
    const Engine engine = engineOf(complexScene(), kTwo);
    CHECK(explain(engine, inferenceOf(engine, {1, 0.62, 0})) ==
          "left   0.57         rule R1: scene overlyComplex 0.62\n"
          "                    rule R3 (avoided): scene not overlyComplex 0.38\n"
          "right  no opinion\n"
          "concept scene overlyComplex 0.62: rule R2: x high 1.00, y high 0.62*\n");
}

TEST_CASE("the linter looks through concepts")
{
    RuleBase base = complexScene();
    CHECK(l03(base).empty());
    Rule rule;
    rule.id = "added";
    DiagnosticSink sink("added");
    REQUIRE(parseRule({"if scene is overlyComplex and x is low and x is high then right is favoured"}, rule, sink));
    base.rules.push_back(rule); // fires where x is between
    CHECK(l03(base).empty());

    base = baseWith({concept_("scene", {"busy", "calm"})},
                    {"if x is high then scene is busy", "if scene is busy then left is favoured",
                     "if scene is calm then left is avoided"});
    REQUIRE(l03(base).size() == 1);
    CHECK(contains(l03(base)[0], "'R3' can never fire"));

    const std::vector<FactInfo> facts = factsFor(base);
    const auto holes =
        findings(lint(base, {.facts = facts, .outputs = {&kTwo[0], 1}, .absent = {}, .traits = {}}), "L02");
    REQUIRE(holes.size() == 1);
    CHECK(contains(holes[0], "where x <= 0 (low)"));
}
