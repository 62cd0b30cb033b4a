#include "contest.hpp"

#include <algorithm>
#include <cstdio>

namespace stranger {
namespace {

constexpr VkExtent2D kSize{320, 180};
constexpr double kStepS = 1.0 / 30.0;           // of the animation, whatever a frame takes
constexpr double kMomentsS[] = {0.7, 2.9, 5.3}; // lamps stand elsewhere each time
constexpr double kHopeless = 20.0;              // times the fastest: not looked at again
constexpr size_t kRivalsInTurns = 3;
constexpr int kTurns = 5, kDefaultFrames = 8, kRivalFrames = 4;
// Near floor of the shipped rules: minimumQuality 0.875 = 1 / (1 + 0.143 %).
constexpr double kFloorWrongPercent = 0.143;
constexpr double kBudgetFactor = 1.5; // times the cheapest rival of equal quality

Options optionsFor(bool recorded)
{
    Options options;
    options.recorded = recorded;
    options.size = kSize;
    return options;
}

/// Renders frames from a moment on, waits, and gives the median of what their shadows took. The first is left out: maps
/// and lists are built in it, if another method ran before.
double runTurn(Renderer& renderer, double fromS, int frames)
{
    const size_t first = renderer.reports().size();
    for (int i = 0; i < frames; ++i)
        renderer.renderFrame(fromS + i * kStepS);
    renderer.finish();
    std::vector<double> times;
    for (size_t i = first + 1; i < renderer.reports().size(); ++i)
        times.push_back(renderer.reports()[i].shadowMs);
    return summarise(times).median;
}

/// Renders for a second of wall time at least, as a host does before a user has looked around.
void runFirstSecond(Renderer& renderer)
{
    double elapsedMs = 0.0;
    while (elapsedMs < 1000.0) {
        const size_t first = renderer.reports().size();
        runTurn(renderer, static_cast<double>(first) * kStepS, kDefaultFrames);
        for (size_t i = first; i < renderer.reports().size(); ++i)
            elapsedMs += renderer.reports()[i].wallMs;
    }
}

/// Largest wrong share over the moments, each looked at in its second frame: what is kept from another moment shows.
double wrongAtMoments(Renderer& renderer, const std::vector<Answer>& references)
{
    double wrong = 0.0;
    for (size_t i = 0; i < references.size(); ++i) {
        runTurn(renderer, kMomentsS[i] - kStepS, 2);
        wrong = std::max(wrong, wrongPercent(renderer.read(), references[i]));
    }
    return wrong;
}

/// The exact answers, ray by ray, whatever the entry point under test.
std::vector<Answer> traceReferences(const Device& device)
{
    Renderer renderer(device, optionsFor(false));
    if (!renderer.shadows().pin("ray_traced")) return {};
    renderer.shadows().warmUp();
    std::vector<Answer> references;
    for (double moment : kMomentsS) {
        runTurn(renderer, moment - kStepS, 2);
        references.push_back(renderer.read());
    }
    return references;
}

std::vector<Rival> lookAtAll(Renderer& renderer, const std::vector<Answer>& references)
{
    std::vector<Rival> rivals;
    double fastestMs = 1e30;
    for (const GnMethodInfo& method : renderer.shadows().methods()) {
        if (!renderer.shadows().pin(method.pName)) continue;
        renderer.renderFrame(0.0);
        renderer.finish();
        const double firstMs = renderer.reports().back().shadowMs;
        if (firstMs > kHopeless * fastestMs) continue;
        Rival rival{.name = method.pName};
        rival.lookMs = runTurn(renderer, kStepS, kRivalFrames);
        rival.wrongPercent = wrongAtMoments(renderer, references);
        fastestMs = std::min({fastestMs, firstMs, rival.lookMs});
        rivals.push_back(rival);
    }
    std::sort(rivals.begin(), rivals.end(), [](const Rival& a, const Rival& b) { return a.lookMs < b.lookMs; });
    return rivals;
}

void takeTurns(Contest& contest, Renderer& chosen, Renderer& pinned)
{
    std::vector<Rival*> equals;
    for (Rival& rival : contest.rivals)
        if (rival.wrongPercent <= contest.allowedWrongPercent && equals.size() < kRivalsInTurns)
            equals.push_back(&rival);
    for (int turn = 0; turn < kTurns; ++turn) {
        const double fromS = 1.1 * turn;
        contest.defaultTurnsMs.push_back(runTurn(chosen, fromS, kDefaultFrames));
        for (Rival* pRival : equals) {
            pinned.shadows().pin(pRival->name.c_str());
            pRival->turnsMs.push_back(runTurn(pinned, fromS, kRivalFrames));
        }
    }
}

/// A frame is over its budget where it is over the same multiple of what the best rival takes at that time, too: other
/// work on the machine slows both.
void holdBudget(Contest& contest, const Device& device, Renderer& pinned, bool recorded)
{
    const Rival* pBest = contest.best();
    if (!pBest) return;
    Options options = optionsFor(recorded);
    contest.budgetMs = kBudgetFactor * summarise(pBest->turnsMs).median;
    options.budgetMs = static_cast<float>(contest.budgetMs);
    Renderer budgeted(device, options);
    budgeted.shadows().warmUp();
    runFirstSecond(budgeted);
    pinned.shadows().pin(pBest->name.c_str());
    double beforeMs = runTurn(pinned, 0.0, kRivalFrames);
    for (int turn = 0; turn < kTurns; ++turn) {
        const size_t first = budgeted.reports().size();
        runTurn(budgeted, static_cast<double>(first) * kStepS, 2 * kDefaultFrames);
        const double afterMs = runTurn(pinned, static_cast<double>(first) * kStepS, kRivalFrames);
        const double limitMs = std::max(contest.budgetMs, kBudgetFactor * std::max(beforeMs, afterMs));
        for (size_t i = first; i < budgeted.reports().size(); ++i)
            contest.framesOver += budgeted.reports()[i].shadowMs > limitMs;
        contest.framesBudgeted += 2 * kDefaultFrames;
        beforeMs = afterMs;
    }
    std::printf("  budget %.1f ms: %u of %u frames over, at last %s\n", contest.budgetMs, contest.framesOver,
                contest.framesBudgeted, listChoices(budgeted.reports().back().choices).c_str());
}

void print(const Contest& contest, bool recorded)
{
    std::printf("%s, %ux%u: default %.1f ms, first frame %.1f ms, %.3f %% wrong; %s\n",
                recorded ? "recorded" : "submitted", kSize.width, kSize.height, contest.defaultMs(),
                contest.firstFrameMs, contest.defaultWrongPercent, contest.choices.c_str());
    for (const Rival& rival : contest.rivals) {
        std::printf("  %-22s %7.1f ms at first, %.3f %% wrong", rival.name.c_str(), rival.lookMs, rival.wrongPercent);
        if (!rival.turnsMs.empty())
            std::printf(", %.1f ms in turns: default takes %.2f of it", summarise(rival.turnsMs).median,
                        contest.defaultMs() / summarise(rival.turnsMs).median);
        std::puts("");
    }
}
} // namespace

double Contest::defaultMs() const
{
    return summarise(defaultTurnsMs).median;
}

const Rival* Contest::best() const
{
    const Rival* pBest = nullptr;
    for (const Rival& rival : rivals)
        if (!rival.turnsMs.empty() && (!pBest || summarise(rival.turnsMs).median < summarise(pBest->turnsMs).median))
            pBest = &rival;
    return pBest;
}

Contest holdContest(const Device& device, bool recorded)
{
    const std::vector<Answer> references = traceReferences(device);
    Contest contest;
    Renderer chosen(device, optionsFor(recorded));
    chosen.shadows().warmUp();
    chosen.renderFrame(0.0);
    chosen.finish();
    const FrameReport& first = chosen.reports().front();
    contest.firstFrameMs = std::max(first.shadowMs, first.callMs); // work before the G-buffer is done counts, too
    runFirstSecond(chosen);

    Renderer pinned(device, optionsFor(recorded));
    pinned.shadows().warmUp();
    contest.rivals = lookAtAll(pinned, references);
    contest.defaultWrongPercent = wrongAtMoments(chosen, references);
    contest.allowedWrongPercent = std::max(contest.defaultWrongPercent, kFloorWrongPercent);
    takeTurns(contest, chosen, pinned);
    contest.choices = listChoices(chosen.reports().back().choices);
    print(contest, recorded);
    holdBudget(contest, device, pinned, recorded);
    return contest;
}
} // namespace stranger
