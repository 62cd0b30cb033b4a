// Sections about one run: headline, frame times, lights, distance.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "demo/program/gnuplot.hpp"
#include "demo/program/pictures.hpp"
#include "demo/report/markup.hpp"
#include "demo/report/sections.hpp"

namespace gnomon::demo {

namespace {

constexpr double kWidth = 1040.0;
constexpr size_t kMostPoints = 1500;    // about a point a pixel
constexpr size_t kMostTips = 200;       // as narrow as a pointer can hit
constexpr size_t kMostStretches = 4000; // some 250 bytes each: a megabyte
constexpr size_t kLeastStretches = 10;  // of a light
constexpr size_t kMostLanes = 128;
constexpr double kLaneHeight = 11.0;
constexpr size_t kLaneLetters = 11; // as many as there is room for

constexpr Rgb8 kFrameColour{150, 150, 150}, kShadowColour{20, 90, 200}, kBudgetColour{210, 40, 40};

/// Frames `first` to `last` of the table as one point.
struct Bin {
    size_t first, last;
    double worstMs = 0.0, shadowMs = 0.0, budgetMs = 0.0;
    uint32_t switches = 0;
};

std::vector<Bin> binned(const std::vector<FrameRow>& frames, size_t most)
{
    std::vector<Bin> bins;
    const size_t size = (frames.size() + most - 1) / std::max<size_t>(most, 1);
    for (size_t first = 0; first < frames.size(); first += size) {
        Bin bin{.first = first, .last = std::min(first + size, frames.size()) - 1};
        for (size_t i = bin.first; i <= bin.last; ++i) {
            bin.worstMs = std::fmax(bin.worstMs, frames[i].frameMs);
            bin.shadowMs += (frames[i].gpuMs + frames[i].cpuMs) / double(bin.last - bin.first + 1);
            bin.budgetMs = std::fmax(bin.budgetMs, frames[i].budgetMs);
            bin.switches += frames[i].switches;
        }
        bins.push_back(bin);
    }
    return bins;
}

std::string framesText(uint32_t first, uint32_t last)
{
    return first == last ? "frame " + std::to_string(first)
                         : "frames " + std::to_string(first) + " to " + std::to_string(last);
}

std::string tipOf(const Bin& bin, const std::vector<FrameRow>& frames)
{
    std::string text = framesText(frames[bin.first].frame, frames[bin.last].frame) + "\n" +
                       (bin.first == bin.last ? "" : "at most ") + fixed(bin.worstMs, 1) + " ms a frame, shadows " +
                       fixed(bin.shadowMs, 1) + " ms";
    if (bin.budgetMs > 0.0) text += ", budget " + fixed(bin.budgetMs, 1) + " ms";
    if (bin.switches > 0) text += "\n" + std::to_string(bin.switches) + " change(s) of method";
    return text;
}

std::vector<size_t> byUse(const RunData& run)
{
    std::vector<size_t> order(run.methods.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return run.uses[a].rows > run.uses[b].rows; });
    return order;
}

Rgb8 colourOf(const std::string& method)
{
    return method == "none" ? Rgb8{225, 225, 225} : methodColour(method);
}

std::string methodLegend(const RunData& run)
{
    std::vector<std::pair<std::string, Rgb8>> entries;
    for (const size_t m : byUse(run))
        entries.emplace_back(run.methods[m] == "none" ? "none (nothing to shadow in view)" : run.methods[m],
                             colourOf(run.methods[m]));
    return legend(entries);
}

std::string metres(double nearest, double farthest)
{
    if (!std::isfinite(nearest)) return "-";
    return fixed(nearest, 1) + " to " + fixed(farthest, 1) + " m";
}

/// What is shorter than a few pixels goes to the stretch before it.
std::vector<Stretch> shortened(const std::vector<Stretch>& all, size_t most)
{
    std::vector<Stretch> out = all;
    for (uint32_t least = 2; out.size() > most; least *= 2) {
        std::vector<Stretch> kept;
        for (const Stretch& stretch : out) {
            const bool goesOn = !kept.empty() && kept.back().last + 1 >= stretch.first;
            if (goesOn && (stretch.last - stretch.first + 1 < least || kept.back().method == stretch.method))
                kept.back().last = stretch.last;
            else
                kept.push_back(stretch);
        }
        if (kept.size() == out.size() && least > 1u << 30) break; // gaps alone
        out = std::move(kept);
    }
    return out;
}

/// As many bytes at most; a character of several is not cut in the middle.
std::string firstBytes(const std::string& text, size_t most)
{
    size_t end = std::min(text.size(), most);
    while (end > 0 && end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80)
        --end;
    return text.substr(0, end);
}

std::string tipOf(const Stretch& stretch, const LightTrack& light, const RunData& run)
{
    std::string text = light.name + ", " + framesText(stretch.first, stretch.last) + "\n" +
                       run.methods[stretch.method] + ", because of: " + stretch.reason;
    if (std::isfinite(stretch.nearest)) text.append("\n").append(metres(stretch.nearest, stretch.farthest)).append(" from the eye");
    if (stretch.timed > 0) text += "\nmeasured " + fixed(stretch.measuredMs / stretch.timed, 2) + " ms";
    return text;
}

} // namespace

std::string headlineSection(const RunData& run)
{
    std::string out = "<section><h1>" + escaped(run.fact("scene").empty() ? "A run of gnomon" : run.fact("scene")) +
                      "</h1>\n<table class=\"facts\">";
    for (const auto& [what, value] : run.facts)
        out += "<tr><th>" + escaped(what) + "</th><td>" + escaped(value) + "</td></tr>";
    out += "</table>\n";
    if (run.frames.empty()) return out + "<p>The run has no frames.</p></section>\n";
    double frameMs = 0.0, shadowMs = 0.0;
    uint64_t over = 0, switches = 0;
    uint32_t lights = 0;
    bool budgeted = false;
    for (const FrameRow& row : run.frames) {
        frameMs += row.frameMs / double(run.frames.size());
        shadowMs += (row.gpuMs + row.cpuMs) / double(run.frames.size());
        over += row.overBudget;
        switches += row.switches;
        lights = std::max(lights, row.lights);
        budgeted |= row.budgetMs > 0.0;
    }
    uint64_t rows = 0;
    for (const MethodUse& use : run.uses)
        rows += use.rows;
    out += "<p class=\"headline\">" + std::to_string(run.frames.size()) + " frames with up to " +
           std::to_string(lights) + " lights took " + fixed(frameMs, 1) + " ms each, " + fixed(shadowMs, 1) +
           " ms of it for shadows. Methods changed " + std::to_string(switches) + " times. " +
           (budgeted ? percent(double(over), double(run.frames.size())) + " of the frames were over their budget."
                     : "No budget was set.") +
           "</p>\n<table><tr><th>method</th><th>share of lights and frames</th><th>distance from the eye</th>"
           "<th>measured, ms a light</th></tr>";
    for (const size_t m : byUse(run)) {
        const MethodUse& use = run.uses[m];
        out += "<tr><td>" + escaped(run.methods[m]) + "</td><td>" + percent(double(use.rows), double(rows)) +
               "</td><td>" + metres(use.nearest, use.farthest) + "</td><td>" +
               fixed(use.measuredMs / double(use.timed), 2) + "</td></tr>";
    }
    return out + "</table></section>\n";
}

std::string frameSection(const RunData& run)
{
    if (run.frames.empty()) return {};
    const std::vector<Bin> bins = binned(run.frames, kMostPoints);
    std::vector<double> sorted;
    for (const Bin& bin : bins)
        sorted.push_back(std::fmax(bin.worstMs, bin.budgetMs));
    std::sort(sorted.begin(), sorted.end());
    // A start that takes a second would press all else to the ground: the chart ends a little above 99 of 100.
    const double high = 1.2 * sorted[(sorted.size() - 1) * 99 / 100];
    SvgChart chart(kWidth, 260.0,
                   {.low = double(run.frames.front().frame), .high = double(run.frames.back().frame), .title = "frame"},
                   {.low = 0.0, .high = high, .title = "milliseconds"});
    Points whole, shadows, budget;
    for (const Bin& bin : bins) {
        const double x = run.frames[bin.first].frame;
        whole.emplace_back(x, bin.worstMs);
        shadows.emplace_back(x, bin.shadowMs);
        budget.emplace_back(x, bin.budgetMs > 0.0 ? bin.budgetMs : std::nan(""));
    }
    chart.line(whole, kFrameColour);
    chart.line(shadows, kShadowColour, 1.6);
    chart.line(budget, kBudgetColour);
    for (const Bin& bin : binned(run.frames, kMostTips))
        chart.tip(run.frames[bin.first].frame, run.frames[bin.last].frame + 1.0, tipOf(bin, run.frames));
    const std::pair<std::string, Rgb8> entries[] = {
        {"whole frame", kFrameColour}, {"shadows, GPU and CPU", kShadowColour}, {"budget", kBudgetColour}};
    std::string note;
    if (run.frames.size() > kMostPoints)
        note = "<p class=\"note\">" + std::to_string(run.frames.size()) + " frames in " + std::to_string(bins.size()) +
               " points: of each the longest frame and the mean of the shadows.</p>";
    return "<section><h2>Time of each frame</h2>\n" + legend(entries) + chart.svg() + note + "</section>\n";
}

std::string laneSection(const RunData& run)
{
    if (run.lights.empty() || run.frames.empty()) return {};
    std::vector<const LightTrack*> lanes;
    for (const LightTrack& light : run.lights)
        lanes.push_back(&light);
    const auto distance = [](const LightTrack* light) {
        return light->distances > 0 ? light->distanceSum / light->distances : 1e30;
    };
    std::stable_sort(lanes.begin(), lanes.end(),
                     [&](const LightTrack* a, const LightTrack* b) { return distance(a) < distance(b); });
    const size_t hidden = lanes.size() > kMostLanes ? lanes.size() - kMostLanes : 0;
    lanes.resize(lanes.size() - hidden);
    const auto count = double(lanes.size());
    const double first = run.frames.front().frame, end = run.frames.back().frame + 1.0;
    SvgChart chart(kWidth, 60.0 + kLaneHeight * count, {.low = first, .high = end, .title = "frame"},
                   {.low = 0.0, .high = count, .numbered = false});
    size_t merged = 0;
    for (size_t i = 0; i < lanes.size(); ++i) {
        const auto stretches = shortened(lanes[i]->stretches, std::max(kLeastStretches, kMostStretches / lanes.size()));
        chart.rowName(count - double(i) - 0.5, firstBytes(lanes[i]->name, kLaneLetters));
        merged += lanes[i]->stretches.size() - stretches.size();
        for (const Stretch& stretch : stretches)
            chart.box(stretch.first, stretch.last + 1.0, count - double(i) - 0.95, count - double(i) - 0.05,
                      colourOf(run.methods[stretch.method]), tipOf(stretch, *lanes[i], run));
    }
    std::string note = "<p class=\"note\">A lane per light, the nearest on top. Point at one for its name and reason.";
    if (merged > 0) note += " " + std::to_string(merged) + " short stretches are drawn with the one before.";
    if (hidden > 0) note += " The farthest " + std::to_string(hidden) + " lights are left out.";
    return "<section><h2>Which method served which light</h2>\n" + methodLegend(run) + chart.svg() + note +
           "</p></section>\n";
}

std::string distanceSection(const RunData& run)
{
    uint64_t known = 0;
    for (const MethodUse& use : run.uses)
        known += std::accumulate(std::begin(use.inBand), std::end(use.inBand), uint64_t{0});
    if (known == 0) return {};
    std::string out = "<section><h2>Near and far</h2>\n" + methodLegend(run) + "<table class=\"bands\">";
    const std::vector<size_t> order = byUse(run);
    double from = 0.0;
    for (size_t band = 0; band < std::size(kBands) + 1; ++band) {
        const bool last = band == std::size(kBands);
        uint64_t all = 0;
        for (const MethodUse& use : run.uses)
            all += use.inBand[band];
        const std::string name =
            last ? "beyond " + fixed(from, 0) + " m" : fixed(from, 1) + " to " + fixed(kBands[band], 1) + " m";
        from = last ? from : kBands[band];
        if (all == 0) continue;
        out += "<tr><th>" + name + "</th><td class=\"bar\">";
        for (const size_t m : order) {
            const double part = 100.0 * double(run.uses[m].inBand[band]) / double(all);
            if (part < 0.05) continue;
            out += "<span style=\"width:" + fixed(part, 1) + "%;background:" + hexOf(colourOf(run.methods[m])) +
                   "\" title=\"" + escaped(run.methods[m]) + " " + fixed(part, 1) + " %\"></span>";
        }
        out += "</td><td>" + std::to_string(all) + "</td></tr>";
    }
    return out +
           "</table><p class=\"note\">By distance from the eye to the light's nearest receiver in view; the number "
           "counts lights and frames.</p></section>\n";
}

} // namespace gnomon::demo
