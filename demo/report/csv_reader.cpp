#include "demo/report/csv_reader.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "demo/io/csv.hpp"
#include "demo/io/file.hpp"
#include "demo/io/number.hpp"

namespace gnomon::demo {

namespace {

constexpr size_t kMostNotes = 3; // a file with more is no table of ours

/// Takes the next row off `text`; line breaks within quotes belong to it. \return whether it was ended
bool takeRow(std::string_view& text, std::string_view& row)
{
    bool quoted = false;
    size_t end = 0;
    for (; end < text.size() && (quoted || text[end] != '\n'); ++end)
        quoted ^= text[end] == '"';
    const bool ended = end < text.size();
    row = text.substr(0, end);
    text.remove_prefix(ended ? end + 1 : end);
    return ended;
}

} // namespace

Outcome<std::vector<std::string>> readCsv(const std::filesystem::path& file, std::span<const std::string_view> columns,
                                          const std::function<void(std::span<const std::string>)>& visit)
{
    using Notes = Outcome<std::vector<std::string>>;
    const Outcome<std::string> text = readText(file);
    if (!text) return Notes::failure(text.error());
    std::string_view rest = *text, line;
    std::vector<std::string> head, cells, wanted(columns.size()), notes;
    takeRow(rest, line);
    if (!splitCsvLine(line, head)) head.clear();
    std::vector<size_t> places;
    for (const std::string_view column : columns) {
        const auto found = std::find(head.begin(), head.end(), column);
        if (found == head.end()) return Notes::failure(file.string() + ": no column '" + std::string(column) + "'");
        places.push_back(size_t(found - head.begin()));
    }
    for (size_t number = 2; !rest.empty() && notes.size() < kMostNotes; ++number) {
        const bool ended = takeRow(rest, line);
        if (!ended || !splitCsvLine(line, cells) || cells.size() != head.size()) {
            notes.push_back(file.string() + ": row " + std::to_string(number) + " is not a whole row, left out");
            continue;
        }
        for (size_t i = 0; i < places.size(); ++i)
            wanted[i].swap(cells[places[i]]);
        visit(wanted);
    }
    if (!rest.empty()) notes.push_back(file.string() + ": too many such rows, the rest is left out");
    return notes;
}

std::string commandIn(const std::filesystem::path& file)
{
    std::string command;
    (void)readCsv(file, std::span(&kCommandColumn, 1), [&](std::span<const std::string> cells) {
        if (command.empty()) command = cells[0];
    });
    return command;
}

double numberIn(const std::string& cell)
{
    return parseNumber(cell).value_or(std::numeric_limits<double>::quiet_NaN());
}

} // namespace gnomon::demo
