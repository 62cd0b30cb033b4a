#include "contest.hpp"

#include <algorithm>
#include <cstdio>

namespace stranger {
namespace {

constexpr VkExtent2D kSize{320, 180};
constexpr double kHopeless = 20.0; // times the fastest first frame: not looked at again
constexpr size_t kHandful = 6;
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

bool servesAll(const Renderer& renderer, const std::string& method)
{
    return std::ranges::all_of(renderer.reports().back().choices,
                               [&](const Choice& choice) { return choice.pMethod && choice.pMethod == method; });
}

/// Looks at a handful of methods, those with the cheapest first frames, each in a renderer of its own.
std::vector<Rival> lookAtHandful(const Device& device, const Options& options, const std::vector<Answer>& references)
{
    std::vector<Rival> rivals;
    double fastestMs = 1e30;
    for (const std::string& name : Renderer(device, options).shadows().methods()) {
        Rival rival{.name = name, .renderer = createPinned(device, options, name)};
        if (!rival.renderer) continue;
        rival.lookMs = runTurn(*rival.renderer, 0.0, 1);
        if (!servesAll(*rival.renderer, name)) continue; // for lack of memory, say
        fastestMs = std::min(fastestMs, rival.lookMs);
        rivals.push_back(std::move(rival));
    }
    std::sort(rivals.begin(), rivals.end(), [](const Rival& a, const Rival& b) { return a.lookMs < b.lookMs; });
    rivals.resize(std::min(rivals.size(), kHandful));
    std::erase_if(rivals, [&](const Rival& rival) { return rival.lookMs > kHopeless * fastestMs; });
    for (Rival& rival : rivals) {
        rival.lookMs = runTurn(*rival.renderer, kStepS, kRivalFrames);
        rival.wrongPercent = wrongAtMoments(*rival.renderer, references);
    }
    std::sort(rivals.begin(), rivals.end(), [](const Rival& a, const Rival& b) { return a.lookMs < b.lookMs; });
    return rivals;
}

void takeTurns(Contest& contest, Renderer& chosen)
{
    std::vector<Rival*> equals;
    for (Rival& rival : contest.rivals)
        if (rival.wrongPercent <= contest.allowedWrongPercent && equals.size() < kRivalsInTurns)
            equals.push_back(&rival);
    for (int turn = 0; turn < kTurns; ++turn) {
        const double fromS = 1.1 * turn;
        contest.defaultTurnsMs.push_back(runTurn(chosen, fromS, kDefaultFrames));
        for (Rival* pRival : equals)
            pRival->turnsMs.push_back(runTurn(*pRival->renderer, fromS, kRivalFrames));
    }
}

/// A frame is over its budget where it is over the same multiple of what the best rival takes just before or after it,
/// too: other work on the machine slows both.
void holdBudget(Contest& contest, const Device& device, Options options)
{
    const Rival* pBest = contest.best();
    if (!pBest) return;
    contest.budgetMs = kBudgetFactor * summarise(pBest->turnsMs).median;
    options.budgetMs = static_cast<float>(contest.budgetMs);
    Renderer budgeted(device, options);
    budgeted.shadows().warmUp();
    runFirstSecond(budgeted);
    double beforeMs = runTurn(*pBest->renderer, 0.0, kRivalFrames);
    for (int turn = 0; turn < kTurns; ++turn) {
        const size_t first = budgeted.reports().size();
        const double fromS = static_cast<double>(first) * kStepS;
        runTurn(budgeted, fromS, kDefaultFrames);
        const double afterMs = runTurn(*pBest->renderer, fromS, kRivalFrames);
        const double limitMs = std::max(contest.budgetMs, kBudgetFactor * std::max(beforeMs, afterMs));
        for (size_t i = first; i < budgeted.reports().size(); ++i)
            contest.framesOver += budgeted.reports()[i].shadowMs > limitMs;
        contest.framesBudgeted += kDefaultFrames;
        beforeMs = afterMs;
    }
    contest.choicesBudgeted = listChoices(budgeted.reports().back().choices);
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
    std::printf("  budget %.1f ms: %u of %u frames over, at last %s\n", contest.budgetMs, contest.framesOver,
                contest.framesBudgeted, contest.choicesBudgeted.c_str());
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
    const Options options = optionsFor(recorded);
    const std::vector<Answer> references = traceReferences(device, options.size);
    Contest contest;
    Renderer chosen(device, options);
    chosen.shadows().warmUp();
    runTurn(chosen, 0.0, 1);
    const FrameReport& first = chosen.reports().front();
    contest.firstFrameMs = std::max(first.shadowMs, first.callMs); // work before the G-buffer is done counts, too
    runFirstSecond(chosen);
    contest.rivals = lookAtHandful(device, options, references);
    contest.defaultWrongPercent = wrongAtMoments(chosen, references);
    contest.allowedWrongPercent = std::max(contest.defaultWrongPercent, kFloorWrongPercent);
    takeTurns(contest, chosen);
    contest.choices = listChoices(chosen.reports().back().choices);
    holdBudget(contest, device, options);
    print(contest, recorded);
    return contest;
}
} // namespace stranger
