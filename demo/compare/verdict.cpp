#include "demo/compare/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "demo/io/number.hpp"

namespace gnomon::demo {
namespace {

/// Two numbers that differ by less are one number: a run over its own repetition scatters by as much.
constexpr double kSame = 0.02;

template <typename Of>
std::vector<double> ofRuns(const Row& row, size_t count, Of&& of)
{
    std::vector<double> out;
    for (size_t i = 0; i < count; ++i)
        out.push_back(of(row.runs[i]));
    return out;
}

template <typename Prepare>
Against against(const Row& adaptive, const Row& fixed, Prepare&& prepare)
{
    const size_t count = std::min(adaptive.runs.size(), fixed.runs.size());
    const auto total = [&](const RunRecord& run) { return totalMs(prepare(run)); };
    const auto worst = [&](const RunRecord& run) { return worstMs(prepare(run)); };
    return {quotientOf(ofRuns(adaptive, count, total), ofRuns(fixed, count, total)),
            quotientOf(ofRuns(adaptive, count, worst), ofRuns(fixed, count, worst))};
}

/// Mean over all frames of all runs.
template <typename Values>
double meanOf(const Row& row, Values&& values)
{
    double sum = 0.0;
    size_t count = 0;
    for (const RunRecord& run : row.runs) {
        sum = std::accumulate(values(run).begin(), values(run).end(), sum);
        count += values(run).size();
    }
    return sum / double(count);
}

std::string fixedText(double value, int decimals)
{
    std::string text;
    appendFixed(text, value, decimals);
    return text;
}

} // namespace

double wrongPercentOf(double quality)
{
    return quality > 0.0 ? 1.0 / quality - 1.0 : std::numeric_limits<double>::infinity();
}

Quotient spreadOf(std::span<const double> values)
{
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    return {medianOf(values), *least, *most, values.size()};
}

Quotient quotientOf(std::span<const double> above, std::span<const double> below)
{
    std::vector<double> quotients;
    for (size_t i = 0; i < above.size(); ++i)
        quotients.push_back(above[i] / below[i]);
    return spreadOf(quotients);
}

Verdict judge(const Quotient& quotient, double bound)
{
    if (quotient.median <= bound)
        return quotient.count > 1 && quotient.most <= bound ? Verdict::Kept : Verdict::KeptInNoise;
    return quotient.count > 1 && quotient.least > bound ? Verdict::Missed : Verdict::MissedInNoise;
}

bool isKept(Verdict verdict)
{
    return verdict == Verdict::Kept || verdict == Verdict::KeptInNoise;
}

std::string verdictText(const Quotient& quotient, double bound)
{
    const Verdict verdict = judge(quotient, bound);
    const std::string text = isKept(verdict) ? "kept" : "missed";
    if (verdict == Verdict::Kept || verdict == Verdict::Missed) return text;
    return text + (quotient.count == 1 ? " in one run, whose noise is not known" : ", within the noise of the runs");
}

Against against(const Row& adaptive, const Row& fixed)
{
    return against(adaptive, fixed, [](const RunRecord& run) -> const RunRecord& { return run; });
}

Against againstNormalised(const Row& adaptive, const Row& fixed, double sentinelMs)
{
    return against(adaptive, fixed, [=](const RunRecord& run) { return normalised(run, sentinelMs); });
}

const Row* bestFixed(std::span<const Row* const> fixed, double sentinelMs)
{
    const Row* best = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const Row* row : fixed) {
        const double median = medianOf(ofRuns(*row, row->runs.size(), [&](const RunRecord& run) {
            return totalMs(sentinelMs > 0.0 ? normalised(run, sentinelMs) : run);
        }));
        if (median < least) best = row;
        least = std::min(least, median);
    }
    return best;
}

std::string disagreement(const Row& adaptive, const Row& fixed, const Quotient& raw, const Quotient& normal,
                         double bound)
{
    const bool sameSide = isKept(judge(raw, bound)) == isKept(judge(normal, bound));
    const bool meet = raw.least <= normal.most * (1.0 + kSame) && normal.least <= raw.most * (1.0 + kSame);
    if (sameSide && meet) return "";
    const auto sentinel = [](const RunRecord& run) -> const std::vector<double>& { return run.sentinelMs; };
    const auto others = [](const RunRecord& run) -> const std::vector<double>& { return run.othersMs; };
    const double speed = meanOf(adaptive, sentinel) / meanOf(fixed, sentinel);
    std::string text = "raw and normalised disagree: ";
    if (std::abs(speed - 1.0) <= kSame)
        text += "the machine was as fast in the runs of both, to 2 %, so slow frames that no sentinel saw decide";
    else
        text += "the machine was " + fixedText(100.0 * std::abs(speed - 1.0), 1) + " % " +
                (speed > 1.0 ? "slower" : "faster") + " (by the sentinel) in the runs of " + adaptive.name +
                " than in those of " + fixed.name;
    return text + "; others took " + fixedText(meanOf(adaptive, others), 1) + " and " +
           fixedText(meanOf(fixed, others), 1) + " ms of processor time a frame meanwhile";
}

} // namespace gnomon::demo
