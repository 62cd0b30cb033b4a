#pragma once

#include "demo/io/image.hpp"
#include "demo/io/outcome.hpp"

#include <filesystem>
#include <string>

namespace gnomon::demo {

/// The bytes of a PNG file: 8-bit gray or RGB, by the image's channel count.
Outcome<std::string> encodePng(const Image8& image);
Status writePng(const std::filesystem::path& file, const Image8& image);

/// Whether the file starts and ends as a PNG file does; what another program wrote may have been cut short.
bool isWholePng(const std::filesystem::path& file);

/// \param channels 1 or 3: what the caller wants; the file is converted.
Outcome<Image8> readPng(const std::filesystem::path& file, uint32_t channels);

} // namespace gnomon::demo
