#include "rules/engine/diagnostic.hpp"

#include <algorithm>

namespace gnomon::rules {

std::string inQuotes(std::string_view text)
{
    std::string result(1, '\'');
    result += text;
    result += '\'';
    return result;
}

namespace {

constexpr std::size_t kShortName = 3;  ///< Any two shorter ones are a slip apart.
constexpr std::size_t kLongName = 6;   ///< From so many letters on, two slips are still the same word.
constexpr std::size_t kShortList = 12; ///< Names that a reader looks through at a glance.

/// Edits between two words, neighbours swapped counting as one (Damerau 1964, in the restricted form).
std::size_t editsBetween(std::string_view a, std::string_view b)
{
    std::vector<std::size_t> before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j)
        row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        next[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t change = row[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            next[j] = std::min({change, row[j] + 1, next[j - 1] + 1});
            const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (swapped) next[j] = std::min(next[j], before[j - 2] + 1);
        }
        before.swap(row);
        row.swap(next);
    }
    return row[b.size()];
}

} // namespace

std::string suggestion(std::string_view name, std::span<const std::string_view> known)
{
    std::size_t least = name.size() < kShortName ? 1 : name.size() < kLongName ? 2 : 3; // one more than is allowed
    std::string_view best;
    for (const std::string_view candidate : known) {
        if (candidate.size() > name.size() + least || name.size() > candidate.size() + least) continue;
        const std::size_t edits = editsBetween(name, candidate);
        if (edits < least) best = candidate, least = edits;
    }
    std::string text;
    if (!best.empty()) text += "; did you mean " + inQuotes(best) + "?";
    if (known.empty() || (known.size() > kShortList && !best.empty())) return text;
    text += best.empty() ? "; known:" : " Known:";
    for (const std::string_view candidate : known) {
        text += candidate == known.front() ? " " : ", ";
        text += candidate;
    }
    return text;
}

std::string toText(const Diagnostic& diagnostic)
{
    std::string text = diagnostic.file;
    if (diagnostic.line != 0) text += ':' + std::to_string(diagnostic.line) + ':' + std::to_string(diagnostic.column);
    text += diagnostic.severity == Severity::Error ? ": error: " : ": warning: ";
    return text + diagnostic.message + " [" + diagnostic.id + ']';
}

} // namespace gnomon::rules
