// What compare makes of the times of runs that were repeated in turns.
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "demo/program/envelope.hpp"

using namespace gnomon::demo;

namespace {

/// Frames of 10 ms that scatter by a tenth.
RunTimes scattered(unsigned seed, size_t runs, size_t frames, double ms = 10.0)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> factor(1.0, 1.1);
    RunTimes times(runs, std::vector<double>(frames));
    for (std::vector<double>& run : times)
        for (double& frame : run)
            frame = ms * factor(random);
    return times;
}

} // namespace

TEST_CASE("the envelope is the least of all methods and runs, frame by frame")
{
    const RunTimes a{{3.0, 9.0, 5.0}, {4.0, 7.0, 6.0}}, b{{8.0, 2.0, 5.5}, {2.5, 8.0, 7.0}};
    CHECK(fastestFrames(a) == std::vector<double>{3.0, 7.0, 5.0});
    const std::vector<const RunTimes*> both{&a, &b};
    CHECK(envelopeOf(both) == std::vector<double>{2.5, 2.0, 5.0});
}

TEST_CASE("what is chosen is never chosen by its own time")
{
    // Frame 0: a is chosen for the second run by 1, b for the first by 6; frame 1: b and a.
    const RunTimes a{{1.0, 8.0}, {7.0, 3.0}}, b{{5.0, 4.0}, {6.0, 9.0}}, taken{{2.0, 2.0}, {3.0, 3.0}};
    const std::vector<const RunTimes*> both{&a, &b};
    CHECK(overChosenElsewhere(taken, both) == doctest::Approx(10.0 / ((5.0 + 8.0) + (7.0 + 9.0))));
    CHECK(std::isnan(overChosenElsewhere({{1.0, 2.0}}, both)));
}

TEST_CASE("methods that take as long lie above their envelope, and at one another")
{
    const RunTimes runs = scattered(1, 3, 5000);
    const RunTimes a = scattered(2, 3, 5000), b = scattered(3, 3, 5000), c = scattered(4, 3, 5000);
    const std::vector<const RunTimes*> methods{&a, &b, &c};
    double taken = 0.0, lowest = 0.0;
    for (const double ms : fastestFrames(runs))
        taken += ms;
    for (const double ms : envelopeOf(methods))
        lowest += ms;
    // Least of three and of nine evenly scattered numbers: a quarter and a tenth of the way.
    CHECK(taken / lowest == doctest::Approx(1.025 / 1.01).epsilon(0.001));
    CHECK(overChosenElsewhere(runs, methods) == doctest::Approx(1.0).epsilon(0.001));
}

TEST_CASE("what a better method in part of the frames would save is told")
{
    RunTimes a = scattered(5, 3, 4000), b = scattered(6, 3, 4000);
    for (RunTimes* half : {&a, &b})
        for (std::vector<double>& run : *half)
            for (size_t frame = half == &a ? 0 : 2000; frame < (half == &a ? 2000u : 4000u); ++frame)
                run[frame] *= 0.5;
    const std::vector<const RunTimes*> both{&a, &b};
    CHECK(overChosenElsewhere(a, both) == doctest::Approx(1.5).epsilon(0.002));
}
