#pragma once
// Tables that hold a thesis's printed number beside ours.

#include <optional>
#include <string>
#include <vector>

#include "demo/io/csv.hpp"

namespace gnomon::demo {

/// A cell: what is printed, if anything, and what we measure.
struct Pair {
    std::optional<double> printed;
    std::optional<double> ours;
    int decimals = 1;
};

struct PairTable {
    std::string id;                 ///< One word, for CSV.
    std::string title;              ///< A sentence with the thesis's table numbers.
    std::vector<std::string> heads; ///< Of the columns that name a row.
    std::vector<std::string> columns;
    struct Row {
        std::vector<std::string> names;
        std::vector<Pair> cells;
    };
    std::vector<Row> rows;
};

/// Each cell "printed / ours"; what one of them lacks is a dash.
std::string markdownOf(const PairTable& table);
/// A line per cell: table, row, column, printed, ours.
CsvWriter csvOf(const std::vector<PairTable>& tables);

} // namespace gnomon::demo
