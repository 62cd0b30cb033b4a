#pragma once
// The page of `gnomon report`: one HTML file that needs nothing beside it.
#include <string>
#include <string_view>

namespace gnomon::demo {

/// \param body sections, well-formed
std::string page(std::string_view title, std::string_view body);

} // namespace gnomon::demo
