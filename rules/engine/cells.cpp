#include "rules/engine/cells.hpp"

#include <algorithm>
#include <cmath>

namespace gnomon::rules {
namespace {

/// Where the flanks of a term pass a level.
void addCrossings(const Trapezoid& shape, double level, std::vector<double>& xs)
{
    if (std::isfinite(shape.a) && shape.b > shape.a) xs.push_back(shape.a + level * (shape.b - shape.a));
    if (std::isfinite(shape.d) && shape.d > shape.c) xs.push_back(shape.d - level * (shape.d - shape.c));
}

std::vector<Cell> elementaryCells(const Variable& variable, std::span<const double> levels)
{
    constexpr double kMostNumbers = 4096;
    std::vector<Cell> cells;
    if (variable.isCount() && variable.high - variable.low <= kMostNumbers) {
        for (double x = std::ceil(variable.low); x <= variable.high; x += 1.0)
            cells.push_back({x, x, false, false, x});
        return cells;
    }
    std::vector<double> xs = {variable.low, variable.high};
    for (const Term& term : variable.terms) {
        xs.insert(xs.end(), {term.shape.a, term.shape.b, term.shape.c, term.shape.d});
        for (const double level : levels)
            addCrossings(term.shape, level, xs);
    }
    std::erase_if(xs, [&](double x) { return !(x >= variable.low && x <= variable.high); });
    std::sort(xs.begin(), xs.end());
    xs.erase(std::unique(xs.begin(), xs.end()), xs.end());
    for (std::size_t i = 0; i < xs.size(); ++i) {
        cells.push_back({xs[i], xs[i], false, false, xs[i]});
        if (i + 1 < xs.size()) cells.push_back({xs[i], xs[i + 1], true, true, 0.5 * (xs[i] + xs[i + 1])});
    }
    return cells;
}

bool sameKind(double x, double y, std::span<const double> levels)
{
    return (x == 0.0) == (y == 0.0) && (x == 1.0) == (y == 1.0) &&
           std::all_of(levels.begin(), levels.end(), [=](double level) { return (x >= level) == (y >= level); });
}

} // namespace

std::vector<Cell> cellsOf(const Variable& variable, std::span<const double> levels)
{
    std::vector<Cell> cells;
    for (const Cell& cell : elementaryCells(variable, levels)) {
        const bool continues =
            !cells.empty() && std::all_of(variable.terms.begin(), variable.terms.end(), [&](auto& t) {
                return sameKind(t.shape.membership(cells.back().inside), t.shape.membership(cell.inside), levels);
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
