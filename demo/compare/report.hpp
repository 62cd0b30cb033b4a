#pragma once
// What `gnomon compare` prints and writes of a scene.
#include <string>

#include "demo/compare/contest.hpp"
#include "demo/io/csv.hpp"

namespace gnomon::demo {

/// What is known of an adaptive run at the end, for the table over all scenes.
struct ScenePart {
    std::string scene, adaptive, best; ///< `best`: the best fixed choice of equal quality; empty: there is none.
    bool warm = false;
    Quotient total, worstFrame;
    Quotient over; ///< Frames over the budget in per cent; of no runs: there is none.
};

/// The table of all rows, and each adaptive run against the best fixed choice of equal quality.
std::vector<ScenePart> printReport(const Contest& contest);

/// A line for each, and in how many scenes the adaptive run was faster than every fixed choice by 1.3 times.
void printSummary(const std::vector<ScenePart>& parts);

/// Three sentences in words.
void printWords(const Contest& contest);

/// Columns of the table that appendTable() fills.
CsvWriter emptyTable();
/// A row per frame of every run. \param command in the first of them.
void appendTable(CsvWriter& csv, const Contest& contest, std::string command);

/// Milliseconds of every frame of the cold runs: the fixed choices, what could be had of those of equal quality, and
/// the adaptive runs.
void plotFrames(const Contest& contest, const std::string& out);

} // namespace gnomon::demo
