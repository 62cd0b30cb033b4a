#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "rules/engine/lint_checks.hpp"
#include "runtime/base/number_text.hpp"

namespace gnomon::rules {
namespace {

double highest(const Variable& variable, double x)
{
    double value = 0.0;
    for (const Term& term : variable.terms)
        value = std::max(value, term.shape.membership(x));
    return value;
}

std::size_t termsAt(const Variable& variable, double x)
{
    return static_cast<std::size_t>(std::count_if(variable.terms.begin(), variable.terms.end(),
                                                  [x](const Term& t) { return t.shape.membership(x) > 0.0; }));
}

/// A flank as a line through (foot, 0) and (shoulder, 1).
struct Flank {
    double foot, shoulder;
};

/// Every x where the highest membership may change its slope: corners, and crossings of two flanks.
std::vector<double> bends(const Variable& variable)
{
    std::vector<double> xs = {variable.low, variable.high};
    std::vector<Flank> flanks;
    for (const Term& term : variable.terms) {
        const Trapezoid& t = term.shape;
        xs.insert(xs.end(), {t.a, t.b, t.c, t.d});
        if (t.a < t.b) flanks.push_back({t.a, t.b});
        if (t.c < t.d) flanks.push_back({t.d, t.c});
    }
    for (std::size_t i = 0; i < flanks.size(); ++i) {
        for (std::size_t j = i + 1; j < flanks.size(); ++j) {
            const double slopeI = 1.0 / (flanks[i].shoulder - flanks[i].foot);
            const double slopeJ = 1.0 / (flanks[j].shoulder - flanks[j].foot);
            if (slopeI != slopeJ) xs.push_back((slopeI * flanks[i].foot - slopeJ * flanks[j].foot) / (slopeI - slopeJ));
        }
    }
    std::erase_if(xs, [&](double x) { return !(x >= variable.low && x <= variable.high); });
    std::sort(xs.begin(), xs.end());
    xs.erase(std::unique(xs.begin(), xs.end()), xs.end());
    return xs;
}

/// Of the whole numbers of a count variable those beside its bends, where they are extreme; its terms mean nothing
/// between them.
std::vector<double> wholeNumbers(const Variable& variable)
{
    std::vector<double> numbers;
    for (const double x : bends(variable)) {
        const double below = std::floor(x), above = std::ceil(x);
        numbers.insert(numbers.end(), {below - 1.0, below, above, above + 1.0});
    }
    std::erase_if(numbers, [&](double x) { return !(x >= variable.low && x <= variable.high); });
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    return numbers;
}

struct Lowest {
    double x = 0.0;
    double value = 1.0;
    void consider(double at, double candidate)
    {
        if (candidate < value) *this = {at, candidate};
    }
};

/// Where the highest membership is lowest. Between bends it is straight, so only the ends count; they are extrapolated
/// from inside, because a vertical edge belongs to its term but the points beside it do not.
Lowest lowestCoverage(const Variable& variable)
{
    Lowest lowest;
    if (variable.isCount()) {
        for (const double x : wholeNumbers(variable))
            lowest.consider(x, highest(variable, x));
        return lowest;
    }
    const std::vector<double> xs = bends(variable);
    for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
        const double quarter = highest(variable, 0.75 * xs[i] + 0.25 * xs[i + 1]);
        const double threeQuarters = highest(variable, 0.25 * xs[i] + 0.75 * xs[i + 1]);
        lowest.consider(xs[i], 1.5 * quarter - 0.5 * threeQuarters);
        lowest.consider(xs[i + 1], 1.5 * threeQuarters - 0.5 * quarter);
    }
    for (const double x : xs)
        lowest.consider(x, highest(variable, x));
    return lowest;
}

std::vector<double> probes(const Variable& variable)
{
    if (variable.isCount()) return wholeNumbers(variable);
    std::vector<double> xs = bends(variable);
    const std::size_t corners = xs.size();
    for (std::size_t i = 0; i + 1 < corners; ++i)
        xs.push_back(0.5 * (xs[i] + xs[i + 1]));
    return xs;
}

/// Shares are numbers from 0 to 1; who thinks of them as per cent writes 5 for a twentieth.
bool isInPercent(const Variable& variable, DiagnosticSink& sink)
{
    constexpr double kHundred = 100.0;
    if (variable.unit != "share") return false;
    for (const Term& term : variable.terms)
        for (const double corner : {term.shape.a, term.shape.b, term.shape.c, term.shape.d}) {
            if (!std::isfinite(corner) || corner <= variable.high) continue;
            sink.warning("L06", term.at,
                         inQuotes(term.name) + " of " + inQuotes(variable.name) + " has a corner at " +
                             shortestText(corner) + ", but a share goes from 0 to 1: for " + shortestText(corner) +
                             " % write " + shortestText(corner / kHundred));
            return true;
        }
    return false;
}

void checkTerms(const Variable& variable, const std::vector<double>& xs, DiagnosticSink& sink)
{
    std::optional<double> previous;
    for (const Term& term : variable.terms) {
        const Trapezoid& t = term.shape;
        const std::string name = inQuotes(term.name) + " of " + inQuotes(variable.name);
        if (std::none_of(xs.begin(), xs.end(), [&](double x) { return t.membership(x) > 0.0; }))
            sink.warning("L06", term.at, name + " contains no value of the universe");
        for (const double edge : {variable.low, variable.high}) {
            const bool onFlank = (t.a < edge && edge < t.b) || (t.c < edge && edge < t.d);
            if (onFlank)
                sink.warning("L06", term.at,
                             name + " is still rising or falling at the edge of the universe, " + shortestText(edge));
        }
        const double centre =
            std::clamp(t.b, variable.low, variable.high) + std::clamp(t.c, variable.low, variable.high);
        if (previous && centre < *previous)
            sink.warning("L06", term.at, name + " is out of order: it lies before the term above it");
        previous = centre;
    }
}

/// How to close the hole at `x`.
std::string mendOf(const Variable& variable, double x)
{
    const Term *before = nullptr, *behind = nullptr;
    for (const Term& term : variable.terms) {
        if (term.shape.c <= x) before = &term;
        if (!behind && term.shape.b >= x) behind = &term;
    }
    if (!before && !behind) return "; add a term there";
    if (!before || !behind) return "; let " + inQuotes((before ? before : behind)->name) + " reach it";
    const Trapezoid& falls = before->shape;
    const std::string flank =
        falls.c < falls.d ? ", from " + shortestText(falls.c) + " to " + shortestText(falls.d) : "";
    return "; let " + inQuotes(behind->name) + " rise where " + inQuotes(before->name) + " falls" + flank;
}

void checkVariable(const Variable& variable, DiagnosticSink& sink)
{
    constexpr double kHole = 0.5;      ///< Below it no term is more true than false.
    constexpr double kRounding = 1e-9; ///< Of the extrapolation above; a crossing at exactly one half is no hole.
    if (isInPercent(variable, sink)) return;
    const std::vector<double> xs = probes(variable);
    checkTerms(variable, xs, sink);
    if (const Lowest lowest = lowestCoverage(variable); lowest.value < kHole - kRounding)
        sink.warning("L06", variable.at,
                     "the terms of " + inQuotes(variable.name) + " leave a hole at " + shortestText(lowest.x) +
                         ": the best membership there is " + fixedText(std::max(0.0, lowest.value), 2) +
                         mendOf(variable, lowest.x));
    const auto crowded = std::find_if(xs.begin(), xs.end(), [&](double x) { return termsAt(variable, x) > 2; });
    if (crowded != xs.end())
        sink.warning("L06", variable.at,
                     "more than two terms of " + inQuotes(variable.name) + " overlap at " + shortestText(*crowded));
}

} // namespace

bool checkPartitions(const Engine& engine, DiagnosticSink& sink)
{
    const std::size_t before = sink.all().size();
    for (const Variable& variable : engine.base().variables)
        checkVariable(variable, sink);
    const bool sound = sink.all().size() == before;
    if (engine.suitability().arePoints()) { // weights at places, with nothing between them
        checkTerms(engine.base().suitability, probes(engine.base().suitability), sink);
        return sound;
    }
    checkVariable(engine.base().suitability, sink);
    if (!engine.suitability().isNeighbourForm())
        sink.warning("L06", engine.base().suitability.at,
                     "the terms of suitability overlap beyond neighbours; the centroid takes its slow general form");
    return sound;
}

} // namespace gnomon::rules
