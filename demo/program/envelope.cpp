#include "demo/program/envelope.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace gnomon::demo {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Of the runs but one.
double fastestElsewhere(const RunTimes& runs, size_t run, size_t frame)
{
    double least = kInfinity;
    for (size_t other = 0; other < runs.size(); ++other)
        if (other != run) least = std::min(least, runs[other][frame]);
    return least;
}

} // namespace

std::vector<double> fastestFrames(const RunTimes& runs)
{
    std::vector<double> least(runs.empty() ? 0 : runs.front().size(), kInfinity);
    for (const std::vector<double>& run : runs)
        std::transform(run.begin(), run.end(), least.begin(), least.begin(),
                       [](double a, double b) { return std::min(a, b); });
    return least;
}

std::vector<double> envelopeOf(std::span<const RunTimes* const> methods)
{
    RunTimes fastest;
    for (const RunTimes* method : methods)
        fastest.push_back(fastestFrames(*method));
    return fastestFrames(fastest);
}

double overChosenElsewhere(const RunTimes& runs, std::span<const RunTimes* const> methods)
{
    if (runs.size() < 2) return std::numeric_limits<double>::quiet_NaN();
    double taken = 0.0, chosen = 0.0;
    for (size_t run = 0; run < runs.size(); ++run) {
        taken = std::accumulate(runs[run].begin(), runs[run].end(), taken);
        for (size_t frame = 0; frame < runs[run].size(); ++frame) {
            const RunTimes* method =
                *std::min_element(methods.begin(), methods.end(), [=](const RunTimes* a, const RunTimes* b) {
                    return fastestElsewhere(*a, run, frame) < fastestElsewhere(*b, run, frame);
                });
            chosen += (*method)[run][frame];
        }
    }
    return taken / chosen;
}

} // namespace gnomon::demo
