// Sections about measurements: fixed choices beside the adaptive run, and error against time.
#include <algorithm>
#include <cmath>
#include <set>

#include "demo/program/pictures.hpp"
#include "demo/report/markup.hpp"
#include "demo/report/sections.hpp"

namespace gnomon::demo {

namespace {

// Where the axes begin: none has a place on a logarithm. A pixel of a million, and a timer's grain.
constexpr double kLeastError = 1e-4, kLeastMs = 1e-2;

std::string savedTable(const Compared& compared, const Compared::Run& adaptive)
{
    std::vector<const Compared::Run*> fixedRuns;
    for (const Compared::Run& run : compared.runs)
        if (!run.adaptive && run.scene == adaptive.scene && run.pass == adaptive.pass) fixedRuns.push_back(&run);
    std::stable_sort(fixedRuns.begin(), fixedRuns.end(),
                     [](const auto* a, const auto* b) { return a->frameMs < b->frameMs; });
    std::string out = "<h3>" + escaped(adaptive.scene) + ", " + escaped(adaptive.pass) + ", by the " +
                      escaped(adaptive.name) + ": " + fixed(adaptive.frameMs, 1) + " ms a frame</h3><table><tr>" +
                      "<th>every light by</th><th>ms a frame</th><th>saved, ms a frame</th><th>shadows, ms</th>"
                      "<th>wrong near, %</th><th>wrong far, %</th><th>equal quality</th></tr>";
    for (const Compared::Run* run : fixedRuns)
        out += "<tr><td>" + escaped(run->name) + "</td><td>" + fixed(run->frameMs, 1) + "</td><td>" +
               fixed(run->frameMs - adaptive.frameMs, 1) + "</td><td>" + fixed(run->shadowMs, 1) + "</td><td>" +
               fixed(run->nearWrong, 3) + "</td><td>" + fixed(run->farWrong, 3) + "</td><td>" +
               (run->equalQuality ? "yes" : "no") + "</td></tr>";
    return out + "</table>\n";
}

SvgChart scatter(const std::vector<Benched::Row>& rows)
{
    double leastMs = 1e30, mostMs = kLeastMs, leastWrong = 1e30, mostWrong = kLeastError;
    const auto place = [](const Benched::Row& row) {
        return std::pair(std::max(row.ms, kLeastMs), std::max(row.error, kLeastError));
    };
    for (const Benched::Row& row : rows) {
        const auto [ms, wrong] = place(row);
        leastMs = std::min(leastMs, ms), mostMs = std::max(mostMs, ms);
        leastWrong = std::min(leastWrong, wrong), mostWrong = std::max(mostWrong, wrong);
    }
    const bool soft = rows.front().soft;
    SvgChart chart(1040.0, 420.0,
                   {.low = leastMs / 1.3, .high = mostMs * 4.0, .title = "milliseconds", .logarithmic = true},
                   {.low = leastWrong / 1.5,
                    .high = mostWrong * 1.5,
                    .title = soft ? "RMSE in penumbrae" : "wrong pixels, %",
                    .logarithmic = true});
    Points front;
    for (const size_t i : paretoFront(rows))
        front.push_back(place(rows[i]));
    chart.line(front, {120, 120, 120});
    for (const Benched::Row& row : rows) {
        const auto [ms, wrong] = place(row);
        const std::string name = row.map.empty() ? row.method : row.method + " at " + row.map;
        chart.text(ms, wrong, std::isfinite(row.memoryMib) ? name + ", " + fixed(row.memoryMib, 1) + " MiB" : name);
        chart.dot(ms, wrong, methodColour(row.method),
                  name + "\n" + fixed(row.ms, 2) + " ms, " + fixed(row.error, 4) + (soft ? " RMSE" : " % wrong"));
    }
    return chart;
}

/// A chart for each scene and kind of error.
std::vector<Drawing> errorCharts(const Benched& benched)
{
    std::set<std::pair<std::string, bool>> kinds;
    for (const Benched::Row& row : benched.rows)
        if (row.method != "none") kinds.emplace(row.scene, row.soft);
    std::vector<Drawing> charts;
    for (const auto& [scene, soft] : kinds) {
        std::vector<Benched::Row> rows;
        for (const Benched::Row& row : benched.rows)
            if (row.scene == scene && row.soft == soft && row.method != "none") rows.push_back(row);
        charts.push_back({.title = scene + (soft ? ", soft lights" : "") + ", on " + rows.front().device,
                          .chart = scatter(rows),
                          .entries = {}}); // names stand beside the dots
    }
    return charts;
}

} // namespace

std::string savedSection(const Compared& compared)
{
    std::string out;
    for (const Compared::Run& run : compared.runs)
        if (run.adaptive) out += savedTable(compared, run);
    if (out.empty()) return {};
    return "<section><h2>What one method for all lights takes</h2>\n" + out +
           "<p class=\"note\">Equal quality: the share of wrong pixels that the rules' quality floor allows within 30 "
           "m, "
           "and at most 1 % beyond.</p></section>\n";
}

std::string errorSection(const Benched& benched)
{
    std::string out;
    for (const Drawing& drawing : errorCharts(benched))
        out += "<h3>" + escaped(drawing.title) + "</h3>" + drawing.chart.svg();
    if (out.empty()) return {};
    return "<section><h2>Error against time</h2>\n" + out +
           "<p class=\"note\">Errors against ray_traced in the same frame, over pixels that face the light; what has "
           "none "
           "stands at " +
           fixed(kLeastError, 4) + ". On the line nothing is better in both.</p></section>\n";
}

std::string errorPicture(const Benched& benched)
{
    return svgPicture(errorCharts(benched));
}

} // namespace gnomon::demo
