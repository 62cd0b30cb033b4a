#include "demo/theses/morais_tables.hpp"

#include <algorithm>
#include <string_view>

#include "demo/theses/morais_printed.hpp"

namespace gnomon::demo {
namespace {

using Views = std::span<const MapView>;
constexpr MapMethod kThesis[] = {MapMethod::pcf, MapMethod::crsm, MapMethod::crsma};
constexpr MapMethod kOurs[] = {MapMethod::guaranteed, MapMethod::sheets};

/// Null: not printed (of Sponza there is one view).
const PrintedMapView* printedOf(const char* scene, Look look)
{
    const auto all = printedMapViews();
    const auto found = std::ranges::find_if(
        all, [&](const PrintedMapView& view) { return std::string_view(view.scene) == scene && view.look == look; });
    return found == all.end() ? nullptr : &*found;
}

std::optional<double> share(const PrintedMapView* printed, uint64_t part)
{
    if (!printed) return std::nullopt;
    return percentOf(part, printed->facing);
}

template <typename Fill>
void forEachView(PairTable& table, uint32_t map, Views ours, Fill&& fill)
{
    for (const CensusScene& scene : kCensusScenes)
        for (const Look look : kLooks) {
            PairTable::Row row{.names = {scene.printed, nameOf(look)}, .cells = {}};
            fill(row, printedOf(scene.printed, look), viewOf(ours, scene.printed, look, map));
            table.rows.push_back(row);
        }
}

/// Tables 7 to 12 and 35 to 58.
PairTable plainMaps(Views ours)
{
    PairTable table{.id = "plain",
                    .title = "**The plain map**, wrong of light-facing pixels in percent (tables 11, 12, 37 to 58).",
                    .heads = {"scene", "view"},
                    .columns = {"512", "1024", "2048", "4096", "512 over 4096"},
                    .rows = {}};
    forEachView(table, kMiddleMap, ours, [&](PairTable::Row& row, const PrintedMapView* p, const MapView& view) {
        for (size_t i = 0; i < std::size(kCensusMaps); ++i) {
            const MapView& o = viewOf(ours, view.scene, view.look, kCensusMaps[i]);
            row.cells.push_back(
                {share(p, p ? p->plain[i][0] + p->plain[i][1] : 0), percentOf(o.plainWrong(), o.facing), 2});
        }
        const Pair first = row.cells.front(), last = row.cells.back();
        const std::optional<double> printed = p ? std::optional(*first.printed / *last.printed) : std::nullopt;
        row.cells.push_back({printed, *first.ours / *last.ours, 1});
    });
    return table;
}

/// Tables 14, 15 and 59 to 66.
PairTable certain(Views ours)
{
    PairTable table{.id = "certain",
                    .title =
                        "**At 1024 texels**, percent of the light-facing pixels: certainly lit, certainly dark, traced "
                        "(tables 14, 15, 59 to 66).",
                    .heads = {"scene", "view"},
                    .columns = {},
                    .rows = {}};
    for (const MapMethod method : kThesis)
        for (const char* what : {" lit", " dark", " traced"})
            table.columns.push_back(nameOf(method) + std::string(what));
    table.columns.insert(table.columns.end(), {"CRSM, of the dark traced", "CRSMA, of the dark traced"});
    forEachView(table, kMiddleMap, ours, [&](PairTable::Row& row, const PrintedMapView* p, const MapView& o) {
        for (const MapMethod method : kThesis) {
            const uint32_t* c = p ? p->certain[size_t(method)] : nullptr;
            const CertainCounts& mine = o.of(method);
            row.cells.push_back({share(p, c ? c[0] : 0), percentOf(mine.lit, o.facing), 1});
            row.cells.push_back({share(p, c ? c[3] : 0), percentOf(mine.dark, o.facing), 1});
            row.cells.push_back({share(p, c ? c[1] + c[4] : 0), tracedPercent(o, method), 1});
        }
        for (const MapMethod method : {MapMethod::crsm, MapMethod::crsma}) {
            const uint32_t* c = p ? p->certain[size_t(method)] : nullptr;
            const std::optional<double> printed = c ? std::optional(percentOf(c[4], c[3] + c[4])) : std::nullopt;
            row.cells.push_back({printed, percentOf(o.of(method).tracedDark, o.dark), 1});
        }
    });
    return table;
}

/// Tables 17, 18 and 75 to 82: his counts of CRSM and CRSMA at 512 texels contradict his other tables and are left out.
PairTable sweep(Views ours)
{
    PairTable table{
        .id = "sweep",
        .title = "**By map**, traced of light-facing pixels in percent, mean over a scene's views (tables 17, 18, "
                 "75 to 82; of CRSM and CRSMA at 512 texels they contradict tables 22, 85 and 92 and are left "
                 "out). The last two are ours, never wrong.",
        .heads = {"scene", "map"},
        .columns = {"PCF", "CRSM", "CRSMA", "CRSMA over CRSM", "guaranteed", "sheets"},
        .rows = {}};
    for (const CensusScene& scene : kCensusScenes)
        for (size_t i = 0; i < std::size(kCensusMaps); ++i) {
            PairTable::Row row{.names = {scene.printed, std::to_string(kCensusMaps[i])}, .cells = {}};
            for (const MapMethod method : kThesis) {
                double theirs = 0.0, mine = 0.0;
                int printed = 0;
                for (const Look look : kLooks) {
                    mine += tracedPercent(viewOf(ours, scene.printed, look, kCensusMaps[i]), method) / 3.0;
                    const PrintedMapView* p = printedOf(scene.printed, look);
                    if (!p) continue;
                    ++printed;
                    theirs += *share(p, p->sweep[size_t(method)][i][0]);
                }
                const bool contradicted = i == 0 && method != MapMethod::pcf;
                row.cells.push_back({contradicted ? std::nullopt : std::optional(theirs / printed), mine, 1});
            }
            const Pair crsm = row.cells[1], crsma = row.cells[2];
            row.cells.push_back({crsm.printed ? std::optional(*crsma.printed / *crsm.printed) : std::nullopt,
                                 *crsma.ours / *crsm.ours, 2});
            for (const MapMethod method : kOurs) {
                double mine = 0.0;
                for (const Look look : kLooks)
                    mine += tracedPercent(viewOf(ours, scene.printed, look, kCensusMaps[i]), method) / 3.0;
                row.cells.push_back({std::nullopt, mine, 1});
            }
            table.rows.push_back(row);
        }
    return table;
}

/// The same tables: wrong pixels.
PairTable wrong(Views ours)
{
    PairTable table{.id = "wrong",
                    .title =
                        "**Wrong pixels**, all views of a scene together (the same tables); false shadow alone where "
                        "\"dark\" (tables 14, 15, 59 to 66).",
                    .heads = {"scene", "map"},
                    .columns = {"PCF", "CRSM", "CRSMA", "guaranteed", "sheets", "CRSM dark", "CRSMA dark"},
                    .rows = {}};
    for (const CensusScene& scene : kCensusScenes)
        for (size_t i = 0; i < std::size(kCensusMaps); ++i) {
            std::array<uint64_t, 3> theirs{}, theirDark{};
            CertainCounts mine[kMapMethods];
            for (const Look look : kLooks) {
                const MapView& o = viewOf(ours, scene.printed, look, kCensusMaps[i]);
                for (size_t m = 0; m < kMapMethods; ++m) {
                    mine[m].wrongLit += o.methods[m].wrongLit;
                    mine[m].wrongDark += o.methods[m].wrongDark;
                }
                const PrintedMapView* p = printedOf(scene.printed, look);
                for (size_t m = 0; p && m < 3; ++m) {
                    theirs[m] += p->sweep[m][i][1];
                    theirDark[m] += p->certain[m][5];
                }
            }
            PairTable::Row row{.names = {scene.printed, std::to_string(kCensusMaps[i])}, .cells = {}};
            for (size_t m = 0; m < kMapMethods; ++m)
                row.cells.push_back(
                    {m < 3 ? std::optional(double(theirs[m])) : std::nullopt, double(mine[m].wrong()), 0});
            const bool known = kCensusMaps[i] == kMiddleMap;
            for (const size_t m : {size_t(MapMethod::crsm), size_t(MapMethod::crsma)})
                row.cells.push_back(
                    {known ? std::optional(double(theirDark[m])) : std::nullopt, double(mine[m].wrongDark), 0});
            table.rows.push_back(row);
        }
    return table;
}

/// Eq. 19 by what its distance may mean.
PairTable lambdas(Views ours)
{
    PairTable table{
        .id = "lambda",
        .title = "**What eq. 19's distance may mean**, at 1024 texels: traced of light-facing pixels in percent, and "
                 "wrong ones per million, means over a scene's views; his numbers do not say which is meant.",
        .heads = {"scene", "edges move by"},
        .columns = {"CRSM", "CRSMA", "CRSM wrong", "CRSMA wrong"},
        .rows = {}};
    constexpr const char* names[] = {"a texel's extent", "half its diagonal", "its diagonal"};
    for (const CensusScene& scene : kCensusScenes)
        for (size_t lambda = 0; lambda < 3; ++lambda) {
            PairTable::Row row{.names = {scene.printed, names[lambda]}, .cells = std::vector<Pair>(4)};
            for (const size_t form : {0u, 1u}) {
                double theirs = 0.0, theirWrong = 0.0, mine = 0.0, wrong = 0.0;
                int printed = 0;
                for (const Look look : kLooks) {
                    const MapView& o = viewOf(ours, scene.printed, look, kMiddleMap);
                    mine += percentOf(o.byLambda[lambda][form].traced(), o.facing) / 3.0;
                    wrong += 1e4 * percentOf(o.byLambda[lambda][form].wrong(), o.facing) / 3.0;
                    const PrintedMapView* p = printedOf(scene.printed, look);
                    if (!p) continue;
                    ++printed;
                    theirs += *share(p, p->sweep[form + 1][1][0]);
                    theirWrong += 1e4 * *share(p, p->sweep[form + 1][1][1]);
                }
                row.cells[form] = {theirs / printed, mine, 1};
                row.cells[form + 2] = {theirWrong / printed, wrong, 0};
            }
            table.rows.push_back(row);
        }
    return table;
}

} // namespace

const MapView& viewOf(std::span<const MapView> views, const char* scene, Look look, uint32_t map)
{
    const auto found = std::ranges::find_if(views, [&](const MapView& view) {
        return std::string_view(view.scene) == scene && view.look == look && view.map == map;
    });
    if (found == views.end()) throw HostError(std::string("no counts of ") + scene);
    return *found;
}

std::vector<PairTable> moraisTables(std::span<const MapView> ours)
{
    return {plainMaps(ours), certain(ours), sweep(ours), wrong(ours), lambdas(ours)};
}

} // namespace gnomon::demo
