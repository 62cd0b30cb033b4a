// What keeps a light at its method, and for how long: thresholds, waits, bans and floors that hold on.
#include <doctest/doctest.h>
#include <vector>

#include "tests/plan/plan_scene.hpp"
#include "tests/plan/random.hpp"

using namespace gnomon;
using namespace gnomon::plan;
using namespace gnomon::plan::test;
using gnomon::test::Random;

TEST_CASE("a gain above the threshold is taken at once, a smaller one when the light has kept its method for longer")
{
    Scene scene(1, cheapAndGood());
    const auto gain = [&](float share) {
        scene.of(0, kGood).suitability = 2048;
        scene.of(0, kGood).quality = (1.0f + share) * 0.7f;
    };
    gain(-0.1f);
    scene.step();
    REQUIRE(scene.chosen(0) == kCheap);
    gain(0.016f); // of a threshold of 2 %, which 30 frames after the change begins to fall
    CHECK(scene.step(30).switches == 0);
    CHECK(scene.why(0, kGood) == Why::hysteresis);
    CHECK(scene.plan.lights()[0].hold == Hold::threshold);
    CHECK(scene.plan.lights()[0].threshold == doctest::Approx(0.02));
    CHECK(scene.step(7).switches == 0);
    CHECK(scene.step().cause == Cause::gain);
    CHECK(scene.chosen(0) == kGood);

    gain(-0.1f);
    scene.input.cut = true;
    scene.step();
    REQUIRE(scene.chosen(0) == kCheap);
    gain(0.025f);
    CHECK(scene.step().cause == Cause::gain);
    CHECK(scene.chosen(0) == kGood);
}

TEST_CASE("upgrades come two a frame, after thirty frames within the budget")
{
    Scene scene(8, cheapAndGood());
    scene.input.budgetMs = 9.0;
    scene.step(5);
    CHECK(scene.plan.lights()[0].chosen == kCheap);
    scene.input.budgetMs = 7.0; // a violation, so that the wait starts again
    CHECK(scene.step().overMs > 0.0);
    scene.input.budgetMs = 40.0;
    uint32_t frames = 0, switched = 0;
    while (switched < 8 && frames < 100) {
        const PlanReport report = scene.step();
        ++frames;
        CHECK(report.upgrades <= 2);
        switched += report.switches;
        if (frames < kSpareFrames) CHECK(report.switches == 0);
    }
    CHECK(switched == 8);
    CHECK(frames <= kSpareFrames + 4);
}

TEST_CASE("measured time above the budget also delays upgrades")
{
    Scene scene(1, cheapAndGood());
    scene.of(0, kGood).suitability = 100;
    scene.step(40);
    CHECK(scene.chosen(0) == kCheap);
    scene.input.measuredMs = 11.0;
    scene.of(0, kGood).suitability = 3686;
    scene.step(50);
    CHECK(scene.chosen(0) == kCheap);
    CHECK(scene.plan.lights()[0].hold == Hold::spareTime);
    scene.input.measuredMs = 5.0;
    scene.step(kSpareFrames);
    CHECK(scene.chosen(0) == kGood);
}

TEST_CASE("a pair that flips is banned, and a camera cut lifts the ban")
{
    Scene scene(1, cheapAndGood());
    auto favour = [&](uint32_t method) {
        scene.of(0, kCheap).suitability = method == kCheap ? 4000 : 100;
        scene.of(0, kGood).suitability = method == kGood ? 4000 : 100;
        scene.of(0, kCheap).ms = scene.of(0, kGood).ms = 1.0;
        scene.of(0, kCheap).quality = scene.of(0, kGood).quality = 1.0f;
    };
    favour(kGood);
    scene.step(60);
    REQUIRE(scene.chosen(0) == kGood);
    favour(kCheap);
    scene.step();
    REQUIRE(scene.chosen(0) == kCheap);
    favour(kGood); // voluntarily back within the window: refused
    scene.step();
    CHECK(scene.chosen(0) == kCheap);
    CHECK(scene.plan.lights()[0].hold == Hold::ban);
    scene.of(0, kCheap).eligibility = Eligibility::trait; // forced back: a flip
    CHECK(scene.step().flips == 1);
    CHECK(scene.chosen(0) == kGood);
    scene.of(0, kCheap).eligibility = Eligibility::eligible;
    favour(kCheap);
    uint32_t frames = 0;
    while (scene.chosen(0) == kGood && frames < 300) {
        scene.step();
        ++frames;
    }
    CHECK(frames >= 118);
    CHECK(frames <= 121);

    favour(kGood);
    scene.input.cut = true;
    scene.step();
    CHECK(scene.chosen(0) == kGood);
    favour(kCheap);
    scene.step();
    CHECK(scene.chosen(0) == kCheap); // nothing before the cut counts
}

TEST_CASE("whatever times and suitabilities do, a light that no budget forces flips no more than its bans let it")
{
    Random random(11);
    const rules::Policy::Hysteresis& hysteresis = rules::Policy{}.hysteresis;
    for (const double budgetMs : {1.0, 16.0, 30.0}) { // nothing fits, half of it does, all does
        Scene scene(6, std::vector<Candidate>(4));
        scene.input.budgetMs = budgetMs;
        uint32_t flips = 0;
        const uint32_t frames = 3000;
        for (uint32_t frame = 0; frame < frames; ++frame) {
            for (Candidate& candidate : scene.candidates)
                candidate = {.suitability = static_cast<int32_t>(random.below(4097)),
                             .quality = static_cast<float>(random.between(0.8, 1.0)),
                             .ms = random.between(0.5, 4.0)};
            flips += scene.step().flips;
        }
        CAPTURE(budgetMs);
        CHECK(flips <= 6 * (1 + frames / hysteresis.flipBanFrames));
    }
}

TEST_CASE("a floor that only holds on raises nothing: what no longer reaches it is no reason for more")
{
    Scene scene(1, cheapAndGood());
    scene.input.budgetMs = 30.0;
    scene.requests[0].minimumQuality = 0.8f;
    scene.requests[0].floor = true;
    for (const uint32_t m : {kCheap, kGood})
        scene.of(0, m).suitability = m == kCheap ? 3000 : 1000;
    scene.of(0, kCheap).quality = 0.85f;
    scene.step();
    REQUIRE(scene.chosen(0) == kCheap);
    scene.requests[0].floor = false;
    scene.of(0, kCheap).quality = 0.7f;
    scene.step();
    CHECK(scene.chosen(0) == kCheap);
    CHECK(!scene.plan.lights()[0].floor);
    scene.requests[0].floor = true;
    scene.step();
    CHECK(scene.chosen(0) == kGood);
}

TEST_CASE("a floor whose condition hovers about its threshold holds on, and lets go of who has left")
{
    Scene scene(1, cheapAndGood());
    scene.input.budgetMs = 3.0; // the good one does not fit
    scene.requests[0].minimumQuality = 0.8f;
    Random random(1);
    uint32_t switches = 0;
    for (int frame = 0; frame < 600; ++frame) {
        scene.requests[0].floor = frame == 0 || random.unit() < 0.5;
        switches += scene.step().switches;
        CHECK(scene.plan.lights()[0].floor);
    }
    CHECK(switches == 0);
    CHECK(scene.chosen(0) == kGood);
    scene.requests[0] = {.memory = &scene.memories[0]}; // far, and nothing is asked
    scene.step(rules::Policy{}.hysteresis.flipWindowFrames + 1);
    CHECK(!scene.plan.lights()[0].floor);
    CHECK(scene.chosen(0) == kCheap);

    scene.requests[0].floor = true, scene.requests[0].minimumQuality = 0.8f;
    scene.step();
    CHECK(scene.chosen(0) == kGood);
    scene.requests[0].floor = false;
    scene.input.cut = true; // another place: nothing is left of the old one
    for (int frame = 0; frame < 3; ++frame) {
        scene.step();
        CHECK(!scene.plan.lights()[0].floor);
        CHECK(scene.chosen(0) == kCheap);
    }
}

TEST_CASE("within the budget a light changes to what shows as much for clearly less, and not for noise")
{
    const uint32_t kServes = 0, kOther = 1;
    Scene scene(4, {{.suitability = 3000, .quality = 0.95f, .ms = 2.0, .sigmaMs = 0.1},
                    {.suitability = 3000, .quality = 0.95f, .ms = 2.1, .sigmaMs = 0.1}});
    scene.input.budgetMs = 100.0;
    scene.step(2);
    Random random(5);
    uint32_t switches = 0;
    for (int frame = 0; frame < 300; ++frame) {
        for (uint32_t light = 0; light < 4; ++light) {
            scene.of(light, kServes).ms = 2.0 * random.between(0.94, 1.06);
            scene.of(light, kOther).ms = 1.95 * random.between(0.94, 1.06);
        }
        switches += scene.step().switches;
    }
    CHECK(switches == 0);
    for (uint32_t light = 0; light < 4; ++light) {
        scene.of(light, kOther).ms = 1.5;
        scene.of(light, kOther).firstFrameMs = light == 0 ? 60.0 : 6.0; // a millisecond a frame, or a tenth
    }
    const uint32_t most = rules::Policy{}.hysteresis.upgradesPerFrame;
    CHECK(scene.step().switches == most);
    scene.step(5);
    CHECK(scene.chosen(0) == kServes);
    for (uint32_t light = 1; light < 4; ++light)
        CHECK(scene.chosen(light) == kOther);
}
