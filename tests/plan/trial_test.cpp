// What no light was timed with is tried on one light at a time.
#include "runtime/plan/probe.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>

#include "tests/plan/plan_scene.hpp"

using namespace gnomon::plan;
using namespace gnomon::plan::test;

namespace {

uint32_t served(const Scene& scene, uint32_t method)
{
    const std::span<const LightPlan> lights = scene.plan.lights();
    return static_cast<uint32_t>(
        std::count_if(lights.begin(), lights.end(), [=](const LightPlan& light) { return light.chosen == method; }));
}

void setMethod(Scene& scene, uint32_t method, const Candidate& candidate)
{
    for (uint32_t light = 0; light < scene.requests.size(); ++light)
        scene.of(light, method) = candidate;
}

constexpr Candidate kUnable{.eligibility = Eligibility::trait};

} // namespace

TEST_CASE("within a budget one light at a time changes to what no light was timed with, and then two a frame")
{
    constexpr uint32_t kLights = 6;
    Scene scene(kLights, cheapAndGood());
    scene.input.budgetMs = 100.0;
    const Candidate good = scene.of(0, kGood);
    setMethod(scene, kGood, kUnable);
    scene.step(kSpareFrames + 1);
    REQUIRE(served(scene, kCheap) == kLights);
    Candidate unknown = good;
    unknown.familiar = false;
    setMethod(scene, kGood, unknown);
    uint32_t before = 0, newest = 0;
    bool waited = false;
    for (uint32_t frame = 1; frame <= 3 * kTrialFrames; ++frame) {
        scene.step();
        const uint32_t now = served(scene, kGood);
        CHECK(now <= before + 1);
        if (now > before && before > 0) CHECK(frame >= newest + kTrialFrames); // its timings never come
        if (now > before) newest = frame;
        before = now;
        for (const LightPlan& light : scene.plan.lights())
            waited |= light.chosen == kCheap && light.hold == Hold::trial;
    }
    CHECK(before == 3);
    CHECK(waited);
    setMethod(scene, kGood, good); // it was timed
    scene.step();
    CHECK(served(scene, kGood) == 5);
    scene.step();
    CHECK(served(scene, kGood) == kLights);
}

TEST_CASE("every light that has something to try comes to its turn")
{
    constexpr uint32_t kLights = 5;
    Scene scene(kLights, cheapAndGood());
    scene.input.budgetMs = 100.0;
    setMethod(scene, kGood, kUnable);
    scene.step(kSpareFrames + 1);
    setMethod(scene, kGood, {.suitability = 3686, .quality = 0.95f, .ms = 4.0, .familiar = false});
    scene.step((kLights + 1) * kTrialFrames);
    CHECK(served(scene, kGood) == kLights);
}

TEST_CASE("a broken budget is repaired by what was timed, and by what was not only where nothing else keeps it")
{
    constexpr uint32_t kLights = 4, kNew = 2;
    std::vector<Candidate> methods = cheapAndGood();
    methods.push_back(kUnable);
    Scene scene(kLights, methods);
    scene.input.budgetMs = 20.0;
    scene.step(kSpareFrames + 1);
    REQUIRE(served(scene, kGood) == kLights);
    // As cheap as the cheap one and worth more: by its prediction, which nobody has seen come true.
    setMethod(scene, kNew, {.suitability = 3000, .quality = 0.95f, .ms = 1.0, .familiar = false});
    scene.input.budgetMs = 5.0;
    PlanReport report = scene.step();
    CHECK(report.cause == Cause::repaired);
    CHECK(report.predictedMs <= 5.0);
    CHECK(served(scene, kNew) <= 1);
    CHECK(served(scene, kCheap) + served(scene, kNew) == kLights);

    Scene bare(kLights, methods);
    bare.input.budgetMs = 20.0;
    setMethod(bare, kCheap, kUnable);
    bare.step(kSpareFrames + 1);
    REQUIRE(served(bare, kGood) == kLights);
    setMethod(bare, kNew, {.suitability = 3000, .quality = 0.95f, .ms = 1.0, .familiar = false});
    bare.input.budgetMs = 5.0;
    report = bare.step();
    CHECK(report.predictedMs <= 5.0);
    CHECK(served(bare, kNew) == kLights);
}

TEST_CASE(
    "where nothing keeps the budget, one light at a time tries what is thought costlier, for a fiftieth of all time")
{
    constexpr uint32_t kLights = 4;
    Scene scene(kLights, cheapAndGood());
    scene.input.budgetMs = 3.0; // all need 4 ms with the cheap one
    setMethod(scene, kGood, {.suitability = 2048, .quality = 0.7f, .ms = 4.0, .likelyMs = 2.5, .familiar = false});
    double allMs = 0.0, wasteMs = 0.0;
    std::array<uint32_t, kLights> frames{};
    for (uint32_t frame = 0; frame < 1200; ++frame) {
        const PlanReport report = scene.step();
        CHECK_FALSE(report.feasible);
        CHECK(report.flips == 0);
        CHECK(served(scene, kGood) <= 1);
        for (uint32_t light = 0; light < kLights; ++light) {
            const bool tries = scene.chosen(light) == kGood;
            CHECK(scene.plan.lights()[light].onTrial == tries);
            frames[light] += tries;
        }
        allMs += report.predictedMs;
        wasteMs += report.predictedMs - kLights;
        CHECK(wasteMs <= kMostWaste * allMs + 4.0 * kTrialFrames); // the trial that runs was saved up for
    }
    CHECK(wasteMs <= kMostWaste * allMs);
    uint32_t trials = 0;
    for (const uint32_t each : frames) {
        CHECK(each % kTrialFrames == 0);
        trials += each / kTrialFrames;
    }
    CHECK(trials >= 4); // its timings never come
    setMethod(scene, kGood, {.suitability = 2048, .quality = 0.7f, .ms = 0.5});
    CHECK(scene.step().predictedMs <= 3.0);
    CHECK(served(scene, kGood) >= kLights - 1); // one may have just left it
}

TEST_CASE("a broken budget is no reason to try what could not keep it with any luck")
{
    const auto tries = [](double ms, double likelyMs, double budgetMs, uint32_t everyFrames = 60) {
        Scene scene(4, cheapAndGood());
        gnomon::rules::Policy policy;
        policy.probing.everyFrames = everyFrames;
        scene.input.policy = &policy;
        scene.input.budgetMs = budgetMs;
        setMethod(scene, kGood,
                  {.suitability = 2048, .quality = 0.7f, .ms = ms, .likelyMs = likelyMs, .familiar = false});
        for (uint32_t frame = 0; frame < 600; ++frame) {
            scene.step();
            if (served(scene, kGood) > 0) return true;
        }
        return false;
    };
    CHECK(tries(3.6, 2.5, 3.0));
    CHECK_FALSE(tries(3.6, 2.5, 3.0, 0)); // the rules want nothing tried
    CHECK_FALSE(tries(2.6, 2.5, 3.0));    // it is known to be costlier
    CHECK_FALSE(tries(3.0, 2.5, 3.0));    // it would need three standard errors of luck
    CHECK(tries(3.6, 2.5, 1.3));
    CHECK_FALSE(tries(3.6, 2.5, 1.1)); // two less than expected are 0.3 ms, of all lights 1.2
    CHECK_FALSE(tries(3.6, 2.5, 5.0)); // the budget is kept
}

TEST_CASE("a light that comes takes what was timed where anything was")
{
    Scene scene(3, cheapAndGood());
    scene.input.budgetMs = 100.0;
    for (uint32_t light = 0; light < 3; ++light)
        scene.of(light, kGood).familiar = false;
    scene.of(0, kGood) = kUnable;
    scene.requests.resize(1);
    scene.step(kTrialFrames + 1);
    REQUIRE(scene.chosen(0) == kCheap);
    scene.requests = {{.memory = &scene.memories[0]}, {.memory = &scene.memories[1]}, {.memory = &scene.memories[2]}};
    scene.step();
    CHECK(served(scene, kCheap) == 3);
    CHECK(scene.plan.lights()[1].hold == Hold::trial);
    // Where nothing was, what suits best.
    scene.memories[1] = scene.memories[2] = {};
    for (Candidate& candidate : scene.candidates)
        candidate.familiar = false;
    scene.step();
    CHECK(scene.chosen(1) == kGood);
    CHECK(scene.chosen(2) == kGood);
}
