#pragma once
// The middle of measurements that do not tell equally much.
#include <algorithm>
#include <cstddef>
#include <span>

namespace gnomon::cost {

struct Weighted {
    double value = 0.0;
    double weight = 0.0; ///< >= 0.
};

/// The value that half of the weight lies on either side of; the mean of two where the half falls between them. 0 where
/// nothing has a weight. Sorts its argument; the same values give the same bits in any order.
inline double weightedMedian(std::span<Weighted> values) noexcept
{
    std::sort(values.begin(), values.end(), [](const Weighted& a, const Weighted& b) {
        return a.value != b.value ? a.value < b.value : a.weight < b.weight;
    });
    double whole = 0.0, below = 0.0;
    for (const Weighted& one : values)
        whole += one.weight;
    for (std::size_t i = 0; i < values.size() && whole > 0.0; ++i) {
        below += values[i].weight;
        if (2.0 * below == whole && i + 1 < values.size()) return 0.5 * (values[i].value + values[i + 1].value);
        if (2.0 * below >= whole) return values[i].value;
    }
    return 0.0;
}

} // namespace gnomon::cost
