#pragma once
// The tables of Macedo's thesis with our numbers beside the printed ones.

#include "demo/theses/macedo_survey.hpp"
#include "demo/theses/pair_table.hpp"

namespace gnomon::demo {

/// What the tables need, not measured.
macedo::Times macedoCells();
/// @param ours macedoCells(), measured
std::vector<PairTable> macedoTables(const macedo::Times& ours);

} // namespace gnomon::demo
