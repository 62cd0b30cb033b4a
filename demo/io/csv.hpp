#pragma once

#include "demo/io/outcome.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::demo {

/// Rows of fixed columns, locale-independent. Cells are given in the order of the columns; a row that has too few or
/// too many is an error at save(), never a shifted table.
class CsvWriter {
public:
    explicit CsvWriter(std::vector<std::string> columns);

    CsvWriter& cell(std::string_view text); ///< Quoted where it has to be (RFC 4180).
    CsvWriter& cell(const char* text) { return cell(std::string_view(text)); }
    CsvWriter& cell(double value);               ///< Shortest text that reads back equal; NaN is an empty cell.
    CsvWriter& cell(double value, int decimals); ///< Fixed decimals, for people.
    CsvWriter& cell(bool value) { return cell(std::string_view(value ? "1" : "0")); }
    template <std::integral Integer>
    CsvWriter& cell(Integer value)
    {
        return cell(std::string_view(std::to_string(value)));
    }
    CsvWriter& empty() { return cell(std::string_view()); }
    void endRow();

    const std::string& text() const noexcept { return text_; }
    /// Fails where a row had the wrong number of cells, or the file cannot be written.
    Status save(const std::filesystem::path& file) const;

private:
    std::vector<std::string> columns_;
    std::string text_;
    std::string fault_;
    size_t cellsInRow_ = 0;
    size_t rows_ = 0;
};

/// Splits one CSV line; quotes as RFC 4180. \return false on an unbalanced quote.
bool splitCsvLine(std::string_view line, std::vector<std::string>& cells);

} // namespace gnomon::demo
