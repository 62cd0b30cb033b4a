#include "demo/io/png.hpp"

#include <lodepng.h>

namespace gnomon::demo {

Status writePng(const std::filesystem::path& file, const Image8& image)
{
    const LodePNGColorType type = image.channels == 1 ? LCT_GREY : LCT_RGB;
    if (const unsigned error = lodepng::encode(file.string(), image.texels, image.width, image.height, type, 8))
        return Status::failure(file.string() + ": " + lodepng_error_text(error));
    return Done{};
}

Outcome<Image8> readPng(const std::filesystem::path& file, uint32_t channels)
{
    Image8 image;
    image.channels = channels;
    const LodePNGColorType type = channels == 1 ? LCT_GREY : LCT_RGB;
    if (const unsigned error = lodepng::decode(image.texels, image.width, image.height, file.string(), type, 8))
        return Outcome<Image8>::failure(file.string() + ": " + lodepng_error_text(error));
    return image;
}

} // namespace gnomon::demo
