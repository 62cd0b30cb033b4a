#include "demo/theses/navratil_tables.hpp"

namespace gnomon::demo {
namespace {

// J. Navratil, "High-Quality Shadow Rendering from Complex Light Sources", Brno University of Technology, 2015: frames
// a second by scene (table 3.1: 600 000 vertices, 3.2: 3 000 000), row and map.
constexpr double kPrinted[2][kSurveyMethods][3] = {{{75.71, 70.04, 47.9},
                                                    {150.43, 116.76, 64.04},
                                                    {188.71, 151.67, 89.68},
                                                    {167.95, 146.62, 97.52},
                                                    {207.24, 178.67, 109.4},
                                                    {208.15, 180.24, 110.95}},
                                                   {{19.11, 18.38, 16.21},
                                                    {57.15, 51.23, 36.50},
                                                    {127.47, 114.21, 83.38},
                                                    {41.50, 39.74, 33.17},
                                                    {57.47, 54.32, 42.85},
                                                    {90.56, 86.08, 69.58}}};
constexpr const char* kTables[2] = {"3.1", "3.2"};
constexpr const char* kScenes[2] = {"600 000 vertices", "3 000 000 vertices"};

using Rows = std::array<std::array<SurveyTime, kSurveyMaps.size()>, kSurveyMethods>;

std::optional<double> framesASecond(const SurveyTime& time)
{
    return time.served && time.frameMs > 0.0 ? std::optional(1000.0 / time.frameMs) : std::nullopt;
}

PairTable frames(size_t scene, const Rows& ours)
{
    PairTable table{.id = "frames" + std::string(kTables[scene]),
                    .title = "**Table " + std::string(kTables[scene]) + "**, " + kScenes[scene] +
                             ": frames a second by side of the maps, and faces or paraboloids drawn in a frame (mean).",
                    .heads = {"method"},
                    .columns = {"1024", "2048", "4096", "drawn"},
                    .rows = {}};
    for (size_t row = 0; row < kSurveyMethods; ++row) {
        PairTable::Row cells{.names = {kSurvey[row].printed}, .cells = {}};
        for (size_t map = 0; map < kSurveyMaps.size(); ++map)
            cells.cells.push_back({kPrinted[scene][row][map], framesASecond(ours[row][map]), 2});
        cells.cells.push_back({std::nullopt, ours[row][0].parts, 2});
        table.rows.push_back(cells);
    }
    return table;
}

/// Times do not travel, ratios may.
PairTable ratios(size_t scene, const Rows& ours)
{
    struct Ratio {
        const char* name;
        const char* asked;
        size_t over, under;
    };
    const Ratio kRatios[] = {{"EFC over Cube6", "1.8", 2, 0},
                             {"Cube6Optim over Cube6", "", 1, 0},
                             {"PC over DP", "1.1", 5, 3},
                             {"DP over Cube6", "1.8", 3, 0},
                             {"EFC over PC", scene == 0 ? "below 1" : "1", 2, 5}};
    PairTable table{.id = "ratios" + std::string(kTables[scene]),
                    .title =
                        "**Ratios of table " + std::string(kTables[scene]) + "**: frames a second of the whole " +
                        "frame, and, ours alone, milliseconds of the shadows, the other way round. Half of our frame " +
                        "is the picture without shadows, so the columns of the shadows are what compares.",
                    .heads = {"ratio", "asked"},
                    .columns = {"1024", "2048", "4096", "shadows, 1024", "shadows, 2048", "shadows, 4096"},
                    .rows = {}};
    for (const Ratio& ratio : kRatios) {
        PairTable::Row cells{.names = {ratio.name, ratio.asked}, .cells = {}};
        for (size_t map = 0; map < kSurveyMaps.size(); ++map) {
            const auto over = framesASecond(ours[ratio.over][map]), under = framesASecond(ours[ratio.under][map]);
            cells.cells.push_back({kPrinted[scene][ratio.over][map] / kPrinted[scene][ratio.under][map],
                                   over && under ? std::optional(*over / *under) : std::nullopt, 2});
        }
        for (size_t map = 0; map < kSurveyMaps.size(); ++map) {
            const SurveyTime &over = ours[ratio.over][map], &under = ours[ratio.under][map];
            const bool known = over.served && under.served && over.shadowsMs > 0.0;
            cells.cells.push_back(
                {std::nullopt, known ? std::optional(under.shadowsMs / over.shadowsMs) : std::nullopt, 2});
        }
        table.rows.push_back(cells);
    }
    return table;
}

/// Section 3.3.3: "6.54 % and 25.76 % on average", which are the means of table 3.2.
PairTable losses(const Survey& ours)
{
    PairTable table{.id = "losses",
                    .title =
                        "**Larger maps**: per cent of the frames a second that are lost against maps of 1024, mean "
                        "of the six rows. A software rasteriser is bound by texels, his GPU by vertices.",
                    .heads = {"table", "asked"},
                    .columns = {"2048", "4096"},
                    .rows = {}};
    for (size_t scene = 0; scene < ours.size(); ++scene) {
        PairTable::Row cells{.names = {kTables[scene], "at most 25, 65"}, .cells = {}};
        for (size_t map = 1; map < kSurveyMaps.size(); ++map) {
            double printed = 0.0, own = 0.0;
            bool known = true;
            for (size_t row = 0; row < kSurveyMethods; ++row) {
                printed += 1.0 - kPrinted[scene][row][map] / kPrinted[scene][row][0];
                const auto large = framesASecond(ours[scene][row][map]), small = framesASecond(ours[scene][row][0]);
                known = known && large && small;
                if (known) own += 1.0 - *large / *small;
            }
            const double percent = 100.0 / kSurveyMethods;
            cells.cells.push_back({percent * printed, known ? std::optional(percent * own) : std::nullopt, 2});
        }
        table.rows.push_back(cells);
    }
    return table;
}

/// Figure 3.21 has curves; the text says about twice.
PairTable oneHemisphere(const HemisphereTimes& ours)
{
    const bool known = ours.cube.served && ours.paraboloid.served && ours.paraboloid.shadowsMs > 0.0;
    const auto times = [](const SurveyTime& time) {
        return std::vector<Pair>{{std::nullopt, time.served ? std::optional(time.shadowsMs) : std::nullopt, 1},
                                 {std::nullopt, time.parts, 1}};
    };
    PairTable table{
        .id = "hemisphere",
        .title = "**All in one hemisphere** (figure 3.21), " + std::to_string(ours.lamps) + " lamps over " +
                 std::to_string(ours.vertices) + " vertices: milliseconds of the shadows, and parts drawn. As many " +
                 "casters lie in one paraboloid as in five faces: what is saved is clears, and casters in two faces.",
        .heads = {"method", "asked"},
        .columns = {"ms", "drawn"},
        .rows = {}};
    table.rows.push_back({.names = {kSurvey[2].printed, ""}, .cells = times(ours.cube)});
    table.rows.push_back({.names = {kSurvey[5].printed, ""}, .cells = times(ours.paraboloid)});
    table.rows.push_back(
        {.names = {"cube over paraboloid", "1.5"},
         .cells = {{2.0, known ? std::optional(ours.cube.shadowsMs / ours.paraboloid.shadowsMs) : std::nullopt, 2},
                   {std::nullopt, std::nullopt, 0}}});
    return table;
}

} // namespace

std::vector<PairTable> navratilTables(const Survey& ours, const HemisphereTimes& hemisphere)
{
    std::vector<PairTable> tables;
    for (size_t scene = 0; scene < ours.size(); ++scene) {
        tables.push_back(frames(scene, ours[scene]));
        tables.push_back(ratios(scene, ours[scene]));
    }
    tables.push_back(losses(ours));
    tables.push_back(oneHemisphere(hemisphere));
    return tables;
}

} // namespace gnomon::demo
