#include "runtime/cost/knowledge_base.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "runtime/base/number_text.hpp"
#include "runtime/cost/csv_line.hpp"

namespace gnomon::cost {

namespace {

constexpr std::string_view kHeading = "# gnomon knowledge ";
constexpr std::string_view kViewPass = "view:";

enum Column : uint32_t {
    device,
    driver,
    kind,
    algorithm,
    pass,
    processor,
    samples,
    octaves,
    firstTerm,
    wrongPercent = firstTerm + kTerms,
    firstFrame,
    kColumns,
};

constexpr std::array<std::string_view, kColumns> columnNames()
{
    std::array<std::string_view, kColumns> names{"device", "driver",    "kind",    "algorithm",
                                                 "pass",   "processor", "samples", "octaves"};
    for (uint32_t i = 0; i < kTerms; ++i)
        names[firstTerm + i] = kTermNames[i];
    names[wrongPercent] = "wrong_percent";
    names[firstFrame] = "first_frame_ms";
    return names;
}
constexpr std::array<std::string_view, kColumns> kNames = columnNames();

/// The whole cell as a number that a measurement can have. An empty cell is 0.
std::optional<double> measureOf(std::string_view cell)
{
    if (cell.empty()) return 0.0;
    const std::optional<double> value = parseNumber(cell);
    if (!value || !std::isfinite(*value) || *value < 0.0 || *value > kMostKnowledge) return std::nullopt;
    return value;
}

class Reader {
public:
    KnowledgeResult read(std::string_view text)
    {
        if (text.size() > kMaxKnowledgeBytes) return failure("the knowledge base is larger than 1 MiB");
        if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3); // as editors mark UTF-8
        std::string_view heading = takeLine(text);
        if (!heading.starts_with(kHeading)) return failure("the first line is not '# gnomon knowledge VERSION'");
        heading.remove_prefix(kHeading.size());
        if (heading != std::to_string(kKnowledgeVersion))
            return failure("knowledge base of version '" + std::string(heading.substr(0, 16)) + "', this build reads " +
                           std::to_string(kKnowledgeVersion) + "; calibrate again");
        if (!splitCells(takeLine(text), cells_)) return failure("the line of column names has an open quote");
        if (const std::string missing = findColumns(); !missing.empty())
            return failure("column '" + missing + "' is missing");
        uint32_t rows = 0;
        for (line_ = 3; !text.empty(); ++line_) {
            const std::string_view line = takeLine(text);
            if (line.empty() || line.front() == '#') continue;
            if (++rows > kMaxKnowledgeRows) return failure("more than 8192 rows");
            readRow(line);
            if (!error_.empty()) return failure(std::move(error_));
        }
        std::erase_if(base_.devices, [](const auto& d) { return d.algorithms.empty() && d.parts.empty(); });
        return {std::move(base_), {}};
    }

private:
    static KnowledgeResult failure(std::string reason) { return {std::nullopt, std::move(reason)}; }

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

    void reject(std::string_view why) { error_ = "line " + std::to_string(line_) + ": " + std::string(why); }

    const std::string& cell(Column column) const { return cells_[places_[column]]; }

    DeviceKnowledge& deviceOfRow()
    {
        for (DeviceKnowledge& known : base_.devices)
            if (known.device == cell(device) && known.driver == cell(driver)) return known;
        return base_.devices.emplace_back(DeviceKnowledge{cell(device), cell(driver), cell(kind), {}, {}});
    }

    AlgorithmCost& algorithmOfRow()
    {
        DeviceKnowledge& known = deviceOfRow();
        for (AlgorithmCost& cost : known.algorithms)
            if (cost.algorithm == cell(algorithm)) return cost;
        return known.algorithms.emplace_back(AlgorithmCost{.algorithm = cell(algorithm), .tracks = {}});
    }

    void readRow(std::string_view line)
    {
        if (!splitCells(line, cells_)) return reject("an open quote");
        if (cells_.size() != columnCount_) return reject("not as many cells as columns");
        for (uint32_t i = samples; i < kColumns; ++i) {
            const std::optional<double> number = measureOf(cells_[places_[i]]);
            if (!number) return reject(std::string(kNames[i]) + " '" + cells_[places_[i]] + "' is no measurement");
            numbers_[i] = *number;
        }
        if (cell(algorithm).empty()) return reject("no algorithm");
        if (const std::string& of = cell(kind); of != "software" && of != "integrated" && of != "discrete")
            return reject("kind '" + of + "' is none of software, integrated and discrete");
        const std::string_view name = cell(pass);
        if (name == "update" || name == "resolve") return readTrack(name == "update" ? Pass::update : Pass::resolve);
        if (name == "method") {
            AlgorithmCost& cost = algorithmOfRow();
            cost.wrongPercent = numbers_[wrongPercent];
            cost.wrongSamples = static_cast<uint32_t>(numbers_[samples]);
            cost.firstFrameMs = numbers_[firstFrame];
            return;
        }
        if (!name.starts_with(kViewPass) || name.size() == kViewPass.size())
            return reject("pass '" + std::string(name) + "' is none of update, resolve, method and view:NAME");
        const double ms = numbers_[firstTerm + static_cast<uint32_t>(Term::viewPixels)];
        if (!(ms > 0.0)) return reject("no time was measured");
        deviceOfRow().parts.push_back({cell(algorithm), std::string(name.substr(kViewPass.size())), ms / 1e6});
    }

    void readTrack(Pass which)
    {
        const std::string& on = cell(processor);
        if (on != "gpu" && on != "cpu") return reject("processor '" + on + "' is neither gpu nor cpu");
        TrackCost cost{.octaves = numbers_[octaves], .samples = static_cast<uint32_t>(numbers_[samples])};
        std::copy_n(numbers_.begin() + firstTerm, kTerms, cost.ms.begin());
        if (std::all_of(cost.ms.begin(), cost.ms.end(), [](double ms) { return ms == 0.0; }) || cost.samples == 0)
            return reject("no time was measured");
        algorithmOfRow().tracks[trackOf(which, on == "gpu" ? Processor::gpu : Processor::cpu)] = cost;
    }

    KnowledgeBase base_;
    std::string error_; ///< Of the newest row.
    std::vector<std::string> cells_;
    std::array<double, kColumns> numbers_{};
    std::array<size_t, kColumns> places_{};
    size_t columnCount_ = 0;
    size_t line_ = 0;
};

/// One row in the order of kNames; cells that say nothing stay empty.
class RowWriter {
public:
    RowWriter(std::string& out, const DeviceKnowledge& of, std::string_view algorithm) : out_(out)
    {
        for (const std::string_view text :
             {std::string_view(of.device), std::string_view(of.driver), std::string_view(of.kind), algorithm})
            cells_[next_++] = quotedCell(text);
    }
    ~RowWriter()
    {
        for (uint32_t i = 0; i < kColumns; ++i)
            (out_ += cells_[i]) += i + 1 < kColumns ? ',' : '\n';
    }
    RowWriter& text(Column column, std::string_view value)
    {
        cells_[column] = quotedCell(value);
        return *this;
    }
    RowWriter& number(uint32_t column, double value)
    {
        char buffer[32];
        constexpr int kDigits = 4; // a number is off by more than its fifth digit
        const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, kDigits).ptr;
        if (value > 0.0) cells_[column].assign(buffer, end);
        return *this;
    }

private:
    std::string& out_;
    std::array<std::string, kColumns> cells_;
    uint32_t next_ = device;
};

void writeAlgorithm(std::string& out, const DeviceKnowledge& of, const AlgorithmCost& cost)
{
    for (const Pass which : {Pass::update, Pass::resolve})
        for (const Processor on : {Processor::gpu, Processor::cpu}) {
            const TrackCost& track = cost.tracks[trackOf(which, on)];
            if (track.samples == 0) continue;
            RowWriter row(out, of, cost.algorithm);
            row.text(pass, which == Pass::update ? "update" : "resolve");
            row.text(processor, on == Processor::gpu ? "gpu" : "cpu");
            row.number(samples, track.samples).number(octaves, track.octaves);
            for (uint32_t i = 0; i < kTerms; ++i)
                row.number(firstTerm + i, track.ms[i]);
        }
    RowWriter(out, of, cost.algorithm)
        .text(pass, "method")
        .number(samples, cost.wrongSamples)
        .number(wrongPercent, cost.wrongPercent)
        .number(firstFrame, cost.firstFrameMs);
}

} // namespace

bool AlgorithmCost::isTimed() const noexcept
{
    return std::any_of(tracks.begin(), tracks.end(), [](const TrackCost& track) { return track.samples > 0; });
}

const AlgorithmCost* DeviceKnowledge::find(std::string_view name) const noexcept
{
    const auto found =
        std::find_if(algorithms.begin(), algorithms.end(), [&](const auto& cost) { return cost.algorithm == name; });
    return found == algorithms.end() ? nullptr : &*found;
}

const DeviceKnowledge* KnowledgeBase::nearestTo(std::string_view name, std::string_view ofKind) const noexcept
{
    const auto first = [&](auto&& suits) {
        const auto found = std::find_if(devices.begin(), devices.end(), suits);
        return found == devices.end() ? nullptr : &*found;
    };
    if (const auto* same = first([&](const DeviceKnowledge& d) { return d.device == name; })) return same;
    if (const auto* alike = first([&](const DeviceKnowledge& d) { return d.kind == ofKind; })) return alike;
    const auto isGpu = [](std::string_view kind) { return kind == "integrated" || kind == "discrete"; };
    if (isGpu(ofKind))
        if (const auto* gpu = first([&](const DeviceKnowledge& d) { return isGpu(d.kind); })) return gpu;
    return devices.empty() ? nullptr : &devices.front();
}

KnowledgeResult parseKnowledge(std::string_view text)
{
    return Reader().read(text);
}

std::vector<KnowledgeColumn> knowledgeColumns()
{
    std::vector<KnowledgeColumn> columns;
    for (uint32_t i = 0; i < kColumns; ++i)
        columns.push_back({kNames[i], i >= samples, i == algorithm || i == pass});
    return columns;
}

std::string writeKnowledge(std::span<const DeviceKnowledge> devices)
{
    std::string out(kHeading);
    out += std::to_string(kKnowledgeVersion) + '\n';
    for (uint32_t i = 0; i < kColumns; ++i)
        (out += kNames[i]) += i + 1 < kColumns ? ',' : '\n';
    for (const DeviceKnowledge& each : devices) {
        for (const AlgorithmCost& cost : each.algorithms)
            writeAlgorithm(out, each, cost);
        for (const KnowledgePart& part : each.parts)
            RowWriter(out, each, part.algorithm)
                .text(pass, std::string(kViewPass) + part.pass)
                .number(firstTerm + static_cast<uint32_t>(Term::viewPixels), part.msPerPixel * 1e6);
    }
    return out;
}

} // namespace gnomon::cost
