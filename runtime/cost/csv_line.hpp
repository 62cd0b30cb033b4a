#pragma once
// Lines and cells of a table as RFC 4180 has them, without line breaks inside cells.
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::cost {

/// Takes the next line off the text, without its end.
inline std::string_view takeLine(std::string_view& text)
{
    const size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
}

/// False on an unbalanced quote.
inline bool splitCells(std::string_view line, std::vector<std::string>& cells)
{
    cells.assign(1, {});
    bool quoted = false;
    for (size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
            cells.back() += '"', ++i;
        } else if (c == '"') {
            quoted = !quoted;
        } else if (c == ',' && !quoted) {
            cells.emplace_back();
        } else {
            cells.back() += c;
        }
    }
    return !quoted;
}

/// The cell as it stands in a line.
inline std::string quotedCell(std::string_view cell)
{
    const bool plain = cell.find_first_of(",\"") == std::string_view::npos && !cell.starts_with('#');
    std::string out = plain ? "" : "\"";
    for (const char c : cell) {
        if (c == '"') out += '"';
        out += c == '\n' || c == '\r' ? ' ' : c;
    }
    if (!plain) out += '"';
    return out;
}

} // namespace gnomon::cost
