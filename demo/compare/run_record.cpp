#include "demo/compare/run_record.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace gnomon::demo {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
/// Frames whose sentinel took longer than this share of its median were disturbed by something else.
constexpr double kUndisturbed = 1.15;
/// One slow sentinel among so many moves nothing; a machine whose speed changes is followed within a few frames.
constexpr size_t kSmoothed = 9;

/// Calls `count(frame)` for all undisturbed frames from `first` on.
template <typename Count>
void forUndisturbed(const RunRecord& run, size_t first, Count&& count)
{
    const double limit = kUndisturbed * medianOf(run.sentinelMs);
    for (size_t i = first; i < run.frameMs.size(); ++i)
        if (run.sentinelMs[i] <= limit) count(i);
}

void note(BudgetCount& frames, double shadowMs, double budgetMs)
{
    ++frames.counted;
    frames.over += shadowMs > budgetMs;
    frames.worst = std::max(frames.worst, shadowMs / budgetMs);
}

} // namespace

double medianOf(std::span<const double> values)
{
    std::vector<double> known;
    std::copy_if(values.begin(), values.end(), std::back_inserter(known), [](double v) { return !std::isnan(v); });
    if (known.empty()) return kNaN;
    const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
    std::nth_element(known.begin(), middle, known.end());
    if (known.size() % 2 == 1) return *middle;
    return 0.5 * (*middle + *std::max_element(known.begin(), middle));
}

std::vector<double> runningMedian(std::span<const double> values, size_t window)
{
    std::vector<double> out;
    const size_t half = window / 2;
    for (size_t i = 0; i < values.size(); ++i) {
        const size_t from = i < half ? 0 : i - half;
        out.push_back(medianOf(values.subspan(from, std::min(values.size(), i + half + 1) - from)));
    }
    return out;
}

double totalMs(const RunRecord& run)
{
    return std::accumulate(run.frameMs.begin(), run.frameMs.end(), 0.0);
}

double worstMs(const RunRecord& run)
{
    return *std::max_element(run.frameMs.begin(), run.frameMs.end());
}

double totalShadowMs(const RunRecord& run)
{
    double sum = 0.0;
    size_t known = 0;
    for (const double ms : run.shadowMs) {
        if (std::isnan(ms)) continue;
        sum += ms;
        ++known;
    }
    return known > 0 ? sum / double(known) * double(run.shadowMs.size()) : kNaN;
}

RunRecord normalised(const RunRecord& run, double sentinelMs)
{
    RunRecord out = run;
    const std::vector<double> around = runningMedian(run.sentinelMs, kSmoothed);
    for (size_t i = 0; i < around.size(); ++i) {
        out.frameMs[i] *= sentinelMs / around[i];
        out.shadowMs[i] *= sentinelMs / around[i];
    }
    return out;
}

double medianSentinel(std::span<const Row> rows)
{
    std::vector<double> all;
    for (const Row& row : rows)
        for (const RunRecord& run : row.runs)
            all.insert(all.end(), run.sentinelMs.begin(), run.sentinelMs.end());
    return medianOf(all);
}

std::vector<double> cheapestShadows(std::span<const Row* const> rows)
{
    std::vector<double> least;
    for (const Row* row : rows) {
        if (row->runs.empty()) continue;
        std::vector<double> ofRow;
        for (size_t frame = 0; frame < row->runs.front().shadowMs.size(); ++frame) {
            std::vector<double> ofRuns;
            for (const RunRecord& run : row->runs)
                ofRuns.push_back(run.shadowMs[frame]);
            ofRow.push_back(medianOf(ofRuns));
        }
        ofRow = runningMedian(ofRow, kSmoothed);
        least.resize(ofRow.size(), kNaN);
        std::transform(ofRow.begin(), ofRow.end(), least.begin(), least.begin(),
                       [](double a, double b) { return std::fmin(a, b); });
    }
    return least;
}

std::vector<double> budgetsOver(std::span<const Row* const> rows, double factor)
{
    std::vector<double> budgets = cheapestShadows(rows);
    for (double& ms : budgets)
        ms *= factor;
    return budgets;
}

BudgetCount countOver(const RunRecord& run, std::span<const double> budgetMs, size_t first)
{
    BudgetCount out;
    forUndisturbed(run, first, [&](size_t i) {
        if (i < budgetMs.size() && !std::isnan(budgetMs[i]) && !std::isnan(run.shadowMs[i]))
            note(out, run.shadowMs[i], budgetMs[i]);
    });
    return out;
}

OwnBudget countOwnBudget(const Row& row, size_t first)
{
    OwnBudget out;
    out.leastMs = std::numeric_limits<double>::infinity();
    for (const RunRecord& run : row.runs) {
        forUndisturbed(run, first, [&](size_t i) {
            const double shadowMs = run.shadowMs[i], budgetMs = run.budgetMs[i];
            if (!(budgetMs > 0.0) || std::isnan(shadowMs)) return;
            out.leastMs = std::min(out.leastMs, budgetMs);
            out.mostMs = std::max(out.mostMs, budgetMs);
            if (run.predictedMs[i] > budgetMs) {
                ++out.infeasible;
                return;
            }
            note(out.frames, shadowMs, budgetMs);
            out.heldUp += shadowMs > budgetMs && shadowMs - run.othersMs[i] <= budgetMs;
        });
    }
    return out;
}

} // namespace gnomon::demo
