#include "demo/report/run_data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "demo/io/file.hpp"
#include "demo/report/csv_reader.hpp"

namespace gnomon::demo {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

uint32_t countIn(const std::string& cell)
{
    const double number = numberIn(cell);
    return number >= 0.0 && number < 4e9 ? static_cast<uint32_t>(number) : 0;
}

/// The place of `name` in `names`, where it is put if it is new.
template <typename Named, typename Name>
size_t placeIn(std::vector<Named>& all, std::map<std::string, size_t, std::less<>>& places, const Name& name)
{
    const auto [at, isNew] = places.try_emplace(name, all.size());
    if (isNew) all.emplace_back();
    return at->second;
}

class LightRows {
public:
    explicit LightRows(RunData& run) : run_(run) {}

    void add(std::span<const std::string> cells)
    {
        const uint32_t frame = countIn(cells[0]);
        const size_t light = placeIn(run_.lights, lights_, cells[1]);
        run_.lights[light].name = cells[1];
        const size_t method = placeIn(run_.uses, methods_, cells[2]);
        if (method == run_.methods.size()) run_.methods.push_back(cells[2]);
        const double measured = numberIn(cells[3]), distance = numberIn(cells[4]);
        extend(run_.lights[light], frame, method, cells[5], measured, distance);
        use(run_.uses[method], measured, distance);
    }

private:
    static void extend(LightTrack& light, uint32_t frame, size_t method, const std::string& reason, double measured,
                       double distance)
    {
        std::vector<Stretch>& all = light.stretches;
        const bool goesOn = !all.empty() && all.back().method == method && all.back().last + 1 >= frame;
        if (!goesOn) all.push_back({frame, frame, method, reason, kUnknown, kUnknown, 0.0, 0});
        Stretch& stretch = all.back();
        stretch.last = frame;
        if (measured > 0.0) stretch.measuredMs += measured, ++stretch.timed;
        if (!std::isfinite(distance)) return;
        stretch.nearest = std::fmin(stretch.nearest, distance);
        stretch.farthest = std::fmax(stretch.farthest, distance);
        light.distanceSum += distance;
        ++light.distances;
    }

    static void use(MethodUse& method, double measured, double distance)
    {
        if (method.rows++ == 0) method.nearest = method.farthest = kUnknown;
        if (measured > 0.0) method.measuredMs += measured, ++method.timed;
        if (!std::isfinite(distance)) return;
        method.nearest = std::fmin(method.nearest, distance);
        method.farthest = std::fmax(method.farthest, distance);
        ++method.inBand[std::lower_bound(std::begin(kBands), std::end(kBands), distance) - std::begin(kBands)];
    }

    RunData& run_;
    std::map<std::string, size_t, std::less<>> lights_, methods_;
};

constexpr std::string_view kFrameColumns[] = {"frame",     "frame_ms", "shadow_gpu_ms", "shadow_cpu_ms",
                                              "budget_ms", "lights",   "switches",      "over_budget"};
constexpr std::string_view kLightColumns[] = {"frame", "light", "method", "measured_ms", "distance", "reason"};
constexpr std::string_view kFactColumns[] = {"what", "value"};

FrameRow frameRow(std::span<const std::string> cells)
{
    return {.frame = countIn(cells[0]),
            .frameMs = numberIn(cells[1]),
            .gpuMs = numberIn(cells[2]),
            .cpuMs = numberIn(cells[3]),
            .budgetMs = numberIn(cells[4]),
            .lights = countIn(cells[5]),
            .switches = countIn(cells[6]),
            .overBudget = cells[7] == "1"};
}

} // namespace

std::string RunData::fact(std::string_view name) const
{
    for (const auto& [what, value] : facts)
        if (what == name) return value;
    return {};
}

std::string pictureName(uint32_t frame)
{
    std::string number = std::to_string(frame);
    number.insert(0, 5 - std::min<size_t>(5, number.size()), '0');
    return "frame_" + number;
}

Outcome<RunData> readRun(const std::filesystem::path& folder)
{
    RunData run{.folder = folder};
    const auto read = [&](const char* name, std::span<const std::string_view> columns, const auto& visit) {
        Outcome<std::vector<std::string>> notes = readCsv(folder / name, columns, visit);
        if (notes) run.notes.insert(run.notes.end(), notes->begin(), notes->end());
        return notes.error();
    };
    std::string error = read("frames.csv", kFrameColumns, [&](auto cells) { run.frames.push_back(frameRow(cells)); });
    LightRows lights(run);
    if (error.empty()) error = read("lights.csv", kLightColumns, [&](auto cells) { lights.add(cells); });
    if (!error.empty()) return Outcome<RunData>::failure(error);
    (void)read("run.csv", kFactColumns, [&](auto cells) { run.facts.emplace_back(cells[0], cells[1]); });
    if (Outcome<std::string> log = readText(folder / "decisions.gnlog")) run.log = std::move(*log);
    for (const FrameRow& row : run.frames) {
        std::error_code ignored;
        const std::filesystem::path picture = folder / pictureName(row.frame);
        if (std::filesystem::exists(picture.string() + ".png", ignored) &&
            std::filesystem::exists(picture.string() + "_methods.png", ignored))
            run.pictures.push_back(row.frame);
    }
    return run;
}

} // namespace gnomon::demo
