#include "demo/theses/navratil_tables.hpp"

namespace gnomon::demo {
namespace {

// J. Navratil, "High-Quality Shadow Rendering from Complex Light Sources", Brno University of Technology, 2015.
// Table 5.1, milliseconds by row and scene; the G-buffer stands by itself there.
constexpr double kTriangles[3] = {126'665, 261'978, 52'583};
constexpr double kPicture[3] = {2.16, 2.229, 1.84};
struct SceneRow {
    WarpRow row;
    double printed[3];
};
constexpr SceneRow kScenes51[] = {{WarpRow::volumes, {9.64, 18.41, 14.96}},
                                  {WarpRow::map, {0.21, 0.40, 0.16}},
                                  {WarpRow::rectilinear, {3.14, 3.47, 3.02}},
                                  {WarpRow::nonorthogonal, {3.63, 3.84, 3.23}}};
// Table 5.2, milliseconds of the frame, of making the maps and of looking them up.
constexpr double kLamp52[kLampRows][3] = {
    {4.8, 0.0, 0.0}, {2.5, 0.38, 0.10}, {2.3, 0.16, 0.09}, {5.8, 3.6, 0.11}, {3.4, 1.2, 0.10}};
// Table 5.3, milliseconds of the frame, by WarpRow.
constexpr double kFrame53[kWarpRows] = {8.750, 1.596, 1.7, 2.521, 3.296, 4.708};

constexpr size_t kScene53 = 2; // the observatory's stand-in

PairTable::Row ratioRow(const char* name, const char* asked, std::optional<double> printed, double over, double under)
{
    return {.names = {name, asked},
            .cells = {{printed, under > 0.0 && over >= 0.0 ? std::optional(over / under) : std::nullopt, 2}}};
}

PairTable scenes(const WarpSurvey& ours)
{
    PairTable table{.id = "scenes5.1",
                    .title = "**Table 5.1**, milliseconds of shadows by scene; ours are the least frame less the least "
                             "without shadows. His scenes are not to be had. A GPU waits for little of a warped map; "
                             "a software device runs a shader for every texel that a triangle may touch.",
                    .heads = {"method"},
                    .columns = {"Conference / room", "Sponza / colonnade", "Observatory / bunny"},
                    .rows = {{{"triangles"}, {}}, {{"G-buffer / picture"}, {}}}};
    for (size_t s = 0; s < kWarpScenes.size(); ++s) {
        table.rows[0].cells.push_back({kTriangles[s], double(ours.triangles[s]), 0});
        table.rows[1].cells.push_back({kPicture[s], ours.pictureMs[s], 2});
    }
    for (const SceneRow& row : kScenes51) {
        table.rows.push_back({.names = {nameOf(row.row)}, .cells = {}});
        for (size_t s = 0; s < kWarpScenes.size(); ++s)
            table.rows.back().cells.push_back({row.printed[s], ours.scenes[s][size_t(row.row)].shadowsMs, 2});
    }
    return table;
}

PairTable sceneRatios(const WarpSurvey& ours)
{
    struct Ratio {
        const char* name;
        const char* asked;
        size_t over, under; // of kScenes51
    };
    constexpr Ratio kRatios[] = {
        {"NoTW over RTW", "at most 1.45", 3, 2}, {"SV over NoTW", "2", 0, 3}, {"NoTW over SM", "", 3, 1}};
    PairTable table{
        .id = "ratios5.1",
        .title = "**Ratios of table 5.1**, of the passes that look maps up, and of how much single frames differ. "
                 "Our look-up of NoTW searches the functions of two rows and two columns, where he reads "
                 "an offset of each; and volumes of so few triangles take less than our warps do.",
        .heads = {"ratio", "asked"},
        .columns = {"Conference / room", "Sponza / colonnade", "Observatory / bunny"},
        .rows = {}};
    for (const Ratio& ratio : kRatios) {
        const SceneRow &over = kScenes51[ratio.over], &under = kScenes51[ratio.under];
        PairTable::Row cells{.names = {ratio.name, ratio.asked}, .cells = {}};
        for (size_t s = 0; s < kWarpScenes.size(); ++s) {
            const double own = ours.scenes[s][size_t(under.row)].shadowsMs;
            cells.cells.push_back(
                {over.printed[s] / under.printed[s],
                 own > 0.0 ? std::optional(ours.scenes[s][size_t(over.row)].shadowsMs / own) : std::nullopt, 2});
        }
        table.rows.push_back(cells);
    }
    PairTable::Row lookup{.names = {"look-up, NoTW over SM", "at most 1.3"}, .cells = {}},
        columns{.names = {"look-up, RTW over SM", "at most 1.3"}, .cells = {}},
        spread{.names = {"spread of frames, NoTW over SV", "below 1"}, .cells = {}};
    for (const auto& rows : ours.scenes) {
        const WarpTime &volumes = rows[size_t(WarpRow::volumes)], &map = rows[size_t(WarpRow::map)],
                       &warp = rows[size_t(WarpRow::nonorthogonal)];
        const auto overMap = [&](const WarpTime& time) {
            return Pair{std::nullopt, map.lookupMs > 0.0 ? std::optional(time.lookupMs / map.lookupMs) : std::nullopt,
                        2};
        };
        lookup.cells.push_back(overMap(warp));
        columns.cells.push_back(overMap(rows[size_t(WarpRow::rectilinear)]));
        spread.cells.push_back(
            {std::nullopt, volumes.spread > 0.0 ? std::optional(warp.spread / volumes.spread) : std::nullopt, 2});
    }
    table.rows.push_back(lookup);
    table.rows.push_back(columns);
    table.rows.push_back(spread);
    return table;
}

PairTable lamp(const WarpSurvey& ours)
{
    PairTable table{.id = "lamp5.2",
                    .title =
                        "**Table 5.2**, a lamp in view: milliseconds of the frame, of the passes that make the maps "
                        "and of those that look them up; maps that casters are drawn into; and by how much the "
                        "95th of 100 frames is longer than the median. Most of our frame is the picture without "
                        "shadows, but of warped maps.",
                    .heads = {"method"},
                    .columns = {"frame", "maps", "look-up", "drawn", "spread, %"},
                    .rows = {}};
    for (size_t i = 0; i < kLampRows; ++i) {
        const WarpTime& time = ours.lamp[i];
        const bool map = LampRow(i) != LampRow::volumes;
        const auto stage = [&](double printed, double own) {
            return map ? Pair{printed, own, 2} : Pair{std::nullopt, std::nullopt, 2};
        };
        table.rows.push_back({.names = {nameOf(LampRow(i))},
                              .cells = {{kLamp52[i][0], time.frameMs, 1},
                                        stage(kLamp52[i][1], time.mapMs),
                                        stage(kLamp52[i][2], time.lookupMs),
                                        {std::nullopt, double(time.mapDraws), 0},
                                        {std::nullopt, 100.0 * time.spread, 0}}});
    }
    return table;
}

PairTable lampRatios(const WarpSurvey& ours)
{
    const auto at = [](LampRow row) { return size_t(row); };
    const size_t cube = at(LampRow::cube), discs = at(LampRow::discs), warpedCube = at(LampRow::warpedCube),
                 warpedDiscs = at(LampRow::warpedDiscs);
    PairTable table{.id = "ratios5.2",
                    .title = "**Ratios of table 5.2**. On paraboloids edges of triangles are circles, which cost our "
                             "exact rasteriser more than the four maps that are saved.",
                    .heads = {"ratio", "asked"},
                    .columns = {"times"},
                    .rows = {}};
    const auto add = [&](const char* name, const char* asked, size_t over, size_t under, bool lookup) {
        const size_t column = lookup ? 2 : 0;
        const auto own = [&](size_t i) { return lookup ? ours.lamp[i].lookupMs : ours.lamp[i].frameMs; };
        table.rows.push_back(
            ratioRow(name, asked, kLamp52[over][column] / kLamp52[under][column], own(over), own(under)));
    };
    add("frame, CubeSM warped over plain", "at most 3", warpedCube, cube, false);
    add("frame, DPSM warped over plain", "at most 2", warpedDiscs, discs, false);
    add("frame, warped CubeSM over warped DPSM", "1", warpedCube, warpedDiscs, false);
    add("look-up, CubeSM warped over plain", "at most 1.3", warpedCube, cube, true);
    add("look-up, DPSM warped over plain", "at most 1.3", warpedDiscs, discs, true);
    return table;
}

PairTable crops(const WarpSurvey& ours)
{
    PairTable table{.id = "frames5.3",
                    .title =
                        "**Table 5.3**, milliseconds of a frame (scene not named; ours bunny, whose picture without "
                        "shadows is most of it), and, ours alone, of its shadows.",
                    .heads = {"method"},
                    .columns = {"frame", "shadows"},
                    .rows = {}};
    for (size_t i = 0; i < kWarpRows; ++i) {
        const WarpTime& time = ours.scenes[kScene53][i];
        table.rows.push_back({.names = {nameOf(WarpRow(i))},
                              .cells = {{kFrame53[i], time.frameMs, 2}, {std::nullopt, time.shadowsMs, 2}}});
    }
    return table;
}

PairTable cropRatios(const WarpSurvey& ours)
{
    const auto& rows = ours.scenes[kScene53];
    PairTable table{.id = "ratios5.3",
                    .title = "**Ratios of table 5.3**, of whole frames, and what finding the desired view takes of all "
                             "that a warp's map takes (figure 5.6).",
                    .heads = {"ratio", "asked"},
                    .columns = {"times"},
                    .rows = {}};
    const auto add = [&](const char* name, const char* asked, WarpRow over, WarpRow under) {
        table.rows.push_back(ratioRow(name, asked, kFrame53[size_t(over)] / kFrame53[size_t(under)],
                                      rows[size_t(over)].frameMs, rows[size_t(under)].frameMs));
    };
    add("MIN-SM over SM", "at most 1.15", WarpRow::minimal, WarpRow::map);
    add("NoTW-DV over SM", "at most 1.8", WarpRow::desired, WarpRow::map);
    add("NoTW over RTW", "at most 1.45", WarpRow::nonorthogonal, WarpRow::rectilinear);
    add("SV over NoTW", "", WarpRow::volumes, WarpRow::nonorthogonal);
    table.rows.push_back(ratioRow("desired view over NoTW's map", "at most 0.25", 0.15,
                                  rows[size_t(WarpRow::desired)].analysisMs,
                                  rows[size_t(WarpRow::nonorthogonal)].mapMs));
    return table;
}

} // namespace

std::vector<PairTable> navratilWarpTables(const WarpSurvey& ours)
{
    return {scenes(ours), sceneRatios(ours), lamp(ours), lampRatios(ours), crops(ours), cropRatios(ours)};
}

} // namespace gnomon::demo
