#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gnomon {

/// Reads a whole text as a decimal number, whatever the locale: "12", "-0.5", "1e3". Not "0x1", "inf", "nan" or "1 ".
std::optional<double> parseNumber(std::string_view text) noexcept;

/// "0.62": fixed point with that many decimals, a point as decimal sign in every locale.
std::string fixedText(double value, int decimals);

/// Shortest text that reads back as the same value: "13.5", "0.1", "1e+30", "-inf", "nan".
std::string shortestText(double value);
/// The same of a float: "5.54", where its double has more digits.
std::string shortestText(float value);

} // namespace gnomon
