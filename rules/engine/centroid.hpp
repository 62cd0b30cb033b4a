#pragma once

/// The last step of Mamdani inference: terms of one output, each cut at its strength, joined by maximum, and the centre
/// of gravity of what remains.

#include <cstdint>
#include <span>
#include <vector>

#include "rules/engine/rule_base.hpp"

namespace gnomon::rules {

/// A centre of gravity, or the state "no term had any strength".
struct Centroid {
    double value = 0.0; ///< In the universe of the variable. Meaningless without an opinion.
    bool hasOpinion = false;
};

/// A term as far as it lies in the universe: a core that reaches past an edge ends there.
Trapezoid withinUniverse(const Trapezoid& shape, double low, double high) noexcept;

/// The terms of an output variable, with everything that does not depend on strengths computed once.
///
/// **Neighbour form.** At height y a trapezoid reaches from a + p y to d - q y, where p = b - a and q = d - c. Cut at
/// height s it has
///     area(s)   = int_0^s (d - q y) - (a + p y) dy           = (d - a) s - (p + q) s^2 / 2
///     moment(s) = int_0^s [(d - q y)^2 - (a + p y)^2] / 2 dy = [(d^2 - a^2) s - (d q + a p) s^2 + (q^2 - p^2) s^3 / 3]
///     / 2
/// The integral of a maximum is the sum of the integrals minus that of the minima, as long as no point lies in three
/// terms. Where the falling flank of one term crosses the rising flank of the next, the minimum is a shape of the same
/// kind with feet a', d and its apex at the crossing, height (d - a') / (p' + q), cut at the lower strength. So a
/// centroid is one polynomial pair per term and per overlap, without a branch per sample.
/// It needs terms in ascending order of which only neighbours overlap, and flat shoulders at the edges of the universe.
///
/// **Points.** Terms without width (a = b = c = d) have a weight at their place and no area: where all are such, the
/// result is their weighted mean, sum(s x) / sum(s), whether exact or `sampled`. That is the neighbour form with
/// area(s) = s, moment(s) = s x and nothing to subtract. A weight and an area have no common measure: validate()
/// refuses a mixture.
///
/// **General form.** Any other set of terms is integrated exactly too, piece by piece along the upper envelope of its
/// straight segments; slower, no less exact. L06 says when a base has slipped into it.
class CentroidTerms {
public:
    /// `variable` must have passed validate().
    explicit CentroidTerms(const Variable& variable);

    std::size_t termCount() const noexcept { return shapes_.size(); }
    bool isNeighbourForm() const noexcept { return neighbourForm_; }
    bool arePoints() const noexcept { return points_; }

    /// Exact centre of gravity. `strengths` holds one value in [0, 1] per term.
    Centroid exact(std::span<const double> strengths) const noexcept;

    /// Exact, always by the general form. The second opinion in tests.
    Centroid exactGeneral(std::span<const double> strengths) const noexcept;

    /// Midpoint sum over `samples` equal steps, the way sampling engines do it. For comparison, and for rule bases that
    /// ask for it.
    Centroid sampled(std::span<const double> strengths, uint32_t samples) const noexcept;

    /// The aggregated set itself at x: the maximum over the cut terms.
    double membership(double x, std::span<const double> strengths) const noexcept;

private:
    /// Coefficients of area(s) and moment(s) above.
    struct Cut {
        double area1 = 0.0, area2 = 0.0;
        double moment1 = 0.0, moment2 = 0.0, moment3 = 0.0;
        double height = 1.0; ///< Where the apex is: cuts above it change nothing.
    };

    static Cut cutOf(double a, double p, double q, double d, double height) noexcept;
    Centroid finished(double area, double moment) const noexcept;
    bool fitsNeighbourForm() const noexcept;

    double low_ = 0.0;
    double high_ = 1.0;
    bool neighbourForm_ = false;
    bool points_ = false;           ///< No term has a width.
    std::vector<Trapezoid> shapes_; ///< Shoulders end at the universe's edges.
    std::vector<Cut> cuts_;         ///< One per term.
    std::vector<Cut> overlaps_;     ///< One per pair of neighbours; height 0 where they do not overlap.
};

} // namespace gnomon::rules
