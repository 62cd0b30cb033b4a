#include "demo/io/csv.hpp"
#include "demo/io/font.hpp"
#include "demo/io/number.hpp"
#include "demo/io/obj.hpp"
#include "demo/io/pfm.hpp"
#include "demo/io/png.hpp"
#include "demo/io/text.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>

using namespace gnomon::demo;
namespace fs = std::filesystem;

namespace {

fs::path temporary(const char* name)
{
    return fs::temp_directory_path() / name;
}

std::string bytesOf(const fs::path& file)
{
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

ImageF ramp(uint32_t channels)
{
    ImageF image(5, 3, channels);
    for (size_t i = 0; i < image.texels.size(); ++i)
        image.texels[i] = float(i) * 0.3f - 1.0f;
    image.texels[1] = std::numeric_limits<float>::infinity();
    image.texels[2] = std::numeric_limits<float>::denorm_min();
    return image;
}

} // namespace

TEST_CASE("PNG returns every byte of gray and RGB images")
{
    for (const uint32_t channels : {1u, 3u}) {
        Image8 image(17, 9, channels);
        for (size_t i = 0; i < image.texels.size(); ++i)
            image.texels[i] = static_cast<uint8_t>(i * 37 + 11);
        const fs::path file = temporary("gnomon_test.png");
        REQUIRE(writePng(file, image));
        const auto back = readPng(file, channels);
        REQUIRE_MESSAGE(back, back.error());
        CHECK(back->width == 17);
        CHECK(back->height == 9);
        CHECK(back->texels == image.texels);
        fs::remove(file);
    }
    CHECK_FALSE(writePng("/no/such/folder/x.png", Image8(1, 1, 3)));
    CHECK_FALSE(readPng("/no/such/folder/x.png", 3));
}

TEST_CASE("a PNG file is whole from its first byte to its last, and no picture fits a full disk")
{
    const fs::path file = temporary("gnomon_whole.png");
    REQUIRE(writePng(file, Image8(17, 9, 3)));
    CHECK(isWholePng(file));
    const std::string bytes = bytesOf(file);
    for (const std::string& damaged :
         {bytes.substr(0, bytes.size() - 1), bytes.substr(1), bytes + '\n', bytes.substr(0, 9), std::string()}) {
        std::ofstream(file, std::ios::binary) << damaged;
        CHECK_FALSE(isWholePng(file));
    }
    fs::remove(file);
    CHECK_FALSE(isWholePng(file));
    if (!fs::exists("/dev/full")) return;
    CHECK_FALSE(isWholePng("/dev/full"));
    CHECK(writePng("/dev/full", Image8(17, 9, 3)).error() == "/dev/full: cannot be written");
    CHECK(writePfm("/dev/full", ImageF(17, 9, 3)).error() == "/dev/full: cannot be written");
}

TEST_CASE("PFM returns every bit, special values included")
{
    for (const uint32_t channels : {1u, 3u}) {
        const ImageF image = ramp(channels);
        const fs::path file = temporary("gnomon_test.pfm");
        REQUIRE(writePfm(file, image));
        const auto back = readPfm(file);
        REQUIRE_MESSAGE(back, back.error());
        CHECK(back->channels == channels);
        CHECK(std::equal(back->texels.begin(), back->texels.end(), image.texels.begin(), image.texels.end(),
                         [](float a, float b) { return std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b); }));
        fs::remove(file);
    }
}

TEST_CASE("a PFM file holds its bottom row right after a three-line header, little-endian")
{
    ImageF image(1, 2, 1);
    image.texels = {1.0f, 2.0f};
    const fs::path file = temporary("gnomon_rows.pfm");
    REQUIRE(writePfm(file, image));
    CHECK(bytesOf(file) == std::string("Pf\n1 2\n-1.0\n\0\0\0\x40\0\0\x80\x3f", 20));
    fs::remove(file);
}

TEST_CASE("ImageMagick sees a PFM file the right way up")
{
    if (std::system("convert -version > /dev/null 2>&1") != 0) {
        MESSAGE("skipped: there is no ImageMagick");
        return;
    }
    ImageF image(2, 3, 1);
    image.texels = {0.0f, 1.0f, 1.0f, 1.0f, 0.0f, 0.0f};
    const fs::path file = temporary("gnomon_magick.pfm"), gray = temporary("gnomon_magick.gray");
    REQUIRE(writePfm(file, image));
    REQUIRE(std::system(("convert '" + file.string() + "' -depth 8 'gray:" + gray.string() + "'").c_str()) == 0);
    CHECK(bytesOf(gray) == std::string("\0\xff\xff\xff\0\0", 6));
    fs::remove(file);
    fs::remove(gray);
}

TEST_CASE("damaged PFM files are refused, big-endian ones are read")
{
    const fs::path file = temporary("gnomon_bad.pfm");
    const auto read = [&file](const std::string& bytes) {
        std::ofstream(file, std::ios::binary) << bytes;
        return readPfm(file);
    };
    const std::string one("\x3f\x80\0\0", 4);
    const auto big = read("Pf\n1 1\n1.0\n" + one);
    REQUIRE(big);
    CHECK(big->texels[0] == 1.0f);
    for (const char* header : {"", "P6\n1 1\n-1.0\n", "Pf\n0 1\n-1.0\n", "Pf\n-1 1\n-1.0\n", "Pf\n1 1\n0\n",
                               "Pf\n1 1\nnan\n", "Pf\n1 2\n-1.0\n", "Pf\n99999999 99999999\n-1.0\n", "Pf\n1 1 -1.0"})
        CHECK_FALSE(read(header + one));
    fs::remove(file);
}

TEST_CASE("nine digits tell neighbouring floats apart in an OBJ file")
{
    Mesh mesh{
        "m", {{0.1f, 1e-20f, -123456.789f}, {std::nextafter(0.1f, 1.0f), 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}}, {0, 1, 2}};
    ObjWriter writer;
    writer.add("a", mesh, Transform{});
    writer.add("b", mesh, Transform{glm::dmat3(2.0), {1e6, 0.0, 0.0}});
    const std::string& text = writer.text();
    CHECK(text.find("v 0.100000001 9.99999968e-21 -123456.789\nv 0.100000009 0 0\n") != std::string::npos);
    CHECK(text.find("f 1 2 3\n") != std::string::npos);
    CHECK(text.find("o b\nv 1000000.2 ") != std::string::npos);
    CHECK(text.ends_with("f 4 5 6\n"));
}

TEST_CASE("CSV quotes what needs it, writes numbers that read back equal and refuses ragged rows")
{
    CsvWriter csv({"name", "value", "count", "flag"});
    csv.cell("plain").cell(0.1).cell(7u).cell(true).endRow();
    csv.cell("a,\"b\"").cell(std::numeric_limits<double>::quiet_NaN()).cell(-3).cell(false).endRow();
    csv.cell("fixed").cell(2.0 / 3.0, 3).empty().empty().endRow();
    CHECK(csv.text() == "name,value,count,flag\nplain,0.1,7,1\n\"a,\"\"b\"\"\",,-3,0\nfixed,0.667,,\n");
    std::vector<std::string> cells;
    REQUIRE(splitCsvLine("\"a,\"\"b\"\"\",,-3,0", cells));
    CHECK(cells == std::vector<std::string>{"a,\"b\"", "", "-3", "0"});
    CHECK_FALSE(splitCsvLine("\"open", cells));

    const fs::path file = temporary("gnomon_test.csv");
    REQUIRE(csv.save(file));
    CHECK(bytesOf(file) == csv.text());
    fs::remove(file);
    csv.cell("too few").endRow();
    const Status ragged = csv.save(file);
    CHECK(ragged.error().ends_with("row 4 has 1 cells for 4 columns"));
    CHECK_FALSE(fs::exists(file));
}

TEST_CASE("numbers are read whole or not at all, and never as NaN or infinity")
{
    CHECK(parseNumber("1.5") == 1.5);
    CHECK(parseNumber("+2e3") == 2000.0);
    CHECK(parseNumber("-.5") == -0.5);
    for (const char* text : {"", " 1", "1 ", "1,5", "1.5x", "nan", "inf", "-inf", ".nan", "1e999", "0x10", "+-1", "+"})
        CHECK_MESSAGE(!parseNumber(text), text);
}

TEST_CASE("trimmed text keeps the blanks inside")
{
    CHECK(trimmed(" \ta b\t") == "a b");
    CHECK(trimmed("ab") == "ab");
    CHECK(trimmed(" \t ").empty());
    CHECK(trimmed("").empty());
}

namespace {

uint64_t inkOf(const Glyph& glyph)
{
    return std::accumulate(glyph.coverage.begin(), glyph.coverage.end(), uint64_t{0});
}

/// Every printable character has a picture of its own, and the others share one.
void checkGlyphs(const Font& font)
{
    std::set<std::vector<uint8_t>> pictures;
    for (char c = ' '; c <= '~'; ++c) {
        const Glyph& glyph = font[c];
        CAPTURE(c);
        CHECK(glyph.coverage.size() == size_t(glyph.width) * glyph.height);
        CHECK((inkOf(glyph) > 0) == (c != ' '));
        CHECK(glyph.advance > 0);
        CHECK(glyph.top <= int32_t(font.ascent));
        CHECK(int32_t(glyph.height) - glyph.top <= int32_t(font.descent));
        std::vector<uint8_t> picture = glyph.coverage; // comma and quote differ in their place alone
        picture.push_back(uint8_t(glyph.width));
        picture.push_back(uint8_t(glyph.top));
        pictures.insert(std::move(picture));
    }
    CHECK(pictures.size() == 95);
    CHECK(font['\x01'].coverage == font[char(200)].coverage);
    CHECK(inkOf(font['\x01']) > 0);
}

} // namespace

TEST_CASE("both fonts have a picture for every printable character")
{
    checkGlyphs(dotFont(1));
    checkGlyphs(dotFont(3));
    const Font dots = dotFont(2);
    CHECK(dots['A'].width == 10); // 5 x 7 dots of 2 pixels
    CHECK(dots['A'].height == 14);
    CHECK(inkOf(dots['|']) == 7 * 4 * 255);
    for (const uint32_t scale : {1u, 2u, 5u}) {
        const std::optional<Font> outlines = outlineFont(scale);
        CHECK(outlines.has_value() == (*fontFile() != 0)); // where the build has found the file, it is there
        if (!outlines) continue;
        CAPTURE(scale);
        checkGlyphs(*outlines);
        // DejaVu Sans by its tables, in units of 1/2048 em: capitals are 1493 high, digits 1303 apart.
        const double em = double(kEmPixels * scale);
        CHECK(std::abs((*outlines)['H'].top - em * 1493.0 / 2048.0) < 1.5); // whole rows, by the hinter
        for (char digit = '0'; digit <= '9'; ++digit)
            CHECK(std::abs((*outlines)[digit].advance - em * 1303.0 / 2048.0) < 1.0);
        size_t soft = 0;
        for (const uint8_t coverage : (*outlines)['o'].coverage)
            soft += coverage > 0 && coverage < 255;
        CHECK(soft > 4); // a round edge is not made of whole pixels
    }
}

TEST_CASE("text stays inside the box that it was measured to have, and touches each of its sides")
{
    for (const uint32_t scale : {1u, 2u}) {
        CAPTURE(scale);
        constexpr std::string_view text = "jAg|\n#(y";
        const Font& font = fontOf(scale);
        const TextSize size = measureText(text, scale);
        CHECK(size.height == font.ascent + font.descent + font.lineAdvance);
        Image8 image(size.width + 2, size.height + 2, 3);
        drawText(image, 1, 1, text, {255, 0, 0}, scale);
        uint64_t ink = 0, expected = 0, atRight = 0;
        for (uint32_t y = 0; y < image.height; ++y)
            for (uint32_t x = 0; x < image.width; ++x) {
                const uint8_t red = image.at(x, y)[0];
                ink += red;
                atRight += x == size.width ? red : 0u;
                if (x == 0 || y == 0 || x + 1 == image.width || y + 1 == image.height) CHECK(red == 0);
            }
        for (const char c : text)
            if (c != '\n') expected += inkOf(font[c]);
        CHECK(double(ink) == doctest::Approx(double(expected)).epsilon(0.01)); // tint() has 1/256 steps
        CHECK(atRight > 0);
        drawText(image, -100, 30, "outside both ways, clipped", {1, 2, 3}, 3); // must not write out of bounds
    }
}

TEST_CASE("images are cropped, enlarged, shrunk and tinted pixel by pixel")
{
    Image8 image(4, 2, 1);
    image.texels = {0, 10, 20, 30, 40, 50, 60, 70};
    const Image8 part = crop(image, {2, 1, 3, 2});
    CHECK(part.texels == std::vector<uint8_t>{60, 70, 0, 0, 0, 0});
    const Image8 big = enlarge(part, 2);
    CHECK(big.width == 6);
    CHECK(*big.at(1, 1) == 60);
    CHECK(*big.at(2, 0) == 70);
    const Image8 small = shrinkToFit(image, 2, 2);
    CHECK(small.width == 2);
    CHECK(small.texels == std::vector<uint8_t>{25, 45});
    CHECK(shrinkToFit(image, 100, 100).texels == image.texels);

    Image8 rgb = toRgb(image);
    tint(rgb, {0, 0, 1, 1}, {255, 0, 255}, 1.0f);
    CHECK(Rgb8{rgb.texels[0], rgb.texels[1], rgb.texels[2]} == Rgb8{255, 0, 255});
    tint(rgb, {1, 0, 1, 1}, {110, 110, 110}, 0.5f);
    CHECK(rgb.at(1, 0)[2] == 60);
    tint(rgb, {0, 0, 9, 9}, {0, 0, 0}, std::numeric_limits<float>::quiet_NaN());
    CHECK(rgb.at(1, 0)[2] == 60);
    outline(rgb, {-1, -1, 6, 4}, {9, 9, 9}); // wholly outside: nothing changes
    CHECK(rgb.at(0, 0)[0] == 255);
    blit(rgb, 3, 1, rgb);
    CHECK(rgb.at(3, 1)[0] == 255);
}

TEST_CASE("sRGB encoding has the standard's fixed points")
{
    CHECK(encodeSrgb(0.0f) == 0);
    CHECK(encodeSrgb(1.0f) == 255);
    CHECK(encodeSrgb(7.0f) == 255);
    CHECK(encodeSrgb(-1.0f) == 0);
    CHECK(encodeSrgb(std::numeric_limits<float>::quiet_NaN()) == 0);
    CHECK(encodeSrgb(0.2158605f) == 128); // ((128 / 255 + 0.055) / 1.055)^2.4
}
