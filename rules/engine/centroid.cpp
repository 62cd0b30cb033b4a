#include "rules/engine/centroid.hpp"

#include <algorithm>
#include <array>

namespace gnomon::rules {
namespace {

/// One term on a piece of the universe where it is straight.
struct Segment {
    double value = 0.0; ///< At the left end of the piece.
    double slope = 0.0;
};

/// The straight continuation of `shape`, cut at `strength`, as it is around `middle`, seen from `left`.
Segment segmentOf(const Trapezoid& shape, double strength, double left, double middle) noexcept
{
    const double membership = shape.membership(middle);
    if (membership == 0.0) return {};
    if (membership >= strength) return {strength, 0.0};
    const double slope = middle < shape.b ? 1.0 / (shape.b - shape.a) : -1.0 / (shape.d - shape.c);
    return {membership - slope * (middle - left), slope};
}

/// Area and first moment of a straight line over [from, to], added to a running total.
struct Integral {
    double area = 0.0;
    double moment = 0.0;

    void add(double from, double to, double valueFrom, double valueTo) noexcept
    {
        const double width = to - from;
        area += 0.5 * width * (valueFrom + valueTo);
        moment += width * (from * (2.0 * valueFrom + valueTo) + to * (valueFrom + 2.0 * valueTo)) / 6.0;
    }
};

/// Integrates the upper envelope of straight lines over [left, right]: follow the highest line to the nearest crossing
/// with a steeper one, and change over. Lines only ever get steeper, so this ends after at most one turn per line.
void addEnvelope(std::span<const Segment> lines, double left, double right, Integral& total) noexcept
{
    const auto at = [left](const Segment& line, double x) { return line.value + line.slope * (x - left); };
    double x = left;
    Segment current = lines[0];
    for (const Segment& line : lines) {
        if (line.value > current.value || (line.value == current.value && line.slope > current.slope)) current = line;
    }
    while (x < right) {
        double crossing = right;
        Segment next = current;
        for (const Segment& line : lines) {
            if (!(line.slope > current.slope)) continue;
            const double where = left + (current.value - line.value) / (line.slope - current.slope);
            const bool steeperAtOnce = where == crossing && line.slope > next.slope;
            if (where < crossing || steeperAtOnce) {
                crossing = std::max(where, x);
                next = line;
            }
        }
        total.add(x, crossing, at(current, x), at(current, crossing));
        x = crossing;
        if (next.slope == current.slope) break; // nothing steeper crosses before the right end
        current = next;
    }
}

} // namespace

Trapezoid withinUniverse(const Trapezoid& shape, double low, double high) noexcept
{
    Trapezoid within = shape; // what lies beyond the edges carries no weight
    if (within.b <= low && within.c >= low) within.a = within.b = low;
    if (within.c >= high && within.b <= high) within.c = within.d = high;
    return within;
}

CentroidTerms::Cut CentroidTerms::cutOf(double a, double p, double q, double d, double height) noexcept
{
    Cut cut;
    cut.area1 = d - a;
    cut.area2 = -0.5 * (p + q);
    cut.moment1 = 0.5 * (d - a) * (d + a);
    cut.moment2 = -0.5 * (d * q + a * p);
    cut.moment3 = (q - p) * (q + p) / 6.0;
    cut.height = height;
    return cut;
}

CentroidTerms::CentroidTerms(const Variable& variable) : low_(variable.low), high_(variable.high)
{
    for (const Term& term : variable.terms)
        shapes_.push_back(withinUniverse(term.shape, low_, high_));
    points_ = std::all_of(shapes_.begin(), shapes_.end(), [](const Trapezoid& shape) { return shape.a == shape.d; });
    neighbourForm_ = points_ || fitsNeighbourForm();
    if (!neighbourForm_) return;
    if (points_) {
        for (const Trapezoid& shape : shapes_)
            cuts_.push_back({.area1 = 1.0, .moment1 = shape.a});
        overlaps_.assign(shapes_.size() - 1, Cut{.height = 0.0});
        return;
    }
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
        const Trapezoid& here = shapes_[i];
        cuts_.push_back(cutOf(here.a, here.b - here.a, here.d - here.c, here.d, 1.0));
        if (i + 1 == shapes_.size()) break;
        const Trapezoid& next = shapes_[i + 1];
        const double p = next.b - next.a;
        const double q = here.d - here.c;
        const double apex = here.d > next.a ? (here.d - next.a) / (p + q) : 0.0;
        overlaps_.push_back(cutOf(next.a, p, q, here.d, apex));
    }
}

bool CentroidTerms::fitsNeighbourForm() const noexcept
{
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
        const Trapezoid& here = shapes_[i];
        if (here.a < low_ || here.d > high_) return false; // a flank is cut off by the edge of the universe
        if (i + 1 < shapes_.size() && !(here.c <= shapes_[i + 1].a && here.d <= shapes_[i + 1].b)) return false;
        if (i + 2 < shapes_.size() && here.d > shapes_[i + 2].a) return false;
    }
    return true;
}

Centroid CentroidTerms::finished(double area, double moment) const noexcept
{
    if (!(area > 0.0)) return {};
    return {std::clamp(moment / area, low_, high_), true};
}

Centroid CentroidTerms::exact(std::span<const double> strengths) const noexcept
{
    if (!neighbourForm_) return exactGeneral(strengths);
    double area = 0.0;
    double moment = 0.0;
    for (std::size_t i = 0; i < cuts_.size(); ++i) {
        const Cut& cut = cuts_[i];
        const double s = strengths[i];
        area += s * (cut.area1 + s * cut.area2);
        moment += s * (cut.moment1 + s * (cut.moment2 + s * cut.moment3));
    }
    for (std::size_t i = 0; i < overlaps_.size(); ++i) {
        const Cut& cut = overlaps_[i];
        const double s = std::min(std::min(strengths[i], strengths[i + 1]), cut.height);
        area -= s * (cut.area1 + s * cut.area2);
        moment -= s * (cut.moment1 + s * (cut.moment2 + s * cut.moment3));
    }
    return finished(area, moment);
}

Centroid CentroidTerms::exactGeneral(std::span<const double> strengths) const noexcept
{
    if (points_) return exact(strengths); // they have no envelope
    std::array<double, 6 * kMaxTerms + 2> breaks;
    std::size_t breakCount = 0;
    const auto breakAt = [&](double x) { breaks[breakCount++] = std::clamp(x, low_, high_); };
    breakAt(low_);
    breakAt(high_);
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
        const Trapezoid& shape = shapes_[i];
        for (const double corner : {shape.a, shape.b, shape.c, shape.d})
            breakAt(corner);
        // Where the cut begins and ends. An infinite corner has no flank: inf - inf must not be formed.
        breakAt(shape.a == shape.b ? shape.a : shape.a + strengths[i] * (shape.b - shape.a));
        breakAt(shape.c == shape.d ? shape.d : shape.d - strengths[i] * (shape.d - shape.c));
    }
    std::sort(breaks.begin(), breaks.begin() + breakCount);

    Integral total;
    std::array<Segment, kMaxTerms> lines;
    for (std::size_t piece = 0; piece + 1 < breakCount; ++piece) {
        const double left = breaks[piece];
        const double right = breaks[piece + 1];
        if (!(left < right)) continue;
        for (std::size_t i = 0; i < shapes_.size(); ++i)
            lines[i] = segmentOf(shapes_[i], strengths[i], left, 0.5 * (left + right));
        addEnvelope(std::span(lines).first(shapes_.size()), left, right, total);
    }
    return finished(total.area, total.moment);
}

Centroid CentroidTerms::sampled(std::span<const double> strengths, uint32_t samples) const noexcept
{
    if (points_) return exact(strengths); // no sample would meet them
    const double step = (high_ - low_) / samples;
    double area = 0.0;
    double moment = 0.0;
    for (uint32_t i = 0; i < samples; ++i) {
        const double x = low_ + (i + 0.5) * step;
        const double y = membership(x, strengths);
        area += y;
        moment += x * y;
    }
    return finished(area, moment);
}

double CentroidTerms::membership(double x, std::span<const double> strengths) const noexcept
{
    double highest = 0.0;
    for (std::size_t i = 0; i < shapes_.size(); ++i)
        highest = std::max(highest, std::min(strengths[i], shapes_[i].membership(x)));
    return highest;
}

} // namespace gnomon::rules
