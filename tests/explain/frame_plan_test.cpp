// All lights of a frame together, without a device.
#include <doctest/doctest.h>

#include <array>
#include <fstream>
#include <iterator>
#include <random>

#include "explain/plan_table.hpp"
#include "rules/yaml/shipped.hpp"

using namespace gnomon;
using namespace gnomon::test;

TEST_CASE("what one light has shown of a method is expected of the others, and stays when it is gone")
{
    PlanTable table;
    FramePlan plan(table.methods(), true);
    std::vector<PlanTable::Lamp> lamps(3);
    table.predict(plan, lamps, 1);
    const float before = lamps[2].decision.candidates[0].predictedMs;
    lamps[0].memory.incumbent = 0;
    plan.observe(lamps[0].memory, 0, {.frame = 1, .resolveGpuMs = 8.0f * before}, false);
    plan.endFrame();
    table.predict(plan, lamps, 2);
    const Candidate& other = lamps[2].decision.candidates[0];
    CHECK(lamps[0].decision.candidates[0].predictedMs == doctest::Approx(8.0f * before).epsilon(0.01));
    CHECK(other.predictedMs > 3.0f * before);
    CHECK(other.sureMs > other.predictedMs);
    plan.forget(lamps[0].memory);
    table.predict(plan, lamps, 3);
    CHECK(lamps[2].decision.candidates[0].predictedMs == doctest::Approx(other.predictedMs));
}

TEST_CASE("without a plan, too, it is known what the cheapest methods would take, whichever serve")
{
    PlanTable table;
    FramePlan plan(table.methods(), true);
    std::vector<PlanTable::Lamp> lamps(2);
    table.predict(plan, lamps, 1);
    double sum = 0.0;
    for (const PlanTable::Lamp& lamp : lamps)
        sum += double{cheapestMs(std::span(lamp.decision.candidates).first(table.methods().size()), UINT32_MAX)};
    CHECK(sum > 0.0);
    CHECK(table.report.cheapestMs == sum);
}

TEST_CASE("without a plan every light carries its share of the view's work, as if all had the method")
{
    PlanTable table;
    FramePlan plan(table.methods(), true);
    const plan::SharedPart parts[] = {{6.0, {0, 2}}, {1.5, {0}}};
    for (const std::size_t lights : {1u, 3u}) {
        std::vector<PlanTable::Lamp> lamps(lights);
        table.predict(plan, lamps, lights, parts);
        for (const PlanTable::Lamp& lamp : lamps) {
            CHECK(lamp.decision.candidates[0].sharedMs == doctest::Approx(7.5 / static_cast<double>(lights)));
            CHECK(lamp.decision.candidates[1].sharedMs == 0.0f);
            CHECK(lamp.decision.candidates[2].sharedMs == doctest::Approx(6.0 / static_cast<double>(lights)));
        }
        for (PlanTable::Lamp& lamp : lamps)
            plan.forget(lamp.memory);
    }
}

TEST_CASE("without a budget lights leave together for what they share, or not at all")
{
    PlanTable table;
    FramePlan plan(table.methods(), true);
    rules::RuleBase base;
    base.options.allocation = rules::Options::Allocation::Budget;
    // Two methods that show the same.
    const std::uint32_t now = methodNamed("ray_traced"), other = methodNamed("tile_shafts");
    std::vector<PlanTable::Lamp> lamps(3);
    std::uint64_t frame = 1;
    for (PlanTable::Lamp& lamp : lamps)
        lamp.suited = lamp.memory.incumbent = now, lamp.able = {now};
    for (; frame < 80; ++frame) { // 10 ms a light by the one, 5 by the other
        table.predict(plan, lamps, frame, {}, &base);
        for (PlanTable::Lamp& lamp : lamps) {
            lamp.memory.incumbent = frame % 40 < 20 ? now : other;
            plan.observe(lamp.memory, lamp.memory.incumbent,
                         {.frame = frame, .resolveCpuMs = lamp.memory.incumbent == now ? 10.0f : 5.0f}, false);
        }
        plan.endFrame();
    }
    const auto serving = [&](std::uint32_t able, double partMs, std::uint32_t incumbent, bool isNew = false) {
        const plan::SharedPart parts[] = {{partMs, {other}}};
        for (PlanTable::Lamp& lamp : lamps) {
            lamp.memory.incumbent = incumbent;
            lamp.memory.pricedAt = isNew ? frame : 0;
            lamp.able = {now};
            if (able >> (&lamp - lamps.data()) & 1) lamp.able.add(other);
        }
        table.predict(plan, lamps, ++frame, parts, &base);
        std::uint32_t moved = 0;
        for (const PlanTable::Lamp& lamp : lamps)
            moved |= lamp.decision.method == other ? 1u << (&lamp - lamps.data()) : 0u;
        return moved;
    };
    CHECK(serving(0b111, 0.0, now) == 0b111);
    const Candidate& by = lamps[0].candidates[other];
    REQUIRE(lamps[0].decision.candidates[now].predictedMs == doctest::Approx(10.0).epsilon(0.1));
    REQUIRE(by.predictedMs == doctest::Approx(5.0).epsilon(0.1));
    // A part of 7.5 ms: three save 15 ms by it, one or two nothing that is worth it.
    CHECK(serving(0b111, 7.5, now) == 0b111);
    CHECK(by.sharedMs == doctest::Approx(2.5));
    CHECK(serving(0b001, 7.5, now) == 0);
    CHECK(by.sharedMs == doctest::Approx(7.5)); // it would be alone
    CHECK(serving(0b101, 6.0, now) == 0b101);
    CHECK(by.sharedMs == doctest::Approx(3.0));
    CHECK(serving(0b101, 8.5, now) == 0);
    // Nor does who serves by it already stay where the others may not follow.
    CHECK(serving(0b001, 7.5, other) == 0);
    // What has just been changed to is given time for its timings, but not where these would have to be wrong by half.
    CHECK(serving(0b001, 7.5, other, true) == 0b001);
    CHECK(serving(0b001, 14.0, other, true) == 0);
}

TEST_CASE("without a budget one light at a time tries what may be cheaper, for two hundredths of all time")
{
    const std::uint32_t own = methodNamed("ray_traced"), other = methodNamed("tile_shafts");
    rules::RuleBase base;
    base.options.allocation = rules::Options::Allocation::Budget;
    constexpr std::uint64_t kFrames = 1200;
    // What a light truly takes by the other one, in terms of its own method, and whether rules let lights try.
    const auto served = [&](float share, std::uint32_t everyFrames) {
        base.policy.probing.everyFrames = everyFrames;
        PlanTable table;
        FramePlan plan(table.methods(), true);
        const cost::KnowledgeBase& shipped = cost::shippedKnowledge();
        REQUIRE(plan.teach(shipped, {shipped.devices.front().device, shipped.devices.front().kind}).methods > 0);
        std::vector<PlanTable::Lamp> lamps(8);
        for (PlanTable::Lamp& lamp : lamps) {
            lamp.able = {own, other};
            lamp.suited = lamp.memory.incumbent = own;
            lamp.memory.measured = true;
        }
        double all = 0.0, waste = 0.0, tried = 0.0;
        float ownMs = 0.0f;
        for (std::uint64_t frame = 1; frame <= kFrames; ++frame) {
            table.predict(plan, lamps, frame, {}, &base, 8.0 * double{ownMs});
            // As dear as the other one is expected to be, so that nothing but a trial can tell.
            if (frame == 1) ownMs = lamps[0].candidates[other].predictedMs;
            std::uint32_t trials = 0, others = 0;
            for (PlanTable::Lamp& lamp : lamps) {
                const std::uint32_t method = lamp.decision.method;
                const float ms = method == own ? ownMs : share * ownMs;
                if (method != lamp.memory.incumbent) lamp.memory.methodSince = frame;
                lamp.memory.incumbent = method;
                trials += lamp.decision.reason == GN_REASON_TRIAL;
                others += method == other;
                all += double{ms};
                waste += double{std::max(ms - ownMs, 0.0f)};
                plan.observe(lamp.memory, method, {.frame = frame, .resolveCpuMs = ms}, false);
            }
            plan.endFrame();
            CHECK(trials <= 1);
            tried += trials;
            if (frame == kFrames) return std::array{tried, waste / all, double(others)};
        }
        return std::array<double, 3>{};
    };
    const auto [tried, waste, others] = served(0.7f, 60);
    CHECK(tried > 0.0);
    CHECK(others == 8.0);
    const auto [again, lost, left] = served(1.5f, 60);
    CHECK(again > 0.0);
    CHECK(lost > 0.0);
    CHECK(lost < 0.02);
    CHECK(left == 0.0);
    CHECK(served(0.7f, 0)[0] == 0.0);
}

TEST_CASE("what is predicted to be cheaper is tried before what only may be")
{
    const std::uint32_t own = methodNamed("ray_traced");
    const std::uint32_t cheaper = methodNamed("tile_shafts"), unsure = methodNamed("coherence_sampling");
    PlanTable table;
    FramePlan plan(table.methods(), true);
    const cost::KnowledgeBase& shipped = cost::shippedKnowledge();
    REQUIRE(plan.teach(shipped, {shipped.devices.front().device, shipped.devices.front().kind}).methods > 0);
    rules::RuleBase base;
    base.options.allocation = rules::Options::Allocation::Budget;
    base.policy.probing.everyFrames = 60;
    std::vector<PlanTable::Lamp> lamps(16);
    for (PlanTable::Lamp& lamp : lamps) {
        lamp.able = {own};
        lamp.suited = lamp.memory.incumbent = own;
        lamp.memory.measured = true;
    }
    constexpr float kOwnMs = 1.45f;
    std::uint64_t frame = 0;
    std::uint32_t trials = 0, serving = 0, changing = 0; // lights on trial, with the cheaper one; frames with changes
    const auto next = [&] {
        table.predict(plan, lamps, ++frame, {}, &base, 16.0 * double{kOwnMs});
        trials = serving = 0;
        std::uint32_t changes = 0;
        double firstMs = 0.0, steadyMs = 0.0;
        for (PlanTable::Lamp& lamp : lamps) {
            const std::uint32_t method = lamp.decision.method;
            steadyMs += double{lamp.candidates[lamp.memory.incumbent].predictedMs};
            if (method != lamp.memory.incumbent) {
                lamp.memory.methodSince = frame;
                firstMs += double{lamp.candidates[method].firstMs}; // without a fade: both are exact
                ++changes;
            }
            lamp.memory.incumbent = method;
            trials += lamp.decision.reason == GN_REASON_TRIAL;
            serving += method == cheaper;
            const float ms = method == own ? kOwnMs : lamp.decision.predictedMs;
            plan.observe(lamp.memory, method, {.frame = frame, .resolveCpuMs = ms}, false);
        }
        plan.endFrame();
        changing += changes > 0;
        CHECK((changes <= 1 || firstMs <= plan::kMostFirst * steadyMs)); // no frame takes far longer than others
    };
    while (frame < 600) // time is saved up
        next();
    for (std::size_t i = 0; i < lamps.size(); ++i)
        lamps[i].able.add(i < 14 ? cheaper : unsure);
    next();
    CHECK(serving == 1);
    CHECK(trials == 0);
    while (frame < 700 && trials == 0)
        next();
    CHECK(serving == 14); // all, before another trial begins
    CHECK(changing > 2);  // though not at once
    CHECK(trials == 1);
}

TEST_CASE("what was chosen before a light was measured holds until it is, and binds nobody then")
{
    PlanTable table;
    const Selector selector(table.methods());
    PlanTable::Lamp lamp;
    lamp.memory.measured = true;
    const auto next = [&](std::uint64_t frame) {
        std::vector<Candidate> candidates(table.methods().size());
        LightDecision decision = selector.assess(table.input(lamp), lamp.memory, candidates);
        decision.method = 1;
        selector.commit(decision, lamp.memory, frame);
        return decision.guessed;
    };
    CHECK_FALSE(next(1));
    CHECK_FALSE(next(2));
    lamp.memory.measured = false; // a camera cut
    CHECK_FALSE(next(3));         // chosen by what was measured
    CHECK_FALSE(next(4));         // guessed, as this one is
    lamp.memory.measured = true;
    CHECK(next(5));
    CHECK_FALSE(next(6));
}

TEST_CASE("what the cheapest takes heeds pins, vetoes and silence, and not what serves")
{
    std::vector<Candidate> candidates(3);
    for (std::uint32_t m = 0; m < 3; ++m)
        candidates[m].predictedMs = candidates[m].sureMs = 1.0f + static_cast<float>(m);
    CHECK(cheapestMs(candidates, UINT32_MAX) == 1.0f); // nobody has an opinion: all may serve
    candidates[1].quantised = candidates[2].quantised = 100;
    CHECK(cheapestMs(candidates, UINT32_MAX) == 2.0f);
    candidates[1].exclusion = Exclusion::vetoed;
    CHECK(cheapestMs(candidates, UINT32_MAX) == 3.0f);
    CHECK(cheapestMs(candidates, 1) == 2.0f);
    for (Candidate& candidate : candidates)
        candidate.exclusion = Exclusion::notReady;
    CHECK(cheapestMs(candidates, 1) == 0.0f);
}

TEST_CASE("the reason is what keeps the best suited method, not what holds the plan's favourite back")
{
    const auto reason = [](std::uint32_t planWants, plan::Why why) {
        std::vector<Candidate> candidates(3);
        LightDecision decision;
        decision.candidates = candidates;
        decision.method = 0; // suits best
        decision.candidates[0].why = why;
        takePlan({.chosen = 2, .wanted = planWants, .hold = plan::Hold::quota}, decision);
        CHECK(decision.method == 2);
        CHECK(decision.wanted == 0);
        return decision.reason;
    };
    CHECK(reason(1, plan::Why::floor) == GN_REASON_FLOOR);
    CHECK(reason(1, plan::Why::budget) == GN_REASON_BUDGET);
    CHECK(reason(1, plan::Why::hysteresis) == GN_REASON_HELD);
    CHECK(reason(0, plan::Why::hysteresis) == GN_REASON_HELD);
    std::vector<Candidate> candidates(3);
    LightDecision tried;
    tried.candidates = candidates;
    tried.method = 0;
    takePlan({.chosen = 2, .wanted = 0, .onTrial = true}, tried);
    CHECK(tried.reason == GN_REASON_TRIAL);
}

TEST_CASE("rules that ask for the budget do not take turns with their own effect")
{
    std::string none(rules::shippedRuleBase("battery"));
    const std::size_t at = none.find("allocation: budget");
    REQUIRE(at != std::string::npos);
    none.replace(at, 18, "allocation: none");
    for (const std::string& text : {none, std::string(rules::shippedRuleBase("battery"))})
        for (const double budgetMs : {2.0, 5.0, 8.0, 10.0, 16.0, 30.0}) {
            std::optional<rules::Engine> engine = bindRules(text);
            REQUIRE(engine.has_value());
            SelectorFixture fixture(std::move(*engine));
            Situation situation;
            situation.budgetMs = text == none ? 0.0 : budgetMs;
            situation.fact(Fact::screenShare) = 0.5;
            situation.fact(Fact::casterTriangles) = 3.2; // volumes are favoured while there is time
            for (Candidate& candidate : situation.candidates)
                candidate.predictedMs = candidate.sureMs = 20.0f;
            situation.method("shadow_map").predictedMs = situation.method("shadow_map").sureMs = 6.0f;
            situation.method("shadow_map").quality = 0.8f;
            std::uint32_t switches = 0;
            for (int frame = 0; frame < 400; ++frame) {
                const DecisionRecord record = fixture.decide(situation);
                switches += record.switched;
                situation.incumbent = record.method;
                situation.fact(Fact::frameBudget) = double{cheapestMs(record.all(), UINT32_MAX)} / budgetMs;
            }
            CAPTURE(budgetMs);
            CHECK(switches <= 1); // from the first frame, which knows no budget yet
        }
}

TEST_CASE("a cap of the rules is the budget where the host gives none, and never raises the host's")
{
    rules::RuleBase base;
    base.policy.budget.shadowCapMs = 4.0;
    CHECK(budgetInForce(&base, 0.0) == 0.0); // nothing plans
    base.options.allocation = rules::Options::Allocation::Budget;
    CHECK(budgetInForce(&base, 0.0) == 4.0);
    CHECK(budgetInForce(&base, 3.0) == 3.0);
    CHECK(budgetInForce(&base, 5.0) == 4.0);
    base.policy.budget.shadowCapMs = 0.0;
    CHECK(budgetInForce(&base, 5.0) == 5.0);
    CHECK(budgetInForce(&base, 0.0) == 0.0);
    CHECK(budgetInForce(nullptr, 5.0) == 5.0);
}

TEST_CASE("by the knowledge that ships, no rule favours near what the floor keeps from serving")
{
    const cost::KnowledgeBase& knowledge = cost::shippedKnowledge();
    const AlgorithmRegistry registry = builtinRegistry();
    for (const rules::ShippedRuleBase& shipped : rules::shippedRuleBases()) {
        const std::optional<rules::Engine> engine = bindRules(shipped.text);
        REQUIRE(engine.has_value());
        const rules::Policy::Floor& floor = engine->base().policy.floor;
        if (floor.when.empty()) continue;
        rules::Inference inference = engine->makeInference();
        const rules::CompiledRules& compiled = engine->compiled();
        std::vector<double> lacking(registry.algorithms.size(), 1.0); // quality where favoured but below the floor
        std::mt19937 random(7);
        for (int round = 0; round < 20'000; ++round) {
            FactValues facts{};
            for (std::size_t i = 0; i < compiled.variables.size(); ++i) {
                const rules::CompiledVariable& variable = compiled.variables[i];
                facts[variable.fact] =
                    variable.low + (variable.high - variable.low) * static_cast<double>(random()) / 0x1p32;
            }
            facts[static_cast<std::size_t>(Fact::recorded)] = 0.0; // there maps grow until they keep it (leastSide())
            engine->evaluate(facts, inference);
            if (inference.floorTruth < floor.atStrength) continue;
            for (std::uint32_t rule = 0; rule < engine->base().rules.size(); ++rule) {
                if (inference.rules[rule].strength <= 0.5) continue;
                for (const std::uint32_t slot : compiled.effectsOf(compiled.rules[rule])) {
                    if (slot % compiled.suitabilityTerms + 1 != compiled.suitabilityTerms) continue;
                    const std::uint32_t output = slot / compiled.suitabilityTerms;
                    Method method;
                    method.entry = registry.algorithms[output].entry;
                    for (const SettingSpec& setting : method.entry->settings)
                        method.settings.push_back(setting.standard);
                    method.noteSettings();
                    const double quality = lacking[output] == 1.0 ? double{qualityOf(method, knowledge)} : 1.0;
                    if (quality < floor.minimumQuality) lacking[output] = quality;
                }
            }
        }
        for (std::size_t output = 0; output < lacking.size(); ++output)
            CHECK_MESSAGE(lacking[output] == 1.0, std::string(shipped.name), ": ",
                          std::string(registry.algorithms[output].entry->name), " ", lacking[output]);
    }
}

TEST_CASE("a method whose passes fail again after every few frames is tried more and more rarely")
{
    // As where a light's first frames find memory that the third lacks.
    PassFailure failure;
    int failures = 0;
    for (std::uint64_t frame = 1, served = 0; frame < 3600; ++frame) {
        if (failure.holds(frame, 0)) continue;
        if (++served % 3 != 0) {
            failure.noteServed(frame);
            continue;
        }
        failure.note(frame, true);
        ++failures;
    }
    CHECK(failures > 4);
    CHECK(failures < 16); // pauses of 4, 8, 16, ... frames

    // One that served for as long as it was left alone starts again.
    for (std::uint64_t frame = failure.until; frame <= 2 * failure.until; ++frame)
        failure.noteServed(frame);
    CHECK(failure.times == 0);
}
