// gnomon-theses from outside: what it prints and draws, and what it refuses.
#include <doctest/doctest.h>

#include <set>
#include <sstream>

#include "demo/cli_fixture.hpp"
#include "demo/io/csv.hpp"
#include "demo/io/png.hpp"
#include "gnomon/gnomon.h"

namespace gnomon::demo {

TEST_CASE("a figure is a row for every number of lights and faces")
{
    const Folder folder("figure");
    const fs::path csv = folder.path / "figure.csv";
    const Ran ran = gnomonProgram("figure 4.19 --size 32x24 --repeat 3 --csv '" + csv.string() + "'");
    CAPTURE(ran.output);
    REQUIRE(ran.exitCode == 0);
    const std::vector<std::string> table = lines(csv);
    REQUIRE(table.size() == 1 + 4 * 5);
    CHECK(table[0] == "figure,method,faces,lights,increment_ms_min");
    CHECK(table[1].starts_with("4.19,shadow_map,600,1,"));
    CHECK(table.back().starts_with("4.19,shadow_map,100000,16,"));
}

TEST_CASE("reasons account for every pixel, and what a ray decided is never wrong")
{
    const Folder folder("reasons");
    const fs::path picture = folder.path / "reasons.png";
    const Ran ran = gnomonProgram("reasons torus_grid --method pcf_hybrid --set resolution=64 --size 160x120 --out '" +
                                  picture.string() + "'");
    CAPTURE(ran.output);
    REQUIRE(ran.exitCode == 0);
    std::istringstream output(ran.output);
    unsigned long long pixels = 0, wrongByMap = 0;
    std::set<std::string> reasons;
    for (std::string line; std::getline(output, line);) {
        std::vector<std::string> cells;
        if (!splitCsvLine(line, cells) || cells.size() != 7 || cells[0] != "torus_grid") continue;
        reasons.insert(cells[2]);
        pixels += std::stoull(cells[3]);
        const unsigned long long wrong = std::stoull(cells[5]) + std::stoull(cells[6]);
        if (cells[2].starts_with("rt_")) CHECK(wrong == 0);
        if (cells[2].starts_with("tc_")) wrongByMap += wrong;
    }
    CHECK(pixels == 160 * 120);
    CHECK(reasons == std::set<std::string>{"outside", "backfacing", "tc_lit", "tc_shadow", "rt_lit", "rt_shadow"});
    CHECK(wrongByMap > 0); // 64 texels cannot do it
    const auto drawn = readPng(picture, 3);
    REQUIRE(drawn);
    CHECK(drawn->width == 160);
    CHECK(distinctColours(*drawn) > 50);
}

TEST_CASE("bad input is named before a device is looked for, and leaves nothing behind")
{
    const Folder folder("theses_checks");
    const std::pair<const char*, const char*> cases[] = {
        {"nosuch", "gnomon-theses: no command 'nosuch'; known: tables, figure, reasons"},
        {"figure 9.9", "no figure '9.9'; there are 4.6, "},
        {"figure 4.6 --out none/x.png", "none/x.png"},
        {"tables morais --csv none/x.csv", "none/x.csv"},
        {"reasons room --method contour_chain --set reasons=2", "'reasons'"},
        {"reasons room --method pcf_hybrid --frame 240", "frames 0 to 239"},
        {"reasons room --method shadow_map", "'shadow_map' has no setting 'reasons'"},
        {"reasons scenario --method pcf_hybrid --light moving7 --frame 0", "no light is there in frame 0"},
        {"reasons room --method pcf_hybrid --out none/x.png", "none/x.png"},
        {"reasons room --method pcf_hybrid --set nosuch=1", "'nosuch'"},
        {"reasons room --method pcf_hybrid --set resolution=1e9", "takes 'resolution' from"},
        {"reasons torus_grid --method pcf_hybrid --light no_such_light", "no_such_light"},
    };
    for (const auto& bad : cases) {
        CAPTURE(bad.first);
        const Ran ran = gnomonProgram(bad.first, "cd '" + folder.path.string() + "' && GNOMON_DEVICE=none");
        CHECK(ran.exitCode == (bad.first == std::string("nosuch") ? 2 : 1)); // a command line, and what it asks for
        CHECK_MESSAGE(ran.output.find(bad.second) != std::string::npos, ran.output);
        CHECK(ran.output.find("Vulkan device") == std::string::npos);
    }
    CHECK(fs::is_empty(folder.path));
    const std::string before = "cd '" + folder.path.string() + "' && PATH=/none GNOMON_DEVICE=none";
    CHECK(gnomonProgram("figure 4.6 --out x.png", before).output.find("gnuplot draws it") != std::string::npos);
    CHECK(gnomonProgram("tables nobody").exitCode > 1);
}

TEST_CASE("a full disk is a failure, whether it was to hold text or a picture")
{
    if (!fs::exists("/dev/full")) return;
    CHECK(gnomonProgram("--help > /dev/full").exitCode == 1);
    CHECK(gnomonProgram("reasons torus_grid --method pcf_hybrid --size 32x24 --out /dev/full").exitCode == 1);
}

TEST_CASE("the program says its version")
{
    CHECK(gnomonProgram("--version").output == "gnomon-theses " + std::to_string(GN_VERSION_MAJOR) + "." +
                                                   std::to_string(GN_VERSION_MINOR) + "." +
                                                   std::to_string(GN_VERSION_PATCH) + "\n");
}

} // namespace gnomon::demo
