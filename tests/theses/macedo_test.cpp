// Macedo's tables: his numbers, and what ours measure. Times are not judged here.
#include <doctest/doctest.h>

#include <algorithm>

#include "demo/theses/macedo_printed.hpp"
#include "demo/theses/macedo_tables.hpp"
#include "device/fixture.hpp"

namespace gnomon::demo {

using namespace macedo;

namespace {

const PairTable& tableOf(const std::vector<PairTable>& tables, const std::string& id)
{
    const auto found = std::ranges::find(tables, id, &PairTable::id);
    REQUIRE(found != tables.end());
    return *found;
}

} // namespace

TEST_CASE("the printed tables have the overheads and ratios that the thesis draws from them")
{
    // "About 1.2 % on average" (3.3.3): 1.26 over all cells of both tables, 3.89 at most.
    double sum = 0.0, most = 0.0;
    const std::vector<PairTable> tables = macedoTables({});
    REQUIRE(tables.size() == 13);
    int cells = 0;
    for (const char* id : {"3.3", "3.4"})
        for (const PairTable::Row& row : tableOf(tables, id).rows)
            for (const Pair& cell : row.cells) {
                sum += *cell.printed;
                most = std::max(most, *cell.printed);
                ++cells;
                CHECK_FALSE(cell.ours);
            }
    CHECK(cells == 49);
    CHECK(sum / cells == doctest::Approx(1.26).epsilon(0.01));
    CHECK(most == doctest::Approx(3.89).epsilon(0.01));
    for (const Area& area : kArea) { // "4 to 11 times", "2 to 4 times" (6.2)
        CHECK(area.samples[0] >= 4.5 * area.samples[2]);
        CHECK(area.samples[1] >= 1.8 * area.samples[2]);
        CHECK(area.byMap[2][1] == area.byPicture[2][1]); // both of 1280 x 720 and maps of 1024
    }
    const auto sumsUp = [](const std::array<Step, 7>& steps) {
        for (size_t scene = 0; scene < 3; ++scene)
            for (size_t column = 0; column < 3; ++column) {
                double parts = 0.0;
                for (size_t step = 0; step + 1 < steps.size(); ++step)
                    parts += steps[step].ms[scene][column];
                CHECK(parts == doctest::Approx(steps.back().ms[scene][column]).epsilon(0.06));
            }
    };
    sumsUp(kDistanceSteps);
    sumsUp(kAreaStepsByMap);
    sumsUp(kAreaStepsByPicture);
}

TEST_CASE("each number of ours stands where its method, map and picture are")
{
    Times times = macedoCells();
    for (auto& [cell, measured] : times) {
        measured = {.served = cell.kernel < 23, .frameMs = 1.0 + double(cell.map), .points = 40.0, .steps = {}};
        if (cell.row == Row::conservative) measured.frameMs *= 1.25;
        if (cell.row == Row::revectorized)
            measured.steps = {{"area_quads.casters", 5.0}, {"area_revectorized.look", 3.0}};
        if (cell.row == Row::distances)
            measured.steps = {{"depth_map.casters", double(cell.map)}, {"distance.rows", 4.0}};
        if (cell.row == Row::tables) measured.steps = {{"moments_soft.rows", double(cell.map)}, {"shared", 7.0}};
    }
    const std::vector<PairTable> tables = macedoTables(times);
    const PairTable& hard = tableOf(tables, "3.1");
    CHECK(*hard.rows[0].cells[3].ours == 4097.0);
    CHECK(*hard.rows[0].cells[3].printed == 3.68);
    for (const PairTable::Row& row : tableOf(tables, "3.4").rows)
        for (const Pair& cell : row.cells)
            CHECK(*cell.ours == doctest::Approx(25.0));
    const PairTable& kernels = tableOf(tables, "4.3");
    CHECK(kernels.rows[1].names[1] == "PCF");
    CHECK(kernels.rows[1].cells[1].ours);
    CHECK_FALSE(kernels.rows[1].cells[2].ours); // not served: a dash
    const PairTable& steps = tableOf(tables, "6.3");
    CHECK(*steps.rows[1].cells[0].ours == 5.0);
    CHECK(*steps.rows[2].cells[0].ours == 3.0);
    CHECK(*steps.rows[6].cells[0].ours == 8.0);
    CHECK(*tableOf(tables, "6.1").rows[2].cells[3].printed == 25.0);
    CHECK(*tableOf(tables, "6.1").rows[2].cells[3].ours == 40.0);
    const auto line = [&](const std::string& name, size_t which = 0) {
        for (const PairTable::Row& row : tableOf(tables, "lines").rows)
            if (row.names[0] == name && which-- == 0) return row.cells[0];
        FAIL(name);
        return Pair{};
    };
    CHECK(*line("H9").ours == 1.0);
    CHECK(*line("F11").ours == 1.0); // the map is left out
    CHECK(*line("V6").ours == 2.0);  // tables alone
    CHECK(*line("V6", 1).ours == doctest::Approx(2049.0 / 1025.0));
    CHECK(*line("A7").ours == doctest::Approx(5.0 / 8.0));
    CHECK(*line("A7").printed == 0.4);
}

TEST_CASE("methods with ramps draw fewer points, steps are the passes' time, and a missing kernel is not served")
{
    const test::DeviceTest silence;
    const Cell adaptive{.scenery = Scenery::lattice, .row = Row::adaptive, .map = 1024},
        ramps{.scenery = Scenery::lattice, .row = Row::revectorized, .map = 1024},
        distances{.scenery = Scenery::lattice, .row = Row::distances, .map = 1024},
        kernel{.scenery = Scenery::lattice, .row = Row::rpcf, .map = 1024, .kernel = 31};
    Times wanted;
    for (const Cell& cell : {adaptive, ramps, distances, kernel})
        wanted.try_emplace(cell);
    const Times times = measure(test::device(), wanted, {.share = 0.125, .frames = 3, .measured = {}});
    for (const Cell& cell : {adaptive, ramps, distances}) {
        CHECK(times.at(cell).served);
        CHECK(times.at(cell).frameMs > 0.0);
    }
    CHECK_FALSE(times.at(kernel).served);
    CHECK(times.at(adaptive).points >= 4.0);
    CHECK(times.at(ramps).points >= 4.0);
    CHECK(times.at(ramps).points <= times.at(adaptive).points);
    for (const char* pass : {"area_quads.casters", "area_revectorized.look", "area_revectorized.resolve"})
        CHECK(times.at(ramps).steps.at(pass) > 0.0);
    for (const char* pass : {"depth_map.casters", "distance.hard", "distance.rows", "distance.mean_rows"})
        CHECK(times.at(distances).steps.contains(pass));
}

} // namespace gnomon::demo
