#pragma once
// What one run over the path of a scene took, frame by frame, and numbers about it. No device needed.
#include <cstdint>
#include <span>
#include <vector>

#include "demo/compare/near_far.hpp"

namespace gnomon::demo {

struct RunRecord {
    std::vector<double> frameMs;    ///< Wall time.
    std::vector<double> sentinelMs; ///< Of the small frame that was drawn before each.
    std::vector<double> othersMs;   ///< Processor time that others took meanwhile (OtherWork).
    std::vector<double> shadowMs;   ///< GPU and host passes; NaN: not known.
    /// The runtime's own: the budget it kept to, 0 for none, and what it predicted.
    std::vector<double> budgetMs, predictedMs;
    uint64_t switches = 0;
};

/// All runs of one contestant, over a path that is new to it or (`warm`) that it has just gone.
struct Row {
    std::string name;
    bool adaptive = false;
    bool warm = false;
    std::vector<RunRecord> runs; ///< One per alternation. Less: those beyond the first could not change a verdict.
    NearFar errors;
    /// Of a fixed choice that was cut: what its shadows took in the frames that it was tried in, over the best so far.
    double overBest = 0.0;
};

/// NaN counts for nothing; NaN where there is no number.
double medianOf(std::span<const double> values);

/// Of each value and the ones around it, `window` in all and fewer at the ends.
std::vector<double> runningMedian(std::span<const double> values, size_t window);

double totalMs(const RunRecord& run);
double worstMs(const RunRecord& run);
/// Of the frames whose shadow time is known, times the number of all.
double totalShadowMs(const RunRecord& run);

/// Frame times as if the machine had been equally fast all the time: over the median of the nine sentinels around each
/// frame, times `sentinelMs`.
RunRecord normalised(const RunRecord& run, double sentinelMs);

/// The median sentinel of all frames of all runs.
double medianSentinel(std::span<const Row> rows);

/// Of each frame: the least of the rows' shadow times, of which each is the median of its runs, smoothed over nine
/// frames. NaN where no row knows one.
std::vector<double> cheapestShadows(std::span<const Row* const> rows);
/// Those times a factor.
std::vector<double> budgetsOver(std::span<const Row* const> rows, double factor);

struct BudgetCount {
    uint32_t counted = 0, over = 0;
    double worst = 0.0; ///< Shadow time over budget.

    double percent() const { return counted > 0 ? 100.0 * over / counted : 0.0; }
};

/// Frames from `first` on whose time is known and that nothing disturbed: the sentinel took at most 1.15 times its
/// median. \param budgetMs of each frame; NaN: there is none.
BudgetCount countOver(const RunRecord& run, std::span<const double> budgetMs, size_t first);

/// The runtime's own budget, which the run is held to by itself.
struct OwnBudget {
    BudgetCount frames;      ///< Of those in which a plan was predicted to fit.
    uint32_t heldUp = 0;     ///< Of the ones over it, those that would not be, had others not taken processor time.
    uint32_t infeasible = 0; ///< No plan that keeps the floor was predicted to fit.
    double leastMs = 0.0, mostMs = 0.0;
};
OwnBudget countOwnBudget(const Row& row, size_t first);

} // namespace gnomon::demo
