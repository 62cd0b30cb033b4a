// The four questions, one situation after the other; the texts name the fact, the rule and the number.
#include <doctest/doctest.h>

#include <cmath>

#include "explain/selector_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

SelectorFixture makeFixture()
{
    std::optional<rules::Engine> engine = bindRules(fixtureRules());
    REQUIRE(engine.has_value());
    return SelectorFixture(std::move(*engine));
}

std::string nameOf(std::uint32_t method)
{
    return std::string(methodText(method, methodWords()));
}

std::string whyNot(const SelectorFixture& fixture, const DecisionRecord& record, std::string_view method)
{
    return explainWhyNot(record, methodNamed(method), fixture.words());
}

void checkContains(const std::string& text, std::initializer_list<const char*> parts)
{
    INFO(text);
    CHECK(lineCount(text) <= kMostExplanationLines);
    for (const char* part : parts)
        CHECK_MESSAGE(contains(text, part), std::string(part));
}

/// Asks the rules themselves: the best suitability among what may serve, without the code under test.
std::uint32_t bestByRules(const SelectorFixture& fixture, Situation situation, std::uint32_t fact, double value)
{
    situation.facts[fact] = value;
    rules::Inference inference = fixture.engine().makeInference();
    fixture.engine().evaluate(situation.facts, inference);
    std::uint32_t best = UINT32_MAX;
    for (std::uint32_t m = 0; m < situation.candidates.size(); ++m) {
        const rules::OutputState& output = inference.outputs[m];
        if (situation.candidates[m].exclusion != Exclusion::none || output.vetoed || !output.hasOpinion) continue;
        if (best == UINT32_MAX || output.quantised > inference.outputs[best].quantised ||
            (output.quantised == inference.outputs[best].quantised && m == situation.incumbent))
            best = m;
    }
    return best;
}

} // namespace

TEST_CASE("a decision by the rules: why, why not, and what if hold up when the rules are asked again")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    const DecisionRecord record = fixture.decide(situation);
    REQUIRE(nameOf(record.method) == "stencil_volume");
    checkContains(explainWhy(record, fixture.words()),
                  {"light 'lamp', frame 1: stencil_volume, highest suitability", "rule A1: viewerDistance near 1.00",
                   "strength 1.00", "because edges are looked at from near", "viewerDistance 12.50 m: near 1.00",
                   "casterTriangles 3.50 log10: small 1.00", "predicted 1.00 ms", "quality 1.00",
                   "next: pcf_hybrid, suitability 0.50"});
    checkContains(whyNot(fixture, record, "shadow_map"),
                  {"not shadow_map:", "outscored: suitability 0.16 against 0.84", "rule A1 (avoided)",
                   "silent: rule A2: viewerDistance far 0.00", "it would be chosen with viewerDistance ",
                   "instead of 12.5 m"});
    checkContains(whyNot(fixture, record, "stencil_volume"), {"stencil_volume is what was chosen"});
    checkContains(whyNot(fixture, record, "ray_traced"), {"no rule that fires speaks of it"});

    const std::vector<NearMiss> misses = nearMisses(record, fixture.engine());
    REQUIRE(misses.size() == 2);
    const std::string text = explainWhatIf(record, fixture.words());
    checkContains(text, {"viewerDistance 12.5 m -> ", "casterTriangles 3.5 log10 (3162 triangles) -> 5 log10",
                         "pcf_hybrid instead"});
    for (const NearMiss& miss : misses) {
        const double width = miss.fact == std::uint32_t(Fact::viewerDistance) ? 90.0 : 5.0;
        CHECK(bestByRules(fixture, situation, miss.fact, miss.to) == miss.method);
        CHECK(miss.method != record.method);
        // A little before it nothing flips: it is the nearest, to the digits shown.
        const double before = miss.to + (miss.to > miss.from ? -0.002 : 0.002) * width;
        CHECK(bestByRules(fixture, situation, miss.fact, before) == record.method);
    }
    CHECK(misses[0].distance <= misses[1].distance);
}

TEST_CASE("a vetoed method names the rule, its reason, and the fact that would lift the veto")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    situation.fact(Fact::casterTriangles) = 6.5;
    const DecisionRecord record = fixture.decide(situation);
    CHECK(nameOf(record.method) == "pcf_hybrid");
    checkContains(explainWhy(record, fixture.words()), {"pcf_hybrid, highest suitability", "rule A1 (acceptable)",
                                                        "out: stencil_volume (never, says rule V1)"});
    checkContains(whyNot(fixture, record, "stencil_volume"),
                  {"never, says rule V1", "rule V1: casterTriangles huge 1.00",
                   "because a million silhouette edges do not fit", "it would be chosen with casterTriangles 4.99",
                   "instead of 6.5 log10"});
    const std::vector<NearMiss> misses = nearMisses(record, fixture.engine(), methodNamed("stencil_volume"));
    REQUIRE(misses.size() == 1);
    CHECK(bestByRules(fixture, situation, misses[0].fact, misses[0].to) == methodNamed("stencil_volume"));
}

TEST_CASE("the near floor names quality, limit and how true its condition is")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    situation.budgetMs = 100.0;
    situation.fact(Fact::viewerDistance) = 44.0; // near 0.533: the floor holds
    situation.method("shadow_map").quality = 0.7f;
    situation.method("stencil_volume").exclusion = Exclusion::topology;
    situation.method("stencil_volume").detail = 3;
    const DecisionRecord record = fixture.decide(situation);
    CHECK(nameOf(record.method) == "pcf_hybrid");
    checkContains(whyNot(fixture, record, "shadow_map"),
                  {"near floor: its quality 0.70 is below 0.80", "0.53 true", "0.50 is enough"});
    checkContains(whyNot(fixture, record, "stencil_volume"), {"3 casters without topology yet"});
    checkContains(explainWhy(record, fixture.words()), {"near floor holds, quality >= 0.80", "of 98.00 ms usable"});
    DecisionRecord few = record;
    few.minimumQuality = 0.72f;
    checkContains(whyNot(fixture, few, "shadow_map"),
                  {"near floor: its quality 0.70 is below 0.72 (0.80 for all near lights together); the floor"});
}

TEST_CASE("a method that does not fit the budget names both times, and what the others leave")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    situation.budgetMs = 10.0;
    situation.othersMs = 4.0;
    situation.method("stencil_volume").predictedMs = situation.method("stencil_volume").sureMs = 8.0f;
    situation.method("pcf_hybrid").predictedMs = situation.method("pcf_hybrid").sureMs = 3.0f;
    situation.method("pcf_hybrid").quality = 0.95f; // shows less
    const DecisionRecord record = fixture.decide(situation);
    CHECK(nameOf(record.method) == "pcf_hybrid");
    CHECK(record.reason == GN_REASON_BUDGET);
    checkContains(explainWhy(record, fixture.words()),
                  {"the plan: better ones do not fit the budget", "stencil_volume suits better (0.84)", "needs 8.00 ms",
                   "plan of all lights: 7.00 ms of 9.80 ms usable (budget 10.00 ms)", "the first plan"});
    checkContains(whyNot(fixture, record, "stencil_volume"),
                  {"budget: it needs 8.00 ms", "the other lights leave 5.80 ms of 9.80 ms"});
    checkContains(explainWhatIf(record, fixture.words()),
                  {"viewerDistance", "shadow_map instead", "other lights' methods"});
}

TEST_CASE("a budget that nothing can keep is said to be one, with the least possible")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    situation.budgetMs = 5.0;
    situation.othersMs = 4.0;
    for (Candidate& candidate : situation.candidates)
        candidate.predictedMs = candidate.sureMs = 3.0f;
    checkContains(explainWhy(fixture.decide(situation), fixture.words()),
                  {"plan of all lights: 7.00 ms of 4.90 ms usable", "nothing fits: the least possible is 7.00 ms"});
    situation.budgetMs = 50.0;
    CHECK(!contains(explainWhy(fixture.decide(situation), fixture.words()), "nothing fits"));
    situation.budgetMs = 7.1; // kept, though not with the headroom of two hundredths
    const std::string kept = explainWhy(fixture.decide(situation), fixture.words());
    checkContains(kept, {"plan of all lights: 7.00 ms of 6.96 ms usable"});
    CHECK(!contains(kept, "nothing fits"));
}

TEST_CASE("what suits better but shows no more is left for its price, with time to spare too")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    situation.budgetMs = 100.0;
    situation.method("stencil_volume").predictedMs = situation.method("stencil_volume").sureMs = 8.0f;
    situation.method("pcf_hybrid").predictedMs = situation.method("pcf_hybrid").sureMs = 3.0f;
    const DecisionRecord record = fixture.decide(situation);
    CHECK(nameOf(record.method) == "pcf_hybrid");
    CHECK(record.reason == GN_REASON_PRICE);
    checkContains(explainWhy(record, fixture.words()),
                  {"stencil_volume suits better (0.84), but shows no more and takes 8.00 ms"});
    checkContains(whyNot(fixture, record, "stencil_volume"), {"shows no more and takes 8.00 ms"});
    checkContains(whyNot(fixture, record, "shadow_map"), {"worth", "takes 1.00 ms against 3.00 ms"});
}

TEST_CASE("a light whose method failed when it was to run answers, with nothing in its place to compare with")
{
    for (const double budgetMs : {0.0, 100.0}) {
        CAPTURE(budgetMs);
        SelectorFixture fixture = makeFixture();
        Situation situation;
        situation.budgetMs = budgetMs;
        situation.method("stencil_volume").predictedMs = situation.method("stencil_volume").sureMs = 8.0f;
        situation.method("pcf_hybrid").predictedMs = situation.method("pcf_hybrid").sureMs = 3.0f;
        DecisionRecord record = fixture.decide(situation);
        record.method = UINT32_MAX;
        record.reason = GN_REASON_NOTHING_READY;
        for (const char* method : {"stencil_volume", "pcf_hybrid", "shadow_map"})
            CHECK(lineCount(whyNot(fixture, record, method)) > 1);
        checkContains(explainWhy(record, fixture.words()), {"none, nothing can serve"});
    }
}

TEST_CASE("what suits better but is below the near floor is left for the floor, not for the budget")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    situation.budgetMs = 100.0;
    situation.method("stencil_volume").quality = 0.7f;
    const DecisionRecord record = fixture.decide(situation);
    CHECK(nameOf(record.method) == "pcf_hybrid");
    CHECK(record.reason == GN_REASON_FLOOR);
    checkContains(explainWhy(record, fixture.words()),
                  {"pcf_hybrid, what suits better is below the near floor",
                   "stencil_volume suits better (0.84), but its quality 0.70 is below the near floor"});
}

TEST_CASE("the long explanation says of every method that could serve what kept it from it")
{
    std::vector<Candidate> candidates(methodWords().size());
    LightDecision decision;
    decision.candidates = candidates;
    decision.method = 0;
    decision.hold = plan::Hold::ban;
    decision.candidates[0].quality = 1.0f;
    const auto textFor = [&](plan::Why why, std::int32_t quantised = 100) {
        const Candidate candidate{
            .quantised = quantised, .quality = 0.5f, .predictedMs = 2.0f, .sureMs = 3.0f, .why = why};
        return passedOverText(decision, candidate);
    };
    CHECK(textFor(plan::Why::floor) == "its quality 0.50 is below the near floor");
    CHECK(textFor(plan::Why::budget) == "does not fit the budget: needs 2.00 ms (not timed here: up to 3.00 ms)");
    CHECK(textFor(plan::Why::hysteresis) == "held: the light has just left it");
    CHECK(textFor(plan::Why::price) ==
          "shows less (quality 0.50 against 1.00) and takes 2.00 ms (not timed here: up to 3.00 ms)");
    CHECK(textFor(plan::Why::outscored) == "outscored");
    CHECK(textFor(plan::Why::noOpinion, -1) == "no opinion");
    decision.method = UINT32_MAX;
    CHECK(textFor(plan::Why::price) == "outscored");
    decision.reason = GN_REASON_PINNED;
    CHECK(textFor(plan::Why::outscored) == "the host pinned another one");
}

TEST_CASE("what suits better but is worth no more with its quality says so")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    situation.budgetMs = 100.0;
    situation.fact(Fact::viewerDistance) = 50.0; // the floor does not hold
    situation.method("shadow_map").quality = 0.5f;
    situation.method("pcf_hybrid").quality = 1.0f;
    situation.method("shadow_map").predictedMs = situation.method("shadow_map").sureMs = 0.5f;
    situation.method("stencil_volume").exclusion = Exclusion::lightKind;
    const DecisionRecord record = fixture.decide(situation);
    CHECK(nameOf(record.method) == "pcf_hybrid");
    CHECK(record.reason == GN_REASON_UTILITY);
    checkContains(explainWhy(record, fixture.words()),
                  {"pcf_hybrid, the plan: what suits better is worth no more with its quality",
                   "shadow_map suits better", "but with its quality 0.50 is worth 0."});
}

TEST_CASE("a held method names the hold, the gain and what a change needs")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    situation.budgetMs = 10.0;
    situation.fact(Fact::viewerDistance) = 70.0;
    situation.method("shadow_map").exclusion = Exclusion::lightKind;
    situation.method("pcf_hybrid").quality = 0.1f; // suits better than stencil_volume, and shows a tenth
    const DecisionRecord first = fixture.decide(situation);
    REQUIRE(nameOf(first.method) == "stencil_volume");
    situation.incumbent = first.method;
    const auto suitability = [&](const char* name) { return first.candidates[methodNamed(name)].quantised; };
    situation.method("pcf_hybrid").quality = // gains 1 %
        1.01f * static_cast<float>(suitability("stencil_volume")) / static_cast<float>(suitability("pcf_hybrid"));
    const DecisionRecord record = fixture.decide(situation);
    CHECK(nameOf(record.method) == "stencil_volume");
    REQUIRE(record.hold == plan::Hold::threshold);
    checkContains(whyNot(fixture, record, "pcf_hybrid"),
                  {"held: the change would not gain enough", "it is worth 1.0 % more", "needs more than 2.0 %"});
    // What if: the very number flips the plan too, once it has been calm for long enough.
    for (const NearMiss& miss : nearMisses(record, fixture.engine())) {
        Situation changed = situation;
        changed.facts[miss.fact] = miss.to;
        std::uint32_t method = record.method;
        for (std::uint32_t i = 0; i < plan::kSpareFrames + 2; ++i) {
            changed.incumbent = method;
            method = fixture.decide(changed).method;
        }
        CHECK(nameOf(method) == nameOf(miss.method));
        for (std::uint32_t i = 0; i < 200; ++i) { // back, past any ban
            Situation back = situation;
            back.incumbent = record.method;
            fixture.decide(back);
        }
    }
}

TEST_CASE("a pinned light answers with the pin, and what the rules would have chosen")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    situation.pinned = methodNamed("cube_map");
    const DecisionRecord record = fixture.decide(situation);
    CHECK(record.replan == Replan::host);
    checkContains(explainWhy(record, fixture.words()), {"cube_map, pinned by the host"});
    checkContains(whyNot(fixture, record, "stencil_volume"), {"the host pinned cube_map"});
    checkContains(explainWhatIf(record, fixture.words()), {"the host pinned it", "would choose stencil_volume"});
    CHECK(nearMisses(record, fixture.engine()).empty());
}

TEST_CASE("a pinned method that cannot serve is named with its reason, whatever serves")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    situation.pinned = methodNamed("cube_map");
    situation.method("cube_map").exclusion = Exclusion::roundTrips;
    situation.method("cube_map").detail = 2;
    const DecisionRecord record = fixture.decide(situation);
    REQUIRE(nameOf(record.method) == "stencil_volume");
    checkContains(explainWhy(record, fixture.words()),
                  {"stencil_volume, highest suitability",
                   "the host pinned cube_map, which cannot serve: needs the CPU between passes (2 round trips)"});
}

TEST_CASE("a method that is not ready names the fallback that stands in for it")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    situation.method("stencil_volume").exclusion = Exclusion::notReady;
    const DecisionRecord record = fixture.decide(situation);
    CHECK(nameOf(record.method) == "shadow_map");
    checkContains(explainWhy(record, fixture.words()),
                  {"fallback while the wanted method is not ready (stencil_volume)",
                   "stencil_volume is wanted: not ready: its pipelines have not run yet"});
    checkContains(whyNot(fixture, record, "stencil_volume"), {"not ready"});
    checkContains(whyNot(fixture, record, "pcf_hybrid"), {"outscored: suitability 0.50 against 0.16", "wanted"});
}

TEST_CASE("under a budget a method that is not ready, and rules without an opinion, stay the reason")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    situation.budgetMs = 100.0;
    situation.method("stencil_volume").exclusion = Exclusion::notReady;
    const DecisionRecord waits = fixture.decide(situation);
    CHECK(nameOf(waits.method) == "pcf_hybrid"); // the plan's, better than the fallback
    CHECK(waits.reason == GN_REASON_FALLBACK);
    checkContains(explainWhy(waits, fixture.words()),
                  {"pcf_hybrid, fallback while the wanted method is not ready (stencil_volume)",
                   "stencil_volume is wanted: not ready"});

    SelectorFixture silent = makeFixture();
    situation = {};
    situation.budgetMs = 100.0;
    situation.fact(Fact::viewerDistance) = std::nan(""); // no rule fires
    situation.method("ray_traced").predictedMs = situation.method("ray_traced").sureMs = 0.1f;
    const DecisionRecord record = silent.decide(situation);
    CHECK(nameOf(record.method) == "ray_traced");
    CHECK(record.reason == GN_REASON_NO_OPINION);
}

TEST_CASE("nothing able to serve is an answer, too")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    for (Candidate& candidate : situation.candidates)
        candidate.exclusion = Exclusion::lightKind;
    const DecisionRecord record = fixture.decide(situation);
    checkContains(explainWhy(record, fixture.words()),
                  {"none, nothing can serve", "does not serve this kind of light"});
    checkContains(whyNot(fixture, record, "shadow_map"), {"does not serve this kind of light"});
    checkContains(explainWhatIf(record, fixture.words()), {"nothing: no change of a single fact"});
}

TEST_CASE("what changed: the facts, the rules and the suitabilities that moved, in numbers")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    const DecisionRecord before = fixture.decide(situation);
    situation.incumbent = before.method;
    situation.fact(Fact::viewerDistance) = 55.0;
    const DecisionRecord after = fixture.decide(situation);
    checkContains(explainWhatChanged(after, &before, fixture.words()),
                  {"frame 2 against frame 1: stencil_volume -> shadow_map", "viewerDistance 12.5 m -> 55 m",
                   "strength 0.00 -> 0.83: rule A2: viewerDistance far 0.83", "shadow_map 0.16 -> ",
                   "strength 1.00 -> 0.17: rule A1"});
    checkContains(explainWhatChanged(after, nullptr, fixture.words()), {"no earlier frame"});
    situation.incumbent = after.method;
    const DecisionRecord same = fixture.decide(situation);
    checkContains(explainWhatChanged(same, &after, fixture.words()), {"still shadow_map", "facts: all the same"});
    situation.method("shadow_map").exclusion = Exclusion::memory;
    situation.method("shadow_map").detail = 64u << 20;
    checkContains(explainWhatChanged(fixture.decide(situation), &same, fixture.words()),
                  {"shadow_map is out (memory: needs 64.0 MiB"});
    // Against the last frame of another method.
    const DecisionRecord all[] = {before, after, same};
    const auto find = [&](std::uint64_t frame, DecisionRecord& out) {
        if (frame < 1 || frame > 3) return false;
        out = all[frame - 1];
        return true;
    };
    REQUIRE(earlierRecord(same, 1, false, find).has_value());
    CHECK(earlierRecord(same, 1, false, find)->frame == 2);
    REQUIRE(earlierRecord(same, 1, true, find).has_value());
    CHECK(earlierRecord(same, 1, true, find)->frame == 1);
    CHECK(!earlierRecord(before, 1, false, find).has_value());
}

TEST_CASE("what changed over a knowledge base that was loaded says so, and counts no timings backwards")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    DecisionRecord before = fixture.decide(situation), now = fixture.decide(situation);
    before.knowledge = 500, now.knowledge = 512;
    checkContains(explainWhatChanged(now, &before, fixture.words()), {"the cost model learned from 12 timings"});
    before.knowledge = 9000;
    const std::string text = explainWhatChanged(now, &before, fixture.words());
    checkContains(text, {"a knowledge base was loaded in between"});
    CHECK_FALSE(contains(text, "learned from"));
}

TEST_CASE("without the rule base of the frame the numbers still answer")
{
    SelectorFixture fixture = makeFixture();
    const DecisionRecord record = fixture.decide({});
    ExplainWords words = fixture.words();
    words.engine = nullptr;
    checkContains(explainWhy(record, words), {"no longer loaded", "1 (strength 1.00)", "viewerDistance 12.5 m"});
    checkContains(explainWhyNot(record, methodNamed("shadow_map"), words), {"outscored: suitability 0.16"});
    checkContains(explainWhatIf(record, words), {"no longer loaded"});
}
