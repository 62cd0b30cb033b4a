#pragma once
// Who is held against whom, by which definition of equal quality, and what is said about it. No device needed.
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "demo/compare/run_record.hpp"

namespace gnomon::demo {

/// The one definition: a contestant is of equal quality if its wrong shares, counted over all lights and all frames
/// that were looked at, are at most these.
struct EqualQuality {
    double nearPercent = 0.0; ///< What the quality floor of the rules allows: wrongPercentOf(minimumQuality).
    double farPercent = 1.0;

    bool holds(const NearFar& errors) const
    {
        return errors.near.percent() <= nearPercent && errors.far.percent() <= farPercent;
    }
};

/// Quality is 1 / (1 + wrong share in percent).
double wrongPercentOf(double quality);

/// Bounds that an adaptive run should keep.
struct Bounds {
    double total;      ///< Time of all frames over that of the best fixed choice of equal quality.
    double worstFrame; ///< Over the worst one of that choice.
    double overBudget; ///< Per cent of the frames.
};
inline constexpr Bounds kColdBounds{1.10, 2.0, 5.0}, kWarmBounds{1.02, 1.3, 1.0};

/// Quotients of two contestants, one of each alternation: both ran within it. The true median lies between the least
/// and the most of n of them with a probability of 1 - 2^(1 - n).
struct Quotient {
    double median = 0.0, least = 0.0, most = 0.0;
    size_t count = 0;
};
/// \param above, below as many numbers each, at least one
Quotient quotientOf(std::span<const double> above, std::span<const double> below);
/// Of numbers that need no other: their median and spread.
Quotient spreadOf(std::span<const double> values);

enum class Verdict {
    Kept,
    Missed,
    KeptInNoise,   ///< The median is at most the bound, but some alternation was over it, or there was only one.
    MissedInNoise, ///< The other way round.
};
Verdict judge(const Quotient& quotient, double bound);
bool isKept(Verdict verdict);
/// In words. Of one run the noise is not known, and that is said.
std::string verdictText(const Quotient& quotient, double bound);

/// An adaptive run against a fixed choice: by wall time, and normalised.
struct Against {
    Quotient total, worstFrame;
};
Against against(const Row& adaptive, const Row& fixed);
/// With every run normalised to the sentinel.
Against againstNormalised(const Row& adaptive, const Row& fixed, double sentinelMs);

/// Of the fixed rows of equal quality that ran in all alternations, the one of the least median total. Null: none.
/// \param sentinelMs over 0: by normalised time
const Row* bestFixed(std::span<const Row* const> fixed, double sentinelMs = 0.0);

/// Why the raw and the normalised quotients do not say the same, in words. Empty where they do: both keep the bound or
/// both do not, and their ranges over the alternations are at most 2 % apart.
std::string disagreement(const Row& adaptive, const Row& fixed, const Quotient& raw, const Quotient& normal,
                         double bound);

} // namespace gnomon::demo
