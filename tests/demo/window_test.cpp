// The window, under a virtual X server: resized twenty times with validation on, then looked at.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "demo/host/device.hpp"
#include "demo/io/png.hpp"

namespace gnomon::demo {

TEST_CASE("a window resized twenty times keeps validation silent and shows the scene")
{
    const std::filesystem::path file = std::filesystem::temp_directory_path() / "gnomon_window_test.png";
    const std::filesystem::path said = std::filesystem::temp_directory_path() / "gnomon_window_test.txt";
    std::filesystem::remove(file);
    const std::string command =
        "xvfb-run -a -s '-screen 0 1280x1024x24' '" GNOMON_PROGRAM
        "' run room --window --size 320x180 --validate --resize-test 20 --why 30:spot1 --screenshot '" +
        file.string() + "' >'" + said.string() + "'";
    CHECK(std::system(command.c_str()) == 0);
    std::ostringstream text;
    text << std::ifstream(said).rdbuf();
    CHECK_MESSAGE(text.str().find("light 'spot1', frame 30") != std::string::npos, text.str()); // --why, at the end
    std::filesystem::remove(said);
    const Outcome<Image8> picture = readPng(file, 3);
    REQUIRE_MESSAGE(picture, picture.error());
    CHECK(picture->width == 640); // the last size the test asks for
    CHECK(picture->height == 360);
    std::set<uint32_t> colours;
    for (size_t i = 0; i < picture->texels.size(); i += 3)
        colours.insert(uint32_t(picture->texels[i]) << 16 | picture->texels[i + 1] << 8 | picture->texels[i + 2]);
    CHECK(colours.size() > 200); // a room under several lights, not a clear colour
    std::filesystem::remove(file);
}

} // namespace gnomon::demo

int main(int argc, char** argv)
{
    const bool haveServer = std::system("command -v xvfb-run >/dev/null 2>&1") == 0;
    if (!haveServer || gnomon::demo::Device::nonePresent() || !gnomon::demo::Device::validationPresent()) return 77;
    return doctest::Context(argc, argv).run();
}
