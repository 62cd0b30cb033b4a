#include "demo/theses/moderno_tables.hpp"

#include <algorithm>
#include <string_view>

namespace gnomon::demo {
namespace {

using Views = std::span<const ChainView>;

struct Column {
    const char* name;
    ChainShare share;
    int decimals;
};

std::vector<ChainView> printedViews()
{
    std::vector<ChainView> views;
    for (const PrintedChainView& printed : printedChainViews())
        views.push_back(countsOf(printed));
    return views;
}

std::string mapName(uint32_t map)
{
    return std::to_string(map);
}

template <size_t N>
std::vector<std::string> namesOf(const std::array<Column, N>& columns)
{
    std::vector<std::string> names;
    for (const Column& column : columns)
        names.emplace_back(column.name);
    return names;
}

constexpr std::array kGrowth = {Column{"contour % of image", chain::ofImage, 2},
                                Column{"map's errors caught %", chain::caught, 1},
                                Column{"map wrong in contour %", chain::mapWrong, 2},
                                Column{"left by TC4 %", chain::leftAfterTc, 1},
                                Column{"left by the chain %", chain::left, 1},
                                Column{"traced % of image", chain::traced, 2},
                                Column{"map's errors left %", chain::errorsLeft, 1},
                                Column{"without rays wrong in contour %", chain::withoutRays, 2}};

/// Tables 5, 6, 12 to 15 by map and contour.
PairTable growth(Views printed, Views ours)
{
    PairTable table{.id = "growth",
                    .title =
                        "**By map and contour**, means over the twelve views (tables 29, 45, ... 199; 5, 6, 12 to 15).",
                    .heads = {"map", "contour"},
                    .columns = namesOf(kGrowth),
                    .rows = {}};
    table.columns.emplace_back("left without hints %");
    for (size_t map = 0; map < std::size(kChainMaps); ++map)
        for (int contour = 0; contour < 3; ++contour) {
            const ChainFilter filter{.map = kChainMaps[map], .contour = contour};
            PairTable::Row row{.names = {mapName(kChainMaps[map]), std::to_string(kContours[contour])}, .cells = {}};
            for (const Column& column : kGrowth)
                row.cells.push_back(
                    {mean(printed, filter, column.share), mean(ours, filter, column.share), column.decimals});
            row.cells.push_back({kPrintedStrictLeft[map][contour], mean(ours, filter, chain::strictLeft), 1});
            table.rows.push_back(row);
        }
    return table;
}

/// The same by scene, at the setting the thesis finds best, and at the hardest.
PairTable scenes(Views printed, Views ours)
{
    PairTable table{.id = "scenes",
                    .title = "**By scene**, means over three views each (the same tables).",
                    .heads = {"scene", "map", "contour"},
                    .columns = namesOf(kGrowth),
                    .rows = {}};
    for (const ChainScene& scene : kChainScenes)
        for (const ChainFilter filter : {ChainFilter{.scene = scene.printed, .map = 1024, .contour = 0},
                                         ChainFilter{.scene = scene.printed, .map = 2048, .contour = 1}}) {
            PairTable::Row row{.names = {scene.printed, mapName(filter.map), std::to_string(kContours[filter.contour])},
                               .cells = {}};
            for (const Column& column : kGrowth)
                row.cells.push_back(
                    {mean(printed, filter, column.share), mean(ours, filter, column.share), column.decimals});
            table.rows.push_back(row);
        }
    return table;
}

PairTable::Row extremes(const char* name, Views printed, Views ours, ChainShare share, int decimals)
{
    PairTable::Row row{.names = {name}, .cells = {}};
    const std::vector<double> theirs = shares(printed, {}, share), mine = shares(ours, {}, share);
    row.cells.push_back({mean(printed, {}, share), mean(ours, {}, share), decimals});
    row.cells.push_back({*std::ranges::min_element(theirs), *std::ranges::min_element(mine), decimals});
    row.cells.push_back({*std::ranges::max_element(theirs), *std::ranges::max_element(mine), decimals});
    return row;
}

/// Tables 6 and 12 to 15: means, and the least and most of any view, map and contour.
PairTable stages(Views printed, Views ours)
{
    constexpr std::array rows = {Column{"map wrong in contour %", chain::mapWrong, 2},
                                 Column{"settled after TC4 %", chain::hinted, 1},
                                 Column{"settled after NB9 %", chain::settledByNb, 1},
                                 Column{"- of the lit", chain::settledOfLit, 1},
                                 Column{"- of the dark", chain::settledOfDarkByNb, 1},
                                 Column{"settled after AG2 %", chain::settled, 1},
                                 Column{"- of the dark", chain::settledOfDark, 1},
                                 Column{"lit of what is left %", chain::litOfLeft, 1},
                                 Column{"rays of those after TC4 %", chain::raysOfTc, 1},
                                 Column{"wrong after rays %", chain::wrongHints, 2},
                                 Column{"- false lit, of the lit", chain::wrongHintsOfLit, 2},
                                 Column{"- false shadow, of the dark", chain::wrongHintsOfDark, 2},
                                 Column{"wrong without rays %", chain::withoutRays, 2}};
    PairTable table{.id = "stages",
                    .title =
                        "**The chain's stages**, of the contour, over views, maps and contours (tables 6, 12 to 15).",
                    .heads = {"of the contour"},
                    .columns = {"mean", "least", "most"},
                    .rows = {}};
    for (const Column& row : rows)
        table.rows.push_back(extremes(row.name, printed, ours, row.share, row.decimals));
    return table;
}

/// Tables 7 and 8.
PairTable hints(Views ours)
{
    PairTable table{
        .id = "hints",
        .title = "**Texels that agree** (tables 7, 8), means.",
        .heads = {"texels"},
        .columns = {"settled %", "of the lit %", "of the dark %", "wrong, of the lit %", "wrong, of the dark %"},
        .rows = {}};
    for (const bool nine : {false, true}) {
        const PrintedHints& p = kPrintedHints[nine];
        const PrintedHints o = meanHints(ours, nine);
        table.rows.push_back({.names = {nine ? "TC9" : "TC4"},
                              .cells = {{p.settled, o.settled, 1},
                                        {p.ofLit, o.ofLit, 1},
                                        {p.ofDark, o.ofDark, 1},
                                        {p.wrongOfLit, o.wrongOfLit, 2},
                                        {p.wrongOfDark, o.wrongOfDark, 2}}});
    }
    return table;
}

double meanAlone(std::span<const PrintedChainView> printed, CandidateOccluder candidate)
{
    double sum = 0.0;
    for (const PrintedChainView& view : printed)
        sum += 100.0 * view.alone[size_t(candidate)][3] / (1024.0 * 1024.0);
    return sum / double(printed.size());
}

/// Tables 9 to 11, and 16 to 184 for the whole image.
PairTable occluders(Views ours)
{
    PairTable table{.id = "candidate occluders",
                    .title =
                        "**Triangles named by texels, each technique alone** (tables 9 to 11; whole image: 16, 30, "
                        "... 184), means; what is not hit is lit.",
                    .heads = {"technique"},
                    .columns = {"wrong in contour %", "lit corrected %", "of wrong lit %", "dark confirmed %",
                                "of right dark %", "wrong, whole image %"},
                    .rows = {}};
    for (size_t i = 0; i < kCandidates; ++i) {
        const auto candidate = static_cast<CandidateOccluder>(i);
        const PrintedOccluder& p = kPrintedOccluders[i];
        const PrintedOccluder o = meanCandidate(ours, candidate);
        double whole = 0.0;
        for (const ChainView& view : ours)
            whole += percentOf(view.whole.wrongAlone(candidate), view.image) / double(ours.size());
        table.rows.push_back({.names = {nameOf(candidate)},
                              .cells = {{p.error, o.error, 2},
                                        {p.corrected, o.corrected, 2},
                                        {p.ofWrongLit, o.ofWrongLit, 1},
                                        {p.confirmed, o.confirmed, 1},
                                        {p.ofRightDark, o.ofRightDark, 1},
                                        {meanAlone(printedChainViews(), candidate), whole, 2}}});
    }
    return table;
}

/// Table 17 and those beside it: the map's errors and TC4 over the whole image.
PairTable wholeImage(Views printed, Views ours)
{
    PairTable table{.id = "whole_image",
                    .title = "**The whole image**, means over three views (tables 17, 19, ... 187).",
                    .heads = {"scene", "map"},
                    .columns = {"map wrong % of image", "TC4 undecided % of image", "TC4 wrong, of the map's errors %"},
                    .rows = {}};
    const auto wrong = [](const ChainView& v, const ContourCounts&) { return percentOf(v.whole.wrong(), v.image); };
    const auto undecided = [](const ChainView& v, const ContourCounts&) {
        return percentOf(v.whole.leftAfterTc(), v.image);
    };
    const auto hintsWrong = [](const ChainView& v, const ContourCounts&) {
        return percentOf(v.whole.wrongHints(), v.whole.wrong());
    };
    for (const ChainScene& scene : kChainScenes)
        for (const uint32_t map : kChainMaps) {
            const ChainFilter filter{.scene = scene.printed, .map = map, .contour = 0};
            table.rows.push_back({.names = {scene.printed, mapName(map)},
                                  .cells = {{mean(printed, filter, wrong), mean(ours, filter, wrong), 3},
                                            {mean(printed, filter, undecided), mean(ours, filter, undecided), 2},
                                            {mean(printed, filter, hintsWrong), mean(ours, filter, hintsWrong), 1}}});
        }
    return table;
}

/// Tables 25 to 197.
PairTable candidates(Views ours)
{
    PairTable table{
        .id = "candidates",
        .title = "**Triangles a pixel of the contour**, map 2048, contour of 4 pixels (tables 25 to 197): of all "
                 "its pixels, and of those that have any.",
        .heads = {"scene", "view"},
        .columns = {"NB4", "NB4, of any", "NB9", "NB9, of any", "AG1", "AG1, of any", "AG2", "AG2, of any"},
        .rows = {}};
    for (const PrintedCandidates& printed : kPrintedCandidates) {
        const auto mine = std::ranges::find_if(ours, [&](const ChainView& view) {
            return std::string_view(view.scene) == printed.scene && view.look == printed.look &&
                   view.map == kChainMaps[1];
        });
        if (mine == ours.end()) continue;
        PairTable::Row row{.names = {printed.scene, nameOf(printed.look)}, .cells = {}};
        for (size_t i = 0; i < printed.of.size(); ++i) {
            const double used = printed.of[i].used;
            row.cells.push_back({used > 0.0 ? std::optional(used) : std::nullopt, mine->candidates[i].used, 2});
            row.cells.push_back({printed.of[i].available, mine->candidates[i].available, 2});
        }
        table.rows.push_back(row);
    }
    return table;
}

} // namespace

std::vector<double> shares(std::span<const ChainView> views, const ChainFilter& filter, ChainShare share)
{
    std::vector<double> out;
    for (const ChainView& view : views) {
        if (filter.scene && std::string_view(filter.scene) != view.scene) continue;
        if (filter.map != 0 && filter.map != view.map) continue;
        for (int i = 0; i < int(view.contours.size()); ++i)
            if (filter.contour < 0 || filter.contour == i) out.push_back(share(view, view.contours[size_t(i)]));
    }
    return out;
}

double mean(std::span<const ChainView> views, const ChainFilter& filter, ChainShare share)
{
    double sum = 0.0;
    const std::vector<double> all = shares(views, filter, share);
    for (const double one : all)
        sum += one;
    return sum / double(all.size());
}

PrintedHints meanHints(std::span<const ChainView> views, bool nineTexels)
{
    PrintedHints sum{};
    for (const ChainView& view : views)
        for (const ContourCounts& c : view.contours) {
            const uint64_t lit = nineTexels ? c.hintedLit9 : c.hintedLit;
            const uint64_t dark = nineTexels ? c.hintedDark9 : c.hintedDark;
            const double weight = 1.0 / double(3 * views.size());
            sum.settled += weight * percentOf(lit + dark, c.pixels);
            sum.ofLit += weight * percentOf(lit, c.lit);
            sum.ofDark += weight * percentOf(dark, c.dark());
            sum.wrongOfLit += weight * percentOf(nineTexels ? c.wrongHintsLit9 : c.wrongHintsLit, c.lit);
            sum.wrongOfDark += weight * percentOf(nineTexels ? c.wrongHintsDark9 : c.wrongHintsDark, c.dark());
        }
    return sum;
}

PrintedOccluder meanCandidate(std::span<const ChainView> views, CandidateOccluder candidate)
{
    PrintedOccluder sum{};
    const auto w = static_cast<size_t>(candidate);
    for (const ChainView& view : views)
        for (const ContourCounts& c : view.contours) {
            const double weight = 1.0 / double(3 * views.size());
            sum.error += weight * percentOf(c.wrongAlone(candidate), c.pixels);
            sum.corrected += weight * percentOf(c.corrects[w], c.lit);
            sum.ofWrongLit += weight * percentOf(c.corrects[w], c.wrongLit);
            sum.confirmed += weight * percentOf(c.confirms[w], c.dark());
            sum.ofRightDark += weight * percentOf(c.confirms[w], c.rightDark());
        }
    return sum;
}

double ringProves(std::span<const ChainView> views, const char* scene)
{
    uint64_t missed = 0, proved = 0;
    for (const ChainView& view : views)
        if (std::string_view(scene) == view.scene)
            for (const ContourCounts& c : view.contours) {
                missed += c.missedByNb;
                proved += c.missedProvedByAg;
            }
    return percentOf(proved, missed);
}

std::vector<PairTable> modernoTables(std::span<const ChainView> ours)
{
    const std::vector<ChainView> printed = printedViews();
    return {growth(printed, ours), scenes(printed, ours),     stages(printed, ours), hints(ours),
            occluders(ours),       wholeImage(printed, ours), candidates(ours)};
}

} // namespace gnomon::demo
