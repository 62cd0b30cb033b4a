#pragma once

#include "demo/io/outcome.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace gnomon::demo {

/// All bytes of a file.
Outcome<std::string> readText(const std::filesystem::path& file);

/// Replaces the file. A disk that fills up on the way is a failure like any other.
Status writeFile(const std::filesystem::path& file, std::string_view bytes);

} // namespace gnomon::demo
