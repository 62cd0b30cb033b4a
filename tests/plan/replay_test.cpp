#include "demo/replay/replay.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <doctest/doctest.h>

#include "demo/replay/resample.hpp"
#include "demo/replay/synthetic.hpp"
#include "tests/plan/random.hpp"

using namespace gnomon;
using namespace gnomon::demo;
using test::Random;

namespace {

const std::string kKindNames[] = {"still", "slow walk", "stress", "budget step"};
constexpr double kSwitchBounds[] = {0.05, 0.2, 1.5, 0.2}; // per light and second

Trace calibrationTrace()
{
    return syntheticTrace({.kind = SyntheticKind::stress, .frames = 1200, .seed = 77});
}

} // namespace

TEST_CASE("a trace reads back as it was written, within its steps")
{
    const Trace trace = syntheticTrace({.kind = SyntheticKind::stress, .frames = 40, .lights = 5});
    const std::string bytes = writeTrace(trace);
    const Outcome<Trace> read = readTrace(bytes);
    REQUIRE(read);
    CHECK(writeTrace(*read) == bytes);
    CHECK(read->methods == trace.methods);
    CHECK(read->facts == trace.facts);
    CHECK(read->budgetsMs == trace.budgetsMs);
    CHECK(read->cuts == trace.cuts);
    for (size_t i = 0; i < trace.measures.size(); ++i) {
        CHECK(read->measures[i].updateGpuMs == doctest::Approx(trace.measures[i].updateGpuMs).epsilon(0.0002));
        CHECK(read->measures[i].resolveGpuMs == doctest::Approx(trace.measures[i].resolveGpuMs).epsilon(0.0002));
        CHECK(read->measures[i].quality == doctest::Approx(trace.measures[i].quality).epsilon(0.0001));
        CHECK(read->measures[i].error == doctest::Approx(trace.measures[i].error).epsilon(0.0001));
    }
}

TEST_CASE("between recorded frames everything goes over smoothly, and what jumps jumps where it was recorded")
{
    Trace trace = syntheticTrace({.kind = SyntheticKind::stress, .frames = 12, .lights = 5});
    trace.frameSeconds = 0.1f;
    trace.cuts[7] = 1;
    trace.lightStates[trace.cell(3, 2)].present = false; // gone for a frame
    trace.lightStates[trace.cell(4, 2)].present = trace.lightStates[trace.cell(4, 2)].fresh = true;
    const Trace fine = resample(trace, 60.0);
    REQUIRE(fine.frames == 72);
    CHECK(fine.frameSeconds == doctest::Approx(1.0 / 60.0));
    for (uint32_t frame = 0; frame < fine.frames; ++frame) {
        const uint32_t key = frame / 6, step = frame % 6;
        CHECK(fine.budgetsMs[frame] == trace.budgetsMs[key]);
        CHECK((fine.cuts[frame] != 0) == (step == 0 && trace.cuts[key] != 0));
        for (uint32_t slot = 0; slot < trace.lights; ++slot) {
            const TraceLight& was = trace.lightStates[trace.cell(key, slot)];
            const TraceLight& is = fine.lightStates[fine.cell(frame, slot)];
            CHECK(is.present == was.present);
            if (!is.present) continue;
            CHECK(is.fresh == (was.fresh && step == 0));
            const bool jumps = key == 11 || trace.cuts[key + 1] ||
                               !trace.lightStates[trace.cell(key + 1, slot)].present ||
                               trace.lightStates[trace.cell(key + 1, slot)].fresh;
            for (uint32_t m = 0; m < trace.methods.size(); ++m) {
                const float from = trace.measure(key, slot, m).resolveGpuMs;
                const float to = jumps ? from : trace.measure(key + 1, slot, m).resolveGpuMs;
                const double geometric =
                    from > 0.0f && to > 0.0f ? from * std::pow(double{to} / from, step / 6.0) : from;
                CHECK(fine.measure(frame, slot, m).resolveGpuMs == doctest::Approx(geometric).epsilon(1e-5));
            }
        }
    }
    CHECK(writeTrace(resample(trace, 0.0)) == writeTrace(trace));
    CHECK(resample(trace, 1e9).frames <= kTraceMostFrames);
}

TEST_CASE("a damaged trace is an error, wherever the damage is")
{
    const std::string bytes = writeTrace(syntheticTrace({.frames = 6, .lights = 3}));
    REQUIRE(readTrace(bytes));
    for (size_t length = 0; length < bytes.size(); length += 1 + length / 50)
        CHECK_FALSE(readTrace(std::string_view(bytes).substr(0, length)));
    Random random(1);
    for (int round = 0; round < 2000; ++round) {
        std::string damaged = bytes;
        char& byte = damaged[random.below(static_cast<uint32_t>(round % 2 ? 64 : bytes.size()))];
        byte = static_cast<char>(byte ^ static_cast<char>(1 + random.below(255)));
        CHECK_FALSE(readTrace(damaged));
    }
    std::string longer = bytes + "x";
    CHECK_FALSE(readTrace(longer));
    std::string huge = bytes; // a header that promises what the file cannot hold
    std::memset(huge.data() + 8, 0xff, 8);
    CHECK(readTrace(huge).error() == "the trace's header is out of bounds");
    std::string newer = bytes;
    newer[7] = '9';
    CHECK(readTrace(newer).error() == "a trace of another version; record it again");
}

TEST_CASE("the calibrated plan keeps its bounds on invented traces, and beats the table and every fixed method")
{
    const Trace calibration = calibrationTrace();
    for (uint32_t kind = 0; kind < 4; ++kind) {
        double flips = 0.0;
        for (uint64_t seed = 1; seed <= 3; ++seed) {
            const Trace trace = syntheticTrace({.kind = static_cast<SyntheticKind>(kind), .seed = seed});
            const std::vector<ReplayMetrics> all = compare(trace, {.noisyTimings = true}, &calibration);
            MESSAGE(kKindNames[kind], ", seed ", seed, "\n", toTable(all));
            const ReplayMetrics& plan = all[0];
            CHECK(plan.regret <= 0.03);
            // Each light has a factor of its own for each method, 8 % one way or the other, that shows only once the
            // method has served it, and until then counts against it.
            CHECK(plan.picks >= 0.73);
            CHECK(plan.over <= 0.01);
            // A step of all times to double their size cannot be foreseen: six frames to come back, whatever the
            // height.
            if (kind != 2) CHECK(plan.worst <= 1.25);
            CHECK(plan.longestOver <= (kind == 2 ? 6 : 10));
            CHECK(plan.floorViolations == 0);
            flips += plan.flipsPerMinute / 3; // of 30 s: a single one is two a minute
            CHECK(plan.switchesPerLightSecond <= kSwitchBounds[kind]);
            for (size_t i = 2; i < all.size(); ++i) // table and fixed methods
                CHECK(plan.regret < all[i].regret);
            // Another device's knowledge: a twentieth of every time, and methods off by a factor of 1.6 either way.
            CHECK(all[1].over <= 0.01);
            CHECK(all[1].regret <= 0.08);
        }
        CHECK(flips <= 1.0);
    }
}

TEST_CASE("a replay is settled by trace and seed")
{
    const Trace trace = syntheticTrace({.kind = SyntheticKind::stress, .frames = 600});
    const Trace calibration = calibrationTrace();
    const Oracle oracle = findOracle(trace, {});
    ReplayMetrics runs[2];
    for (ReplayMetrics& run : runs)
        run = replay(trace, oracle, *planPolicy(trace, {}, &calibration), {});
    CHECK(runs[0].regret == runs[1].regret);
    CHECK(runs[0].meanMs == runs[1].meanMs);
    CHECK(runs[0].switchesPerLightSecond == runs[1].switchesPerLightSecond);
}

TEST_CASE("the oracle loses nothing against itself, and no policy has negative regret")
{
    const Trace trace = syntheticTrace({.kind = SyntheticKind::slowWalk, .frames = 300, .lights = 6});
    struct Seer : ReplayPolicy {
        const Oracle& oracle;
        explicit Seer(const Oracle& o) : oracle(o) {}
        std::string name() const override { return "seer"; }
        void decide(const Trace& t, uint32_t frame, double, std::span<uint32_t> chosen) override
        {
            std::copy_n(oracle.chosen.begin() + static_cast<std::ptrdiff_t>(t.cell(frame, 0)), t.lights,
                        chosen.begin());
        }
    };
    const Oracle oracle = findOracle(trace, {});
    Seer seer(oracle);
    const ReplayMetrics metrics = replay(trace, oracle, seer, {});
    CHECK(metrics.regret == doctest::Approx(0.0));
    CHECK(metrics.picks == 1.0);
    CHECK(metrics.over == 0.0);
    CHECK(metrics.floorViolations == 0);
    const Trace calibration = calibrationTrace();
    for (const ReplayMetrics& m : compare(trace, {.noisyTimings = true}, &calibration))
        CHECK(m.regret > -0.001);
}
