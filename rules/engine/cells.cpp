#include "rules/engine/cells.hpp"

#include <algorithm>
#include <cmath>

namespace gnomon::rules {
namespace {

std::vector<Cell> elementaryCells(const Variable& variable)
{
    constexpr double kMostNumbers = 4096;
    std::vector<Cell> cells;
    if (variable.isCount() && variable.high - variable.low <= kMostNumbers) {
        for (double x = std::ceil(variable.low); x <= variable.high; x += 1.0)
            cells.push_back({x, x, false, false, x});
        return cells;
    }
    std::vector<double> xs = {variable.low, variable.high};
    for (const Term& term : variable.terms)
        xs.insert(xs.end(), {term.shape.a, term.shape.b, term.shape.c, term.shape.d});
    std::erase_if(xs, [&](double x) { return !(x >= variable.low && x <= variable.high); });
    std::sort(xs.begin(), xs.end());
    xs.erase(std::unique(xs.begin(), xs.end()), xs.end());
    for (std::size_t i = 0; i < xs.size(); ++i) {
        cells.push_back({xs[i], xs[i], false, false, xs[i]});
        if (i + 1 < xs.size()) cells.push_back({xs[i], xs[i + 1], true, true, 0.5 * (xs[i] + xs[i + 1])});
    }
    return cells;
}

bool sameKind(double x, double y)
{
    return (x == 0.0) == (y == 0.0) && (x == 1.0) == (y == 1.0);
}

} // namespace

std::vector<Cell> cellsOf(const Variable& variable)
{
    std::vector<Cell> cells;
    for (const Cell& cell : elementaryCells(variable)) {
        const bool continues =
            !cells.empty() && std::all_of(variable.terms.begin(), variable.terms.end(), [&](auto& t) {
                return sameKind(t.shape.membership(cells.back().inside), t.shape.membership(cell.inside));
            });
        if (continues) {
            cells.back().high = cell.high;
            cells.back().highOpen = cell.highOpen;
        } else {
            cells.push_back(cell);
        }
    }
    return cells;
}

} // namespace gnomon::rules
