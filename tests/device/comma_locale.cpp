#include "device/comma_locale.hpp"

#include <array>
#include <clocale>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <locale>
#include <unistd.h>

namespace gnomon::test {
namespace {

struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

// A category file of glibc (locale/loadlocale.c): a magic number, the count of elements, their offsets, their values.
// LC_NUMERIC is category 1; its elements are decimal point, thousands separator, grouping, the first two as wide
// characters, codeset.
void writeNumericCategory(const std::filesystem::path& file)
{
    constexpr uint32_t kMagic = 0x20031115u ^ 1u;
    constexpr uint32_t kElements = 6;
    const std::array<uint32_t, 2 + kElements> head = {kMagic, kElements, 32, 34, 36, 40, 44, 48};
    std::array<char, 56> bytes{};
    std::char_traits<char>::copy(bytes.data(), reinterpret_cast<const char*>(head.data()), sizeof head);
    bytes[32] = ',';
    bytes[34] = '.';
    bytes[36] = 3;
    bytes[40] = ','; // little-endian wide characters
    bytes[44] = '.';
    std::char_traits<char>::copy(&bytes[48], "UTF-8", 6);
    std::ofstream(file, std::ios::binary).write(bytes.data(), bytes.size());
}

} // namespace

CommaLocale::CommaLocale()
    : folder_((std::filesystem::temp_directory_path() / ("gnomon_locale_" + std::to_string(getpid()))).string())
{
    const std::filesystem::path category = std::filesystem::path(folder_) / "comma";
    std::filesystem::create_directories(category);
    writeNumericCategory(category / "LC_NUMERIC");
    setenv("LOCPATH", folder_.c_str(), 1);
    std::locale::global(std::locale(std::locale::classic(), new Comma));
    std::setlocale(LC_NUMERIC, "comma");
}

CommaLocale::~CommaLocale()
{
    std::locale::global(std::locale::classic());
    std::setlocale(LC_NUMERIC, "C");
    unsetenv("LOCPATH");
    std::error_code ignored; // a folder left behind in /tmp breaks nothing
    std::filesystem::remove_all(folder_, ignored);
}

bool CommaLocale::inForce() const
{
    char text[8];
    std::snprintf(text, sizeof text, "%.1f", 1.5);
    return text[1] == ',';
}

} // namespace gnomon::test
