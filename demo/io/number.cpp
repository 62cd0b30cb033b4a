#include "demo/io/number.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace gnomon::demo {
namespace {

// The longest fixed notation of a double: sign, 309 digits, point, decimals (at most 40 are asked for).
constexpr size_t kLongestNumber = 384;

template <typename... Format>
void append(std::string& out, double value, Format... format)
{
    std::array<char, kLongestNumber> buffer;
    const std::to_chars_result end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format...);
    out.append(buffer.data(), end.ptr);
}

} // namespace

void appendNumber(std::string& out, double value)
{
    append(out, value);
}

void appendDigits(std::string& out, double value, int significant)
{
    append(out, value, std::chars_format::general, significant);
}

void appendFixed(std::string& out, double value, int decimals)
{
    append(out, value, std::chars_format::fixed, decimals < 40 ? decimals : 40);
}

std::optional<double> parseNumber(std::string_view text) noexcept
{
    // from_chars takes no leading plus, YAML and people do.
    if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
    double value = 0.0;
    const std::from_chars_result end = std::from_chars(text.data(), text.data() + text.size(), value);
    if (end.ec != std::errc() || end.ptr != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

std::string_view trimmed(std::string_view text) noexcept
{
    constexpr std::string_view blanks = " \t";
    const size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) + 1 - first);
}

} // namespace gnomon::demo
