// Cross-fades and `budget: auto` without a device: which methods are mixed, by how much, and what that may cost.
#include <array>
#include <limits>
#include <vector>

#include <doctest/doctest.h>

#include "runtime/select/auto_budget.hpp"
#include "runtime/select/fade.hpp"

using namespace gnomon;

namespace {

constexpr std::uint32_t kA = 3, kB = 5, kC = 7;

/// A light that has had `method` for long.
struct Light {
    Fade fade;
    std::uint64_t frame = 0;
    std::uint32_t length = 4;

    explicit Light(std::uint32_t method) { next(method); }
    Fade::Step next(std::uint32_t method, bool jump = false) { return fade.advance(++frame, method, length, jump); }
};

bool is(const Fade::Step& step, std::uint32_t outgoing, float share)
{
    return step.outgoing == outgoing && step.share == share;
}

} // namespace

TEST_CASE("the share of the new method grows by equal parts, and the old one runs in n frames")
{
    for (const std::uint32_t length : {1u, 4u, 8u}) {
        CAPTURE(length);
        Light light(kA);
        light.length = length;
        for (std::uint32_t k = 1; k <= length; ++k) {
            const Fade::Step step = light.next(kB);
            CHECK(is(step, kA, float(k) / float(length + 1)));
            CHECK(step.begun == (k > 1));
        }
        CHECK(light.fade.shows(kA));
        CHECK(light.fade.shows(kB));
        CHECK(is(light.next(kB), Fade::kNone, 1.0f));
        CHECK(is(light.next(kB), Fade::kNone, 1.0f));
        CHECK_FALSE(light.fade.running());
        CHECK_FALSE(light.fade.shows(kA));
        CHECK(light.fade.shows(kB));
    }
}

TEST_CASE("a new light, a jump and a length of 0 show the method at once")
{
    Fade fresh;
    CHECK(is(fresh.advance(1, kA, 4, false), Fade::kNone, 1.0f));

    Light light(kA);
    CHECK(is(light.next(kB, true), Fade::kNone, 1.0f));
    CHECK(is(light.next(kB), Fade::kNone, 1.0f)); // and the fade is not made up for
    light.next(kA);
    CHECK(light.fade.running());
    CHECK(is(light.next(kA, true), Fade::kNone, 1.0f)); // in the middle

    light.length = 0;
    CHECK(is(light.next(kB), Fade::kNone, 1.0f));
}

TEST_CASE("a light that nothing served before does not fade from nothing")
{
    Light light(kA);
    CHECK(is(light.next(Fade::kNone), Fade::kNone, 1.0f));
    CHECK(is(light.next(kA), Fade::kNone, 1.0f));
    light.fade.lose();
    CHECK(is(light.next(kB), Fade::kNone, 1.0f));
}

TEST_CASE("a fade turns round where the change is taken back, and no share moves by more than one part")
{
    Light light(kA);
    light.next(kB);
    light.next(kB);                             // 2/5 B
    CHECK(is(light.next(kA), kB, 4.0f / 5.0f)); // 1/5 B
    CHECK(is(light.next(kB), kA, 2.0f / 5.0f)); // 2/5 B
    CHECK(is(light.next(kB), kA, 3.0f / 5.0f));
    Light early(kA);
    early.next(kB);                               // 1/5 B
    CHECK(is(early.next(kA), Fade::kNone, 1.0f)); // 0/5 B
    CHECK(is(early.next(kA), Fade::kNone, 1.0f));
}

TEST_CASE("a third method fades from whichever of the two is the more visible")
{
    Light early(kA);
    early.next(kB);
    early.next(kB); // 2/5 B
    CHECK(is(early.next(kC), kA, 1.0f / 5.0f));
    Light late(kA);
    late.next(kB);
    late.next(kB);
    late.next(kB); // 3/5 B
    CHECK(is(late.next(kC), kB, 1.0f / 5.0f));
    CHECK(is(late.next(kC), kB, 2.0f / 5.0f));
}

TEST_CASE("the length is that of the rules under which a fade began; 0 ends it")
{
    Light light(kA);
    light.next(kB);
    light.length = 9;
    CHECK(is(light.next(kB), kA, 2.0f / 5.0f));
    light.length = 0;
    CHECK(is(light.next(kB), Fade::kNone, 1.0f));
}

TEST_CASE("a withdrawn frame is shown by the next one")
{
    Light light(kA);
    light.next(kB);
    light.fade.withdraw(light.frame); // the one that began it
    CHECK(is(light.next(kB), kA, 1.0f / 5.0f));
    light.next(kB);
    light.fade.withdraw(light.frame);
    light.fade.withdraw(light.frame); // only once
    CHECK(is(light.next(kB), kA, 2.0f / 5.0f));
    light.next(kA);
    light.fade.withdraw(light.frame); // the one that turned round
    CHECK(is(light.next(kA), kB, 4.0f / 5.0f));
    light.fade.withdraw(light.frame - 1); // not the newest
    CHECK(is(light.next(kA), Fade::kNone, 1.0f));
    light.fade.withdraw(light.frame); // the one that ended it
    CHECK(is(light.next(kB), kA, 2.0f / 5.0f));
}

TEST_CASE("outgoing methods are counted, and only those admitted that fit beside the plan")
{
    const std::vector<FadeRequest> wanted = {
        {.outgoingMs = 2.0}, {}, {.outgoingMs = 3.0, .begun = true}, {.outgoingMs = 1.0}};
    auto admit = [&](double plannedMs, double usableMs, std::array<bool, 4> expected) {
        std::vector<FadeRequest> requests = wanted;
        const double sum = admitFades(requests, plannedMs, usableMs);
        double counted = plannedMs;
        for (std::size_t i = 0; i < requests.size(); ++i) {
            CHECK(requests[i].admitted == expected[i]);
            if (requests[i].admitted) counted += requests[i].outgoingMs;
        }
        CHECK(sum == counted);
        return sum;
    };
    CHECK(admit(10.0, std::numeric_limits<double>::infinity(), {true, true, true, true}) == 16.0);
    CHECK(admit(10.0, 16.0, {true, true, true, true}) == 16.0);
    CHECK(admit(10.0, 15.0, {true, true, true, false}) == 15.0);
    CHECK(admit(10.0, 14.5, {false, true, true, true}) == 14.0); // the one that runs goes first
    CHECK(admit(10.0, 12.0, {true, true, false, false}) == 12.0);
    CHECK(admit(10.0, 9.0, {false, false, false, false}) == 10.0); // the plan itself is over
    CHECK(admit(10.0, 0.0, {false, false, false, false}) == 10.0); // nothing is left beside shared work
}

TEST_CASE("budget auto is 1.3 times the median of the later half of the first second")
{
    AutoBudget budget;
    CHECK(budget.ms() == 0.0);
    for (std::uint32_t frame = 1; frame <= AutoBudget::kMostFrames; ++frame) {
        CHECK(budget.measuring());
        const bool spike = frame == 40 || frame == 50;
        const bool last = budget.note(frame <= 20 ? 50.0 : spike ? 30.0 : 2.0, 5.0);
        CHECK(last == (frame == AutoBudget::kMostFrames));
    }
    CHECK_FALSE(budget.measuring());
    CHECK(budget.ms() == doctest::Approx(2.6));
    CHECK_FALSE(budget.note(90.0, 5.0)); // known once
    CHECK(budget.ms() == doctest::Approx(2.6));
    budget.restart();
    CHECK(budget.measuring());
}

namespace {

/// Frames of `lights` lights that take `ms` each, until the budget is known. @return how many
std::uint32_t measure(AutoBudget& budget, std::uint32_t lights, double ms)
{
    std::uint32_t frames = 0;
    for (; budget.measuring(); ++frames) {
        budget.look(lights, false);
        budget.note(ms, 5.0);
    }
    return frames;
}

/// Whether the budget stays known over the frames.
bool stays(AutoBudget& budget, std::uint32_t frames, std::uint32_t lights, bool cut)
{
    for (std::uint32_t i = 0; i < frames; ++i)
        budget.look(lights, cut);
    return !budget.measuring();
}

} // namespace

TEST_CASE("budget auto is measured again after a cut and once an eighth of the lights have come or gone to stay")
{
    AutoBudget budget;
    CHECK(measure(budget, 9, 2.0) == AutoBudget::kMostFrames); // 300 ms: not a second yet
    CHECK(stays(budget, 300, 10, false));
    CHECK(stays(budget, 300, 8, false));
    CHECK(stays(budget, 300, 0, false)); // frames without lights
    CHECK(budget.ms() == doctest::Approx(2.6));
    CHECK(stays(budget, AutoBudget::kSettled - 1, 11, false));
    CHECK_FALSE(stays(budget, 1, 11, false));
    CHECK(measure(budget, 11, 4.0) == AutoBudget::kFewestAgain);
    CHECK(budget.ms() == doctest::Approx(5.2));
    CHECK(stays(budget, AutoBudget::kSettled, 11, false));
    CHECK_FALSE(stays(budget, 1, 11, true)); // a cut
    CHECK(measure(budget, 11, 3.0) == AutoBudget::kFewestAgain);
}

TEST_CASE("budget auto is not measured over and over by flickering lights, views in turn or cuts in every frame")
{
    AutoBudget budget;
    measure(budget, 4, 2.0);
    for (int i = 0; i < 1000; ++i)
        REQUIRE(stays(budget, 10, i % 2 ? 4 : 5, false));
    std::uint32_t measuring = 0;
    for (int i = 0; i < 460; ++i) {
        budget.look(4, true);
        budget.note(2.0, 5.0);
        measuring += budget.measuring();
    }
    CHECK(measuring <= 10 * AutoBudget::kFewestAgain);
    // While it measures, lights may come one after another.
    budget.restart();
    std::uint32_t lights = 1;
    for (; budget.measuring() && lights < 100; ++lights) {
        budget.look(lights, false);
        budget.note(1.0, 20.0);
    }
    CHECK(lights == 51); // a second
    CHECK(stays(budget, 100, 50, false));
}

TEST_CASE("budget auto follows what the cheapest plan takes over what was predicted, and nothing else")
{
    AutoBudget budget;
    const auto follow = [&budget](std::uint32_t frames, double tookMs, double plannedMs, double cheapestMs) {
        for (std::uint32_t i = 0; i < frames; ++i)
            budget.follow(tookMs, plannedMs, cheapestMs);
        return budget.perCheapest();
    };
    CHECK(follow(AutoBudget::kFollowed - 1, 3.3, 3.0, 3.0) == 0.0); // still measuring
    measure(budget, 4, 2.0);
    CHECK(budget.ms() == doctest::Approx(2.6));
    CHECK(budget.perCheapest() == 0.0);                            // too little is known
    CHECK(follow(1, 3.3, 3.0, 3.0) == doctest::Approx(1.3 * 1.1)); // frames that measured count
    CHECK(follow(AutoBudget::kFollowed / 2 - 1, 9.0, 3.0, 3.0) == doctest::Approx(1.3 * 1.1)); // spikes
    CHECK(follow(100, 9.0, 5.0, 3.0) == doctest::Approx(1.3 * 1.1));                           // a costlier plan's
    CHECK(follow(100, -1.0, 3.0, 3.0) == doctest::Approx(1.3 * 1.1));                          // unknown
    CHECK(follow(100, 3.0, 0.0, 0.0) == doctest::Approx(1.3 * 1.1));
    CHECK(follow(100, 3.0, 3.2, 3.0) == doctest::Approx(1.3 * 3.0 / 3.2)); // about as cheap
    CHECK(measure(budget, 4, 2.0) == 0);
    CHECK_FALSE(stays(budget, AutoBudget::kSettled, 9, false)); // other lights: the frames so far count no more
    CHECK(budget.perCheapest() == 0.0);
    CHECK(measure(budget, 9, 8.0) == AutoBudget::kFewestAgain);
    CHECK(budget.ms() == doctest::Approx(10.4));
    CHECK(budget.perCheapest() == 0.0);
}

TEST_CASE("budget auto takes a second of time where frames are slow, and ignores frames that took nothing")
{
    AutoBudget budget;
    std::uint32_t frames = 0;
    while (budget.measuring() && frames < 100) {
        budget.note(0.0, 25.0);
        budget.note(4.0, 25.0);
        ++frames;
    }
    CHECK(frames == 40); // 25 ms each
    CHECK(budget.ms() == doctest::Approx(5.2));
    AutoBudget slower;
    for (frames = 0; slower.measuring() && frames < 100; ++frames)
        slower.note(4.0, 500.0);
    CHECK(frames == AutoBudget::kFewestFrames);
}
