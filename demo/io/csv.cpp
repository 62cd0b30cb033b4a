#include "demo/io/csv.hpp"

#include "demo/io/file.hpp"
#include "demo/io/number.hpp"
#include "runtime/cost/csv_line.hpp"

#include <cmath>

namespace gnomon::demo {

CsvWriter::CsvWriter(std::vector<std::string> columns) : columns_(std::move(columns))
{
    for (size_t i = 0; i < columns_.size(); ++i)
        text_ += (i == 0 ? "" : ",") + columns_[i];
    text_ += '\n';
}

CsvWriter& CsvWriter::cell(std::string_view text)
{
    if (cellsInRow_++ > 0) text_ += ',';
    if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
        text_ += text;
        return *this;
    }
    text_ += '"';
    for (const char c : text) {
        if (c == '"') text_ += '"';
        text_ += c;
    }
    text_ += '"';
    return *this;
}

CsvWriter& CsvWriter::cell(double value)
{
    std::string text;
    if (!std::isnan(value)) appendNumber(text, value);
    return cell(std::string_view(text));
}

CsvWriter& CsvWriter::cell(double value, int decimals)
{
    std::string text;
    if (!std::isnan(value)) appendFixed(text, value, decimals);
    return cell(std::string_view(text));
}

void CsvWriter::endRow()
{
    ++rows_;
    if (cellsInRow_ != columns_.size() && fault_.empty())
        fault_ = "row " + std::to_string(rows_) + " has " + std::to_string(cellsInRow_) + " cells for " +
                 std::to_string(columns_.size()) + " columns";
    cellsInRow_ = 0;
    text_ += '\n';
}

Status CsvWriter::save(const std::filesystem::path& file) const
{
    if (!fault_.empty()) return Status::failure(file.string() + ": " + fault_);
    if (cellsInRow_ != 0) return Status::failure(file.string() + ": the last row was not ended");
    return writeFile(file, text_);
}

bool splitCsvLine(std::string_view line, std::vector<std::string>& cells)
{
    return cost::splitCells(line, cells);
}

} // namespace gnomon::demo
