#include "demo/report/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "demo/report/csv_reader.hpp"
#include "demo/report/markup.hpp"
#include "runtime/registry.hpp"

namespace gnomon::demo {
namespace {

constexpr std::string_view kColumns[] = {
    "scene",  "method", "map",    "increment_ms_min", "wrong_pct", "memory_mib",   "device",
    "driver", "width",  "height", kLightKindColumn,   kDateColumn, "penumbra_rmse"};

/// Least frames with shadows were up to 0.8 ms shorter than without (lavapipe, comparison of 2026-11-28): what takes
/// less than this, ms, is told as equal.
constexpr double kLeastMs = 0.1;

/// Texts in the order in which they came first.
class Names {
public:
    void add(const std::string& name)
    {
        if (std::find(all_.begin(), all_.end(), name) == all_.end()) all_.push_back(name);
    }
    auto begin() const { return all_.begin(); }
    auto end() const { return all_.end(); }

private:
    std::vector<std::string> all_;
};

/// A text in a table's cell.
std::string inCell(const std::string& text)
{
    std::string out;
    for (const char c : text)
        out += c == '|' ? std::string("\\|") : std::string(1, c);
    return out;
}

std::string linked(const std::string& method)
{
    for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms)
        if (method == algorithm.entry->name)
            return "[`" + method + "`](../algorithms/" + algorithm.family + "/" + method + ".md)";
    return std::string("`").append(inCell(method)).append("`");
}

std::string cellOf(const Compilation::Row& row, bool onFront)
{
    const std::string ms = row.measured.ms < kLeastMs ? "< " + fixed(kLeastMs, 1) : fixed(row.measured.ms, 2);
    std::string text = ms + " ms, " + fixed(row.memoryMib, 1) + " MiB";
    if (std::isfinite(row.measured.error))
        text += ", " + fixed(row.measured.error, 4) + (row.measured.soft ? "" : " %");
    return onFront ? "**" + text + "**" : text;
}

/// The rows of one kind of light at one place.
std::string table(const std::vector<const Compilation::Row*>& rows)
{
    Names methods, scenes;
    std::map<std::string, std::vector<const Compilation::Row*>> byScene;
    for (const Compilation::Row* row : rows) {
        methods.add(row->measured.method);
        scenes.add(row->measured.scene);
        byScene[row->measured.scene].push_back(row);
    }
    std::map<std::pair<std::string, std::string>, std::string> cells; // by method and scene
    std::map<std::string, uint32_t> fronts;                           // scenes in which a method is on the front
    for (const auto& [scene, all] : byScene) {
        std::vector<Benched::Row> known;
        for (const Compilation::Row* row : all)
            if (std::isfinite(row->measured.error)) {
                known.push_back(row->measured);
                known.back().ms = std::max(known.back().ms, kLeastMs);
            }
        const std::vector<size_t> front = paretoFront(known); // one of equals
        for (const Compilation::Row* row : all) {
            const Benched::Row& measured = row->measured;
            const bool onFront = std::any_of(front.begin(), front.end(), [&](size_t i) {
                return known[i].ms == std::max(measured.ms, kLeastMs) && known[i].error == measured.error;
            });
            fronts[measured.method] += onFront;
            cells[{measured.method, scene}] = cellOf(*row, onFront);
        }
    }
    std::string out = "| method |", rule = "| --- |";
    for (const std::string& scene : scenes) {
        out.append(" ").append(inCell(scene)).append(" |");
        rule += " --- |";
    }
    out += "\n" + rule + "\n";
    for (const std::string& method : methods) {
        out += "| " + linked(method) + " |";
        for (const std::string& scene : scenes) {
            const auto cell = cells.find({method, scene});
            out += cell == cells.end() ? " - |" : " " + cell->second + " |";
        }
        out += "\n";
    }
    std::erase_if(fronts, [](const auto& entry) { return entry.second == 0; });
    std::vector<std::pair<std::string, uint32_t>> most(fronts.begin(), fronts.end());
    std::stable_sort(most.begin(), most.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    out += "\nBold in most scenes:";
    for (size_t i = 0; i < most.size() && i < 4; ++i)
        out += (i > 0 ? ", `" : " `") + most[i].first + "` in " + std::to_string(most[i].second);
    return out + " of " + std::to_string(byScene.size()) + ".\n";
}

} // namespace

Status readCompilation(const std::filesystem::path& file, Compilation& into)
{
    const auto visit = [&](std::span<const std::string> cells) {
        Compilation::Row row{.measured = {.scene = cells[0],
                                          .method = cells[1],
                                          .map = cells[2],
                                          .device = cells[6],
                                          .ms = numberIn(cells[3]),
                                          .error = numberIn(cells[4])},
                             .kind = cells[10],
                             .where = cells[6] + ", " + cells[7] + ", " + cells[8] + "x" + cells[9] + ", " + cells[11],
                             .memoryMib = numberIn(cells[5])};
        if (const double rmse = numberIn(cells[12]); std::isfinite(rmse))
            row.measured.soft = true, row.measured.error = rmse;
        if (std::isfinite(row.measured.ms)) into.rows.push_back(std::move(row));
    };
    Outcome<std::vector<std::string>> notes = readCsv(file, kColumns, visit);
    if (!notes) return Status::failure(notes.error());
    into.notes.insert(into.notes.end(), notes->begin(), notes->end());
    return Done{};
}

std::string comparisonPage(const Compilation& all, std::string_view command, const std::vector<std::string>& tables)
{
    std::string out = "# Comparison\n\nWhat each method takes, and how far it is from the truth, by scene and kind of "
                      "light. This page is the output of\n\n```\n";
    out += command;
    out += "\n```\n\nwith more columns in";
    for (const std::string& table : tables)
        out += (&table == tables.data() ? " [`" : ", [`") + table + "`](" + table + ")";
    out += ".\n\n"
           "- One light casts shadows: of its kind the one with the largest shadow in the picture.\n"
           "- *ms*: what a frame takes more with shadows than without, by the fastest of both, which alternate. On a "
           "software\n  device the processor does the GPU's work, and what else it does makes times of a millisecond "
           "uncertain; less\n  than 0.1 ms is told as that.\n"
           "- *MiB*: device memory that the runtime holds.\n"
           "- *%*: light-facing pixels that differ from `ray_traced`. These lights are points, which soft methods are "
           "not\n  made for.\n"
           "- Of *soft* and *rectangle* lights the last number is the RMSE of visibility in penumbrae, against 1 024 "
           "rays a\n  pixel.\n"
           "- **bold**: no other method is faster and as close to the truth, or closer and as fast.\n"
           "- Maps have the sides that the picture asks for.\n";
    Names places;
    for (const Compilation::Row& row : all.rows)
        places.add(row.where);
    for (const std::string& place : places) {
        out += "\n## " + place + "\n";
        Names kinds;
        for (const Compilation::Row& row : all.rows)
            if (row.where == place) kinds.add(row.kind);
        for (const std::string& kind : kinds) {
            std::vector<const Compilation::Row*> rows;
            for (const Compilation::Row& row : all.rows)
                if (row.where == place && row.kind == kind) rows.push_back(&row);
            out += "\n### " + kind + "\n\n" + table(rows);
        }
    }
    return out;
}

} // namespace gnomon::demo
