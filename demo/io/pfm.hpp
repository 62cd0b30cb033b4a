#pragma once

#include "demo/io/image.hpp"
#include "demo/io/outcome.hpp"

#include <filesystem>

namespace gnomon::demo {

/// Which row of the picture comes first in the file. The format has no word for it: by convention PFM is bottom up,
/// while gnomon's dumps are top down and say so in frame.json. So every call names the order.
enum class RowOrder : uint8_t { TopDown, BottomUp };

/// "Pf" (1 channel) or "PF" (3), little-endian floats, scale -1.
Status writePfm(const std::filesystem::path& file, const ImageF& image, RowOrder order);

/// Either byte order. The result's row 0 is the top row, whatever the order in the file.
Outcome<ImageF> readPfm(const std::filesystem::path& file, RowOrder order);

} // namespace gnomon::demo
