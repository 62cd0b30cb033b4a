#include "demo/calibrate/fit.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace gnomon::demo {
namespace {

using cost::kTerms;
using cost::Terms;

struct Point {
    Terms terms;
    double ms;
};

constexpr uint32_t kReweighings = 30; // the fits of rules/knowledge stand still after twenty
constexpr uint32_t kSweeps = 400;
constexpr double kLeastError = 0.05; // octaves: below it a sample weighs no more
constexpr double kLeastMs = 1e-6;

/// Weighted least squares with numbers >= 0, coordinate by coordinate: each is set to its best with the others as they
/// are, until none moves (V. Franc et al., "Sequential coordinate-wise algorithm for the non-negative least squares
/// problem", 2005).
Terms leastSquares(const std::vector<Point>& points, const std::vector<double>& weights, Terms ms)
{
    std::array<std::array<double, kTerms>, kTerms> products{};
    Terms targets{};
    for (size_t p = 0; p < points.size(); ++p)
        for (uint32_t i = 0; i < kTerms; ++i) {
            const double weighted = weights[p] * weights[p] * points[p].terms[i];
            targets[i] += weighted * points[p].ms;
            for (uint32_t j = 0; j < kTerms; ++j)
                products[i][j] += weighted * points[p].terms[j];
        }
    for (uint32_t sweep = 0; sweep < kSweeps; ++sweep)
        for (uint32_t i = 0; i < kTerms; ++i) {
            if (!(products[i][i] > 0.0)) continue;
            double rest = targets[i];
            for (uint32_t j = 0; j < kTerms; ++j)
                if (j != i) rest -= products[i][j] * ms[j];
            ms[i] = std::max(rest / products[i][i], 0.0);
        }
    return ms;
}

double errorOf(const Terms& ms, const Point& point)
{
    return std::log2(std::max(cost::sumOf(ms, point.terms), kLeastMs) / point.ms);
}

/// Iteratively reweighted: squares of differences become absolute logarithms of ratios.
cost::TrackCost fitTrack(const std::vector<Point>& points)
{
    cost::TrackCost out{.samples = static_cast<uint32_t>(points.size())};
    if (points.empty()) return out;
    std::vector<double> weights(points.size());
    for (size_t p = 0; p < points.size(); ++p)
        weights[p] = 1.0 / points[p].ms;
    for (uint32_t i = 0; i < kReweighings; ++i) {
        out.ms = leastSquares(points, weights, out.ms);
        for (size_t p = 0; p < points.size(); ++p) {
            const double predicted = std::max(cost::sumOf(out.ms, points[p].terms), kLeastMs);
            weights[p] = 1.0 / std::sqrt(points[p].ms * predicted *
                                         std::max(std::fabs(errorOf(out.ms, points[p])), kLeastError));
        }
    }
    double squares = 0.0;
    for (const Point& point : points)
        squares += std::pow(errorOf(out.ms, point), 2.0);
    out.octaves = std::sqrt(squares / static_cast<double>(points.size()));
    return out;
}

double medianOf(std::vector<double> values)
{
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Side of one face of the maps a sample was measured with; 0: none.
double sideOf(const cost::Workload& workload)
{
    return std::sqrt(workload.mapTexels / (workload.point ? 6.0 : 1.0));
}

cost::AlgorithmCost fitAlgorithm(const std::string& name, const Samples& samples)
{
    cost::AlgorithmCost out{.algorithm = name, .tracks = {}};
    std::array<std::vector<Point>, cost::kTracks> points;
    std::vector<double> firstFrames;
    for (const Sample& sample : samples.rows) {
        if (sample.algorithm != name) continue;
        const Terms terms = termsOf(sample.workload, sample.pass);
        // The fastest sample is the one that nothing else disturbed.
        if (sample.gpuMsMin > 0.0)
            points[trackOf(sample.pass, cost::Processor::gpu)].push_back({terms, sample.gpuMsMin});
        if (sample.cpuMsMin > 0.0)
            points[trackOf(sample.pass, cost::Processor::cpu)].push_back({terms, sample.cpuMsMin});
        if (sample.pass != cost::Pass::resolve) continue; // its update row says the same of the rest again
        firstFrames.push_back(sample.firstFrameMs);
        if (sample.wrongPercent < 0.0) continue;
        const double side = sideOf(sample.workload);
        out.wrongPercent += sample.wrongPercent * (side > 0.0 ? side / 1024.0 : 1.0);
        ++out.wrongSamples;
    }
    out.wrongPercent /= std::max(1u, out.wrongSamples);
    out.firstFrameMs = medianOf(firstFrames);
    for (uint32_t t = 0; t < cost::kTracks; ++t)
        out.tracks[t] = fitTrack(points[t]);
    return out;
}

} // namespace

cost::DeviceKnowledge fitKnowledge(const Samples& samples, const std::string& kind)
{
    cost::DeviceKnowledge out;
    out.kind = kind;
    if (samples.rows.empty()) return out;
    out.device = samples.rows.front().device;
    out.driver = samples.rows.front().driver;
    std::vector<std::string> names; // in the order of their rows
    for (const Sample& sample : samples.rows)
        if (std::find(names.begin(), names.end(), sample.algorithm) == names.end()) names.push_back(sample.algorithm);
    for (const std::string& name : names)
        out.algorithms.push_back(fitAlgorithm(name, samples));
    for (const SharedSample& part : samples.parts)
        out.parts.push_back({part.algorithm, part.pass, (part.gpuMs + part.cpuMs) / part.viewPixels});
    return out;
}

} // namespace gnomon::demo
