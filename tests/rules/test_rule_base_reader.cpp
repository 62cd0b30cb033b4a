#include "yaml_support.hpp"

#include <clocale>
#include <ctime>
#include <locale>

#include "rules/engine/explain.hpp"
#include "rules/yaml/shipped.hpp"
#include "runtime/base/number_text.hpp"

using namespace gnomon;
using namespace gnomon::rules;
using namespace gnomon::rules::test;

namespace {

constexpr std::string_view kHead =
    "version: 1\n"
    "variables:\n"
    "  x: {universe: [0, 1], unit: m, terms: {low: [-.inf, -.inf, 0, 1], high: [0, 1, .inf, .inf]}}\n";

/// All errors of a text, one a line, without the file name.
std::string errorsOf(std::string_view text)
{
    const ParseResult result = parseRuleBase(text, "f");
    CHECK(result.base.has_value() == result.diagnostics.empty());
    std::string all;
    for (const Diagnostic& d : result.diagnostics)
        if (d.severity == Severity::Error) all += toText(d).substr(2) + "\n";
    return all;
}

std::string errorsInRules(std::string_view rules)
{
    return errorsOf(std::string(kHead) + "rules:\n" + std::string(rules));
}

/// What a rule base decides, in bits.
std::vector<double> decisions(std::string_view text)
{
    const Engine engine = bound(parsed(text));
    Inference inference = engine.makeInference();
    std::vector<double> all;
    for (int i = 0; i <= 20; ++i) {
        engine.evaluate(std::vector<double>{i * 1.0, i / 20.0, i * 4.5, i / 20.0, 2 + i / 4.0, i / 10.0, 0.3, 0.9,
                                            i % 2 * 1.0, i * 5.0, i / 4.0},
                        inference);
        for (const OutputState& output : inference.outputs)
            all.push_back(output.suitability);
    }
    return all;
}

struct CommaPunctuation : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

} // namespace

TEST_CASE("every part of the format arrives")
{
    const RuleBase base = parsed(std::string(kHead) + R"(name: full
options: {and: product, or: max, aggregation: sum, defuzzifier: sampled(100), allocation: budget, minimumStrength: 0.05, vetoAt: 0.7}
suitability: {universe: [0, 10], terms: {bad: [-.inf, -.inf, 2, 4], good: [2, 4, .inf, .inf]}}
rules:
  - {id: A, rule: "if x is low then p is bad with 0.8", because: "a reason"}
  - {rule: "if x is high then never p"}
otherwise: p is good with 0.1
policy:
  budget: {shadowCapMs: 4, headroom: 0.05}
  floor: {when: x is low and x is not high, minimumQuality: 0.7, atStrength: 0.4, oneLightTimes: 3}
  hysteresis: {planGain: 0.03, upgradesPerFrame: 1, flipWindowFrames: 20, flipBanFrames: 90, crossFadeFrames: 5}
  probing: {everyFrames: 30, sigma: 1.5}
tuned: {by: hand, from: nowhere, hash: "0"}
)");
    CHECK(base.name == "full");
    CHECK(base.options.conjunction == Options::And::Product);
    CHECK(base.options.aggregation == Options::Aggregation::Sum);
    CHECK(base.options.samples == 100);
    CHECK(base.options.allocation == Options::Allocation::Budget);
    CHECK(base.options.minimumStrength == 0.05);
    CHECK(base.options.vetoAt == 0.7);
    CHECK(base.variables.at(0).unit == "m");
    CHECK(base.variables.at(0).terms.at(0).shape == Trapezoid{-kInf, -kInf, 0, 1});
    CHECK(base.suitability.high == 10);
    CHECK(base.suitability.terms.size() == 2);
    CHECK(base.rules.at(0).id == "A");
    CHECK(base.rules.at(0).because == "a reason");
    CHECK(base.rules.at(0).weight == 0.8);
    CHECK(base.rules.at(1).id == "2");
    CHECK(base.rules.at(1).consequents.at(0).isVeto());
    REQUIRE(base.otherwise.has_value());
    CHECK(base.otherwise->weight == 0.1);
    CHECK(base.policy.budget.shadowCapMs == 4);
    CHECK_FALSE(base.policy.budget.automatic);
    CHECK(base.policy.floor.when.size() == 4);
    CHECK(base.policy.floor.atStrength == 0.4);
    CHECK(base.policy.floor.oneLightTimes == 3.0);
    CHECK(base.policy.hysteresis.flipBanFrames == 90);
    CHECK(base.policy.hysteresis.crossFadeFrames == 5);
    CHECK(base.policy.probing.sigma == 1.5);
    CHECK(base.textHash != 0);
}

TEST_CASE("suitability and policy have defaults, and budget may be auto")
{
    const RuleBase base =
        parsed(std::string(kHead) + "rules: [{rule: if x is low then p is favoured}]\npolicy: {budget: auto}\n");
    CHECK(base.suitability.terms.size() == 3);
    CHECK(base.policy.budget.automatic);
    CHECK(base.policy.hysteresis.crossFadeFrames == 8);
    CHECK(base.policy.floor.when.empty());
    CHECK(base.options.allocation == Options::Allocation::None);
}

TEST_CASE("L11: what only a plan reads is reported in a base for which none is made, and nothing else is")
{
    const auto reported = [](const std::string& allocation) {
        std::string text;
        const std::string base =
            std::string(kHead) +
            "rules: [{rule: if x is low then p is favoured}]\noptions: {allocation: " + allocation +
            "}\npolicy:\n  budget: {headroom: 0.1}\n  floor: {when: x is low}\n"
            "  hysteresis: {planGain: 0.1, crossFadeFrames: 4}\n  probing: {everyFrames: 0}\n";
        const ParseResult result = parseRuleBase(base, "");
        CHECK(result.base.has_value());
        for (const Diagnostic& d : result.diagnostics) {
            CHECK(d.severity == Severity::Warning);
            text += std::to_string(d.line) + " " + d.id + " " + d.message.substr(0, d.message.find(" has")) + "\n";
        }
        return text;
    };
    CHECK(reported("budget").empty());
    CHECK(reported("none") == "7 L11 'budget'\n8 L11 'floor'\n9 L11 'planGain'\n10 L11 'probing'\n");

    const ParseResult target = parseRuleBase(std::string(kHead) + "rules: [{rule: if x is low then p is favoured}]\n"
                                                                  "options: {allocation: budget}\n"
                                                                  "policy: {budget: {targetFrameMs: 16.6}}\n",
                                             "");
    CHECK(target.base.has_value());
    REQUIRE(target.diagnostics.size() == 1);
    CHECK(target.diagnostics[0].id == std::string("L11"));
    CHECK(target.diagnostics[0].severity == Severity::Warning);
}

TEST_CASE("errors name line and column, inside sentences too, and all are reported at once")
{
    CHECK(errorsInRules("  - rule: \"if x is lowww then p is favoured\"\n"
                        "  - rule: >-\n"
                        "      if x is low\n"
                        "      then p favoured\n"
                        "  - rule: 'if y is low then p is favoured'\n"
                        "  - {id: D, rool: x}\n") == "8:14: error: expected 'is', found 'favoured' [R06]\n"
                                                     "10:5: error: a rule needs a key 'rule' [R04]\n"
                                                     "10:13: error: a rule has no key 'rool'; known: id, rule, "
                                                     "because, priority [R04]\n");
    // With the sentences in order, names are checked.
    CHECK(errorsInRules("  - rule: \"if x is lowww then p is favoured\"\n"
                        "  - rule: 'if y is low then p is good'\n") ==
          "5:20: error: 'x' has no term 'lowww'; known: low, high [L01]\n"
          "6:15: error: unknown variable 'y'; known: x [L01]\n"
          "6:34: error: 'suitability' has no term 'good'; known: avoided, acceptable, favoured [L01]\n");
}

TEST_CASE("a faulty rule base is refused with the place of each fault")
{
    const std::string rules = "rules: [{rule: if x is low then p is favoured}]\n";
    const std::string head(kHead);
    CHECK(errorsOf("version: 2\nvariables: {}\nrules: []\n") ==
          "1:10: error: this reader knows version 1 only, found '2' [R05]\n");
    CHECK(errorsOf("- 1\n") == "1:1: error: a rule base must be a map, found a list [R04]\n");
    CHECK(errorsOf("version: 1\nrules: []\n") == "1:1: error: a rule base needs a key 'variables' [R04]\n");
    CHECK(errorsOf(head + rules + "extra: 1\n") == "5:1: error: a rule base has no key 'extra'; known: version, "
                                                   "name, options, variables, concepts, suitability, rules, otherwise, "
                                                   "policy, kinds, monotony, tuned, presets [R04]\n");
    CHECK(errorsOf(head + rules + "options: {and: most}\n") ==
          "5:16: error: 'and' must be one of min product, found 'most' [R05]\n");
    CHECK(errorsOf(head + rules + "options: {defuzzifier: sampled(1)}\n") ==
          "5:24: error: 'defuzzifier' must be centroid or sampled(2 to 100000), found 'sampled(1)' [R05]\n");
    CHECK(errorsOf(head + rules + "policy: {budget: {headroom: 1.5}}\n") ==
          "5:29: error: 'headroom' must be a number from 0 to 0.99, found '1.5' [R05]\n");
    CHECK(errorsOf(head + rules + "policy: {budget: {targetFrameMs: 0}}\n").find("'targetFrameMs' must be a number") !=
          std::string::npos);
    for (const std::string frames : {"-1", "601", "some", "[8]"})
        CHECK(errorsOf(head + rules + "options: {allocation: budget}\npolicy: {hysteresis: {crossFadeFrames: " +
                       frames + "}}\n") == "6:40: error: 'crossFadeFrames' must be a number from 0 to 600, found " +
                                               (frames == "[8]" ? "a list" : "'" + frames + "'") + " [R05]\n");
    CHECK(errorsOf(head + rules + "options: {allocation: " + std::string(60, 'x') + "}\n") ==
          "5:23: error: 'allocation' must be one of none budget, found '" + std::string(40, 'x') + "...' [R05]\n");
    CHECK(errorsOf(head + rules + "policy: {hysteresis: {crossFadeFrames: 2.5}}\n") ==
          "5:40: error: 'crossFadeFrames' must be a whole number, found '2.5' [R05]\n");
    CHECK(errorsOf(head + rules + "policy: {floor: {when: z is low}}\n") ==
          "5:24: error: unknown variable 'z'; known: x [L01]\n");
    CHECK(errorsOf(head + rules + "otherwise: never p\n") ==
          "5:18: error: 'otherwise' cannot veto: it fires where the rules know nothing [R06]\n");
    CHECK(errorsOf("version: 1\nvariables: {x: {universe: [0], terms: {a: [0, 0, 1, one]}}}\nrules: []\n") ==
          "2:27: error: a universe is a list of 2 numbers [R04]\n2:53: error: not a number: 'one' [R05]\n");
    CHECK(errorsOf("version: 1\nvariables: {x: {universe: [0, 1], terms: {a: [0, 2, 1, 1]}}}\nrules: []\n") ==
          "2:43: error: term 'a': corners must ascend: a <= b <= c <= d [R05]\n");
    CHECK(errorsOf(head + "rules: [{id: A, rule: if x is low then p is favoured}, {id: A, rule: if x is high then p is "
                          "favoured}]\n") == "4:70: error: two rules are called 'A' [R05]\n");
    const auto errorOfId = [&](std::string_view id) {
        return errorsOf(head + "rules: [{id: \"" + std::string(id) + "\", rule: if x is low then p is favoured}]\n");
    };
    for (const char* id : {"x\\ny", "x\\0y", "x\\ty", "\\x7f"})
        CHECK(contains(errorOfId(id), "error: the id of a rule holds a control character"));
    CHECK(contains(errorOfId("otherwise"), "error: 'otherwise' cannot be the id of a rule"));
    CHECK(errorOfId(std::string(64, 'i')) == "");
    CHECK(contains(errorOfId(std::string(65, 'i')), "error: the id of a rule is longer than 64 bytes"));
}

TEST_CASE("concepts and priorities arrive, and a circle is reported at the word that closes it")
{
    const std::string head(kHead);
    const RuleBase base = parsed(head + "concepts: {scene: [calm, busy]}\n"
                                        "rules:\n"
                                        "  - {rule: if x is high then scene is busy, priority: 3}\n"
                                        "  - {rule: if scene is busy then p is favoured}\n");
    REQUIRE(base.concepts.size() == 1);
    CHECK(base.concepts[0].name == "scene");
    CHECK(base.concepts[0].terms.at(1).name == "busy");
    CHECK(base.concepts[0].terms.at(1).at == SourceSpot{4, 26});
    CHECK(base.rules[0].priority == 3);
    CHECK(base.rules[1].priority == 0);

    CHECK(errorsOf(head + "concepts: {scene: [busy], load: [heavy]}\n"
                          "rules:\n"
                          "  - rule: if scene is busy then load is heavy\n"
                          "  - rule: >-\n"
                          "      if x is high and\n"
                          "      load is heavy then scene is busy\n") ==
          "6:14: error: concept 'scene' is concluded from itself: scene <- load <- scene, closed by rule '1'; "
          "take 'scene' out of that rule's condition [R08]\n");
    CHECK(errorsOf(head + "concepts: {scene: busy}\nrules: []\n") ==
          "4:19: error: a concept is a list of words [R04]\n");
    CHECK(errorsOf(head + "concepts: []\nrules: []\n") ==
          "4:11: error: 'concepts' must be a map of name: [term, ...], found a list [R04]\n");
    CHECK(errorsOf(head + "rules: [{rule: if x is low then p is favoured, priority: 10}]\n") ==
          "4:58: error: 'priority' must be a number from 0 to 9, found '10' [R05]\n");
}

TEST_CASE("kinds and promises arrive, and a promise that is none is refused at the word")
{
    const std::string head = std::string(kHead) + "rules: [{rule: if x is high then any soft is favoured}]\n";
    const RuleBase base = parsed(head + "kinds: [spot, point]\nmonotony: [more x never raises any soft]\n");
    REQUIRE(base.kinds.size() == 2);
    CHECK(base.kinds[1].name == "point");
    REQUIRE(base.monotony.size() == 1);
    CHECK(base.monotony[0].variable == "x");
    CHECK(base.monotony[0].ascending);
    CHECK(base.monotony[0].raises);
    CHECK(base.monotony[0].isTrait);
    CHECK(base.monotony[0].name == "soft");
    CHECK(errorsOf(head + "monotony:\n  - more x always raises p\n") ==
          "6:12: error: expected 'never', found 'always' [R06]\n");
    CHECK(errorsOf(head + "monotony:\n  - most x never raises p\n") ==
          "6:5: error: expected 'more' or 'less', found 'most' [R06]\n");
    CHECK(errorsOf(head + "monotony:\n  - less z never raises p\n") ==
          "6:10: error: unknown variable 'z'; known: x [L01]\n");
    CHECK(errorsOf(head + "kinds: spot\n") == "5:8: error: 'kinds' is a list of words [R04]\n");
}

TEST_CASE("aliases, anchors, merge keys and repeated keys are errors")
{
    CHECK(errorsOf(std::string(kHead) + "rules: &r []\n") == "4:8: error: anchors are not accepted [R02]\n");
    CHECK(contains(errorsOf("a: &x {b: 1}\nc: *x\n"), "1:4: error: anchors are not accepted [R02]"));
    CHECK(errorsOf(std::string(kHead) + "rules: []\nversion: 1\n") ==
          "5:1: error: key 'version' stands twice in one map [R03]\n");
    CHECK(errorsOf("version: 1\nvariables:\n  x: {universe: [0, 1], terms: {a: [0, 0, 1, 1], a: [0, 0, 1, 1]}}\nrules: "
                   "[]\n") == "3:50: error: key 'a' stands twice in one map [R03]\n");
}

TEST_CASE("every limit on a rule file is where the page says: what reaches it is read, one more is refused")
{
    // 4096 rules.
    std::string text = "version: 1\nvariables:\n  x: {universe: [0, 1], terms: {low: [0, 0, 1, 1]}}\nrules:\n";
    for (std::size_t i = 0; i < kMaxRules; ++i)
        text += "  - {rule: 'if x is low then o is favoured'}\n";
    CHECK(errorsOf(text) == "");
    CHECK(errorsOf(text + "  - {rule: 'if x is low then o is favoured'}\n") ==
          "4101:5: error: more than 4096 rules [R07]\n");

    // 1 MiB, filled up by a comment.
    const std::string small = "version: 1\nvariables:\n  x: {universe: [0, 1], terms: {low: [0, 0, 1, 1]}}\n"
                              "rules: [{rule: 'if x is low then o is favoured'}]\n#";
    constexpr std::size_t kMost = std::size_t(1) << 20;
    CHECK(errorsOf(small + std::string(kMost - small.size(), '#')) == "");
    CHECK(errorsOf(small + std::string(kMost + 1 - small.size(), '#')) ==
          " error: the text is longer than 1048576 bytes [R07]\n");

    // 32 levels: the map of the file is one, so 31 lists may stand in a value. What they hold is no name, which is the
    // reader's to say; of the 32nd the parser says that it is too deep, and says nothing else.
    const auto nested = [&](std::size_t levels) {
        return "version: 1\nname: " + std::string(levels, '[') + std::string(levels, ']') + small.substr(10);
    };
    CHECK(errorsOf(nested(31)) == "2:7: error: 'name' must be a text, found a list [R04]\n");
    CHECK(errorsOf(nested(32)) == "2:38: error: nested deeper than 32 [R07]\n");
}

TEST_CASE("a text as long as may be takes a time in proportion, however its names are laid out")
{
    const std::string head = "version: 1\nvariables:\n  x: {universe: [0, 1], terms: {low: [0, 0, 1, 1]}}\nrules: [";
    const auto secondsFor = [&](std::size_t bytes, std::string_view between) {
        std::string sentence = "{rule: \"if x is low";
        for (int i = 0; i < 480; ++i)
            sentence += " or low";
        sentence += " then o is favoured\"},";
        std::string text = head;
        while (text.size() < bytes)
            text.append(sentence).append(between);
        const std::clock_t start = std::clock();
        CHECK(errorsOf(text + "]\n") == "");
        return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    };
    for (const char* between : {"", "\n "})          // one line, or many
        CHECK(secondsFor(1'000'000, between) < 5.0); // half a second; it used to be a minute
}

TEST_CASE("NaN is no number anywhere in a rule file")
{
    const auto base = [](std::string_view universe, std::string_view corners, std::string_view weight) {
        return std::string("version: 1\nvariables:\n  x: {universe: [0, ") + std::string(universe) +
               "], terms: {low: [" + std::string(corners) +
               "]}}\nrules: [{rule: 'if x is low then o is favoured with " + std::string(weight) + "'}]\n";
    };
    CHECK(errorsOf(base("1", "0, 0, 1, 1", "0.5")) == "");
    for (const std::string_view nan : {".nan", ".NaN", "nan", "-nan", "NAN"}) {
        CAPTURE(nan);
        CHECK(errorsOf(base(nan, "0, 0, 1, 1", "0.5")) != "");
        CHECK(errorsOf(base("1", "0, 0, " + std::string(nan) + ", 1", "0.5")) != "");
        CHECK(errorsOf(base("1", "0, 0, 1, 1", nan)) != "");
    }
}

TEST_CASE("a comma locale changes no number, in C or in C++")
{
    const std::vector<double> expected = decisions(shippedRuleBase("default"));
    const std::locale before = std::locale();
    const std::string cBefore = std::setlocale(LC_ALL, nullptr);

    bool found = false;
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "de_DE", "fr_FR.UTF-8", "fr_FR.utf8"})
        found = found || std::setlocale(LC_ALL, name) != nullptr;
    if (found)
        CHECK(std::string(std::localeconv()->decimal_point) == ",");
    else
        MESSAGE("no C locale with a decimal comma here; only the C++ one is tested");
    CHECK(decisions(shippedRuleBase("default")) == expected);
    CHECK(parseNumber("0.5") == 0.5);
    CHECK_FALSE(parseNumber("0,5").has_value());
    CHECK(fixedText(0.625, 2) == "0.62");
    std::setlocale(LC_ALL, cBefore.c_str());

    std::locale::global(std::locale(before, new CommaPunctuation));
    CHECK(decisions(shippedRuleBase("default")) == expected);
    CHECK(shortestText(1234.5) == "1234.5");
    CHECK(errorsOf("version: 1\nvariables: {x: {universe: [0, 1], terms: {a: [0, 0, 1, one]}}}\nrules: []\n") ==
          "2:56: error: not a number: 'one' [R05]\n");
    std::locale::global(before);
}

TEST_CASE("diagnostics count lines without grouping them, beyond a thousand")
{
    const std::string text = std::string(1500, '\n') + "version: 1\nversion: 1\n";
    CHECK(errorsOf(text) == "1502:1: error: key 'version' stands twice in one map [R03]\n");
}
