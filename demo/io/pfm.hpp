#pragma once

#include "demo/io/image.hpp"
#include "demo/io/outcome.hpp"

#include <filesystem>

namespace gnomon::demo {

// In an image row 0 is the top one; in a file the bottom row comes first, as the format has it.

/// "Pf" (1 channel) or "PF" (3), little-endian floats, scale -1.
Status writePfm(const std::filesystem::path& file, const ImageF& image);

/// Either byte order.
Outcome<ImageF> readPfm(const std::filesystem::path& file);

} // namespace gnomon::demo
