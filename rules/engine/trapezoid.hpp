#pragma once

namespace gnomon::rules {

/// Membership function of one linguistic term: 0 outside [a, d], 1 on [b, c], straight flanks between.
/// a <= b <= c <= d, in the unit of the variable. a = b = -inf is a left shoulder, c = d = +inf a right one; b = c is a
/// triangle, a = b a vertical edge (the edge itself belongs to the term). NaN belongs to no term.
/// Comparisons are exact: a point one ulp outside a foot has membership 0.
struct Trapezoid {
    double a = 0.0;
    double b = 0.0;
    double c = 0.0;
    double d = 0.0;

    constexpr double membership(double x) const noexcept
    {
        if (!(x >= a && x <= d)) return 0.0; // outside, or NaN
        if (x < b) return (x - a) / (b - a);
        if (x > c) return (d - x) / (d - c);
        return 1.0;
    }

    friend constexpr bool operator==(const Trapezoid&, const Trapezoid&) = default;
};

} // namespace gnomon::rules
