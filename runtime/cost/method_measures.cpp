#include "runtime/cost/method_measures.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace gnomon::cost {

namespace {

constexpr double kReferenceSide = 1024.0;
constexpr double kPriorRows = 4.0; // measurements that the author's figure is worth

/// Side of one face of the maps a row was measured with; 0: none.
double sideOf(const Workload& workload)
{
    return std::sqrt(workload.mapTexels / (workload.point ? 6.0 : 1.0));
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
    std::vector<double> firstFrames;
    for (const KnowledgeRow& row : base.rows) {
        if (row.algorithm != algorithm || row.pass != Pass::resolve) continue; // its update row says the same again
        if (row.device == device) firstFrames.push_back(row.firstFrameMs);
        if (row.wrongPercent < 0.0) continue;
        const double side = sideOf(row.workload);
        sum += row.wrongPercent * (side > 0.0 ? side / kReferenceSide : 1.0);
        ++measures.wrongRows;
    }
    measures.wrongPercent = sum / (kPriorRows + measures.wrongRows);
    if (!firstFrames.empty()) {
        const auto middle = firstFrames.begin() + static_cast<std::ptrdiff_t>(firstFrames.size() / 2);
        std::nth_element(firstFrames.begin(), middle, firstFrames.end());
        measures.firstFrameMs = *middle;
    }
    return measures;
}

} // namespace gnomon::cost
