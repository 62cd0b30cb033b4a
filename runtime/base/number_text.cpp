#include "runtime/base/number_text.hpp"

#include <array>
#include <charconv>

namespace gnomon {

std::optional<double> parseNumber(std::string_view text) noexcept
{
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1); // from_chars knows no plus sign
    // from_chars would also take "inf" and "nan"; a rule base spells infinity ".inf" and has no use for NaN.
    if (text.empty() || text.find_first_not_of("0123456789.eE+-") != std::string_view::npos) return std::nullopt;
    double value = 0.0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

std::string fixedText(double value, int decimals)
{
    std::array<char, 400> buffer; // 309 digits before the point, at most
    const auto result =
        std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed, decimals);
    return result.ec == std::errc() ? std::string(buffer.data(), result.ptr) : shortestText(value);
}

namespace {

template <typename Number>
std::string shortest(Number value)
{
    std::array<char, 32> buffer;
    const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    return std::string(buffer.data(), result.ptr);
}

} // namespace

std::string shortestText(double value)
{
    return shortest(value);
}

std::string shortestText(float value)
{
    return shortest(value);
}

} // namespace gnomon
