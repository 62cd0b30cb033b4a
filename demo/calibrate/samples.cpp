#include "demo/calibrate/samples.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "runtime/base/number_text.hpp"
#include "runtime/cost/csv_line.hpp"

namespace gnomon::demo {

namespace {

constexpr int kDigits = 7; // the texels of a cube of 1024 x 1024 faces, and of times more than there is
constexpr std::string_view kHeading = "# gnomon samples ";
constexpr std::string_view kViewPass = "view:";

enum Column : uint32_t {
    device,
    driver,
    algorithm,
    pass,
    pixels,
    casterTriangles,
    mapTexels,
    sharing,
    still,
    drawnTriangles,
    casters,
    directional,
    pointLight,
    drawnPixels,
    viewPixels,
    shadowPixels,
    softPixels,
    treeLevels,
    mapFilled,
    mapTouched,
    samples,
    gpuMin,
    gpuP50,
    gpuP95,
    cpuMin,
    cpuP50,
    firstFrame,
    wrongPercent,
    clockMhz,
    date,
    kColumns,
};
constexpr std::array<std::string_view, kColumns> kNames = {
    "device",           "driver",         "algorithm",     "pass",         "pixels",
    "caster_triangles", "map_texels",     "sharing",       "still",        "drawn_triangles",
    "casters",          "directional",    "point",         "drawn_pixels", "view_pixels",
    "shadow_pixels",    "soft_pixels",    "tree_levels",   "map_filled",   "map_touched",
    "samples",          "gpu_ms_min",     "gpu_ms_p50",    "gpu_ms_p95",   "cpu_ms_min",
    "cpu_ms_p50",       "first_frame_ms", "wrong_percent", "clock_mhz",    "date"};

/// The whole cell as a number that a measurement can have: finite and not negative. An empty cell is 0.
std::optional<double> measureOf(std::string_view cell)
{
    if (cell.empty()) return 0.0;
    const std::optional<double> value = parseNumber(cell);
    if (!value || !std::isfinite(*value) || *value < 0.0 || *value > 1e15) return std::nullopt;
    return value;
}

class Reader {
public:
    Outcome<Samples> read(std::string_view text)
    {
        if (text.size() > kMaxSampleBytes) return failure("the file is larger than 16 MiB");
        if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3); // as editors mark UTF-8
        std::string_view heading = cost::takeLine(text);
        if (!heading.starts_with(kHeading)) return failure("the first line is not '# gnomon samples VERSION'");
        heading.remove_prefix(kHeading.size());
        if (heading != std::to_string(kSamplesVersion))
            return failure("samples of version '" + std::string(heading.substr(0, 16)) + "', this build reads " +
                           std::to_string(kSamplesVersion) + "; measure again");
        if (!cost::splitCells(cost::takeLine(text), cells_))
            return failure("the line of column names has an open quote");
        if (const std::string missing = findColumns(); !missing.empty())
            return failure("column '" + missing + "' is missing");
        for (line_ = 3; !text.empty(); ++line_) {
            const std::string_view line = cost::takeLine(text);
            if (line.empty() || line.front() == '#') continue;
            if (base_.rows.size() + base_.parts.size() == kMaxSamples) return failure("more than 65536 rows");
            readRow(line);
        }
        return std::move(base_);
    }

private:
    static Outcome<Samples> failure(std::string reason) { return Outcome<Samples>::failure(std::move(reason)); }

    std::string findColumns()
    {
        columnCount_ = cells_.size();
        for (uint32_t i = 0; i < kColumns; ++i) {
            const auto found = std::find(cells_.begin(), cells_.end(), kNames[i]);
            if (found == cells_.end()) return std::string(kNames[i]);
            places_[i] = static_cast<size_t>(found - cells_.begin());
        }
        return {};
    }

    void reject(std::string_view why)
    {
        ++base_.rejected;
        if (base_.findings.size() < kMaxFindings)
            base_.findings.push_back("line " + std::to_string(line_) + ": " + std::string(why));
    }

    void readRow(std::string_view line)
    {
        if (!cost::splitCells(line, cells_)) return reject("an open quote");
        if (cells_.size() != columnCount_) return reject("not as many cells as columns");
        std::array<double, kColumns> numbers{};
        for (uint32_t i = pixels; i < date; ++i) {
            const std::optional<double> number = measureOf(cells_[places_[i]]);
            if (!number) return reject(std::string(kNames[i]) + " is not a measurement");
            numbers[i] = *number;
        }
        const std::string& passName = cells_[places_[pass]];
        const bool part = passName.starts_with(kViewPass) && passName.size() > kViewPass.size();
        if (!part && passName != "update" && passName != "resolve")
            return reject("pass is neither update nor resolve, nor view: and a name");
        if (cells_[places_[algorithm]].empty()) return reject("no algorithm");
        if (cells_[places_[wrongPercent]].empty()) numbers[wrongPercent] = kNotMeasured;
        if (numbers[gpuP50] <= 0.0 && numbers[cpuP50] <= 0.0) return reject("no time was measured");
        if (part) return readPart(passName.substr(kViewPass.size()), numbers);
        base_.rows.push_back({.device = cells_[places_[device]],
                              .driver = cells_[places_[driver]],
                              .algorithm = cells_[places_[algorithm]],
                              .pass = passName == "update" ? cost::Pass::update : cost::Pass::resolve,
                              .workload = {.pixels = numbers[pixels],
                                           .casterTriangles = numbers[casterTriangles],
                                           .mapTexels = numbers[mapTexels],
                                           .sharing = std::max(1.0, numbers[sharing]),
                                           .still = numbers[still] != 0.0,
                                           .drawnTriangles = numbers[drawnTriangles],
                                           .casters = numbers[casters],
                                           .directional = numbers[directional] != 0.0,
                                           .point = numbers[pointLight] != 0.0,
                                           .drawnPixels = numbers[drawnPixels],
                                           .viewPixels = numbers[viewPixels],
                                           .shadowPixels = numbers[shadowPixels],
                                           .softPixels = numbers[softPixels],
                                           .mapFilled = numbers[mapFilled],
                                           .mapTouched = numbers[mapTouched],
                                           .treeLevels = numbers[treeLevels]},
                              .samples = static_cast<uint32_t>(std::min(numbers[samples], 1e9)),
                              .gpuMsMin = numbers[gpuMin],
                              .gpuMsP50 = numbers[gpuP50],
                              .gpuMsP95 = numbers[gpuP95],
                              .cpuMsMin = numbers[cpuMin],
                              .cpuMsP50 = numbers[cpuP50],
                              .firstFrameMs = numbers[firstFrame],
                              .wrongPercent = numbers[wrongPercent],
                              .clockMhz = numbers[clockMhz],
                              .date = cells_[places_[date]]});
    }

    void readPart(std::string name, const std::array<double, kColumns>& numbers)
    {
        if (numbers[viewPixels] < 1.0) return reject("view_pixels is not a size");
        base_.parts.push_back({.device = cells_[places_[device]],
                               .driver = cells_[places_[driver]],
                               .algorithm = cells_[places_[algorithm]],
                               .pass = std::move(name),
                               .viewPixels = numbers[viewPixels],
                               .samples = static_cast<uint32_t>(std::min(numbers[samples], 1e9)),
                               .gpuMs = numbers[gpuP50],
                               .cpuMs = numbers[cpuP50],
                               .date = cells_[places_[date]]});
    }

    Samples base_;
    std::vector<std::string> cells_;
    std::array<size_t, kColumns> places_{};
    size_t columnCount_ = 0;
    size_t line_ = 0;
};

void appendNumber(std::string& out, double value)
{
    char buffer[32];
    const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, kDigits);
    out.append(buffer, error == std::errc{} ? end : buffer);
}

} // namespace

Outcome<Samples> parseSamples(std::string_view text)
{
    return Reader().read(text);
}

namespace {

void appendRow(std::string& out, const Sample& row, std::string_view pass)
{
    for (const std::string* text : {&row.device, &row.driver, &row.algorithm}) {
        out += cost::quotedCell(*text);
        out += ',';
    }
    out += cost::quotedCell(pass);
    const cost::Workload& workload = row.workload;
    for (const double number : {workload.pixels,
                                workload.casterTriangles,
                                workload.mapTexels,
                                workload.sharing,
                                workload.still ? 1.0 : 0.0,
                                workload.drawnTriangles,
                                workload.casters,
                                workload.directional ? 1.0 : 0.0,
                                workload.point ? 1.0 : 0.0,
                                workload.drawnPixels,
                                workload.viewPixels,
                                workload.shadowPixels,
                                workload.softPixels,
                                workload.treeLevels,
                                workload.mapFilled,
                                workload.mapTouched,
                                1.0 * row.samples,
                                row.gpuMsMin,
                                row.gpuMsP50,
                                row.gpuMsP95,
                                row.cpuMsMin,
                                row.cpuMsP50,
                                row.firstFrameMs,
                                row.wrongPercent,
                                row.clockMhz}) {
        out += ',';
        if (number >= 0.0) appendNumber(out, number); // kNotMeasured is an empty cell
    }
    out += ',';
    out += cost::quotedCell(row.date);
    out += '\n';
}

} // namespace

std::string writeSamples(std::span<const Sample> rows, std::span<const SharedSample> parts)
{
    std::string out(kHeading);
    out += std::to_string(kSamplesVersion) + '\n';
    for (uint32_t i = 0; i < kColumns; ++i)
        (out += kNames[i]) += i + 1 < kColumns ? ',' : '\n';
    for (const Sample& row : rows)
        appendRow(out, row, row.pass == cost::Pass::update ? "update" : "resolve");
    for (const SharedSample& part : parts) {
        const Sample row{.device = part.device,
                         .driver = part.driver,
                         .algorithm = part.algorithm,
                         .workload = {.sharing = 0.0, .viewPixels = part.viewPixels},
                         .samples = part.samples,
                         .gpuMsMin = part.gpuMs,
                         .gpuMsP50 = part.gpuMs,
                         .gpuMsP95 = part.gpuMs,
                         .cpuMsMin = part.cpuMs,
                         .cpuMsP50 = part.cpuMs,
                         .date = part.date};
        appendRow(out, row, std::string(kViewPass) + part.pass);
    }
    return out;
}

} // namespace gnomon::demo
