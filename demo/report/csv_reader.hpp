#pragma once
// Tables that the program's commands have written, read back row by row: a long run's do not fit twice into memory.
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "demo/io/outcome.hpp"

namespace gnomon::demo {

/// Calls `visit` with the cells of each row, in the order of `columns`. Fails where the file lacks one of them.
/// \return notes about rows that are not whole (a file cut off in the middle): they are left out.
Outcome<std::vector<std::string>> readCsv(const std::filesystem::path& file, std::span<const std::string_view> columns,
                                          const std::function<void(std::span<const std::string>)>& visit);

/// The last column of the tables of `bench` and `compare`: the command that made the table, in the first row.
inline constexpr std::string_view kCommandColumn = "command";

/// Empty: the table has no such column.
std::string commandIn(const std::filesystem::path& file);

/// NaN where the cell is no number.
double numberIn(const std::string& cell);

} // namespace gnomon::demo
