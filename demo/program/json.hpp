#pragma once
#include <string>
#include <string_view>

namespace gnomon::demo {

/// As a JSON string, in quotes (RFC 8259).
std::string jsonString(std::string_view text);

} // namespace gnomon::demo
