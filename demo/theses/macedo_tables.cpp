#include "demo/theses/macedo_tables.hpp"

#include <string_view>

#include "demo/theses/macedo_printed.hpp"

namespace gnomon::demo {
namespace {

using namespace macedo;

constexpr uint32_t kMaps[] = {256, 512, 1024, 2048, 4096};
constexpr uint32_t kKernels[] = {7, 15, 23, 31};
constexpr Picture kThree[] = {Picture::p480, Picture::p720, Picture::p1080};

Scenery standInFor(std::string_view scene)
{
    if (scene == "YeahRight") return Scenery::fine;
    if (scene == "San Miguel" || scene == "Adam") return Scenery::trees;
    if (scene == "Fence" || scene == "QuadBot" || scene == "Robot" || scene == "Gate") return Scenery::lattice;
    return Scenery::figure;
}

/// Milliseconds of a cell: of its frame, or of passes.
struct Part {
    Cell cell;
    std::string_view passes; ///< Names separated by spaces, or "all"; empty: the frame.

    double of(const Measured& measured) const
    {
        if (passes.empty()) return measured.frameMs;
        double sum = 0.0;
        for (const auto& [name, ms] : measured.steps)
            if (passes == "all" || passes.find(name) != std::string_view::npos) sum += ms;
        return sum;
    }
};

/// Pairs of printed numbers and ours. Before anything is measured it notes what has to be.
class Pairs {
public:
    explicit Pairs(Times& wanted) : wanted_(&wanted) {}
    explicit Pairs(const Times& ours) : ours_(&ours) {}

    Pair frame(double printed, const Cell& cell, int decimals = 1)
    {
        const Measured* measured = find(cell);
        return {printed, measured ? std::optional(measured->frameMs) : std::nullopt, decimals};
    }
    Pair points(double printed, const Cell& cell)
    {
        const Measured* measured = find(cell);
        return {printed, measured ? std::optional(measured->points) : std::nullopt, 0};
    }
    /// By how many percent one frame is longer than another.
    Pair longer(double printed, double thanPrinted, const Cell& cell, const Cell& than)
    {
        const Measured *measured = find(cell), *base = find(than);
        const auto percent = [](double of, double over) { return 100.0 * (of / over - 1.0); };
        return {percent(printed, thanPrinted),
                measured && base ? std::optional(percent(measured->frameMs, base->frameMs)) : std::nullopt, 1};
    }
    /// @param passes what the step is in ours, names separated by spaces; empty: it is none of ours
    Pair step(double printed, const Cell& cell, std::string_view passes)
    {
        const Measured* measured = find(cell);
        if (!measured || passes.empty()) return {printed, std::nullopt, 1};
        return {printed, Part{cell, passes}.of(*measured), 1};
    }

    /// Milliseconds of one over those of another. \param asked of the ratio
    Pair ratio(double asked, const Part& part, const Part& over)
    {
        const Measured *measured = find(part.cell), *base = find(over.cell);
        const double below = base ? over.of(*base) : 0.0;
        return {asked, measured && below > 0.0 ? std::optional(part.of(*measured) / below) : std::nullopt, 2};
    }

private:
    /// Null: not measured, or not served.
    const Measured* find(const Cell& cell)
    {
        if (wanted_) {
            wanted_->try_emplace(cell);
            return nullptr;
        }
        const auto found = ours_->find(cell);
        return found != ours_->end() && found->second.served ? &found->second : nullptr;
    }

    Times* wanted_ = nullptr;
    const Times* ours_ = nullptr;
};

PairTable tableOf(const char* id, const std::string& text, std::vector<std::string> heads,
                  std::vector<std::string> columns)
{
    return {.id = id,
            .title = "**Table " + std::string(id) + "**, " + text,
            .heads = std::move(heads),
            .columns = std::move(columns),
            .rows = {}};
}

PairTable hardByMap(Pairs& pairs)
{
    PairTable table = tableOf("3.1",
                              "hard shadows, 1280 x 720: ms a frame by side of the map. Volumes, exact, have no map; "
                              "over maps they cost less here, since a processor fills as fast as it looks up.",
                              {"scene", "method"}, {"512", "1024", "2048", "4096"});
    for (const Hard& hard : kHard) {
        constexpr Row kRows[] = {Row::map, Row::conservative, Row::lines};
        for (size_t row = 0; row < 3; ++row) {
            PairTable::Row line{.names = {hard.scene, nameOf(kRows[row])}, .cells = {}};
            for (size_t m = 0; m < 4; ++m)
                line.cells.push_back(
                    pairs.frame(hard.byMap[row][m],
                                {.scenery = standInFor(hard.scene), .row = kRows[row], .map = kMaps[m + 1]}, 2));
            table.rows.push_back(line);
        }
        table.rows.push_back(
            {.names = {hard.scene, nameOf(Row::volume)},
             .cells = {pairs.frame(hard.volume[1], {.scenery = standInFor(hard.scene), .row = Row::volume}), Pair{},
                       Pair{}, Pair{}}});
    }
    return table;
}

PairTable hardByPicture(Pairs& pairs)
{
    PairTable table =
        tableOf("3.2",
                "hard shadows, maps of 1024: ms a frame by picture. Ours grow with the pixels, of which a "
                "graphics card hides most behind the geometry.",
                {"scene", "method"}, {"480p", "720p", "1080p"});
    for (const Hard& hard : kHard) {
        constexpr Row kRows[] = {Row::map, Row::conservative, Row::lines, Row::volume};
        for (size_t row = 0; row < 4; ++row) {
            PairTable::Row line{.names = {hard.scene, nameOf(kRows[row])}, .cells = {}};
            for (size_t p = 0; p < 3; ++p)
                line.cells.push_back(
                    pairs.frame(row < 3 ? hard.byPicture[row][p] : hard.volume[p],
                                {.scenery = standInFor(hard.scene), .picture = kThree[p], .row = kRows[row]}, 2));
            table.rows.push_back(line);
        }
    }
    return table;
}

PairTable engineByMap(Pairs& pairs)
{
    PairTable table =
        tableOf("3.3",
                "a game engine's frame, 1920 x 1080: percent that conservative lines add to a map, by its "
                "side. Our frame has little else in it, so that the share is that of the shadows.",
                {"scene"}, {"256", "512", "1024", "2048"});
    for (const Engine& engine : kEngine) {
        PairTable::Row line{.names = {engine.scene}, .cells = {}};
        for (size_t m = 0; m < 4; ++m) {
            Cell cell{.scenery = standInFor(engine.scene),
                      .picture = Picture::p1080,
                      .row = Row::conservative,
                      .map = kMaps[m]};
            Cell map = cell;
            map.row = Row::map;
            line.cells.push_back(pairs.longer(engine.byMap[1][m], engine.byMap[0][m], cell, map));
        }
        table.rows.push_back(line);
    }
    return table;
}

PairTable engineByPicture(Pairs& pairs)
{
    PairTable table =
        tableOf("3.4",
                "the same by picture, maps of 2048 (its caption says 1024, its numbers are those of 2048 in "
                "table 3.3). Here as there both methods are paid by the pixel, and so is the rest of ours.",
                {"scene"}, {"720p", "1080p", "2160p"});
    constexpr Picture kPictureOf[] = {Picture::p720, Picture::p1080, Picture::p2160};
    for (const Engine& engine : kEngine) {
        PairTable::Row line{.names = {engine.scene}, .cells = {}};
        for (size_t p = 0; p < 3; ++p) {
            Cell cell{
                .scenery = standInFor(engine.scene), .picture = kPictureOf[p], .row = Row::conservative, .map = 2048};
            Cell map = cell;
            map.row = Row::map;
            line.cells.push_back(pairs.longer(engine.byPicture[1][p], engine.byPicture[0][p], cell, map));
        }
        table.rows.push_back(line);
    }
    return table;
}

constexpr Row kFilteredRows[] = {Row::moments, Row::pcf, Row::distances, Row::rpcf};

/// A row a scene and method. cellOf(cell, column): changes it to that column's.
template <typename Printed, typename CellOf>
void addFiltered(PairTable& table, Pairs& pairs, const Printed& printed, const CellOf& cellOf)
{
    for (const Filtered& filtered : kFiltered)
        for (size_t row = 0; row < 4; ++row) {
            PairTable::Row line{.names = {filtered.scene, nameOf(kFilteredRows[row])}, .cells = {}};
            for (size_t column = 0; column < table.columns.size(); ++column) {
                Cell cell{.scenery = standInFor(filtered.scene), .row = kFilteredRows[row]};
                if (cellOf(cell, column))
                    line.cells.push_back(pairs.frame(printed(filtered)[row][column], cell));
                else
                    line.cells.push_back({printed(filtered)[row][column], std::nullopt, 1});
            }
            table.rows.push_back(line);
        }
}

PairTable filteredByMap(Pairs& pairs)
{
    PairTable table = tableOf("4.1",
                              "penumbrae of one width, 1280 x 720: ms a frame by side of the map. Moments are blurred "
                              "texel by texel and grow with the map as his do; ours end at 2048 texels.",
                              {"scene", "method"}, {"512", "1024", "2048", "4096"});
    addFiltered(
        table, pairs, [](const Filtered& f) { return f.byMap; },
        [](Cell& cell, size_t column) { return cell.map = kMaps[column + 1]; });
    return table;
}

PairTable filteredByPicture(Pairs& pairs)
{
    PairTable table = tableOf("4.2",
                              "the same, maps of 1024: ms a frame by picture. RPCF is nearer to PCF than his, since a "
                              "stair is followed once.",
                              {"scene", "method"}, {"480p", "720p", "1080p"});
    addFiltered(
        table, pairs, [](const Filtered& f) { return f.byPicture; },
        [](Cell& cell, size_t column) {
            cell.picture = kThree[column];
            return true;
        });
    return table;
}

PairTable filteredByKernel(Pairs& pairs)
{
    PairTable table =
        tableOf("4.3",
                "the same, 1280 x 720, maps of 1024: ms a frame by side of the kernel. PCF and RPCF end at "
                "15 here, and the mean of distances has 15 taps a row and column, whatever its width.",
                {"scene", "method"}, {"7", "15", "23", "31"});
    addFiltered(
        table, pairs, [](const Filtered& f) { return f.byKernel; },
        [](Cell& cell, size_t column) {
            if (cell.row == Row::distances) return column == 1;
            cell.kernel = kKernels[column];
            return true;
        });
    return table;
}

PairTable distanceSteps(Pairs& pairs)
{
    PairTable table = tableOf("4.4",
                              "steps of distances (EDTSM), maps of 1024: ms by picture. G-buffer and shading are the "
                              "host's.",
                              {"scene", "step"}, {"480p", "720p", "1080p"});
    constexpr std::string_view kPasses[] = {"",
                                            "depth_map.casters depth_map.statics depth_map.copy_statics",
                                            "distance.hard",
                                            "distance.seeds distance.columns distance.rows",
                                            "distance.ramp distance.mean_rows distance.mean_columns",
                                            "",
                                            "all"};
    for (size_t scene = 0; scene < kFiltered.size(); ++scene)
        for (size_t step = 0; step < kDistanceSteps.size(); ++step) {
            PairTable::Row line{.names = {kFiltered[scene].scene, kDistanceSteps[step].name}, .cells = {}};
            for (size_t p = 0; p < 3; ++p)
                line.cells.push_back(pairs.step(
                    kDistanceSteps[step].ms[scene][p],
                    {.scenery = standInFor(kFiltered[scene].scene), .picture = kThree[p], .row = Row::distances},
                    kPasses[step]));
            table.rows.push_back(line);
        }
    return table;
}

constexpr Row kAreaRows[] = {Row::uniform, Row::adaptive, Row::revectorized, Row::pcss};

PairTable areaByMap(Pairs& pairs)
{
    PairTable table =
        tableOf("6.1",
                "lights with a surface, 1280 x 720: ms a frame by side of the map, and points at 1024. Of "
                "points that are not needed a clear and an empty pass remain here, which his list has not.",
                {"scene", "method"}, {"512", "1024", "2048", "points"});
    for (const Area& area : kArea)
        for (size_t row = 0; row < 4; ++row) {
            PairTable::Row line{.names = {area.scene, nameOf(kAreaRows[row])}, .cells = {}};
            Cell cell{.scenery = standInFor(area.scene), .row = kAreaRows[row]};
            for (size_t m = 0; m < 3; ++m) {
                cell.map = kMaps[m + 1];
                line.cells.push_back(pairs.frame(area.byMap[row][m], cell));
            }
            cell.map = 1024;
            if (row == 0)
                line.cells.push_back({289.0, 289.0, 0});
            else
                line.cells.push_back(row < 3 ? pairs.points(area.samples[row], cell) : Pair{});
            table.rows.push_back(line);
        }
    return table;
}

PairTable areaByPicture(Pairs& pairs)
{
    PairTable table = tableOf("6.2",
                              "the same, maps of 1024: ms a frame by picture. Larger pictures show narrower steps, so "
                              "that both adaptive methods take more points, as his.",
                              {"scene", "method"}, {"480p", "720p", "1080p"});
    for (const Area& area : kArea)
        for (size_t row = 0; row < 4; ++row) {
            PairTable::Row line{.names = {area.scene, nameOf(kAreaRows[row])}, .cells = {}};
            for (size_t p = 0; p < 3; ++p)
                line.cells.push_back(
                    pairs.frame(area.byPicture[row][p],
                                {.scenery = standInFor(area.scene), .picture = kThree[p], .row = kAreaRows[row]}));
            table.rows.push_back(line);
        }
    return table;
}

/// cellOf(cell, column): changes it to that column's.
template <typename CellOf>
void addAreaSteps(PairTable& table, Pairs& pairs, const std::array<Step, 7>& printed, const CellOf& cellOf)
{
    constexpr std::string_view kPasses[] = {"",
                                            "area_quads.casters",
                                            "area_revectorized.look",
                                            "",
                                            "area_revectorized.test area_quads.divide",
                                            "area_revectorized.resolve",
                                            "all"};
    for (size_t scene = 0; scene < kArea.size(); ++scene)
        for (size_t step = 0; step < printed.size(); ++step) {
            PairTable::Row line{.names = {kArea[scene].scene, printed[step].name}, .cells = {}};
            for (size_t column = 0; column < 3; ++column) {
                Cell cell{.scenery = standInFor(kArea[scene].scene), .row = Row::revectorized};
                cellOf(cell, column);
                line.cells.push_back(pairs.step(printed[step].ms[scene][column], cell, kPasses[step]));
            }
            table.rows.push_back(line);
        }
}

PairTable areaStepsByMap(Pairs& pairs)
{
    PairTable table = tableOf("6.3",
                              "steps of revectorized sampling, 1280 x 720: ms by side of the map. A map is looked up "
                              "once, where discontinuities are found: both of his refinement passes read what is kept, "
                              "and the final one adds it up.",
                              {"scene", "step"}, {"512", "1024", "2048"});
    addAreaSteps(table, pairs, kAreaStepsByMap, [](Cell& cell, size_t column) { cell.map = kMaps[column + 1]; });
    return table;
}

PairTable areaStepsByPicture(Pairs& pairs)
{
    PairTable table = tableOf("6.4",
                              "the same, maps of 1024: ms by picture. Look-ups grow with pixels times points, as his "
                              "final rendering does.",
                              {"scene", "step"}, {"480p", "720p", "1080p"});
    addAreaSteps(table, pairs, kAreaStepsByPicture, [](Cell& cell, size_t column) { cell.picture = kThree[column]; });
    return table;
}

/// Lines of docs/macedo.md that times decide.
PairTable criteria(Pairs& pairs)
{
    PairTable table{.id = "lines",
                    .title =
                        "**Lines of docs/macedo.md** that times decide, 1280 x 720: what is asked of the ratio (at "
                        "most; of summed tables and of A7 at least), and ours.",
                    .heads = {"line", "what", "over"},
                    .columns = {"simple bodies", "fine detail"},
                    .rows = {}};
    const auto add = [&](const char* line, const char* what, const char* over, double asked, Part part, Part base) {
        PairTable::Row row{.names = {line, what, over}, .cells = {}};
        for (const Scenery scenery : {Scenery::figure, Scenery::fine}) {
            part.cell.scenery = base.cell.scenery = scenery;
            row.cells.push_back(pairs.ratio(asked, part, base));
        }
        table.rows.push_back(row);
    };
    const auto frame = [](Row row, uint32_t map = 1024) { return Part{{.row = row, .map = map}, {}}; };
    const auto passes = [](Row row, uint32_t map, std::string_view names) {
        return Part{{.row = row, .map = map}, names};
    };
    constexpr std::string_view kDistances = "distance.hard distance.seeds distance.columns distance.rows distance.ramp "
                                            "distance.mean_rows distance.mean_columns",
                               kTables = "moments_soft.rows moments_soft.columns";
    add("H9", "a frame with lines", "with a map", 1.32, frame(Row::lines), frame(Row::map));
    add("F11", "passes of distances, map of 4096", "of 512", 1.1, passes(Row::distances, 4096, kDistances),
        passes(Row::distances, 512, kDistances));
    add("V5", "a frame with SSRBSSM", "with EDTSSM", 1.0, frame(Row::screenLines), frame(Row::softDistances));
    add("V5", "a frame with SSRBSSM", "with RBSSM", 1.0, frame(Row::screenLines), frame(Row::softLines));
    add("V6", "summed tables of 2048", "of 1024", 3.0, passes(Row::tables, 2048, kTables),
        passes(Row::tables, 1024, kTables));
    add("V6", "a frame with PCSS, map of 2048", "of 1024", 1.3, frame(Row::pcss, 2048), frame(Row::pcss));
    add("A7", "maps of revectorized points", "all passes", 0.4, passes(Row::revectorized, 1024, "area_quads.casters"),
        passes(Row::revectorized, 1024, "all"));
    return table;
}

std::vector<PairTable> tablesOf(Pairs pairs)
{
    return {hardByMap(pairs),     hardByPicture(pairs),     engineByMap(pairs),      engineByPicture(pairs),
            filteredByMap(pairs), filteredByPicture(pairs), filteredByKernel(pairs), distanceSteps(pairs),
            areaByMap(pairs),     areaByPicture(pairs),     areaStepsByMap(pairs),   areaStepsByPicture(pairs),
            criteria(pairs)};
}

} // namespace

macedo::Times macedoCells()
{
    Times cells;
    tablesOf(Pairs(cells));
    return cells;
}

std::vector<PairTable> macedoTables(const macedo::Times& ours)
{
    return tablesOf(Pairs(ours));
}

} // namespace gnomon::demo
