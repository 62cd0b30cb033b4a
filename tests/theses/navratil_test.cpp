// Navratil's survey of maps around point lights: his numbers, and what ours draw. Times are not judged here.
#include <algorithm>

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
    REQUIRE(tables.size() == 6);
    const PairTable& many = tables[2];
    CHECK(many.id == "frames3.2");
    // "6.54 % and 25.76 % on average", section 3.3.3: losses of larger maps against 1024, of table 3.2.
    for (const auto& [column, loss] : {std::pair{1, 6.54}, std::pair{2, 25.76}}) {
        double sum = 0.0;
        for (const PairTable::Row& row : many.rows)
            sum += 100.0 * (1.0 - *row.cells[size_t(column)].printed / *row.cells[0].printed);
        CHECK(sum / 6.0 == doctest::Approx(loss).epsilon(1e-3));
    }
    const PairTable& losses = tables[4];
    CHECK(*losses.rows[1].cells[0].printed == doctest::Approx(6.54).epsilon(1e-3));
    CHECK(*losses.rows[1].cells[1].printed == doctest::Approx(25.76).epsilon(1e-3));
    double own = 0.0;
    for (const auto& row : ours[1])
        own += 100.0 / 6.0 * (1.0 - row[0].frameMs / row[1].frameMs);
    CHECK(*losses.rows[1].cells[0].ours == doctest::Approx(own));
    CHECK(losses.rows[0].cells[0].ours);
    CHECK_FALSE(losses.rows[0].cells[1].ours); // one row had no memory for it
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

// The quotients are those that one works out by hand from the printed tables.
TEST_CASE("tables of warps have their printed ratios, and ours are of the same rows")
{
    WarpSurvey ours;
    double value = 1.0;
    const auto fill = [&](WarpTime& time) {
        value += 1.0;
        time = {.frameMs = value, .spread = 0.1 * value, .shadowsMs = 2.0 * value, .mapMs = 3.0 * value};
        time.analysisMs = 0.5 * value;
        time.lookupMs = 0.25 * value;
    };
    for (auto& scene : ours.scenes)
        std::ranges::for_each(scene, fill);
    std::ranges::for_each(ours.lamp, fill);
    const std::vector<PairTable> tables = navratilWarpTables(ours);
    REQUIRE(tables.size() == 6);
    const auto checkRatio = [&](const PairTable& table, size_t row, size_t column, double printed, double own) {
        CAPTURE(table.id);
        CAPTURE(table.rows[row].names[0]);
        const Pair& pair = table.rows[row].cells[column];
        REQUIRE(pair.ours);
        CHECK(*pair.ours == doctest::Approx(own));
        if (printed > 0.0)
            CHECK(*pair.printed == doctest::Approx(printed).epsilon(5e-3));
        else
            CHECK_FALSE(pair.printed);
    };
    const auto frame = [&](size_t scene, WarpRow row) { return ours.scenes[scene][size_t(row)].frameMs; };
    constexpr double kWarps[] = {1.156, 1.107, 1.070}, kVolumes[] = {2.66, 4.79, 4.63};
    for (size_t s = 0; s < 3; ++s) {
        const double warp = frame(s, WarpRow::nonorthogonal);
        checkRatio(tables[1], 0, s, kWarps[s], warp / frame(s, WarpRow::rectilinear));
        checkRatio(tables[1], 1, s, kVolumes[s], frame(s, WarpRow::volumes) / warp);
        checkRatio(tables[1], 3, s, 0.0, warp / frame(s, WarpRow::map));
        checkRatio(tables[1], 4, s, 0.0, frame(s, WarpRow::rectilinear) / frame(s, WarpRow::map));
        checkRatio(tables[1], 5, s, 0.0, warp / frame(s, WarpRow::volumes));
    }
    const auto lamp = [&](LampRow row) { return ours.lamp[size_t(row)].frameMs; };
    checkRatio(tables[3], 0, 0, 2.32, lamp(LampRow::warpedCube) / lamp(LampRow::cube));
    checkRatio(tables[3], 1, 0, 1.48, lamp(LampRow::warpedDiscs) / lamp(LampRow::discs));
    checkRatio(tables[3], 2, 0, 1.71, lamp(LampRow::warpedCube) / lamp(LampRow::warpedDiscs));
    checkRatio(tables[3], 4, 0, 1.11, lamp(LampRow::warpedDiscs) / lamp(LampRow::discs));
    checkRatio(tables[5], 0, 0, 1.065, frame(2, WarpRow::minimal) / frame(2, WarpRow::map));
    checkRatio(tables[5], 1, 0, 1.58, frame(2, WarpRow::desired) / frame(2, WarpRow::map));
    checkRatio(tables[5], 2, 0, 1.43, frame(2, WarpRow::nonorthogonal) / frame(2, WarpRow::rectilinear));
    checkRatio(tables[5], 4, 0, 0.15, frame(2, WarpRow::desired) / frame(2, WarpRow::nonorthogonal) / 6.0);
}

TEST_CASE("warps draw casters as often as plain maps do: their view is counted, not drawn")
{
    const test::DeviceTest silence;
    const WarpSurvey survey = measureWarps(test::device(), {.picture = 64, .map = 128, .pairs = 2, .measured = {}});
    for (const auto& rows : survey.scenes) {
        for (size_t row = 0; row < kWarpRows; ++row) {
            CAPTURE(std::string(nameOf(WarpRow(row))));
            CHECK(rows[row].mapDraws == (WarpRow(row) == WarpRow::volumes ? 0 : 1));
            CHECK(rows[row].frameMs > 0.0);
            CHECK((rows[row].lookupMs > 0.0) == (WarpRow(row) != WarpRow::volumes));
        }
        for (const WarpRow row : {WarpRow::desired, WarpRow::rectilinear, WarpRow::nonorthogonal}) {
            const WarpTime& time = rows[size_t(row)];
            CHECK(time.analysisMs > 0.0);
            CHECK(time.analysisMs < time.mapMs);
        }
    }
    const auto drawn = [&](LampRow row) { return survey.lamp[size_t(row)].mapDraws; };
    CHECK(drawn(LampRow::volumes) == 0);
    CHECK(drawn(LampRow::discs) == 2);
    CHECK(drawn(LampRow::warpedDiscs) == 2);
    CHECK(drawn(LampRow::cube) >= 4);
    CHECK(drawn(LampRow::cube) <= 6);
    CHECK(drawn(LampRow::warpedCube) == drawn(LampRow::cube));
}

} // namespace gnomon::demo
