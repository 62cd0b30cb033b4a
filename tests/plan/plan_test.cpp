#include "runtime/plan/plan.hpp"

#include <array>
#include <doctest/doctest.h>
#include <limits>
#include <vector>

#include "runtime/plan/utility.hpp"
#include "tests/plan/plan_scene.hpp"
#include "tests/plan/random.hpp"
#include "tests/rules/allocation_count.hpp"

using namespace gnomon;
using namespace gnomon::plan;
using namespace gnomon::plan::test;
using gnomon::test::Random;

TEST_CASE("what shows as much counts as much, unless the rules like it less than half as well")
{
    const std::array<UtilityTerms, 5> terms = {UtilityTerms{3400, 0.99f, true},  // best suited
                                               UtilityTerms{2000, 1.0f, true},   // shows more
                                               UtilityTerms{1600, 1.0f, true},   // avoided
                                               UtilityTerms{2000, 0.9f, true},   // shows less
                                               UtilityTerms{4000, 0.5f, false}}; // may not serve
    const std::array<int32_t, 5> suitability = {3400, 3400, 2000, 2000, 4000};
    const std::array<float, 5> quality = {0.99f, 0.99f, 1.0f, 0.9f, 0.5f};
    for (size_t m = 0; m < terms.size(); ++m) {
        CHECK(sharedTerms(terms, m).suitability == suitability[m]);
        CHECK(sharedTerms(terms, m).quality == quality[m]);
    }
    // A budget with room for either is spent on neither: the cheaper one serves.
    Scene scene(1, cheapAndGood());
    scene.of(0, kCheap).quality = 0.95f;
    scene.step();
    CHECK(scene.chosen(0) == kCheap);
    CHECK(scene.why(0, kGood) == Why::price);
    // Worth more and costlier: what suits better did not lose by its price.
    scene.of(0, kCheap).quality = 1.0f;
    scene.of(0, kCheap).ms = 5.0;
    scene.memories[0] = {};
    scene.step();
    CHECK(scene.chosen(0) == kCheap);
    CHECK(scene.why(0, kGood) == Why::outscored);
    scene.of(0, kCheap).suitability = scene.of(0, kGood).suitability / 3;
    scene.memories[0] = {};
    scene.step();
    CHECK(scene.chosen(0) == kGood);
}

TEST_CASE("what all methods count at once is what each counts, whatever order was known before")
{
    Random random(9);
    for (int round = 0; round < 500; ++round) {
        const uint32_t count = 1 + random.below(64);
        std::vector<UtilityTerms> terms(count);
        std::vector<uint8_t> order(count);
        std::vector<double> utilities(count);
        for (uint32_t m = 0; m < count; ++m) {
            order[m] = static_cast<uint8_t>(count - 1 - m);
            terms[m] = {static_cast<int32_t>(random.below(12)) * 340 - 1,
                        static_cast<float>(random.below(20)) * 0.006f + 0.88f, random.unit() < 0.8};
        }
        sharedUtilities(terms, order, utilities);
        for (uint32_t m = 0; m < count; ++m)
            REQUIRE(utilities[m] == utility(sharedTerms(terms, m)));
    }
}

TEST_CASE("of two that show as much but for a wrong pixel in ten thousand, a budget buys the cheaper")
{
    Scene scene(1, cheapAndGood());
    scene.of(0, kGood).quality = 0.995f;
    scene.of(0, kCheap).quality = 0.99f;
    for (const uint32_t first : {kNone, kCheap, kGood}) {
        CAPTURE(first);
        scene.memories[0] = {.incumbent = first};
        for (int frame = 0; frame < 500; ++frame) // what is missed a little in every frame does not add up
            scene.step();
        CHECK(scene.chosen(0) == kCheap);
    }
    scene.of(0, kCheap).quality = 0.98f;
    scene.memories[0] = {};
    scene.step();
    CHECK(scene.chosen(0) == kGood);
}

TEST_CASE("authority runs from capability over pin, never, floor and budget to benefit")
{
    Scene scene(1, cheapAndGood());
    scene.step();
    CHECK(scene.chosen(0) == kGood); // benefit
    CHECK(scene.why(0, kCheap) == Why::outscored);

    scene.input.budgetMs = 2.0;
    scene.step();
    CHECK(scene.chosen(0) == kCheap); // budget over benefit
    CHECK(scene.why(0, kGood) == Why::budget);

    scene.requests[0].floor = true;
    scene.requests[0].minimumQuality = 0.8f;
    PlanReport report = scene.step();
    CHECK(scene.chosen(0) == kGood); // floor over budget, and reported
    CHECK(scene.why(0, kCheap) == Why::floor);
    CHECK(report.overMs == doctest::Approx(2.0));
    CHECK(report.floorsUnmet == 0);

    scene.of(0, kGood).eligibility = Eligibility::never;
    report = scene.step();
    CHECK(scene.chosen(0) == kCheap); // never over floor, and reported
    CHECK(scene.why(0, kGood) == Why::never);
    CHECK(report.floorsUnmet == 1);

    scene.requests[0].pinned = kGood;
    scene.step();
    CHECK(scene.chosen(0) == kGood); // pin over never
    CHECK(scene.why(0, kCheap) == Why::pinned);

    scene.of(0, kGood).eligibility = Eligibility::trait;
    scene.step();
    CHECK(scene.chosen(0) == kCheap); // capability over pin
    CHECK(scene.why(0, kGood) == Why::trait);

    scene.of(0, kCheap).ms = -1.0; // nobody knows what it costs
    scene.step();
    CHECK(scene.chosen(0) == kNone);
}

TEST_CASE("a method without opinion serves only where no rule speaks at all")
{
    Scene scene(1, cheapAndGood());
    scene.of(0, kGood).suitability = kNoOpinion;
    scene.step();
    CHECK(scene.chosen(0) == kCheap);
    CHECK(scene.why(0, kGood) == Why::noOpinion);
    scene.of(0, kCheap).suitability = kNoOpinion;
    scene.step(); // equally unloved: the incumbent
    CHECK(scene.chosen(0) == kCheap);
}

TEST_CASE("a broken budget is repaired by the one downgrade that loses least")
{
    Scene scene(4, cheapAndGood());
    scene.input.budgetMs = 17.0;
    scene.requests[2].importance = 0.9;
    scene.step();
    for (uint32_t i = 0; i < 4; ++i)
        CHECK(scene.chosen(i) == kGood);
    scene.input.budgetMs = 15.0;
    const PlanReport report = scene.step();
    CHECK(report.cause == Cause::repaired);
    CHECK(report.switches == 1);
    CHECK(scene.chosen(2) == kCheap);
    CHECK(report.predictedMs <= report.usableMs);
}

TEST_CASE("headroom grows with the error of the sum, not with the sum of errors")
{
    Scene scene(16, cheapAndGood());
    scene.input.budgetMs = 64.0;
    for (Candidate& candidate : scene.candidates)
        candidate.sigmaMs = 1.0;
    scene.step();
    const PlanReport report = scene.step();
    CHECK(report.standardErrorMs == doctest::Approx(4.0)); // sqrt(16)
    CHECK(report.usableMs == doctest::Approx(60.0));
    for (Candidate& candidate : scene.candidates)
        candidate.sigmaMs = 0.0;
    CHECK(scene.step().usableMs == doctest::Approx(64.0 * 0.98));
}

TEST_CASE("what is shared comes off the budget before lights may spend it")
{
    Scene scene(2, cheapAndGood()); // 2 ms to 8
    scene.input.budgetMs = 8.5;
    CHECK(scene.step().predictedMs == doctest::Approx(8.0));
    scene.input.sharedMs = 1.0;
    scene.input.cut = true;
    const PlanReport report = scene.step();
    CHECK(report.predictedMs == doctest::Approx(5.0));
    CHECK(report.budgetMs == doctest::Approx(8.5));
    CHECK(report.usableMs == doctest::Approx(7.5 * 0.98));
    scene.input.sharedMs = 100.0; // more than there is: the cheapest serve
    CHECK(scene.step().predictedMs == doctest::Approx(2.0));
}

TEST_CASE("a budget may be a multiple of what the cheapest plan is predicted to take in this very frame")
{
    Scene scene(4, cheapAndGood());
    scene.input.budgetMs = 0.0;
    scene.input.perCheapest = 2.0;
    PlanReport report = scene.step();
    CHECK(report.budgetMs == doctest::Approx(8.0));
    CHECK(report.predictedMs == doctest::Approx(7.0)); // one of four is good
    for (uint32_t light = 0; light < 4; ++light)
        scene.of(light, kCheap).ms = 3.0; // the camera has come near
    scene.input.cut = true;
    report = scene.step();
    CHECK(report.budgetMs == doctest::Approx(24.0));
    CHECK(report.predictedMs == doctest::Approx(16.0));
    scene.input.budgetMs = 10.0; // measured: predictions lead no farther than half as much again
    CHECK(scene.step().budgetMs == doctest::Approx(15.0));
    scene.input.perCheapest = 0.1;
    CHECK(scene.step().budgetMs == doctest::Approx(10.0 / 1.5));
    scene.input.perCheapest = 1.0;
    CHECK(scene.step().budgetMs == doctest::Approx(12.0));
}

TEST_CASE("where no plan fits the cheapest serves, but what noise calls the cheapest moves nobody")
{
    const uint32_t kNow = 0, kOther = 1; // the third is dear
    Scene scene(6, {{.suitability = 600, .quality = 0.95f, .ms = 2.9},
                    {.suitability = 3000, .quality = 0.95f, .ms = 3.0},
                    {.suitability = 3600, .quality = 0.95f, .ms = 6.0}});
    scene.input.budgetMs = 10.0;
    const PlanReport report = scene.step();
    CHECK(report.overMs == doctest::Approx(6 * 2.9 - 10.0));
    CHECK(report.cheapestMs == doctest::Approx(6 * 2.9));
    Random random(3);
    uint32_t switches = 0;
    for (int frame = 0; frame < 300; ++frame) {
        for (uint32_t light = 0; light < 6; ++light) {
            CHECK(scene.chosen(light) == kNow);
            scene.of(light, kNow).ms = 2.95 * random.between(0.98, 1.02);
            scene.of(light, kOther).ms = 2.95 * random.between(0.98, 1.02);
        }
        switches += scene.step().switches;
    }
    CHECK(switches == 0);
    for (uint32_t light = 0; light < 6; ++light)
        scene.of(light, kOther).ms = 2.0; // a third less is no noise
    scene.step();
    for (uint32_t light = 0; light < 6; ++light)
        CHECK(scene.chosen(light) == kOther);
}

TEST_CASE("qualities that are no numbers leave a near light the methods that it has")
{
    Scene scene(1, cheapAndGood());
    for (uint32_t method : {kCheap, kGood})
        scene.of(0, method).quality = std::numeric_limits<float>::quiet_NaN();
    scene.requests[0].floor = true, scene.requests[0].minimumQuality = 0.8f;
    scene.step();
    CHECK(scene.chosen(0) != kNone);
    CHECK(scene.plan.lights()[0].floorUnmet);
}

TEST_CASE("what fits the budget but not its headroom is not given up for a better suited method that fits neither")
{
    const uint32_t kFits = 1;
    Scene scene(
        1, {{.suitability = 3000, .quality = 0.95f, .ms = 3.0}, {.suitability = 600, .quality = 0.95f, .ms = 2.9}});
    scene.input.budgetMs = 2.95; // less two hundredths: 2.891
    const PlanReport report = scene.step();
    CHECK(report.usableMs < 2.9);
    CHECK(scene.chosen(0) == kFits);
    CHECK(report.overMs == 0.0);
}

TEST_CASE("over random scenes no plan breaks a budget that can be kept, and decisions allocate nothing and repeat")
{
    std::vector<uint32_t> first;
    for (int run = 0; run < 2; ++run) {
        Random random(7);
        Scene scene(24, std::vector<Candidate>(12));
        std::vector<uint32_t> history;
        std::vector<SharedPart> parts(9);
        for (int frame = 0; frame < 2000; ++frame) {
            if (frame % 100 == 0) {
                for (SharedPart& part : parts)
                    part = {random.unit() < 0.5 ? random.between(0.0, 2.0) : 0.0, randomSet(random, 12)};
                scene.input.parts =
                    frame / 100 % 2 ? std::span<const SharedPart>(parts) : std::span<const SharedPart>();
            }
            for (Candidate& candidate : scene.candidates) {
                if (frame % 50 && random.unit() > 0.05) continue;
                candidate = {.eligibility = random.unit() < 0.8 ? Eligibility::eligible : Eligibility::trait,
                             .suitability = static_cast<int32_t>(random.below(4097)),
                             .quality = static_cast<float>(random.unit()),
                             .ms = random.between(0.05, 3.0)};
            }
            scene.input.budgetMs = 4.0 + 20.0 * (frame / 400 % 2);
            scene.input.cut = frame % 777 == 0;
            scene.input.lights = scene.requests;
            scene.input.candidates = scene.candidates;
            const size_t before = rules::test::allocationCount();
            const PlanReport report = scene.step();
            REQUIRE(rules::test::allocationCount() == before);
            if (report.cheapestMs <= report.usableMs * (1 - 1e-9)) REQUIRE(report.predictedMs <= scene.input.budgetMs);
            for (uint32_t i = 0; i < 24; ++i) {
                history.push_back(scene.chosen(i));
                if (scene.chosen(i) == kNone) continue;
                CHECK(scene.why(i, scene.chosen(i)) == Why::chosen);
                CHECK(scene.of(i, scene.chosen(i)).eligibility == Eligibility::eligible);
            }
        }
        if (run == 0)
            first = history;
        else
            CHECK(first == history);
    }
}
