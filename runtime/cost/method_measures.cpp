#include "runtime/cost/method_measures.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace gnomon::cost {

namespace {

constexpr double kReferenceSide = 1024.0;
constexpr double kPriorRows = 4.0; // measurements that the author's figure is worth
// Measurements of so many whose largest counts as the next smaller one. Two bases of one day apart: with plain means
// penumbra_wedges errs by 0.117 and 0.208 % (one place by 7.4 %), stencil_volume by 0.047 and 0.074; so by 0.099 and
// 0.105, 0.041 and 0.050.
constexpr std::size_t kRowsAnOutlier = 20;

/// Side of one face of the maps a row was measured with; 0: none.
double sideOf(const Workload& workload)
{
    return std::sqrt(workload.mapTexels / (workload.point ? 6.0 : 1.0));
}

/// Their sum, with outliers drawn in (winsorised). Sorts its argument.
double sumWithoutOutliers(std::vector<double>& values)
{
    std::sort(values.begin(), values.end());
    const std::size_t last = values.size() - 1 - values.size() / kRowsAnOutlier;
    double sum = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i)
        sum += values[std::min(i, last)];
    return sum;
}

} // namespace

double MethodMeasures::quality(double side) const noexcept
{
    return 1.0 / (1.0 + wrongPercent * (side > 0.0 ? kReferenceSide / side : 1.0));
}

MethodMeasures measuresOf(const KnowledgeBase& base, std::string_view algorithm, double typicalWrongPercent,
                          std::string_view device)
{
    MethodMeasures measures;
    double sum = kPriorRows * typicalWrongPercent;
    std::vector<double> firstFrames, wrong;
    for (const KnowledgeRow& row : base.rows) {
        if (row.algorithm != algorithm || row.pass != Pass::resolve) continue; // its update row says the same again
        if (row.device == device) firstFrames.push_back(row.firstFrameMs);
        if (row.wrongPercent < 0.0) continue;
        const double side = sideOf(row.workload);
        wrong.push_back(row.wrongPercent * (side > 0.0 ? side / kReferenceSide : 1.0));
    }
    measures.wrongRows = static_cast<uint32_t>(wrong.size());
    if (!wrong.empty()) sum += sumWithoutOutliers(wrong);
    measures.wrongPercent = sum / (kPriorRows + measures.wrongRows);
    if (!firstFrames.empty()) {
        const auto middle = firstFrames.begin() + static_cast<std::ptrdiff_t>(firstFrames.size() / 2);
        std::nth_element(firstFrames.begin(), middle, firstFrames.end());
        measures.firstFrameMs = *middle;
    }
    return measures;
}

} // namespace gnomon::cost
