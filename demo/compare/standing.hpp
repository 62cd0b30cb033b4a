#pragma once
// The rows of one pass, cold or warm, with what is found out by looking at all of them together. No device needed.
#include <vector>

#include "demo/compare/verdict.hpp"

namespace gnomon::demo {

struct Standing {
    bool warm = false;
    Bounds bounds = kColdBounds;
    std::vector<const Row*> adaptive;
    std::vector<const Row*> fixed; ///< Those that ran, the fastest first.
    std::vector<const Row*> equal; ///< Of these, the ones of equal quality that ran in all alternations.
    std::vector<double> budgetMs;  ///< Of each frame; empty: none can be said.
    size_t firstCounted = 0;       ///< Frame from which on the budget counts.
    double sentinelMs = 0.0;       ///< Median of all rows.
};

/// \param hostBudgetMs of each frame; empty: 1.3 times the cheapest fixed choice of equal quality in it
/// \param firstCounted of a cold pass; a warm one counts from its beginning
Standing standingOf(const std::vector<Row>& rows, bool warm, const EqualQuality& quality,
                    std::span<const double> hostBudgetMs, size_t firstCounted);

/// Frames over the budget, over all runs, and of each run in per cent.
struct OverBudget {
    BudgetCount frames;
    std::vector<double> percents;
};
OverBudget overBudget(const Row& row, const Standing& standing);

} // namespace gnomon::demo
