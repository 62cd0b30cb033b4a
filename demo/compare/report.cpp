#include "demo/compare/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "demo/compare/standing.hpp"
#include "demo/program/envelope.hpp"
#include "runtime/select/auto_budget.hpp"

namespace gnomon::demo {
namespace {

/// "faster than every fixed choice", as the summary counts it.
constexpr double kClearlyFaster = 1.3;

template <typename Of>
double medianOfRuns(const Row& row, Of&& of)
{
    std::vector<double> values;
    for (const RunRecord& run : row.runs)
        values.push_back(of(run));
    return medianOf(values);
}

const char* passOf(bool warm)
{
    return warm ? "warm" : "cold";
}

std::string titleOf(const Row& row)
{
    return row.name + (row.warm ? ", warm" : "");
}

int nameWidth(const std::vector<Row>& rows)
{
    size_t width = 0;
    for (const Row& row : rows)
        width = std::max(width, titleOf(row).size());
    return static_cast<int>(width);
}

std::string percentText(const BudgetCount& count)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.2f", count.percent());
    return count.counted > 0 ? text : "-";
}

void printHead(const Contest& contest, size_t alternations)
{
    const Stage& stage = contest.stage();
    const ComparePath& path = stage.path;
    std::printf("%s, %ux%u, %s, %u frames (every %u of %.1f s), medians of %zu alternation%s, on %s\n",
                contest.scene().name.c_str(), stage.size.width, stage.size.height,
                stage.recorded ? "gnCmdRenderShadows" : "gnSubmitShadows", path.frames, path.stride,
                path.frames * path.stride / contest.scene().framesPerSecond, alternations, alternations == 1 ? "" : "s",
                stage.device.properties.deviceName);
    const EqualQuality& quality = contest.quality();
    std::printf("equal quality: wrong share against ray_traced at most %.4f %% of the receivers under %.0f m from the "
                "eye (quality %.3f, the floor of %s), and at most %.4f %% of those beyond\n",
                quality.nearPercent, double(kNearMetres), 1.0 / (1.0 + quality.nearPercent),
                contest.rows().front().name.c_str(), quality.farPercent);
    for (const std::string& note : contest.notes())
        std::printf("left out: %s\n", note.c_str());
}

void printRow(const Row& row, const Standing& standing, const EqualQuality& quality, int width)
{
    const double frames = double(row.runs.front().frameMs.size());
    const double switches = medianOfRuns(row, [](const RunRecord& run) { return double(run.switches); });
    std::printf("%-*s %5zu %9.2f %9.3f %10.3f %9.4f %8.4f %6s %9.2f %9.2f %7s %9.0f\n", width, titleOf(row).c_str(),
                row.runs.size(), medianOfRuns(row, totalMs) / 1000.0, medianOfRuns(row, totalMs) / frames,
                medianOfRuns(row, totalShadowMs) / frames, row.errors.near.percent(), row.errors.far.percent(),
                quality.holds(row.errors) ? "yes" : "no",
                medianOfRuns(row, [](const RunRecord& run) { return run.frameMs.front(); }), medianOfRuns(row, worstMs),
                percentText(overBudget(row, standing).frames).c_str(), switches);
}

void printTable(const Contest& contest, const std::vector<Standing>& standings)
{
    const int width = nameWidth(contest.rows());
    std::printf("%-*s %5s %9s %9s %10s %9s %8s %6s %9s %9s %7s %9s\n", width, "", "runs", "total s", "frame ms",
                "shadow ms", "near %", "far %", "equal", "first ms", "worst ms", "over %", "switches");
    for (const Standing& standing : standings) {
        for (const Row* row : standing.adaptive)
            printRow(*row, standing, contest.quality(), width);
        for (const Row* row : standing.fixed)
            printRow(*row, standing, contest.quality(), width);
    }
    for (const Row& row : contest.rows())
        if (row.overBest > 0.0)
            std::printf("%-*s over %.0f x (%.1f x the best of equal quality in the frames it was tried in)\n", width,
                        row.name.c_str(), kCut, row.overBest);
}

void printQuotient(const char* what, const Quotient& quotient, double bound)
{
    std::printf("  %-24s %.3f (%.3f to %.3f), bound %.2f: %s\n", what, quotient.median, quotient.least, quotient.most,
                bound, verdictText(quotient, bound).c_str());
}

/// @return per cent, of no runs without a budget
Quotient printOver(const Row& adaptive, const Standing& standing)
{
    const OverBudget over = overBudget(adaptive, standing);
    if (over.percents.empty()) return {};
    const Quotient spread = spreadOf(over.percents);
    std::printf("  %-24s %.2f %% of %u frames (%.2f to %.2f), worst %.2f x, bound %.0f %%: %s\n", "frames over budget",
                spread.median, over.frames.counted, spread.least, spread.most, over.frames.worst,
                standing.bounds.overBudget, verdictText(spread, standing.bounds.overBudget).c_str());
    return spread;
}

/// What could be had frame by frame, as far as the choices of equal quality go.
void printEnvelope(const Row& adaptive, const Standing& standing)
{
    std::vector<RunTimes> times;
    for (const Row* row : standing.equal) {
        times.emplace_back();
        for (const RunRecord& run : row->runs)
            times.back().push_back(run.frameMs);
    }
    RunTimes mine;
    for (const RunRecord& run : adaptive.runs)
        mine.push_back(run.frameMs);
    std::vector<const RunTimes*> methods;
    for (const RunTimes& one : times)
        methods.push_back(&one);
    const std::vector<double> taken = fastestFrames(mine), lowest = envelopeOf(methods);
    std::printf("  %-24s %.3f of it", "envelope, frame by frame",
                std::accumulate(taken.begin(), taken.end(), 0.0) / std::accumulate(lowest.begin(), lowest.end(), 0.0));
    if (mine.size() > 1)
        std::printf("; %.3f of what was fastest in the other alternations", overChosenElsewhere(mine, methods));
    std::printf("\n");
}

void printOwnBudget(const Row& adaptive, const Standing& standing)
{
    const OwnBudget own = countOwnBudget(adaptive, standing.firstCounted);
    if (own.frames.counted + own.infeasible == 0) return;
    std::printf("  its own budget           %.2f to %.2f ms: over it in %.2f %% of %u frames, worst %.2f x; of these "
                "%u, %u but for the processor time that others took; in %u more no plan keeps it and the floor\n",
                own.leastMs, own.mostMs, own.frames.percent(), own.frames.counted, own.frames.worst, own.frames.over,
                own.heldUp, own.infeasible);
}

ScenePart printAgainst(const Row& adaptive, const Standing& standing, const Contest& contest)
{
    ScenePart part{.scene = contest.scene().name, .adaptive = adaptive.name, .warm = standing.warm};
    std::printf("%s, %s: ", adaptive.name.c_str(), passOf(standing.warm));
    if (!contest.quality().holds(adaptive.errors)) std::printf("is not of equal quality itself; ");
    const Row* best = bestFixed(standing.equal);
    if (!best) {
        std::printf("no fixed choice is of equal quality\n");
        part.over = printOver(adaptive, standing);
        printOwnBudget(adaptive, standing);
        return part;
    }
    const Against raw = against(adaptive, *best), normal = againstNormalised(adaptive, *best, standing.sentinelMs);
    const Bounds& bounds = standing.bounds;
    std::printf("against %s, the best fixed choice of equal quality\n", best->name.c_str());
    printQuotient("total", raw.total, bounds.total);
    printQuotient("total, normalised", normal.total, bounds.total);
    if (const std::string why = disagreement(adaptive, *best, raw.total, normal.total, bounds.total); !why.empty())
        std::printf("    %s\n", why.c_str());
    if (const Row* other = bestFixed(standing.equal, standing.sentinelMs); other != best) {
        const Against to = againstNormalised(adaptive, *other, standing.sentinelMs);
        std::printf("    by normalised time %s is the best fixed choice: %.3f (%.3f to %.3f)\n", other->name.c_str(),
                    to.total.median, to.total.least, to.total.most);
    }
    printQuotient("worst frame", raw.worstFrame, bounds.worstFrame);
    printQuotient("worst frame, normalised", normal.worstFrame, bounds.worstFrame);
    if (const std::string why = disagreement(adaptive, *best, raw.worstFrame, normal.worstFrame, bounds.worstFrame);
        !why.empty())
        std::printf("    %s\n", why.c_str());
    part.over = printOver(adaptive, standing);
    printOwnBudget(adaptive, standing);
    printEnvelope(adaptive, standing);
    part.best = best->name;
    part.total = raw.total;
    part.worstFrame = raw.worstFrame;
    return part;
}

std::vector<Standing> standingsOf(const Contest& contest)
{
    std::vector<Standing> standings;
    for (const bool warm : {false, true}) {
        Standing standing = standingOf(contest.rows(), warm, contest.quality(), contest.hostBudgetMs(warm),
                                       contest.stage().path.afterFirstSecond());
        if (!standing.adaptive.empty()) standings.push_back(std::move(standing));
    }
    return standings;
}

} // namespace

std::vector<ScenePart> printReport(const Contest& contest)
{
    const std::vector<Standing> standings = standingsOf(contest);
    printHead(contest, contest.rows().front().runs.size());
    printTable(contest, standings);
    constexpr const char* kCheapest = "times the cheapest fixed choice of equal quality in each frame";
    if (const double factor = contest.budgetFactor(); factor > 0.0)
        std::printf("over %%: of the budget that the host gave, %g %s of its first run\n", factor, kCheapest);
    else if (contest.hostBudgetMs(false).empty())
        std::printf("over %%: of a budget of %g %s\n", AutoBudget::kFactor, kCheapest);
    std::vector<ScenePart> parts;
    for (const Standing& standing : standings)
        for (const Row* adaptive : standing.adaptive)
            parts.push_back(printAgainst(*adaptive, standing, contest));
    return parts;
}

void printWords(const Contest& contest)
{
    const Standing standing = standingsOf(contest).front();
    const Row& adaptive = *standing.adaptive.front();
    const double frames = double(adaptive.runs.front().frameMs.size());
    const size_t lights = contest.scene().lights.size();
    std::printf("In %s, with %zu light%s, a frame by the %s takes %.1f ms.\n", contest.scene().name.c_str(), lights,
                lights == 1 ? "" : "s", adaptive.name.c_str(), medianOfRuns(adaptive, totalMs) / frames);
    if (const Row* best = bestFixed(standing.equal))
        std::printf("By the best fixed choice of equal quality, %s, it takes %.1f ms in the same run.\n",
                    best->name.c_str(), medianOfRuns(*best, totalMs) / frames);
    else
        std::printf("No fixed choice has equal quality.\n");
    uint64_t all = 0;
    std::vector<std::pair<std::string, Service>> services(contest.services().begin(), contest.services().end());
    for (const auto& [method, service] : services)
        all += service.lightFrames;
    std::sort(services.begin(), services.end(),
              [](const auto& a, const auto& b) { return a.second.lightFrames > b.second.lightFrames; });
    std::printf("%zu method%s or map side%s served:", services.size(), services.size() == 1 ? "" : "s",
                services.size() == 1 ? "" : "s");
    for (size_t i = 0; i < services.size(); ++i) {
        const Service& service = services[i].second;
        std::printf("%s %s %.1f %%", i > 0 ? "," : "", services[i].first.c_str(),
                    100.0 * double(service.lightFrames) / double(all));
        if (service.nearestMetres <= service.farthestMetres)
            std::printf(" (%.0f to %.0f m from the eye)", double(service.nearestMetres),
                        double(service.farthestMetres));
    }
    std::printf(".\n");
}

void printSummary(const std::vector<ScenePart>& parts)
{
    size_t faster = 0, warm = 0;
    for (const ScenePart& part : parts) {
        if (part.best.empty()) continue;
        const Bounds& bounds = part.warm ? kWarmBounds : kColdBounds;
        std::printf("%s, %s, %s: total %.3f (%s), worst frame %.3f (%s)", part.scene.c_str(), part.adaptive.c_str(),
                    passOf(part.warm), part.total.median, verdictText(part.total, bounds.total).c_str(),
                    part.worstFrame.median, verdictText(part.worstFrame, bounds.worstFrame).c_str());
        if (part.over.count > 0)
            std::printf(", over the budget %.2f %% (%s)", part.over.median,
                        verdictText(part.over, bounds.overBudget).c_str());
        std::printf(", against %s\n", part.best.c_str());
        if (!part.warm || part.adaptive != parts.front().adaptive) continue;
        ++warm;
        faster += part.total.median * kClearlyFaster <= 1.0;
    }
    if (warm > 0)
        std::printf("%s, warm: faster than every fixed choice of equal quality by %.1f times or more in %zu of %zu "
                    "scenes\n",
                    parts.front().adaptive.c_str(), kClearlyFaster, faster, warm);
}

} // namespace gnomon::demo
