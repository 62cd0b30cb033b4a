#pragma once

#include <vector>

#include "rules/engine/rule_base.hpp"

namespace gnomon::rules {

/// Part of an axis on which no term changes between false, partly true and true.
struct Cell {
    double low, high;
    bool lowOpen, highOpen; ///< Whether the end itself lies outside.
    double inside;          ///< A point that stands for the cell.
};

/// The axis of a variable in ascending cells.
std::vector<Cell> cellsOf(const Variable& variable);

} // namespace gnomon::rules
