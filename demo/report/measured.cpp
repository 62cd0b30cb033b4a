#include "demo/report/measured.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "demo/compare/run_record.hpp"
#include "demo/report/csv_reader.hpp"

namespace gnomon::demo {

namespace {

constexpr std::string_view kCompareColumns[] = {"scene",          "run",          "pass",     "alternation",
                                                "frame_ms",       "shadow_ms",    "adaptive", "equal_quality",
                                                "near_wrong_pct", "far_wrong_pct"};
constexpr std::string_view kBenchColumns[] = {"scene",     "method", "map",           "increment_ms_min",
                                              "wrong_pct", "device", "penumbra_rmse", "memory_mib"};

struct Mean {
    double sum = 0.0;
    uint64_t count = 0;

    void add(double value)
    {
        if (!std::isfinite(value)) return;
        sum += value;
        ++count;
    }
    double get() const { return count > 0 ? sum / double(count) : std::nan(""); }
};

/// One contestant's frames, by alternation.
struct Frames {
    Compared::Run run;
    std::map<std::string, std::pair<Mean, Mean>> alternations; ///< Frame and shadows.
};

} // namespace

Outcome<Compared> readCompared(const std::filesystem::path& file)
{
    std::vector<Frames> all;
    std::map<std::tuple<std::string, std::string, std::string>, size_t> places;
    const auto visit = [&](std::span<const std::string> cells) {
        const auto [at, isNew] = places.try_emplace({cells[0], cells[1], cells[2]}, all.size());
        if (isNew)
            all.push_back({.run = {.scene = cells[0],
                                   .name = cells[1],
                                   .pass = cells[2],
                                   .adaptive = cells[6] == "1",
                                   .equalQuality = cells[7] == "1",
                                   .nearWrong = numberIn(cells[8]),
                                   .farWrong = numberIn(cells[9])},
                           .alternations = {}});
        auto& [frame, shadows] = all[at->second].alternations[cells[3]];
        frame.add(numberIn(cells[4]));
        shadows.add(numberIn(cells[5]));
    };
    Outcome<std::vector<std::string>> notes = readCsv(file, kCompareColumns, visit);
    if (!notes) return Outcome<Compared>::failure(notes.error());
    Compared out{.runs = {}, .notes = std::move(*notes)};
    for (Frames& frames : all) {
        std::vector<double> frameMs, shadowMs;
        for (const auto& [number, means] : frames.alternations) {
            frameMs.push_back(means.first.get());
            shadowMs.push_back(means.second.get());
        }
        frames.run.frameMs = medianOf(frameMs);
        frames.run.shadowMs = medianOf(shadowMs);
        out.runs.push_back(std::move(frames.run));
    }
    return out;
}

Outcome<Benched> readBenched(const std::filesystem::path& file)
{
    Benched out;
    const auto visit = [&](std::span<const std::string> cells) {
        Benched::Row row{.scene = cells[0],
                         .method = cells[1],
                         .map = cells[2],
                         .device = cells[5],
                         .ms = numberIn(cells[3]),
                         .error = numberIn(cells[6]),
                         .memoryMib = numberIn(cells[7])};
        row.soft = std::isfinite(row.error);
        if (!row.soft) row.error = numberIn(cells[4]);
        if (std::isfinite(row.ms) && std::isfinite(row.error)) out.rows.push_back(std::move(row));
    };
    Outcome<std::vector<std::string>> notes = readCsv(file, kBenchColumns, visit);
    if (!notes) return Outcome<Benched>::failure(notes.error());
    out.notes = std::move(*notes);
    return out;
}

std::vector<size_t> paretoFront(const std::vector<Benched::Row>& rows)
{
    std::vector<size_t> order(rows.size()), front;
    std::iota(order.begin(), order.end(), size_t{0});
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        return std::tie(rows[a].ms, rows[a].error) < std::tie(rows[b].ms, rows[b].error);
    });
    for (const size_t i : order)
        if (front.empty() || rows[i].error < rows[front.back()].error) front.push_back(i);
    return front;
}

} // namespace gnomon::demo
