// What a method takes once, in its first frame: maps and lists of what stands still.
#include <doctest/doctest.h>

#include "plan_scene.hpp"

using namespace gnomon::plan;
using namespace gnomon::plan::test;

TEST_CASE("a switch whose first frame does not fit, or costs more than its stay gains, is not made")
{
    Scene scene(1, cheapAndGood());
    scene.of(0, kGood).suitability = 2100; // better, but not by much
    scene.step();
    REQUIRE(scene.chosen(0) == kGood); // the first plan took it
    scene.of(0, kGood).firstFrameMs = 1000.0;
    const auto tryFromCheap = [&] {
        scene.memories[0] = {.incumbent = kCheap};
        scene.step(kSpareFrames);
        return scene.chosen(0);
    };
    CHECK(tryFromCheap() == kCheap);
    CHECK(scene.plan.lights()[0].hold == Hold::margin); // 17 ms a frame of the stay
    scene.input.budgetMs = 40.0;
    CHECK(tryFromCheap() == kCheap);
    CHECK(scene.plan.lights()[0].hold == Hold::firstFrame);
    scene.of(0, kGood).firstFrameMs = 5.0;
    CHECK(tryFromCheap() == kGood);
}

TEST_CASE("where nothing holds, first frames are of the frame's own budget")
{
    Scene scene(4, cheapAndGood());
    scene.input.budgetMs = 25.0;
    for (uint32_t light = 0; light < 4; ++light)
        scene.of(light, kGood).firstFrameMs = 6.0; // 10 ms in the first frame, 4 in the others
    const auto good = [&] {
        uint32_t count = 0;
        for (uint32_t light = 0; light < 4; ++light)
            count += scene.chosen(light) == kGood;
        return count;
    };
    CHECK(scene.step().predictedMs == doctest::Approx(2 * 1.0 + 2 * 10.0));
    CHECK(good() == 2);
    scene.step(2 * kSpareFrames);
    CHECK(good() == 4); // later ones came one by one
    scene.input.cut = true;
    scene.step();
    CHECK(good() == 4); // what serves is drawn already
    scene.memories[3] = {};
    for (uint32_t light = 0; light < 3; ++light)
        scene.of(light, kGood).ms = 5.0;
    scene.step();
    CHECK(scene.chosen(3) == kCheap); // 15 ms, and 10 for a new light do not fit
}

TEST_CASE("a repair draws no more at once than half of the budget, but for one light")
{
    Scene scene(8, cheapAndGood());
    scene.input.budgetMs = 40.0;
    scene.step();
    for (uint32_t light = 0; light < 8; ++light) {
        REQUIRE(scene.chosen(light) == kGood);
        scene.of(light, kGood).ms = 8.0; // 64 ms: four have to go
    }
    const auto switchesOf = [&](double firstFrameMs) {
        scene.memories.assign(8, {.incumbent = kGood});
        for (uint32_t light = 0; light < 8; ++light)
            scene.of(light, kCheap).firstFrameMs = firstFrameMs;
        return scene.step().switches;
    };
    CHECK(switchesOf(0.0) == 4);
    CHECK(switchesOf(9.0) == 2);
    CHECK(switchesOf(50.0) == 1);
    for (uint32_t frame = 0; frame < 3; ++frame)
        CHECK(scene.step().switches == 1);
    CHECK(scene.step().switches == 0); // 36 ms
}
