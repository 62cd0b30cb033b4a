#include "yaml_support.hpp"

#include "rules/engine/lint.hpp"
#include "rules/yaml/shipped.hpp"

using namespace gnomon::rules;
using namespace gnomon::rules::test;

namespace {

constexpr std::string_view kBase = R"(version: 1
options: {allocation: budget}
variables:
  x: {universe: [0, 10], unit: m, terms: {low: [-.inf, -.inf, 4, 6], high: [4, 6, .inf, .inf]}}
rules:
  - {id: A, rule: if x is low then p is favoured and others are avoided}
  - {id: B, rule: if x is high then q is favoured and others are avoided}
policy: {floor: {when: x is low, minimumQuality: 0.9}, probing: {everyFrames: 7}}
presets:
  wide: {about: "p further out", variables: {x: {terms: {low: [-.inf, -.inf, 8, 9], high: [8, 9, .inf, .inf]}}}}
  turned:
    rules:
      - {id: A, rule: if x is low then q is favoured and others are avoided}
      - {id: C, rule: if x is high then r is acceptable}
    without: [B]
    policy: {floor: {minimumQuality: 0.5}}
)";

const std::vector<OutputInfo> kThree = {{"p", {}}, {"q", {}}, {"r", {}}};

std::string bestAt(std::string_view preset, double x)
{
    ParseResult read = parseRuleBase(kBase, "f", preset);
    REQUIRE(read.base.has_value());
    const std::vector<FactInfo> facts = {{"x", "m"}};
    BindResult bound = Engine::bind(std::move(*read.base), {.facts = facts, .outputs = kThree});
    REQUIRE(bound.engine.has_value());
    Inference inference = bound.engine->makeInference();
    bound.engine->evaluate(std::vector<double>{x}, inference);
    return winner(*bound.engine, inference);
}

std::string errorsWith(const std::string& preset)
{
    const std::string text(kBase);
    const ParseResult read = parseRuleBase(text.substr(0, text.find("presets:")) + "presets:\n" + preset, "f");
    CHECK(read.base.has_value() == read.diagnostics.empty());
    std::string all;
    for (const Diagnostic& finding : read.diagnostics)
        all += toText(finding) + "\n";
    return all;
}

} // namespace

TEST_CASE("a preset changes what it names, and nothing else")
{
    CHECK(bestAt("", 3.0) == "p");
    CHECK(bestAt("", 7.0) == "q");
    CHECK(bestAt("wide", 7.0) == "p");
    CHECK(bestAt("wide", 9.5) == "q");
    CHECK(bestAt("turned", 3.0) == "q"); // rule A is another
    CHECK(bestAt("turned", 7.0) == "r"); // B is gone, C is there

    const RuleBase plain = parsed(kBase);
    const RuleBase turned = std::move(*parseRuleBase(kBase, "f", "turned").base);
    CHECK(plain.policy.floor.minimumQuality == 0.9);
    CHECK(turned.policy.floor.minimumQuality == 0.5);
    CHECK(turned.policy.floor.when.size() == plain.policy.floor.when.size());
    CHECK(turned.policy.probing.everyFrames == 7);
    CHECK(plain.textHash != turned.textHash);
    for (const RuleBase* base : {&plain, &turned}) {
        REQUIRE(base->presets.size() == 2);
        CHECK(base->presets[0].about == "p further out");
    }
    CHECK(plain.preset.empty());
    CHECK(turned.preset == "turned");
}

TEST_CASE("an unknown preset is refused with those there are")
{
    const ParseResult read = parseRuleBase(kBase, "f", "wider");
    CHECK(!read.base);
    REQUIRE(read.diagnostics.size() == 1);
    CHECK(toText(read.diagnostics[0]) ==
          "f: error: there is no preset 'wider'; did you mean 'wide'? Known: wide, turned [R05]");
    const ParseResult none = parseRuleBase(shippedRuleBase("thesis"), "thesis", "low");
    REQUIRE(none.diagnostics.size() == 1);
    CHECK(none.diagnostics[0].message == "there is no preset 'low': the rule base has none");
}

TEST_CASE("a fault in a preset refuses the base, at its place")
{
    CHECK(errorsWith("  a: {without: [D]}\n") ==
          "f:10:17: error: 'without' names no rule of the base: 'D'; known: A, B (with preset 'a') [R05]\n");
    CHECK(errorsWith("  a: {extra: 1}\n") ==
          "f:10:7: error: preset 'a' has no key 'extra'; known: about, options, variables, rules, "
          "without, otherwise, policy [R04]\n");
    CHECK(errorsWith("  a: 3\n") == "f:10:6: error: preset 'a' must be a map, found a number [R04]\n");
    CHECK(errorsWith("  a: {policy: {floor: {minimumQuality: 2}}}\n") ==
          "f:10:40: error: 'minimumQuality' must be a number from 0 to 1, found '2' (with preset 'a') [R05]\n");
    CHECK(errorsWith("  a: {rules: [{id: A, rule: if x is lo then p is favoured}]}\n") ==
          "f:10:37: error: 'x' has no term 'lo'; known: low, high (with preset 'a') [L01]\n");
    CHECK(errorsWith("  a: {}\n") == "");
}

TEST_CASE("each preset of the default base moves the distance at which exact edges end, and its floor")
{
    struct Expected {
        const char* name;
        double exactUpTo, mapsFrom; // metres
        double headroom, quality;
        uint32_t fadeFrames;
    };
    constexpr Expected kExpected[] = {{"low", 5, 15, 0.25, 0.7, 0},
                                      {"medium", 15, 30, 0.1, 0.8, 8},
                                      {"high", 30, 60, 0.02, 0.875, 8},
                                      {"ultra", 60, 85, 0.0, 0.95, 8}};
    const std::string_view text = shippedRuleBase("default");
    CHECK(parsed(text).presets.size() == std::size(kExpected));
    for (const Expected& expected : kExpected) {
        CAPTURE(expected.name);
        ParseResult read = parseRuleBase(text, "default", expected.name);
        REQUIRE(read.base.has_value());
        const Policy& policy = read.base->policy;
        CHECK(policy.budget.headroom == expected.headroom);
        CHECK(policy.floor.minimumQuality == expected.quality);
        CHECK(policy.hysteresis.crossFadeFrames == expected.fadeFrames);
        CHECK(lint(*read.base, vocabulary()).empty());
        const Engine engine = bound(*read.base);
        Inference inference = engine.makeInference();
        const auto best = [&](double distance) {
            engine.evaluate(std::vector<double>{1, 1, distance, 0.5, 3.5, 0.0, 0.5, 0.5, 0.0, 0.0, 0.0}, inference);
            return winner(engine, inference);
        };
        CHECK(best(expected.exactUpTo) == "stencil_volume");
        CHECK(best(expected.mapsFrom) == "shadow_map");
    }
}
