#include "demo/compare/standing.hpp"

#include <algorithm>

#include "runtime/select/auto_budget.hpp"

namespace gnomon::demo {

Standing standingOf(const std::vector<Row>& rows, bool warm, const EqualQuality& quality,
                    std::span<const double> hostBudgetMs, size_t firstCounted)
{
    Standing standing{.warm = warm,
                      .bounds = warm ? kWarmBounds : kColdBounds,
                      .firstCounted = warm ? 0 : firstCounted,
                      .sentinelMs = medianSentinel(rows)};
    size_t most = 0;
    for (const Row& row : rows) {
        if (row.warm != warm || row.runs.empty()) continue;
        (row.adaptive ? standing.adaptive : standing.fixed).push_back(&row);
        most = std::max(most, row.runs.size());
    }
    const auto median = [](const Row& row) {
        std::vector<double> totals;
        for (const RunRecord& run : row.runs)
            totals.push_back(totalMs(run));
        return medianOf(totals);
    };
    std::stable_sort(standing.fixed.begin(), standing.fixed.end(),
                     [&](const Row* a, const Row* b) { return median(*a) < median(*b); });
    std::copy_if(standing.fixed.begin(), standing.fixed.end(), std::back_inserter(standing.equal),
                 [&](const Row* row) { return row->runs.size() == most && quality.holds(row->errors); });
    if (!hostBudgetMs.empty())
        standing.budgetMs.assign(hostBudgetMs.begin(), hostBudgetMs.end());
    else
        standing.budgetMs = budgetsOver(standing.equal, AutoBudget::kFactor);
    return standing;
}

OverBudget overBudget(const Row& row, const Standing& standing)
{
    OverBudget out;
    for (const RunRecord& run : row.runs) {
        const BudgetCount count = countOver(run, standing.budgetMs, standing.firstCounted);
        out.frames.counted += count.counted;
        out.frames.over += count.over;
        out.frames.worst = std::max(out.frames.worst, count.worst);
        if (count.counted > 0) out.percents.push_back(count.percent());
    }
    return out;
}

} // namespace gnomon::demo
