// Any decision at all: four questions, four answers of at most twelve lines, and what-ifs that are true.
#include <doctest/doctest.h>

#include "explain/selector_fixture.hpp"
#include "plan/random.hpp"
#include "rules/yaml/shipped.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr int kDecisions = 500; // of every shipped base

Situation randomSituation(Random& random, const rules::Engine& engine, bool budgeted)
{
    Situation out;
    for (std::uint32_t i = 0; i < kFactCount; ++i)
        out.facts[i] = random.between(0.0, 5.0);
    for (std::size_t i = 0; i < engine.compiled().variables.size(); ++i) {
        const rules::Variable& variable = engine.base().variables[i];
        const double width = variable.high - variable.low;
        double& fact = out.facts[engine.compiled().variables[i].fact];
        fact = random.between(variable.low - 0.1 * width, variable.high + 0.1 * width);
        if (variable.isCount()) fact = std::round(fact);
        if (random.below(12) == 0) fact = std::numeric_limits<double>::quiet_NaN();
    }
    for (Candidate& candidate : out.candidates) {
        if (random.below(3) == 0) candidate.exclusion = static_cast<Exclusion>(random.below(10));
        candidate.detail = random.below(5);
        candidate.refusal = candidate.exclusion == Exclusion::refused ? "it would not" : nullptr;
        candidate.quality = static_cast<float>(random.between(0.3, 1.0));
        candidate.predictedMs = static_cast<float>(random.between(0.05, 8.0));
        candidate.sureMs = candidate.predictedMs;
    }
    const auto methods = static_cast<std::uint32_t>(out.candidates.size());
    if (random.below(2)) out.incumbent = random.below(methods);
    if (random.below(8) == 0) out.pinned = random.below(methods);
    if (budgeted) {
        out.budgetMs = random.between(0.5, 16.0);
        out.othersMs = random.between(0.0, 8.0);
        out.importance = random.between(0.5, 2.0);
        out.cut = random.below(4) == 0;
        for (std::uint32_t part = random.below(4); part > 0; --part)
            out.parts.push_back({random.between(0.1, 3.0), randomSet(random, methods)});
    }
    return out;
}

void checkAnswer(const std::string& text, std::size_t leastLines)
{
    INFO(text);
    CHECK(lineCount(text) >= leastLines);
    CHECK(lineCount(text) <= kMostExplanationLines);
    CHECK(text.find("nan") == std::string::npos);
    CHECK(text.find("light 'lamp'") == 0);
}

} // namespace

TEST_CASE("every random decision answers all four questions, and every what-if flips the choice when made again")
{
    Random random(20);
    std::uint32_t flips = 0;
    for (const rules::ShippedRuleBase& base : rules::shippedRuleBases()) {
        const std::optional<rules::Engine> engine = bindRules(base.text);
        REQUIRE(engine.has_value());
        for (int i = 0; i < kDecisions; ++i) {
            SelectorFixture fixture(*engine);
            Situation situation = randomSituation(random, *engine, i % 2 == 0);
            const DecisionRecord before = fixture.decide(situation);
            situation.facts[random.below(kFactCount)] = random.between(0.0, 20.0);
            if (random.below(2)) situation.incumbent = before.method;
            const DecisionRecord record = fixture.decide(situation);
            checkAnswer(explainWhy(record, fixture.words()), 3);
            for (std::uint32_t m = 0; m < record.methods; ++m)
                checkAnswer(explainWhyNot(record, m, fixture.words()), 2);
            checkAnswer(explainWhatIf(record, fixture.words()), 2);
            checkAnswer(explainWhatChanged(record, &before, fixture.words()), 2);
            if (record.budgeted) continue; // question_test and the next case ask the plan again
            for (const NearMiss& miss : nearMisses(record, *engine)) {
                Situation changed = situation;
                changed.facts[miss.fact] = miss.to;
                const DecisionRecord again = SelectorFixture(*engine).decide(changed);
                CHECK(again.method == miss.method);
                CHECK(again.method != record.method);
                ++flips;
            }
        }
    }
    CHECK(flips > 500);
    MESSAGE("flips verified: " << flips);
}

TEST_CASE("in a plan of two lights, what-ifs come true once the plan has settled")
{
    Random random(21);
    std::uint32_t flips = 0, agree = 0;
    const std::optional<rules::Engine> engine = bindRules(fixtureRules());
    REQUIRE(engine.has_value());
    for (int i = 0; i < 600; ++i) {
        Situation situation = randomSituation(random, *engine, true);
        situation.cut = false;
        situation.pinned = situation.incumbent = UINT32_MAX;
        // Settled: what it has is what the plan moves towards.
        const auto settle = [&](SelectorFixture& fixture, Situation at) {
            DecisionRecord record = fixture.decide(at);
            for (std::uint32_t frame = 0; frame < 2 * plan::kSpareFrames + 5; ++frame) {
                at.incumbent = record.method;
                record = fixture.decide(at);
            }
            return record;
        };
        SelectorFixture fixture(*engine);
        const DecisionRecord record = settle(fixture, situation);
        if (record.method == UINT32_MAX || record.planMs > record.usableMs) continue;
        for (const NearMiss& miss : nearMisses(record, *engine)) {
            SelectorFixture copy = fixture;
            Situation changed = situation;
            changed.facts[miss.fact] = miss.to;
            changed.incumbent = record.method;
            ++flips;
            agree += settle(copy, changed).method == miss.method;
        }
    }
    CHECK(flips > 100);
    CHECK(100 * agree >= 99 * flips); // a plan within a budget depends on the one before it
}
