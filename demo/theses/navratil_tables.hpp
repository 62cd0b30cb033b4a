#pragma once
// Tables of Navratil's thesis, our numbers beside the printed ones. Ratios have a column of what is asked of ours.

#include "demo/theses/navratil_survey.hpp"
#include "demo/theses/navratil_warps.hpp"
#include "demo/theses/pair_table.hpp"

namespace gnomon::demo {

/// Tables 3.1 and 3.2 and the test of one hemisphere.
std::vector<PairTable> navratilTables(const Survey& ours, const HemisphereTimes& hemisphere);
/// Tables 5.1 to 5.3.
std::vector<PairTable> navratilWarpTables(const WarpSurvey& ours);

} // namespace gnomon::demo
