#include "comparison.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <span>

namespace stranger {
namespace {

constexpr VkExtent2D kSize{320, 180};
constexpr double kTooSlow = 20.0; // times the fastest first frame: not looked at further
constexpr size_t kPinnedAlternating = 3;
constexpr int kAlternations = 5, kDefaultFrames = 6, kPinnedFrames = 4;
constexpr double kTimesAsLong = 1.2;                         // what is above it is measured again
constexpr double kBudgetFactor = 1.5, kTooTightFactor = 0.5; // times the cheapest method of equal quality

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

/// Looks at methods, each in a renderer of its own, those with the cheapest first frames before others, until enough of
/// them are wrong on so few pixels at most.
std::vector<PinnedMethod> lookForEquals(const Device& device, const Options& options,
                                        const std::vector<Answer>& references, double allowedWrongPercent)
{
    std::vector<PinnedMethod> methods;
    double fastestMs = 1e30;
    for (const std::string& name : Renderer(device, options).shadows().methods()) {
        PinnedMethod method{.name = name, .renderer = createPinned(device, options, name)};
        if (!method.renderer) continue;
        method.lookMs = runFrames(*method.renderer, 0.0, 1);
        if (!servesAll(*method.renderer, name)) continue; // for lack of memory, say
        fastestMs = std::min(fastestMs, method.lookMs);
        methods.push_back(std::move(method));
    }
    std::sort(methods.begin(), methods.end(),
              [](const PinnedMethod& a, const PinnedMethod& b) { return a.lookMs < b.lookMs; });
    std::erase_if(methods, [&](const PinnedMethod& method) { return method.lookMs > kTooSlow * fastestMs; });
    size_t looked = 0, equals = 0;
    for (; looked < methods.size() && equals < kPinnedAlternating; ++looked) {
        PinnedMethod& method = methods[looked];
        method.lookMs = runFrames(*method.renderer, kStepS, kPinnedFrames);
        method.wrongPercent = wrongAtMoments(*method.renderer, references);
        equals += method.wrongPercent <= allowedWrongPercent;
    }
    methods.resize(looked);
    std::sort(methods.begin(), methods.end(),
              [](const PinnedMethod& a, const PinnedMethod& b) { return a.lookMs < b.lookMs; });
    return methods;
}

void alternate(Comparison& comparison, Renderer& chosen)
{
    std::vector<PinnedMethod*> equals;
    for (PinnedMethod& method : comparison.pinned)
        if (method.wrongPercent <= comparison.allowedWrongPercent && equals.size() < kPinnedAlternating)
            equals.push_back(&method);
    comparison.defaultMediansMs.clear();
    for (PinnedMethod* pPinned : equals)
        pPinned->mediansMs.clear();
    for (int alternation = 0; alternation < kAlternations; ++alternation) {
        const double fromS = 1.1 * alternation;
        comparison.defaultMediansMs.push_back(runFrames(chosen, fromS, kDefaultFrames));
        for (PinnedMethod* pPinned : equals)
            pPinned->mediansMs.push_back(runFrames(*pPinned->renderer, fromS, kPinnedFrames));
    }
}

/// For shadows, or within gnomon's call: work before the G-buffer is done counts, too, and the wait for it.
double waitedMs(const FrameReport& frame)
{
    return std::max(frame.shadowMs, frame.callMs);
}

double steadyFrameMs(const Renderer& renderer)
{
    std::vector<double> times;
    for (const FrameReport& frame : std::span(renderer.reports()).last(kDefaultFrames))
        times.push_back(waitedMs(frame));
    return summarise(times).median;
}

/// Of pairs measured one after the other: what slows both does not count.
double medianRatio(const std::vector<double>& values, const std::vector<double>& others)
{
    std::vector<double> ratios;
    for (size_t i = 0; i < values.size(); ++i)
        ratios.push_back(values[i] / others[i]);
    return summarise(ratios).median;
}

uint32_t countOver(const Renderer& renderer, size_t first, double limitMs)
{
    const auto& reports = renderer.reports();
    return static_cast<uint32_t>(std::count_if(reports.begin() + static_cast<std::ptrdiff_t>(first), reports.end(),
                                               [&](const FrameReport& report) { return report.shadowMs > limitMs; }));
}

/// Runs the default with a budget of a multiple of what the best pinned method takes, in alternation with it.
BudgetRun runBudget(const Device& device, Options options, const PinnedMethod& best, double factor)
{
    const double usualMs = summarise(best.mediansMs).median;
    BudgetRun run{.budgetMs = factor * usualMs, .frames = kAlternations * kDefaultFrames};
    options.budgetMs = static_cast<float>(run.budgetMs);
    Renderer budgeted(device, options);
    budgeted.shadows().warmUp();
    runFirstSecond(budgeted);
    std::vector<double> mediansMs, bestMediansMs;
    for (int alternation = 0; alternation < kAlternations; ++alternation) {
        const size_t first = budgeted.reports().size(), firstOfBest = best.renderer->reports().size();
        const double fromS = static_cast<double>(first) * kStepS;
        mediansMs.push_back(runFrames(budgeted, fromS, kDefaultFrames));
        bestMediansMs.push_back(runFrames(*best.renderer, fromS, kDefaultFrames));
        const double limitMs = factor * std::max(usualMs, bestMediansMs.back()); // the machine may have slowed down
        run.framesOver += countOver(budgeted, first, limitMs);
        run.bestFramesOver += countOver(*best.renderer, firstOfBest, limitMs);
    }
    run.medianMs = summarise(mediansMs).median;
    run.bestMedianMs = summarise(bestMediansMs).median;
    run.timesBest = medianRatio(mediansMs, bestMediansMs);
    run.choices = listChoices(budgeted.reports().back().choices);
    return run;
}

void print(const BudgetRun& run)
{
    std::printf("  budget %.1f ms: %.1f ms, %.2f of the best pinned method's %.1f; %u and %u of %u frames over it; at "
                "last %s\n",
                run.budgetMs, run.medianMs, run.timesBest, run.bestMedianMs, run.framesOver, run.bestFramesOver,
                run.frames, run.choices.c_str());
}

void print(const Comparison& comparison, bool recorded)
{
    std::printf("%s, %ux%u: default %.1f ms, frame %.1f ms, the first %.1f ms, %.3f %% wrong; %s\n",
                recorded ? "recorded" : "submitted", kSize.width, kSize.height, comparison.defaultMs(),
                comparison.steadyFrameMs, comparison.firstFrameMs, comparison.defaultWrongPercent,
                comparison.choices.c_str());
    for (const PinnedMethod& method : comparison.pinned) {
        std::printf("  %-22s %7.1f ms at first, %.3f %% wrong", method.name.c_str(), method.lookMs,
                    method.wrongPercent);
        if (!method.mediansMs.empty())
            std::printf(", %.1f ms in turns: default takes %.2f of it", summarise(method.mediansMs).median,
                        comparison.timesMethod(method));
        std::puts("");
    }
    print(comparison.kept);
    print(comparison.tooTight);
    std::fflush(stdout); // a failure of the next entry point does not take the figures along
}
} // namespace

double Comparison::defaultMs() const
{
    return summarise(defaultMediansMs).median;
}

double Comparison::timesMethod(const PinnedMethod& method) const
{
    return medianRatio(defaultMediansMs, method.mediansMs);
}

const PinnedMethod* Comparison::best() const
{
    const PinnedMethod* pBest = nullptr;
    for (const PinnedMethod& method : pinned)
        if (!method.mediansMs.empty() &&
            (!pBest || summarise(method.mediansMs).median < summarise(pBest->mediansMs).median))
            pBest = &method;
    return pBest;
}

Comparison compareEntry(const Device& device, bool recorded)
{
    const Options options = optionsFor(recorded);
    const std::vector<Answer> references = traceReferences(device, options.size);
    Comparison comparison;
    const auto drawFirst = [](Renderer& renderer) {
        renderer.shadows().warmUp();
        runFrames(renderer, 0.0, 1);
        return waitedMs(renderer.reports().front());
    };
    Renderer chosen(device, options);
    comparison.firstFrameMs = drawFirst(chosen);
    Renderer another(device, options); // what other programs add to the one they hardly add to both
    comparison.firstFrameMs = std::min(comparison.firstFrameMs, drawFirst(another));
    runFirstSecond(chosen);
    comparison.defaultWrongPercent = wrongAtMoments(chosen, references);
    comparison.allowedWrongPercent = std::max(comparison.defaultWrongPercent, kFloorWrongPercent);
    comparison.pinned = lookForEquals(device, options, references, comparison.allowedWrongPercent);
    for (int tries = 0; tries < 3; ++tries) { // other programs may take more of the one's turns than of the other's
        alternate(comparison, chosen);
        if (!comparison.best() || comparison.timesMethod(*comparison.best()) <= kTimesAsLong) break;
    }
    comparison.steadyFrameMs = steadyFrameMs(chosen);
    comparison.choices = listChoices(chosen.reports().back().choices);
    if (const PinnedMethod* pBest = comparison.best()) {
        comparison.kept = runBudget(device, options, *pBest, kBudgetFactor);
        // What other programs take of the processors is only ever added: the best of up to five runs counts.
        for (int again = 0; again < 4 && comparison.kept.framesOver > 1; ++again) {
            const BudgetRun other = runBudget(device, options, *pBest, kBudgetFactor);
            if (other.framesOver < comparison.kept.framesOver) comparison.kept = other;
        }
        comparison.tooTight = runBudget(device, options, *pBest, kTooTightFactor);
    }
    print(comparison, recorded);
    return comparison;
}
} // namespace stranger
