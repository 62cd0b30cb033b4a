#include "demo/theses/pair_table.hpp"

#include "demo/io/number.hpp"

namespace gnomon::demo {
namespace {

std::string textOf(const std::optional<double>& value, int decimals)
{
    if (!value) return "-";
    std::string text;
    appendFixed(text, *value, decimals);
    return text;
}

std::string lineOf(const std::vector<std::string>& names, const std::vector<std::string>& cells)
{
    std::string line = "|";
    for (const std::string& name : names)
        line += " " + name + " |";
    for (const std::string& cell : cells)
        line += " " + cell + " |";
    return line + "\n";
}

std::string joined(const std::vector<std::string>& names)
{
    std::string text;
    for (const std::string& name : names)
        text += (text.empty() ? "" : ", ") + name;
    return text;
}

} // namespace

std::string markdownOf(const PairTable& table)
{
    std::string text = table.title + "\n\n" + lineOf(table.heads, table.columns);
    text += lineOf(std::vector<std::string>(table.heads.size(), "---"),
                   std::vector<std::string>(table.columns.size(), "---"));
    for (const PairTable::Row& row : table.rows) {
        std::vector<std::string> cells;
        for (const Pair& cell : row.cells)
            cells.push_back(textOf(cell.printed, cell.decimals) + " / " + textOf(cell.ours, cell.decimals));
        text += lineOf(row.names, cells);
    }
    return text;
}

CsvWriter csvOf(const std::vector<PairTable>& tables)
{
    CsvWriter csv({"table", "row", "column", "printed", "ours"});
    for (const PairTable& table : tables)
        for (const PairTable::Row& row : table.rows)
            for (size_t i = 0; i < row.cells.size(); ++i) {
                csv.cell(table.id).cell(joined(row.names)).cell(table.columns.at(i));
                for (const std::optional<double>& value : {row.cells[i].printed, row.cells[i].ours})
                    value ? csv.cell(*value, row.cells[i].decimals) : csv.empty();
                csv.endRow();
            }
    return csv;
}

} // namespace gnomon::demo
