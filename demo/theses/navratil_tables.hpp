#pragma once
// Tables 3.1 and 3.2 of Navratil's thesis and its test of one hemisphere, our numbers beside the printed ones.

#include "demo/theses/navratil_survey.hpp"
#include "demo/theses/pair_table.hpp"

namespace gnomon::demo {

std::vector<PairTable> navratilTables(const Survey& ours, const HemisphereTimes& hemisphere);

} // namespace gnomon::demo
