#include "demo/program/frame_log.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "demo/io/number.hpp"

namespace gnomon::demo {

const char* nameOf(GnReason reason) noexcept
{
    switch (reason) {
    case GN_REASON_RULES:
        return "rules";
    case GN_REASON_PINNED:
        return "pinned";
    case GN_REASON_INCUMBENT:
        return "incumbent";
    case GN_REASON_FALLBACK:
        return "fallback";
    case GN_REASON_BUDGET:
        return "budget";
    case GN_REASON_HELD:
        return "held";
    case GN_REASON_PRICE:
        return "price";
    case GN_REASON_FLOOR:
        return "floor";
    case GN_REASON_UTILITY:
        return "utility";
    case GN_REASON_NOT_RECORDABLE:
        return "not_recordable";
    case GN_REASON_NOTHING_READY:
        return "nothing_ready";
    case GN_REASON_NO_OPINION:
        return "no_opinion";
    case GN_REASON_UNSEEN:
        return "unseen";
    case GN_REASON_TRIAL:
        return "trial";
    case GN_REASON_MAX_ENUM:
        break;
    }
    return "unknown";
}

namespace {

/// "rules T3": the reason, and the strongest rule behind the method.
std::string reasonText(const GnDecision& decision)
{
    std::string text = nameOf(decision.reason);
    if (decision.pRule && decision.reason != GN_REASON_PINNED) text += std::string(" ") + decision.pRule;
    return text;
}

} // namespace

FrameLog::FrameLog(const Scene& scene)
    : scene_(scene), lights_({"frame", "light", "method", "suitability", "predicted_ms", "measured_ms", "distance",
                              "reason", "map_side"})
{
}

void FrameLog::add(uint32_t frame, double timeSeconds, const SceneState& state, const ShadowHost& shadows)
{
    const GnFrameStats stats = shadows.stats();
    budgetSet_ = budgetSet_ || stats.budgetMs > 0.0f;
    rows_.push_back({frame, timeSeconds, state.present.size(), stats});
    shadowTimes_.note(shadows);

    newest_.clear();
    newestSwitched_ = false;
    for (uint32_t light : state.present) {
        GnDecision decision{};
        if (gnGetDecision(shadows.context(), shadows.view(0), shadows.light(light), &decision) < 0)
            continue; // no frame has seen this light yet
        const std::string method = decision.pMethod ? decision.pMethod : kNoMethod;
        lights_.cell(frame).cell(scene_.lights[light].name).cell(method).cell(double(decision.suitability), 4);
        lights_.cell(double(decision.predictedMs), 3).cell(double(decision.measuredMs), 3);
        lights_.cell(double(decision.viewerDistance), 3).cell(reasonText(decision));
        lights_.cell(decision.mapSide).endRow();
        ++lightFrames_[method];
        newest_.push_back({scene_.lights[light].name, method, decision.suitability, decision.switched != 0});
        newestSwitched_ = newestSwitched_ || decision.switched;
    }
}

void FrameLog::finish(double frameMs)
{
    frameMs_.push_back(frameMs);
}

CsvWriter FrameLog::framesTable() const
{
    CsvWriter table({"frame", "time_s", "frame_ms", "fps", "shadow_gpu_ms", "shadow_cpu_ms", "decide_us", "lights",
                     "switches", "budget_ms", "over_budget", "pages_evicted", "pages_without_room"});
    for (size_t i = 0; i < frameMs_.size(); ++i) {
        const FrameRow& row = rows_[i];
        const double ms = frameMs_[i];
        table.cell(row.frame).cell(row.timeSeconds, 4).cell(ms, 3).cell(ms > 0.0 ? 1000.0 / ms : 0.0, 2);
        table.cell(double(row.stats.gpuMs), 3).cell(double(row.stats.cpuMs), 3).cell(double(row.stats.decideUs), 1);
        table.cell(row.lights).cell(row.stats.switches).cell(double(row.stats.budgetMs), 4);
        table.cell(overBudget(row)).cell(row.stats.pagesEvicted).cell(row.stats.pagesWithoutRoom).endRow();
    }
    return table;
}

bool FrameLog::overBudget(const FrameRow& row) const
{
    return row.stats.budgetMs > 0.0f && shadowTimes_.ms(row.stats.frame) > double(row.stats.budgetMs);
}

void FrameLog::save(const std::filesystem::path& folder) const
{
    expect(framesTable().save(folder / "frames.csv"));
    expect(lights_.save(folder / "lights.csv"));
}

/// Of the frames whose time is known; that of the last ones never is. NaN where none is.
double FrameLog::meanGpuMs() const
{
    double sum = 0.0;
    uint64_t known = 0, newest = 0;
    for (const FrameRow& row : rows_) {
        if (row.stats.gpuFrame <= newest) continue; // told already, or nothing is known yet
        newest = row.stats.gpuFrame;
        sum += double(row.stats.gpuMs);
        ++known;
    }
    return sum / double(known);
}

FrameLog::Summary FrameLog::summary() const
{
    Summary out;
    out.frames = static_cast<uint32_t>(frameMs_.size());
    out.lightFrames = lightFrames_;
    if (frameMs_.empty()) return out;
    out.shadowGpuMs = meanGpuMs();
    for (const FrameRow& row : rows_) {
        out.switches += row.stats.switches;
        out.overBudget += overBudget(row);
        out.pagesEvicted += row.stats.pagesEvicted;
        out.pagesWithoutRoom += row.stats.pagesWithoutRoom;
        out.shadowCpuMs += double(row.stats.cpuMs) / double(rows_.size());
    }
    std::vector<double> sorted = frameMs_;
    std::sort(sorted.begin(), sorted.end(), std::greater<>());
    const size_t slowest = std::max<size_t>(1, sorted.size() / 100);
    const double total = std::accumulate(sorted.begin(), sorted.end(), 0.0);
    const double slow = std::accumulate(sorted.begin(), sorted.begin() + std::ptrdiff_t(slowest), 0.0);
    out.averageFps = total > 0.0 ? 1000.0 * double(sorted.size()) / total : 0.0;
    out.onePercentLowFps = slow > 0.0 ? 1000.0 * double(slowest) / slow : 0.0;
    return out;
}

std::string FrameLog::summaryText() const
{
    const Summary s = summary();
    std::string out;
    const auto line = [&out](std::string_view label, double value, int decimals, std::string_view unit) {
        out += label;
        appendFixed(out, value, decimals);
        out += unit;
        out += '\n';
    };
    line("frames              ", s.frames, 0, "");
    line("frame rate          ", s.averageFps, 2, " fps on average");
    line("1 %-low             ", s.onePercentLowFps, 2, " fps");
    if (std::isnan(s.shadowGpuMs))
        out += "shadows, GPU        known of no frame yet\n";
    else
        line("shadows, GPU        ", s.shadowGpuMs, 2, " ms a frame");
    line("shadows, CPU        ", s.shadowCpuMs, 2, " ms a frame");
    uint64_t all = 0;
    for (const auto& [method, count] : s.lightFrames)
        all += count;
    for (const auto& [method, count] : s.lightFrames) {
        std::string label = "  " + method;
        label.resize(std::max<size_t>(20, label.size() + 1), ' ');
        line(label, 100.0 * double(count) / double(all), 1, " % of light-frames");
    }
    line("switches            ", double(s.switches), 0, "");
    line("over-budget frames  ", s.overBudget, 0, budgetSet_ ? "" : " (no budget set)");
    if (s.pagesEvicted + s.pagesWithoutRoom > 0) {
        line("pages evicted       ", double(s.pagesEvicted), 0, "");
        line("pages without room  ", double(s.pagesWithoutRoom) / s.frames, 1, " a frame, coarser ones in their place");
    }
    return out;
}

} // namespace gnomon::demo
