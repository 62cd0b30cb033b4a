// Navratil's survey of maps around point lights: his numbers, and what ours draw. Times are not judged here.
#include <doctest/doctest.h>

#include "demo/theses/navratil_tables.hpp"
#include "device/fixture.hpp"

namespace gnomon::demo {

TEST_CASE("the printed tables have the means that the thesis draws from them, and ratios are of the right rows")
{
    Survey ours{};
    double value = 1.0;
    for (auto& scene : ours)
        for (auto& row : scene)
            for (SurveyTime& time : row)
                time = {.frameMs = value += 1.0, .shadowsMs = 10.0 * value, .parts = 2.0, .served = true};
    ours[0][5][2].served = false;
    const std::vector<PairTable> tables = navratilTables(ours, {});
    REQUIRE(tables.size() == 5);
    const PairTable& many = tables[2];
    CHECK(many.id == "frames3.2");
    // "6.54 % and 25.76 % on average", section 3.3.3: losses of larger maps against 1024, of table 3.2.
    for (const auto& [column, loss] : {std::pair{1, 6.54}, std::pair{2, 25.76}}) {
        double sum = 0.0;
        for (const PairTable::Row& row : many.rows)
            sum += 100.0 * (1.0 - *row.cells[size_t(column)].printed / *row.cells[0].printed);
        CHECK(sum / 6.0 == doctest::Approx(loss).epsilon(1e-3));
    }
    const PairTable& ratios = tables[1];
    CHECK(ratios.rows[0].names[0] == "EFC over Cube6");
    CHECK(*ratios.rows[0].cells[0].printed == doctest::Approx(188.71 / 75.71));
    CHECK(*ratios.rows[0].cells[0].ours == doctest::Approx(ours[0][0][0].frameMs / ours[0][2][0].frameMs));
    CHECK(*ratios.rows[0].cells[3].ours == doctest::Approx(ours[0][0][0].shadowsMs / ours[0][2][0].shadowsMs));
    CHECK(*ratios.rows[4].cells[1].printed == doctest::Approx(151.67 / 180.24));
    CHECK_FALSE(ratios.rows[4].cells[2].ours); // no memory: a dash
    CHECK_FALSE(tables[0].rows[5].cells[2].ours);
}

TEST_CASE("what is left out on the walk: no face or half without culling, some of them with it")
{
    const test::DeviceTest silence;
    const SurveyOptions small{.picture = 64, .pairs = 4, .share = 0.002, .maps = {64, 128, 256}, .measured = {}};
    const Survey survey = measureSurvey(test::device(), small);
    for (const auto& scene : survey) {
        for (size_t map = 0; map < small.maps.size(); ++map) {
            for (const size_t whole : {0u, 1u})
                CHECK(scene[whole][map].parts == 6.0);
            for (const size_t whole : {3u, 4u})
                CHECK(scene[whole][map].parts == 2.0);
            CHECK(scene[2][map].parts >= 1.0);
            CHECK(scene[2][map].parts <= 4.5); // not even the faces of the frames with the lamp in view are all drawn
            CHECK(scene[5][map].parts >= 1.0);
            CHECK(scene[5][map].parts <= 1.5);
            for (const auto& row : scene)
                CHECK(row[map].served);
        }
    }
}

TEST_CASE("lamps with everything in one hemisphere draw one paraboloid each, and several faces")
{
    const test::DeviceTest silence;
    const HemisphereTimes times = measureHemisphere(
        test::device(), {.picture = 64, .pairs = 3, .share = 0.05, .maps = {64, 64, 64}, .measured = {}});
    CHECK(times.lamps == 13);
    CHECK(times.cube.served);
    CHECK(times.paraboloid.served);
    CHECK(times.paraboloid.parts == times.lamps);
    CHECK(times.cube.parts >= 2.0 * times.lamps);
    CHECK(times.cube.parts <= 5.0 * times.lamps);
}

} // namespace gnomon::demo
