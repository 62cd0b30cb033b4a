#include "demo/io/png.hpp"

#include "demo/io/file.hpp"

#include <lodepng.h>

#include <fstream>
#include <string>
#include <string_view>

namespace gnomon::demo {

Outcome<std::string> encodePng(const Image8& image)
{
    const LodePNGColorType type = image.channels == 1 ? LCT_GREY : LCT_RGB;
    std::vector<uint8_t> bytes;
    if (const unsigned error = lodepng::encode(bytes, image.texels, image.width, image.height, type, 8))
        return Outcome<std::string>::failure(lodepng_error_text(error));
    return std::string(bytes.begin(), bytes.end());
}

Status writePng(const std::filesystem::path& file, const Image8& image)
{
    const Outcome<std::string> bytes =
        encodePng(image); // lodepng's own way into a file takes a full disk for a success
    if (!bytes) return Status::failure(file.string() + ": " + bytes.error());
    return writeFile(file, *bytes);
}

bool isWholePng(const std::filesystem::path& file)
{
    constexpr std::string_view kFirst = "\x89PNG\r\n\x1a\n";
    constexpr std::string_view kLast("\0\0\0\0IEND\xae\x42\x60\x82", 12); // the last chunk, always the same
    std::ifstream in(file, std::ios::binary);
    std::string first(kFirst.size(), '\0'), last(kLast.size(), '\0');
    in.read(first.data(), std::ssize(first));
    in.seekg(-std::ssize(last), std::ios::end);
    in.read(last.data(), std::ssize(last));
    return in && first == kFirst && last == kLast;
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
