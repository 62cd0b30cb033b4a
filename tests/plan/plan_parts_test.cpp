// Work that methods share, in the plan: paid once, by whoever needs it.
#include <doctest/doctest.h>
#include <vector>

#include "tests/plan/plan_scene.hpp"

using namespace gnomon;
using namespace gnomon::plan;
using namespace gnomon::plan::test;

TEST_CASE("the cheapest plan keeps the floor and charges a shared part once")
{
    Scene scene(3, cheapAndGood());
    CHECK(scene.step().cheapestMs == doctest::Approx(3.0));
    scene.requests[0].floor = true;
    scene.requests[0].minimumQuality = 0.9f;
    const std::vector<SharedPart> parts{{0.5, {kCheap}}, {0.25, {kGood}}};
    scene.input.parts = parts;
    CHECK(scene.step().cheapestMs == doctest::Approx(6.75));
    const std::vector<SharedPart> common{{0.5, {kCheap, kGood}}};
    scene.input.parts = common;
    CHECK(scene.step().cheapestMs == doctest::Approx(6.5));
}

TEST_CASE("a method whose shared part breaks the budget is not taken, given up once that is known, and not tried again")
{
    Scene scene(2, cheapAndGood()); // 2 ms to 8
    scene.input.budgetMs = 9.0;
    CHECK(scene.step().predictedMs == doctest::Approx(8.0));
    std::vector<SharedPart> parts{{1.5, {kGood}}}; // a timed frame has told
    scene.input.parts = parts;
    const PlanReport report = scene.step();
    CHECK(report.cause == Cause::repaired);
    CHECK(report.predictedMs == doctest::Approx(6.5)); // one of two: the part is paid all the same
    scene.input.budgetMs = 6.0;
    CHECK(scene.step().predictedMs == doctest::Approx(2.0));
    uint32_t switches = 0;
    for (int frame = 0; frame < 300; ++frame)
        switches += scene.step().switches;
    CHECK(switches == 0);
    scene.input.budgetMs = 9.0;
    scene.step(100);
    CHECK(scene.step().predictedMs == doctest::Approx(6.5));
}

TEST_CASE("of methods that show as much the cheaper one with its shared parts serves, which others may pay for")
{
    const uint32_t kPlain = 0, kSharing = 1;
    const auto known = [](double ms) { return Candidate{.suitability = 3000, .quality = 1.0f, .ms = ms}; };
    Scene scene(2, {known(4.0), known(2.0)});
    scene.input.budgetMs = 100.0;
    const std::vector<SharedPart> parts{{8.0, {kSharing}}};
    scene.input.parts = parts;
    scene.requests[0].pinned = scene.requests[1].pinned = kPlain;
    scene.step();
    scene.requests[0].pinned = scene.requests[1].pinned = kNone;
    scene.step(700);
    for (uint32_t light = 0; light < 2; ++light)
        CHECK(scene.chosen(light) == kPlain); // 8, or 4 + 2 + 8, or 4 + 8
    scene.requests[0].pinned = kSharing;
    scene.step(700);
    CHECK(scene.chosen(1) == kSharing); // its part is paid
    scene.requests[0].pinned = kNone;
    const PlanReport report = scene.step(700);
    for (uint32_t light = 0; light < 2; ++light)
        CHECK(scene.chosen(light) == kPlain); // alone neither saves anything by going: together they do
    CHECK(report.predictedMs == doctest::Approx(8.0));
}

TEST_CASE("lights that share a part stay with it where leaving saves too little, is not known, or shows less")
{
    const uint32_t kPlain = 0, kSharing = 1;
    const auto known = [](double ms) { return Candidate{.suitability = 3000, .quality = 1.0f, .ms = ms}; };
    const std::vector<SharedPart> parts{{8.0, {kSharing}}};
    const auto plain = [&](auto&& change) {
        Scene scene(2, {known(4.0), known(2.0)});
        scene.input.budgetMs = 100.0;
        scene.input.parts = parts;
        scene.requests[0].pinned = scene.requests[1].pinned = kSharing;
        scene.step();
        scene.requests[0].pinned = scene.requests[1].pinned = kNone;
        change(scene);
        scene.step(5);
        return (scene.chosen(0) == kPlain) + (scene.chosen(1) == kPlain);
    };
    CHECK(plain([](Scene&) {}) == 2);
    rules::Policy still; // no change for the better, of all lights together neither
    still.hysteresis.upgradesPerFrame = 0;
    CHECK(plain([&](Scene& scene) { scene.input.policy = &still; }) == 0);
    CHECK(plain([](Scene& scene) { scene.of(1, kPlain).ms = 6.5; }) == 0);             // 10.5 of 12 ms
    CHECK(plain([](Scene& scene) { scene.of(1, kPlain).sigmaMs = 3.0; }) == 0);        // nobody knows
    CHECK(plain([](Scene& scene) { scene.of(1, kPlain).firstFrameMs = 600.0; }) == 0); // 10 ms a frame of the stay
    CHECK(plain([](Scene& scene) { scene.of(1, kPlain).quality = 0.5f; }) == 0);
}

TEST_CASE("where no plan fits nothing that is worth more brings a shared part with it")
{
    const uint32_t kPlain = 0, kSharing = 1;
    Scene scene(2,
                {{.suitability = 3000, .quality = 0.8f, .ms = 3.0}, {.suitability = 3000, .quality = 1.0f, .ms = 3.1}});
    const std::vector<SharedPart> parts{{1.0, {kSharing}}};
    scene.input.budgetMs = 2.0;
    scene.input.parts = parts;
    scene.step();
    CHECK(scene.chosen(0) == kPlain);
    CHECK(scene.chosen(1) == kPlain);
}

TEST_CASE("lights that share a part leave it together for what is worth more, though none of them could pay alone")
{
    const uint32_t kNow = 0, kBetter = 1; // each needs a part of its own, and there is room for one
    Scene scene(3,
                {{.suitability = 3600, .quality = 1.0f, .ms = 0.3}, {.suitability = 400, .quality = 1.0f, .ms = 0.4}});
    const std::vector<SharedPart> parts = {{2.0, {kNow}}, {2.0, {kBetter}}};
    scene.input.parts = parts;
    scene.input.budgetMs = 3.6;
    scene.step(60);
    for (uint32_t light = 0; light < 3; ++light) {
        REQUIRE(scene.chosen(light) == kNow);
        scene.of(light, kNow).suitability = 1600, scene.of(light, kBetter).suitability = 3600;
    }
    PlanReport report;
    for (uint32_t frame = 0; frame < 4 && report.switches == 0; ++frame) // sets of two parts
        report = scene.step();
    CHECK(report.cause == Cause::gain);
    CHECK(report.switches == 3);
    CHECK(report.predictedMs <= report.usableMs);
    for (uint32_t light = 0; light < 3; ++light)
        CHECK(scene.chosen(light) == kBetter);

    // What has just been left is not taken back, however much it is worth.
    for (uint32_t light = 0; light < 3; ++light)
        scene.of(light, kNow).suitability = 4096, scene.of(light, kBetter).suitability = 400;
    CHECK(scene.step().switches == 0);
    scene.step(rules::Policy{}.hysteresis.flipWindowFrames + 10);
    for (uint32_t light = 0; light < 3; ++light)
        CHECK(scene.chosen(light) == kNow);
}
