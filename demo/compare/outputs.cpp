// The table and the plot of a comparison.
#include <utility>

#include "demo/compare/report.hpp"
#include "demo/compare/standing.hpp"
#include "demo/program/envelope.hpp"
#include "demo/program/gnuplot.hpp"
#include "demo/program/pictures.hpp"
#include "demo/report/csv_reader.hpp"

namespace gnomon::demo {
namespace {

RunTimes timesOf(const Row& row)
{
    RunTimes times;
    for (const RunRecord& run : row.runs)
        times.push_back(run.frameMs);
    return times;
}

PlotCurve curve(const std::string& title, const std::string& style, const std::vector<double>& ms)
{
    PlotCurve made{.title = title, .style = style};
    for (size_t frame = 0; frame < ms.size(); ++frame)
        made.points.emplace_back(double(frame), ms[frame]);
    return made;
}

} // namespace

CsvWriter emptyTable()
{
    return CsvWriter({"scene", "run", "pass", "alternation", "frame", "frame_ms", "sentinel_ms", "shadow_ms",
                      "adaptive", "equal_quality", "near_wrong_pct", "far_wrong_pct", std::string(kCommandColumn)});
}

void appendTable(CsvWriter& csv, const Contest& contest, std::string command)
{
    for (const Row& row : contest.rows()) {
        for (size_t i = 0; i < row.runs.size(); ++i) {
            const RunRecord& run = row.runs[i];
            for (size_t frame = 0; frame < run.frameMs.size(); ++frame) {
                csv.cell(contest.scene().name).cell(row.name).cell(row.warm ? "warm" : "cold").cell(i).cell(frame);
                csv.cell(run.frameMs[frame], 3).cell(run.sentinelMs[frame], 3).cell(run.shadowMs[frame]);
                csv.cell(row.adaptive).cell(contest.quality().holds(row.errors));
                csv.cell(row.errors.near.percent(), 4).cell(row.errors.far.percent(), 4);
                csv.cell(std::exchange(command, {})).endRow();
            }
        }
    }
}

void plotFrames(const Contest& contest, const std::string& out)
{
    const Standing standing = standingOf(contest.rows(), false, contest.quality(), {}, 0);
    const std::string settings = "set title " + gnuplotText(contest.scene().name) +
                                 "\nset xlabel 'frame'\nset ylabel 'ms'\nset yrange [0:]\nset grid\n"
                                 "set key outside top center horizontal maxcols 3\n";
    std::vector<PlotCurve> curves;
    for (const Row* row : standing.fixed)
        curves.push_back(curve(row->name, "lines lw 1 lc rgb '" + hexOf(methodColour(row->name)) + "'",
                               fastestFrames(timesOf(*row))));
    std::vector<RunTimes> times;
    for (const Row* row : standing.equal)
        times.push_back(timesOf(*row));
    std::vector<const RunTimes*> equal;
    for (const RunTimes& one : times)
        equal.push_back(&one);
    if (!equal.empty())
        curves.push_back(curve("envelope of equal quality", "lines lw 2 dt 2 lc rgb 'black'", envelopeOf(equal)));
    for (const Row* row : standing.adaptive)
        curves.push_back(curve(
            row->name, row == standing.adaptive.front() ? "lines lw 2 lc rgb 'black'" : "lines lw 2 lc rgb 'gray50'",
            fastestFrames(timesOf(*row))));
    plotCurves(settings, curves, out);
}

} // namespace gnomon::demo
