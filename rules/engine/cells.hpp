#pragma once

#include <span>
#include <vector>

#include "rules/engine/rule_base.hpp"

namespace gnomon::rules {

/// Part of an axis on which no term changes between false, partly true and true, nor from one side of a level to the
/// other.
struct Cell {
    double low, high;
    bool lowOpen, highOpen; ///< Whether the end itself lies outside.
    double inside;          ///< A point that stands for the cell.
};

/// The axis of a variable in ascending cells.
/// @param levels Memberships in (0, 1) that are told apart as well: what a rule needs to be heard.
std::vector<Cell> cellsOf(const Variable& variable, std::span<const double> levels = {});

} // namespace gnomon::rules
