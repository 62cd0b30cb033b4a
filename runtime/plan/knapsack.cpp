#include "runtime/plan/knapsack.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <limits>

namespace gnomon::plan {

namespace {

/// Sums are made in other orders than sumOf()'s while searching; this much of the budget stays unused so that the last
/// bits never turn a plan that fits into one that does not.
constexpr double kRounding = 1e-12;

/// Up to so many parts greedy tries every set of them: 2^6 times 0.1 us a light.
constexpr int kExhaustiveSets = 6;
/// Sets tried beyond that. Above kTableLights one solution costs tens of microseconds, and a part that many lights
/// share matters less.
constexpr uint32_t kSetTrials = 24;
constexpr uint32_t kSetTrialsMany = 3;

constexpr uint32_t kFillSteps = 4; ///< Single exchanges tried after greedy; gains beyond were below 0.01 %.

bool better(const Solution& a, const Solution& b)
{
    if (a.fits != b.fits) return a.fits;
    if (!a.fits) return a.costMs < b.costMs;
    return a.value > b.value || (a.value == b.value && a.costMs < b.costMs);
}

/// Those that at least one light uses.
MethodSet usedMethods(std::span<const uint32_t> chosen)
{
    MethodSet used;
    for (const uint32_t method : chosen)
        if (method != kNone) used.add(method);
    return used;
}

/// Parts that those of `methods` need.
uint32_t partsOf(const Problem& problem, const MethodSet& methods)
{
    uint32_t parts = 0;
    for (size_t p = 0; p < problem.parts.size(); ++p)
        if (problem.parts[p].methods.meets(methods)) parts |= 1u << p;
    return parts;
}

/// Parts that cost something and that some light may need.
uint32_t dearParts(const Problem& problem)
{
    uint32_t dear = 0;
    MethodSet allowed;
    for (uint32_t light = 0; light < problem.lights; ++light)
        allowed |= problem.allowed[light];
    for (size_t p = 0; p < problem.parts.size(); ++p)
        if (problem.parts[p].ms > 0.0 && problem.parts[p].methods.meets(allowed)) dear |= 1u << p;
    return dear;
}

double msOf(const Problem& problem, uint32_t parts)
{
    double sum = 0.0;
    for (; parts; parts &= parts - 1)
        sum += problem.parts[static_cast<size_t>(std::countr_zero(parts))].ms;
    return sum;
}

/// Methods that need more than `paid`, and what costs nothing.
MethodSet methodsBeyond(const Problem& problem, uint32_t paid)
{
    MethodSet barred;
    for (size_t p = 0; p < problem.parts.size(); ++p)
        if (problem.parts[p].ms > 0.0 && !(paid >> p & 1)) barred |= problem.parts[p].methods;
    return barred;
}

/// The cheapest methods that need nothing but `paid`, and that; infinite where a light is left without any.
double cheapestPaying(const Problem& problem, uint32_t paid)
{
    const MethodSet barred = methodsBeyond(problem, paid);
    double sum = msOf(problem, paid);
    for (uint32_t light = 0; light < problem.lights; ++light) {
        if (problem.allowed[light].empty()) continue;
        double least = std::numeric_limits<double>::infinity();
        for (const uint32_t method : problem.allowed[light] - barred)
            least = std::min(least, problem.costsMs[size_t{light} * problem.methods + method]);
        sum += least;
    }
    return sum;
}

/// No plan that pays `paid` is worth more, whatever is said to be the price of a millisecond (boundRest()).
double mostPaying(const Problem& problem, uint32_t paid, double perMs)
{
    const MethodSet barred = methodsBeyond(problem, paid);
    double sum = perMs * (problem.budgetMs - msOf(problem, paid));
    for (uint32_t light = 0; light < problem.lights; ++light) {
        if (problem.allowed[light].empty()) continue;
        double most = -std::numeric_limits<double>::infinity();
        for (const uint32_t method : problem.allowed[light] - barred) {
            const size_t index = size_t{light} * problem.methods + method;
            most = std::max(most, problem.values[index] - perMs * problem.costsMs[index]);
        }
        sum += most;
    }
    return sum;
}

/// The parts of the cheapest plan: of every set where they are few, otherwise one is dropped as long as that saves.
uint32_t cheapestParts(const Problem& problem)
{
    const uint32_t dear = dearParts(problem);
    uint32_t best = dear;
    double least = cheapestPaying(problem, dear);
    const auto consider = [&](uint32_t paid) {
        const double ms = cheapestPaying(problem, paid);
        if (!(ms < least)) return false;
        least = ms, best = paid;
        return true;
    };
    if (std::popcount(dear) <= kExhaustiveSets) {
        for (uint32_t set = dear; set;)
            consider(set = (set - 1) & dear);
        return best;
    }
    for (uint32_t untried = dear; untried;) {
        const uint32_t part = untried & -untried;
        untried = consider(best & ~part) ? best : untried & ~part;
    }
    return best;
}

} // namespace

double cheapestMs(const Problem& problem) noexcept
{
    return cheapestPaying(problem, cheapestParts(problem));
}

double partsMs(std::span<const SharedPart> parts, const MethodSet& methods) noexcept
{
    double sum = 0.0;
    for (const SharedPart& part : parts)
        if (part.methods.meets(methods)) sum += part.ms;
    return sum;
}

Sums sumOf(const Problem& problem, std::span<const uint32_t> chosen) noexcept
{
    Sums sums;
    for (uint32_t light = 0; light < problem.lights; ++light) {
        if (chosen[light] == kNone) continue;
        const size_t index = size_t{light} * problem.methods + chosen[light];
        sums.value += problem.values[index];
        sums.costMs += problem.costsMs[index];
    }
    sums.costMs += partsMs(problem.parts, usedMethods(chosen.first(problem.lights)));
    return sums;
}

void Knapsack::reserve(uint32_t lights, uint32_t methods, uint32_t tableLights)
{
    const size_t tableSize = std::min(lights, tableLights);
    tableLights_ = std::max(tableLights_, tableLights);
    auto grow = [](auto& vector, size_t size) {
        if (vector.size() < size) vector.resize(size);
    };
    grow(options_, size_t{lights} * methods);
    grow(steps_, size_t{lights} * methods);
    grow(optionCounts_, lights);
    grow(at_, lights);
    grow(trial_, lights);
    grow(states_, bins_ + 1);
    grow(nextStates_, bins_ + 1);
    grow(origins_, tableSize * (bins_ + 1));
    grow(restOver_, tableSize + 1);
    grow(inUse_, bins_ / 64 + 1);
    grow(nextInUse_, bins_ / 64 + 1);
}

std::span<const Knapsack::Option> Knapsack::optionsOf(uint32_t light) const noexcept
{
    return std::span(options_).subspan(size_t{light} * methods_, optionCounts_[light]);
}

/// Undominated options of every light by rising cost and value; false if a light that may have one has none left.
bool Knapsack::gatherOptions(const Problem& problem, const MethodSet& barred) noexcept
{
    methods_ = problem.methods;
    for (uint32_t light = 0; light < problem.lights; ++light) {
        const MethodSet open = problem.allowed[light] - barred;
        optionCounts_[light] = 0;
        if (problem.allowed[light].empty()) continue;
        if (open.empty()) return false;
        Option* const first = &options_[size_t{light} * methods_];
        uint32_t count = 0;
        for (const uint32_t method : open) {
            const size_t index = size_t{light} * methods_ + method;
            const Option option{problem.costsMs[index], problem.values[index], method};
            // Insertion by cost; among equals the dearer value first, then registry order (methods come in order).
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
    return true;
}

/// Buys steps along the hulls by gain per millisecond; a step that does not fit ends its light's walk.
void Knapsack::walkGreedy(const Problem& problem, double limitMs, std::span<uint32_t> chosen) noexcept
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
void Knapsack::fillSlack(const Problem& problem, double slackMs, std::span<uint32_t> chosen) noexcept
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
void Knapsack::boundRest(uint32_t lights, double slackMs) noexcept
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
void Knapsack::addLight(uint32_t light, double slackMs, double hopeless) noexcept
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
    double dearest = -1.0; // a state worth no more than a cheaper one is not carried on
    for (uint32_t word = 0; word < words;) {
        if (inUse_[word] == 0) {
            ++word;
            continue;
        }
        const uint32_t bin = word * 64 + static_cast<uint32_t>(std::countr_zero(inUse_[word]));
        inUse_[word] &= inUse_[word] - 1;
        const State state = states_[bin];
        if (state.value <= dearest) continue;
        dearest = state.value;
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
bool Knapsack::readTable(uint32_t lights, std::span<uint32_t> chosen) const noexcept
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
/// cost: rounding never adds up, and no plan found is dearer than it looks. By induction a state (value, cost) that is
/// lost at one light has a keeper of no less value that costs less than one bin more.
///
/// Only plans worth more than `known`, or as much for less, are looked for; false: there are none. The price at which
/// greedy stopped makes the bound of boundRest() tight, and most states fall below `known` at once.
bool Knapsack::fillTable(const Problem& problem, double limitMs, double known, std::span<uint32_t> chosen) noexcept
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

/// With `paid` paid in advance, and methods that need other parts left out, the rest is an ordinary knapsack.
Solution Knapsack::solvePaying(const Problem& problem, Method method, uint32_t paid, double known,
                               std::span<uint32_t> chosen) noexcept
{
    Solution none{.costMs = std::numeric_limits<double>::infinity()};
    if (!gatherOptions(problem, methodsBeyond(problem, paid))) return none;
    const double limitMs = problem.budgetMs * (1.0 - kRounding) - msOf(problem, paid);
    if (method == Method::greedy)
        walkGreedy(problem, limitMs, chosen);
    else if (!fillTable(problem, limitMs, known, chosen))
        return none;
    const Sums sums = sumOf(problem, chosen);
    return {sums.value, sums.costMs, sums.costMs <= problem.budgetMs};
}

/// Solves with other parts paid and keeps the better plan.
bool Knapsack::tryPaying(const Problem& problem, Method method, uint32_t paid, Solution& best,
                         std::span<uint32_t> chosen) noexcept
{
    if (best.fits && mostPaying(problem, paid, dualPerMs_) < best.value * (1.0 - kRounding)) return false;
    const std::span<uint32_t> trial = std::span(trial_).first(problem.lights);
    const Solution solution = solvePaying(problem, method, paid, best.fits ? best.value : 0.0, trial);
    if (!better(solution, best)) return false;
    best = solution;
    std::copy(trial.begin(), trial.end(), chosen.begin());
    paid_ = paid;
    return true;
}

/// Which parts to pay: every set where they are few, otherwise a descent that drops or adds one at a time.
Solution Knapsack::solveGreedy(const Problem& problem, std::span<uint32_t> chosen) noexcept
{
    assert(problem.lights <= optionCounts_.size() && problem.methods <= kMaxMethods &&
           problem.parts.size() <= kMaxParts);
    chosen = chosen.first(problem.lights);
    const uint32_t dear = dearParts(problem);
    const bool few = problem.lights <= kTableLights;
    paid_ = dear;
    Solution best = solvePaying(problem, Method::greedy, paid_, 0.0, chosen);
    if (dear == 0) return best;
    if (few && std::popcount(dear) <= kExhaustiveSets) {
        tryPaying(problem, Method::greedy, 0, best, chosen);
        for (uint32_t set = (dear - 1) & dear; set; set = (set - 1) & dear)
            tryPaying(problem, Method::greedy, set, best, chosen);
        return best;
    }
    const uint32_t used = partsOf(problem, usedMethods(chosen)) & dear;
    if (used != dear) tryPaying(problem, Method::greedy, used, best, chosen); // the rest need not be paid
    if (!best.fits) tryPaying(problem, Method::greedy, cheapestParts(problem), best, chosen); // fits if anything does
    uint32_t trials = few ? kSetTrials : kSetTrialsMany;
    for (bool improved = true; improved && trials > 0;) {
        improved = false;
        // With many lights only what is used is dropped.
        uint32_t flips = dear & (few ? ~0u : partsOf(problem, usedMethods(chosen)));
        for (; flips && trials > 0; flips &= flips - 1, --trials)
            improved |= tryPaying(problem, Method::greedy, paid_ ^ (flips & -flips), best, chosen);
    }
    return best;
}

/// The table for the set of parts that greedy finds best, and for the sets one part away from it.
Solution Knapsack::solveTable(const Problem& problem, std::span<uint32_t> chosen) noexcept
{
    assert(problem.lights <= tableLights_);
    chosen = chosen.first(problem.lights);
    // Greedy knows no bins: now and then it finds the better plan, and it costs a tenth of the table.
    Solution best = solveGreedy(problem, chosen);
    const uint32_t paid = paid_;
    tryPaying(problem, Method::table, paid, best, chosen);
    for (uint32_t flips = dearParts(problem); flips; flips &= flips - 1)
        tryPaying(problem, Method::table, paid ^ (flips & -flips), best, chosen);
    return best;
}

Solution Knapsack::solve(const Problem& problem, std::span<uint32_t> chosen) noexcept
{
    return problem.lights > kTableLights ? solveGreedy(problem, chosen) : solveTable(problem, chosen);
}

} // namespace gnomon::plan
