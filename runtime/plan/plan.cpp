#include "runtime/plan/plan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace gnomon::plan {

const rules::Policy& PlanInput::inForce() const noexcept
{
    static const rules::Policy defaults{};
    return policy ? *policy : defaults;
}

void PlanStep::reserve(uint32_t lights, uint32_t methods)
{
    const auto grow = [](auto& vector, size_t size) { vector.resize(std::max(vector.size(), size)); };
    const size_t cells = size_t{lights} * methods;
    greedy_.reserve(lights, methods);
    grow(values_, cells);
    grow(worths_, cells);
    grow(costsMs_, cells);
    grow(why_, cells);
    if (cells > orders_.size()) orderedMethods_ = 0;
    grow(orders_, cells);
    grow(allowed_, lights);
    grow(current_, lights);
    grow(target_, lights);
    grow(saved_, lights);
    grow(plans_, lights);
    grow(terms_, methods);
}

/// One standard error of the sum, lights taken as independent; at least the policy's share, at most kMostHeadroom.
double PlanStep::headroomMs(const PlanInput& input, double& errorMs) const noexcept
{
    double variance = 0.0;
    for (uint32_t light = 0; light < lightCount_; ++light) {
        uint32_t m = current_[light];
        if (m == kNone && !allowed_[light].empty()) m = *allowed_[light].begin();
        if (m == kNone) continue;
        const double sigma = input.candidates[at(light, m)].sigmaMs;
        if (std::isfinite(sigma)) variance += sigma * sigma;
    }
    errorMs = std::sqrt(variance);
    return std::min(std::max(input.inForce().budget.headroom * input.budgetMs, errorMs),
                    kMostHeadroom * input.budgetMs);
}

// --- sums, and what lights share ---

void PlanStep::countUsers() noexcept
{
    users_.fill(0);
    for (uint32_t light = 0; light < lightCount_; ++light)
        if (current_[light] != kNone)
            for (uint32_t rest = greedy_.partsOf(current_[light]); rest; rest &= rest - 1)
                ++users_[static_cast<size_t>(std::countr_zero(rest))];
}

double PlanStep::sharedMs(uint32_t light, uint32_t method) const noexcept
{
    const uint32_t own = current_[light] == kNone ? 0 : greedy_.partsOf(current_[light]);
    double ms = 0.0;
    for (uint32_t rest = greedy_.partsOf(method); rest; rest &= rest - 1) {
        const auto part = static_cast<size_t>(std::countr_zero(rest));
        if (users_[part] == (own >> part & 1)) ms += parts_[part].ms; // nobody else
    }
    return ms;
}

double PlanStep::unpaidMs(uint32_t method) const noexcept
{
    return greedy_.msOf(greedy_.partsOf(method) & ~partsInUse());
}

uint32_t PlanStep::partsInUse() const noexcept
{
    uint32_t parts = 0;
    for (size_t part = 0; part < parts_.size(); ++part)
        if (users_[part] > 0) parts |= 1u << part;
    return parts;
}

PlanStep::Sums PlanStep::sumOf(std::span<const uint32_t> chosen) const noexcept
{
    Sums sums;
    uint32_t parts = 0;
    for (uint32_t light = 0; light < lightCount_; ++light) {
        if (chosen[light] == kNone) continue;
        sums.worth += worths_[at(light, chosen[light])];
        sums.ms += costsMs_[at(light, chosen[light])];
        parts |= greedy_.partsOf(chosen[light]);
    }
    sums.ms += greedy_.msOf(parts);
    return sums;
}

/// How the plan's time changes if one light moves.
double PlanStep::moveMs(uint32_t light, uint32_t to) const noexcept
{
    const uint32_t from = current_[light];
    return costsMs_[at(light, to)] + sharedMs(light, to) -
           (from == kNone ? 0.0 : costsMs_[at(light, from)] + sharedMs(light, from));
}

void PlanStep::move(uint32_t light, uint32_t to) noexcept
{
    current_[light] = to;
    countUsers();
}

// --- the step ---

/// What all lights would have if nothing but Option::worth held them. @return the limit that it keeps, ms.
double PlanStep::findTarget(const PlanInput& input, double headroom, PlanReport& report) noexcept
{
    const auto target = std::span(target_).first(lightCount_);
    report.usableMs = input.budgetMs - headroom;
    const double limitMs = report.feasible ? std::max(report.usableMs, report.cheapestMs) : report.usableMs;
    greedy_.solve(limitMs, partsInUse(), input.frame, isFresh(input) ? greedy_.partSets() : 1, target);
    return limitMs;
}

/// Towards the target, what loses least for its time first. What saves time has to be drawn first: no more of that than
/// kMostFirst of the budget, but for one light, so that a repair does not cost more than it saves.
/// @return false if that is why the limit is not reached
bool PlanStep::payUntil(const PlanInput& input, double limitMs) noexcept
{
    double firstMs = 0.0;
    for (double ms = sumOf(current_).ms; ms > limitMs;) {
        double least = std::numeric_limits<double>::infinity();
        uint32_t payer = kNone;
        bool waits = false;
        for (uint32_t light = 0; light < lightCount_; ++light) {
            const uint32_t from = current_[light], to = target_[light];
            if (from == to || from == kNone || to == kNone) continue;
            const double savedMs = -moveMs(light, to);
            const double loss = worths_[at(light, from)] - worths_[at(light, to)];
            if (!(savedMs > 0.0) || loss >= least * savedMs) continue;
            if (firstMs > 0.0 && firstMs + input.candidates[at(light, to)].firstFrameMs > kMostFirst * input.budgetMs)
                waits = true;
            else
                least = loss / savedMs, payer = light;
        }
        if (payer == kNone) return !waits;
        ms += moveMs(payer, target_[payer]);
        firstMs += input.candidates[at(payer, target_[payer])].firstFrameMs;
        move(payer, target_[payer]);
    }
    return true;
}

/// Whether the first frame costs more than the stay would gain, the gain in milliseconds at the plan's average price.
Hold PlanStep::holdOf(const PlanInput& input, uint32_t light) const noexcept
{
    const size_t from = at(light, current_[light]), to = at(light, target_[light]);
    const double gain = values_[to] - values_[from], firstFrameMs = input.candidates[to].firstFrameMs;
    if (!(firstFrameMs > 0.0) || gain <= 0.0) return Hold::none; // what saves time has it in its price
    const Sums sums = sumOf(current_);
    return gain / sums.worth * sums.ms * kExpectedStayFrames <= firstFrameMs ? Hold::firstFrame : Hold::none;
}

/// Moves one light to its target and, where that does not fit, others down to theirs. All stays as it was unless that
/// is worth more, or as much for less.
Hold PlanStep::tryUpgrade(const PlanInput& input, uint32_t light, double limitMs) noexcept
{
    if (const Hold hold = holdOf(input, light); hold != Hold::none) return hold;
    const Sums before = sumOf(current_);
    std::copy_n(current_.begin(), lightCount_, saved_.begin());
    move(light, target_[light]);
    payUntil(input, limitMs);
    const Sums after = sumOf(current_);
    Hold hold = Hold::none;
    if (after.ms > limitMs || after.worth < before.worth || (after.worth == before.worth && after.ms >= before.ms))
        hold = Hold::threshold;
    else if (after.ms > before.ms && calmFrames_ < kSpareFrames)
        hold = Hold::spareTime;
    if (hold == Hold::none) return hold;
    std::copy_n(saved_.begin(), lightCount_, current_.begin());
    countUsers();
    return hold;
}

/// Voluntary changes, few at a time, largest gain first.
void PlanStep::improve(const PlanInput& input, double limitMs, PlanReport& report) noexcept
{
    const Sums now = sumOf(current_), target = sumOf(target_);
    const bool gains = target.worth > now.worth || (target.worth == now.worth && target.ms < now.ms);
    const uint32_t quota = input.inForce().hysteresis.upgradesPerFrame;
    for (uint32_t tries = 0;;) {
        uint32_t next = kNone;
        double most = -1.0;
        for (uint32_t light = 0; light < lightCount_; ++light) {
            const uint32_t from = current_[light], to = target_[light];
            if (from == to || from == kNone || to == kNone || plans_[light].hold != Hold::none) continue;
            const double gain = worths_[at(light, to)] - worths_[at(light, from)];
            if (!gains)
                plans_[light].hold = Hold::threshold;
            else if (tries == 2 * quota || report.upgrades == quota)
                plans_[light].hold = Hold::quota;
            else if (gain >= 0.0 && gain > most)
                most = gain, next = light;
        }
        if (next == kNone) break;
        ++tries;
        plans_[next].hold = tryUpgrade(input, next, limitMs);
        report.upgrades += plans_[next].hold == Hold::none;
    }
    // No light gains anything alone: together they may, as where they leave a part that they share.
    const auto held = [](const LightPlan& plan) { return plan.hold == Hold::firstFrame; };
    if (quota > 0 && gains && report.upgrades == 0 && target.ms <= limitMs &&
        (calmFrames_ == kSpareFrames || target.ms < now.ms) &&
        std::none_of(plans_.begin(), plans_.begin() + lightCount_, held)) {
        takeTarget();
        report.upgrades = quota;
    }
    if (report.upgrades > 0) report.cause = Cause::gain;
}

void PlanStep::takeTarget() noexcept
{
    std::copy_n(target_.begin(), lightCount_, current_.begin());
    countUsers();
}

/// Lights that must not try a method yet stay where they are; where some have no method, or the budget is broken, the
/// search looks for a target without those methods. @return the limit that the target keeps, ms.
double PlanStep::waitForTrials(const PlanInput& input, double headroom, double limitMs, bool over,
                               PlanReport& report) noexcept
{
    if (isFresh(input) || !gateTrials(input)) return limitMs;
    bool searches = over;
    for (uint32_t light = 0; light < lightCount_; ++light)
        if (target_[light] != kNone && waitsWith(light, target_[light])) {
            searches = searches || current_[light] == kNone;
            target_[light] = current_[light];
        }
    if (!searches) return limitMs;
    greedy_.begin(methods_, parts_);
    offerAll(input);
    greedy_.cheapestMs();
    return findTarget(input, headroom, report);
}

void PlanStep::planWithinBudget(const PlanInput& input, PlanReport& report) noexcept
{
    const auto current = std::span(current_).first(lightCount_), target = std::span(target_).first(lightCount_);
    const double headroom = headroomMs(input, report.standardErrorMs);
    const double mostMs = std::max(input.budgetMs - (1.0 - kKeepShare) * headroom, report.cheapestMs);
    double limitMs = findTarget(input, headroom, report);
    limitMs = waitForTrials(input, headroom, limitMs, !report.feasible || sumOf(current).ms > mostMs, report);
    if (isFresh(input)) {
        takeTarget();
        report.cause = Cause::fresh;
        calmFrames_ = kSpareFrames;
        return;
    }
    for (uint32_t light = 0; light < lightCount_; ++light)
        if (current[light] == kNone && target[light] != kNone) {
            current[light] = target[light];
            report.cause = Cause::forced;
        }
    countUsers();
    // Where nothing fits, the target is over the budget too, and all that it saves is taken.
    const bool over = sumOf(current).ms > (report.feasible ? mostMs : sumOf(target).ms);
    calmFrames_ =
        over || !report.feasible || input.measuredMs > input.budgetMs ? 0 : std::min(calmFrames_ + 1, kSpareFrames);
    if (!over) return improve(input, limitMs, report);
    std::copy_n(current_.begin(), lightCount_, saved_.begin());
    if (payUntil(input, limitMs) && sumOf(current).ms > limitMs) takeTarget();
    if (!std::equal(current.begin(), current.end(), saved_.begin())) report.cause = Cause::repaired;
}

PlanReport PlanStep::step(const PlanInput& whole) noexcept
{
    admit(whole);
    PlanReport report{.budgetMs = whole.budgetMs, .cheapestMs = greedy_.cheapestMs()};
    if (whole.perCheapest > 0.0) report.budgetMs = whole.perCheapest * report.cheapestMs;
    if (whole.budgetMs > 0.0)
        report.budgetMs = std::clamp(report.budgetMs, whole.budgetMs / kLeash, whole.budgetMs * kLeash);
    // What concerns the lights alone: budget and measurement less what is shared.
    PlanInput input = whole;
    input.budgetMs = std::max(report.budgetMs - whole.sharedMs, kLeastShare * report.budgetMs);
    if (whole.measuredMs >= 0.0) input.measuredMs = std::max(whole.measuredMs - whole.sharedMs, 0.0);
    report.feasible = report.cheapestMs <= input.budgetMs;
    planWithinBudget(input, report);
    tryDear(input, report);
    started_ = true;
    report.partsMs = greedy_.msOf(partsInUse());
    report.predictedMs = sumOf(current_).ms;
    report.overMs = std::max(0.0, report.predictedMs - input.budgetMs);
    remember(input, report);
    for (uint32_t light = 0; light < lightCount_; ++light)
        explainLight(input, light, report);
    return report;
}

} // namespace gnomon::plan
