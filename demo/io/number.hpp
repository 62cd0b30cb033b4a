#pragma once

#include <optional>
#include <string>
#include <string_view>

/// Numbers as text without any locale, and what stands round them on a command line.
namespace gnomon::demo {

void appendNumber(std::string& out, double value);                  ///< Shortest that reads back equal.
void appendDigits(std::string& out, double value, int significant); ///< Like printf's %.{significant}g.
void appendFixed(std::string& out, double value, int decimals);     ///< Like printf's %.{decimals}f.
std::optional<double> parseNumber(std::string_view text) noexcept;  ///< The whole text, or nothing. NaN, inf: nothing.
/// Without the spaces and tabs at both ends.
std::string_view trimmed(std::string_view text) noexcept;

} // namespace gnomon::demo
