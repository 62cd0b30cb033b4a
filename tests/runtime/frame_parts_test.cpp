// What a context keeps from frame to frame, part by part, without a device.
#include <chrono>
#include <vector>

#include <doctest/doctest.h>

#include "runtime/frame/frame.hpp"
#include "runtime/frame/frame_budget.hpp"
#include "runtime/frame/frame_costs.hpp"
#include "runtime/frame/probe_run.hpp"
#include "runtime/frame/world_origin.hpp"

using namespace gnomon;

namespace {

GnViewFrame viewAt(double x)
{
    GnViewFrame view{};
    view.eye[0] = x;
    return view;
}

FrameTimings timingsOf(std::uint64_t frame, float gpuMs, bool timed = false)
{
    return {.frame = frame, .timed = timed, .totalGpuMs = gpuMs, .passes = {}};
}

/// Frames 1 to `last`, of the same methods.
PastFrames pastUntil(std::uint64_t last)
{
    PastFrames past;
    for (std::uint64_t frame = 1; frame <= last; ++frame) {
        past.begin(frame);
        past.present().methods = 7;
        past.present().timedUnasked = true;
        past.present().pixels = 100.0;
    }
    return past;
}

rules::RuleBase automaticBase()
{
    rules::RuleBase base;
    base.textHash = 1;
    base.options.allocation = rules::Options::Allocation::Budget;
    base.policy.budget.automatic = true;
    return base;
}

} // namespace

TEST_CASE("the origin follows an eye in steps, with slack at their boundaries")
{
    WorldOrigin origin;
    const auto follow = [&](double x, std::uint64_t frame) {
        const GnViewFrame view = viewAt(x);
        return origin.follow({&view, 1}, frame);
    };
    CHECK_FALSE(origin.follow({}, 1));
    CHECK(origin.movedIn() == 0);
    CHECK(follow(0.0, 2)); // the first eye of all sets it
    CHECK(follow(300.0, 3));
    CHECK(origin.at()[0] == WorldOrigin::kStep);
    CHECK_FALSE(follow(WorldOrigin::kStep * 1.74, 4)); // nearer to the next step, but within the slack
    CHECK_FALSE(follow(WorldOrigin::kStep * 0.26, 5));
    CHECK(origin.movedIn() == 3);
    CHECK(follow(WorldOrigin::kStep * 1.76, 6));
    CHECK(origin.at()[0] == 2.0 * WorldOrigin::kStep);
}

TEST_CASE("of views far from one another any one holds the origin")
{
    WorldOrigin origin;
    const GnViewFrame views[] = {viewAt(0.0), viewAt(1e6)}, swapped[] = {views[1], views[0]};
    CHECK(origin.follow(views, 1));
    CHECK_FALSE(origin.follow(swapped, 2));
    CHECK(origin.at()[0] == 0.0);
}

TEST_CASE("a past frame is known for as long as sixteen follow")
{
    PastFrames past = pastUntil(20);
    CHECK(past.at(20).frame == 20);
    CHECK(past.at(5).frame == 5);
    CHECK(past.at(4).frame == 0);
    CHECK_FALSE(past.disturbedBefore(21, 8));
    past.present().disturbed = true;
    CHECK(past.disturbedBefore(27, 8));
    CHECK_FALSE(past.disturbedBefore(28, 8));
}

TEST_CASE("the rate of frames is the mean of those that follow each other")
{
    FrameIntervals intervals;
    FrameIntervals::Time now{};
    intervals.note(now, false);
    CHECK(intervals.rate() == 0.0);
    CHECK(intervals.newestMs() == 0.0f);
    for (const int ms : {10, 30})
        intervals.note(now += std::chrono::milliseconds(ms), true);
    CHECK(intervals.newestMs() == doctest::Approx(30.0));
    CHECK(intervals.rate() == doctest::Approx(50.0));
    intervals.note(now += std::chrono::seconds(5), false); // another context of the host's may have had that time
    CHECK(intervals.rate() == doctest::Approx(50.0));
}

TEST_CASE("one frame in eight is timed, and the settled ones after a change or the start of a probe")
{
    TimedFrames timed;
    const auto among = [&](std::uint64_t first, std::uint64_t probedSince) {
        std::vector<std::uint64_t> frames;
        for (std::uint64_t frame = first; frame < first + 7; ++frame)
            if (timed.has(frame, probedSince)) frames.push_back(frame);
        return frames;
    };
    CHECK(among(1, 0).empty());
    CHECK(among(2, 0) == std::vector<std::uint64_t>{8});
    timed.noteChange(16);
    timed.noteChange(18); // while the timings of the first are to come: passed over
    CHECK(among(17, 0) == std::vector<std::uint64_t>{17, 18, 19});
    CHECK(among(33, 33) == std::vector<std::uint64_t>{34, 35, 36});
}

TEST_CASE("a timed frame's passes are scaled by what the same methods took untimed")
{
    PastFrames past = pastUntil(9);
    FrameTotals totals;
    CHECK(totals.ms() < 0.0);
    const FrameTimings whole = timingsOf(7, 6.0f), timed = timingsOf(8, 8.0f, true);
    totals.note(&whole, &timed, past);
    CHECK(totals.frame() == 7);
    CHECK(totals.ms() == doctest::Approx(6.0));
    totals.noteScale(timed, past);
    CHECK(totals.scale() == doctest::Approx(0.75));

    past.present().disturbed = true; // frame 9
    totals.noteScale(timingsOf(9, 60.0f, true), past);
    CHECK(totals.scale() == doctest::Approx(0.75));
}

TEST_CASE("a host that times every frame leaves none untimed, and totals go on")
{
    const PastFrames past = pastUntil(30);
    FrameTotals totals;
    const FrameTimings whole = timingsOf(1, 6.0f), soon = timingsOf(1 + 2 * kTimedPeriod, 9.0f, true),
                       late = timingsOf(2 + 2 * kTimedPeriod, 9.0f, true);
    totals.note(&whole, &soon, past);
    CHECK(totals.frame() == 1);
    totals.note(&whole, &late, past);
    CHECK(totals.frame() == late.frame);
    CHECK(totals.gpuMs() == doctest::Approx(9.0));
}

TEST_CASE("what no method asked for is told apart from what methods share")
{
    const PastFrames past = pastUntil(8);
    FrameTimings timings = timingsOf(8, 4.0f, true);
    timings.passes.push_back({.name = "grid", .owner = {.view = 1}, .gpuMs = 1.0f});
    timings.passes.push_back({.name = "copy", .owner = {.view = 1, .declarers = {0}}, .gpuMs = 2.0f});
    timings.passes.push_back({.name = "map", .owner = {.view = 1, .light = 1}, .gpuMs = 4.0f});
    SharedCosts costs;
    costs.note(timings, past.at(8), 0.5f);
    CHECK(costs.ms() == doctest::Approx(1.5));
    CHECK(costs.unaskedMs() == doctest::Approx(0.5));
    PastFrame disturbed = past.at(8);
    disturbed.disturbed = true;
    costs.note(timings, disturbed, 1.0f);
    CHECK(costs.ms() == doctest::Approx(1.5));
}

TEST_CASE("the host's budget is in force, below the cap of the rules")
{
    FrameBudget budget;
    budget.begin(nullptr, {.hostMs = 4.0});
    CHECK(budget.ms() == 4.0);
    CHECK(budget.planMs() == 4.0);
    CHECK(budget.cheapestShare() == 0.0); // nothing was planned yet
    budget.take({.cheapestMs = 1.0});
    CHECK(budget.cheapestShare() == 0.25);

    rules::RuleBase base = automaticBase();
    base.policy.budget.shadowCapMs = 2.0;
    budget.begin(&base, {.hostMs = 4.0});
    CHECK(budget.ms() == 2.0);
    CHECK_FALSE(budget.measuring());
}

TEST_CASE("without a budget `budget: auto` measures the cheapest plan, then allows more than that took")
{
    const rules::RuleBase base = automaticBase();
    FrameBudget budget;
    std::uint32_t frames = 0;
    do {
        budget.begin(&base, {.lights = 3, .tookMs = 2.0, .intervalMs = 16.0f});
        CHECK(budget.cheapestShare() == 0.0);
        if (budget.measuring()) CHECK(budget.planMs() < 0.01);
        REQUIRE(++frames < 200);
    } while (budget.measuring());
    CHECK(budget.begins());
    CHECK(budget.ms() == doctest::Approx(2.0 * AutoBudget::kFactor));
    budget.begin(&base, {.lights = 3, .tookMs = 2.0, .intervalMs = 16.0f});
    CHECK_FALSE(budget.begins());

    rules::RuleBase other = base;
    other.textHash = 2;
    budget.begin(&other, {.lights = 3, .tookMs = 2.0, .intervalMs = 16.0f});
    CHECK(budget.measuring());
}

TEST_CASE("frames that something disturbed measure nothing")
{
    const rules::RuleBase base = automaticBase();
    FrameBudget budget;
    for (int i = 0; i < 200; ++i)
        budget.begin(&base, {.lights = 3, .disturbed = true, .tookMs = 2.0, .intervalMs = 16.0f});
    CHECK(budget.measuring());
}

TEST_CASE("a probe is due as often as the rules say, and one at a time")
{
    rules::RuleBase base;
    base.policy.probing.everyFrames = 60;
    ProbeRun probe;
    CHECK_FALSE(probe.isDue(nullptr, 64));
    CHECK_FALSE(probe.isDue(&base, 56));
    CHECK_FALSE(probe.isDue(&base, 63));
    CHECK(probe.isDue(&base, 64));
    probe.begin(1, 2, 3, 64);
    CHECK(probe.isOf(1, 2));
    CHECK_FALSE(probe.isOf(2, 1));
    CHECK_FALSE(probe.isDue(&base, 128));
    CHECK_FALSE(probe.isDone(64 + cost::kLearnFrames - 1));
    CHECK(probe.isDone(64 + cost::kLearnFrames));
    probe.end();
    CHECK_FALSE(probe.isDue(&base, 120));
    CHECK(probe.isDue(&base, 128));
    base.policy.probing.everyFrames = 0;
    CHECK_FALSE(probe.isDue(&base, 640));
}
