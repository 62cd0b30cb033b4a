#include "demo/replay/best_plan.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace gnomon::demo {

namespace {

using plan::kNone;

/// Sums are made in other orders than sumOf()'s while searching; this much of the budget stays unused so that the last
/// bits never turn a plan that fits into one that does not.
constexpr double kRounding = 1e-12;

constexpr uint32_t kFillSteps = 4; ///< Single exchanges tried after greedy; gains beyond were below 0.01 %.

BestPlan sumOf(const PlanProblem& problem, std::span<const uint32_t> chosen)
{
    BestPlan sums;
    for (uint32_t light = 0; light < problem.lights; ++light) {
        if (chosen[light] == kNone) continue;
        const size_t index = size_t{light} * problem.methods + chosen[light];
        sums.value += problem.values[index];
        sums.costMs += problem.costsMs[index];
    }
    sums.fits = sums.costMs <= problem.budgetMs;
    return sums;
}

} // namespace

BestPlans::BestPlans(uint32_t lights, uint32_t methods, uint32_t tableLights, uint32_t bins)
    : bins_(bins), tableLights_(tableLights)
{
    const size_t tableSize = std::min(lights, tableLights);
    options_.resize(size_t{lights} * methods);
    steps_.resize(options_.size());
    optionCounts_.resize(lights);
    at_.resize(lights);
    trial_.resize(lights);
    states_.resize(bins_ + 1);
    nextStates_.resize(bins_ + 1);
    origins_.resize(tableSize * (bins_ + 1));
    restOver_.resize(tableSize + 1);
    inUse_.resize(bins_ / 64 + 1);
    nextInUse_.resize(bins_ / 64 + 1);
}

std::span<const BestPlans::Option> BestPlans::optionsOf(uint32_t light) const noexcept
{
    return std::span(options_).subspan(size_t{light} * methods_, optionCounts_[light]);
}

/// Undominated options of every light by rising cost and value.
void BestPlans::gatherOptions(const PlanProblem& problem) noexcept
{
    methods_ = problem.methods;
    for (uint32_t light = 0; light < problem.lights; ++light) {
        optionCounts_[light] = 0;
        if (problem.allowed[light].empty()) continue;
        Option* const first = &options_[size_t{light} * methods_];
        uint32_t count = 0;
        for (const uint32_t method : problem.allowed[light]) {
            const size_t index = size_t{light} * methods_ + method;
            const Option option{problem.costsMs[index], problem.values[index], method};
            // Insertion by cost; among equals the costlier value first, then registry order (methods come in order).
            uint32_t place = count++;
            for (; place > 0; --place) {
                const Option& before = first[place - 1];
                if (before.costMs < option.costMs || (before.costMs == option.costMs && before.value >= option.value))
                    break;
                first[place] = before;
            }
            first[place] = option;
        }
        uint32_t kept = 1;
        for (uint32_t i = 1; i < count; ++i)
            if (first[i].value > first[kept - 1].value) first[kept++] = first[i];
        optionCounts_[light] = kept;
    }
}

/// Buys steps along the hulls by gain per millisecond; a step that does not fit ends its light's walk.
void BestPlans::walkGreedy(const PlanProblem& problem, double limitMs, std::span<uint32_t> chosen) noexcept
{
    uint32_t stepCount = 0;
    double costMs = 0.0;
    for (uint32_t light = 0; light < problem.lights; ++light) {
        const std::span<const Option> options = optionsOf(light);
        chosen[light] = options.empty() ? kNone : options[0].method;
        at_[light] = 0;
        if (options.empty()) continue;
        costMs += options[0].costMs;
        // Upper hull: a point below the line from its predecessor to its successor is never bought.
        uint32_t hull[kMaxMethods];
        uint32_t size = 0;
        auto slope = [&](uint32_t a, uint32_t b) {
            return (options[b].value - options[a].value) / (options[b].costMs - options[a].costMs);
        };
        for (uint32_t i = 0; i < options.size(); ++i) {
            while (size >= 2 && slope(hull[size - 2], hull[size - 1]) <= slope(hull[size - 1], i))
                --size;
            hull[size++] = i;
        }
        for (uint32_t i = 1; i < size; ++i)
            steps_[stepCount++] = {slope(hull[i - 1], hull[i]), light, hull[i]};
    }
    const auto end = steps_.begin() + stepCount;
    std::sort(steps_.begin(), end, [](const Step& a, const Step& b) {
        if (a.gainPerMs != b.gainPerMs) return a.gainPerMs > b.gainPerMs;
        return a.light != b.light ? a.light < b.light : a.option < b.option;
    });
    constexpr uint32_t kEnded = UINT32_MAX;
    dualPerMs_ = 0.0;
    for (auto step = steps_.begin(); step != end; ++step) {
        const uint32_t from = at_[step->light];
        if (from == kEnded) continue;
        const std::span<const Option> options = optionsOf(step->light);
        const double more = options[step->option].costMs - options[from].costMs;
        if (costMs + more > limitMs) {
            dualPerMs_ = std::max(dualPerMs_, step->gainPerMs);
            at_[step->light] = kEnded;
            continue;
        }
        costMs += more;
        at_[step->light] = step->option;
        chosen[step->light] = options[step->option].method;
    }
    fillSlack(problem, limitMs - costMs, chosen);
}

/// What is left over buys the largest single gains that fit, off the hulls too.
void BestPlans::fillSlack(const PlanProblem& problem, double slackMs, std::span<uint32_t> chosen) noexcept
{
    for (uint32_t fill = 0; fill < kFillSteps; ++fill) {
        double bestGain = 0.0, bestMore = 0.0;
        uint32_t bestLight = kNone, bestMethod = kNone;
        for (uint32_t light = 0; light < problem.lights; ++light) {
            if (chosen[light] == kNone) continue;
            const size_t now = size_t{light} * methods_ + chosen[light];
            for (const Option& option : optionsOf(light)) {
                const double more = option.costMs - problem.costsMs[now];
                if (more > slackMs) break;
                const double gain = option.value - problem.values[now];
                if (gain > bestGain) bestGain = gain, bestMore = more, bestLight = light, bestMethod = option.method;
            }
        }
        if (bestLight == kNone) return;
        chosen[bestLight] = bestMethod;
        slackMs -= bestMore;
    }
}

/// At a price p for a millisecond no plan is worth more than p * budget + the sum over the lights of max (value - p *
/// cost), whatever p is (Lagrange). restOver_[i]: that of the lights from i on.
void BestPlans::boundRest(uint32_t lights, double slackMs) noexcept
{
    restOver_[lights] = dualPerMs_ * slackMs;
    for (uint32_t light = lights; light-- > 0;) {
        double most = 0.0; // a light that may have nothing adds nothing
        const std::span<const Option> options = optionsOf(light);
        for (const Option& option : options)
            most = std::max(most, option.value - dualPerMs_ * (option.costMs - options[0].costMs));
        restOver_[light] = restOver_[light + 1] + most;
    }
}

/// From the states of the lights before `light` to those with it. Leaves out what can be worth no more than `hopeless`.
void BestPlans::addLight(uint32_t light, double slackMs, double hopeless) noexcept
{
    const std::span<const Option> options = optionsOf(light);
    Origin* const origins = &origins_[size_t{light} * (bins_ + 1)];
    if (options.empty()) {
        for (uint32_t bin = 0; bin <= bins_; ++bin)
            origins[bin] = {static_cast<uint16_t>(bin), 0};
        return;
    }
    const double binsPerMs = slackMs > 0.0 ? bins_ / slackMs : 0.0;
    const auto words = static_cast<uint32_t>(inUse_.size());
    double costliest = -1.0; // a state worth no more than a cheaper one is not carried on
    for (uint32_t word = 0; word < words;) {
        if (inUse_[word] == 0) {
            ++word;
            continue;
        }
        const uint32_t bin = word * 64 + static_cast<uint32_t>(std::countr_zero(inUse_[word]));
        inUse_[word] &= inUse_[word] - 1;
        const State state = states_[bin];
        if (state.value <= costliest) continue;
        costliest = state.value;
        for (uint32_t i = 0; i < options.size(); ++i) {
            const double extraMs = state.extraMs + (options[i].costMs - options[0].costMs);
            if (extraMs > slackMs) break;
            const double value = state.value + options[i].value;
            if (value - dualPerMs_ * extraMs + restOver_[light + 1] < hopeless) continue;
            const uint32_t to = std::min(bins_, static_cast<uint32_t>(extraMs * binsPerMs));
            State& target = nextStates_[to];
            const uint64_t bit = uint64_t{1} << (to % 64);
            const bool taken = nextInUse_[to / 64] & bit;
            if (taken && (value < target.value || (value == target.value && extraMs >= target.extraMs))) continue;
            target = {value, extraMs};
            nextInUse_[to / 64] |= bit;
            origins[to] = {static_cast<uint16_t>(bin), static_cast<uint8_t>(i)};
        }
    }
    std::swap(states_, nextStates_);
    std::swap(inUse_, nextInUse_); // the one behind is all zero again
}

/// The plan behind the most valuable state of all lights; false: there is none.
bool BestPlans::readTable(uint32_t lights, std::span<uint32_t> chosen) const noexcept
{
    uint32_t bin = UINT32_MAX;
    for (uint32_t i = 0; i <= bins_; ++i)
        if ((inUse_[i / 64] >> (i % 64) & 1) && (bin == UINT32_MAX || states_[i].value > states_[bin].value)) bin = i;
    if (bin == UINT32_MAX) return false;
    for (uint32_t light = lights; light-- > 0;) {
        const Origin origin = origins_[size_t{light} * (bins_ + 1) + bin];
        const std::span<const Option> options = optionsOf(light);
        chosen[light] = options.empty() ? kNone : options[origin.option].method;
        bin = origin.bin;
    }
    return true;
}

/// Dynamic programming over lights. A bin keeps the most valuable state whose extra cost falls into it, with its exact
/// cost: rounding never adds up, and no plan found is costlier than it looks. By induction a state (value, cost) that
/// is lost at one light has a keeper of no less value that costs less than one bin more.
///
/// Only plans worth more than `known`, or as much for less, are looked for; false: there are none. The price at which
/// greedy stopped makes the bound of boundRest() tight, and most states fall below `known` at once.
bool BestPlans::fillTable(const PlanProblem& problem, double limitMs, double known, std::span<uint32_t> chosen) noexcept
{
    double cheapestMs = 0.0;
    for (uint32_t light = 0; light < problem.lights; ++light)
        if (const auto options = optionsOf(light); !options.empty()) cheapestMs += options[0].costMs;
    const double slackMs = std::max(0.0, limitMs - cheapestMs);
    boundRest(problem.lights, slackMs);
    std::fill(inUse_.begin(), inUse_.end(), uint64_t{0});
    std::fill(nextInUse_.begin(), nextInUse_.end(), uint64_t{0});
    states_[0] = {0.0, 0.0};
    inUse_[0] = 1;
    for (uint32_t light = 0; light < problem.lights; ++light)
        addLight(light, slackMs, known * (1.0 - kRounding));
    return readTable(problem.lights, chosen);
}

/// Greedy knows no bins: now and then it finds the better plan, and its price bounds what the table must look at.
BestPlan BestPlans::find(const PlanProblem& problem, std::span<uint32_t> chosen) noexcept
{
    gatherOptions(problem);
    const double limitMs = problem.budgetMs * (1.0 - kRounding);
    walkGreedy(problem, limitMs, chosen);
    const BestPlan greedy = sumOf(problem, chosen);
    if (!greedy.fits || problem.lights > tableLights_) return greedy;
    const std::span<uint32_t> trial = std::span(trial_).first(problem.lights);
    if (!fillTable(problem, limitMs, greedy.value, trial)) return greedy;
    const BestPlan table = sumOf(problem, trial);
    if (!table.fits || table.value <= greedy.value) return greedy;
    std::copy(trial.begin(), trial.end(), chosen.begin());
    return table;
}

} // namespace gnomon::demo
