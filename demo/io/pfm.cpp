#include "demo/io/pfm.hpp"

#include "demo/io/number.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>

namespace gnomon::demo {
namespace {

// Sides beyond this are damage, not pictures; it also keeps width * height * 12 far from overflow.
constexpr uint32_t kLargestSide = 65536;

/// Takes the next white-space separated word of a header and exactly one white space after it, as the format says.
std::string_view takeWord(std::string_view& rest)
{
    constexpr std::string_view kSpace = " \t\r\n";
    rest.remove_prefix(std::min(rest.find_first_not_of(kSpace), rest.size()));
    const std::string_view word = rest.substr(0, rest.find_first_of(kSpace));
    rest.remove_prefix(std::min(word.size() + 1, rest.size()));
    return word;
}

uint32_t parseSide(std::string_view word)
{
    uint32_t value = 0;
    const auto end = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool whole = end.ec == std::errc() && end.ptr == word.data() + word.size();
    return whole && value <= kLargestSide ? value : 0;
}

uint32_t swapIfNeeded(uint32_t word, bool fileIsLittle)
{
    constexpr bool kHostIsLittle = std::endian::native == std::endian::little;
    if (fileIsLittle == kHostIsLittle) return word;
    return (word >> 24) | ((word >> 8) & 0xff00u) | ((word << 8) & 0xff0000u) | (word << 24);
}

} // namespace

Status writePfm(const std::filesystem::path& file, const ImageF& image)
{
    const std::string header = std::string(image.channels == 3 ? "PF\n" : "Pf\n") + std::to_string(image.width) + " " +
                               std::to_string(image.height) + "\n-1.0\n"; // a negative scale says little-endian
    const size_t rowWords = size_t(image.width) * image.channels;
    std::vector<uint32_t> words(rowWords * image.height);
    for (uint32_t y = 0; y < image.height; ++y)
        for (size_t i = 0; i < rowWords; ++i)
            words[size_t(image.height - 1 - y) * rowWords + i] =
                swapIfNeeded(std::bit_cast<uint32_t>(image.texels[y * rowWords + i]), true);
    std::ofstream out(file, std::ios::binary);
    out.write(header.data(), static_cast<std::streamsize>(header.size()));
    out.write(reinterpret_cast<const char*>(words.data()), static_cast<std::streamsize>(words.size() * 4));
    out.close();
    if (!out) return Status::failure(file.string() + ": cannot be written");
    return Done{};
}

Outcome<ImageF> readPfm(const std::filesystem::path& file)
{
    const auto fail = [&file](const char* why) { return Outcome<ImageF>::failure(file.string() + ": " + why); };
    std::ifstream in(file, std::ios::binary);
    if (!in) return fail("cannot be opened");
    const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};

    std::string_view rest = bytes;
    const std::string_view magic = takeWord(rest);
    if (magic != "PF" && magic != "Pf") return fail("not a PFM file");
    const uint32_t width = parseSide(takeWord(rest)), height = parseSide(takeWord(rest));
    if (width == 0 || height == 0) return fail("bad size in the header");
    const std::optional<double> scale = parseNumber(takeWord(rest));
    if (!scale || *scale == 0.0) return fail("bad scale in the header");

    const uint32_t channels = magic == "PF" ? 3 : 1;
    const size_t rowWords = size_t(width) * channels;
    if (rest.size() != rowWords * height * 4) return fail("length does not match the header");
    ImageF image(width, height, channels);
    for (uint32_t y = 0; y < height; ++y)
        for (size_t i = 0; i < rowWords; ++i) {
            uint32_t word = 0;
            std::memcpy(&word, rest.data() + (size_t(height - 1 - y) * rowWords + i) * 4, 4);
            image.texels[y * rowWords + i] = std::bit_cast<float>(swapIfNeeded(word, *scale < 0.0));
        }
    return image;
}

} // namespace gnomon::demo
