#include "runtime/plan/plan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "runtime/plan/utility.hpp"

namespace gnomon::plan {

namespace {

bool isBanned(const LightMemory& memory, uint32_t from, uint32_t to, uint64_t frame)
{
    for (const LightMemory::Ban& ban : memory.bans)
        if (frame < ban.until && ((ban.a == from && ban.b == to) || (ban.a == to && ban.b == from))) return true;
    return false;
}

void ban(LightMemory& memory, uint32_t a, uint32_t b, uint64_t until)
{
    const auto same = std::find_if(memory.bans.begin(), memory.bans.end(), [&](const LightMemory::Ban& held) {
        return (held.a == a && held.b == b) || (held.a == b && held.b == a);
    });
    auto oldest = std::min_element(memory.bans.begin(), memory.bans.end(),
                                   [](const auto& x, const auto& y) { return x.until < y.until; });
    *(same != memory.bans.end() ? same : oldest) = {a, b, until};
}

/// True if going back to `to` now would be the last step of an A-B-A.
bool wouldFlip(const LightMemory& memory, uint32_t to, uint64_t frame, uint32_t window)
{
    return memory.previous != kNone && to == memory.previous && frame - memory.switchedAt <= window;
}

} // namespace

const rules::Policy& PlanInput::inForce() const noexcept
{
    static const rules::Policy defaults{};
    return policy ? *policy : defaults;
}

void PlanStep::reserve(uint32_t lights, uint32_t methods)
{
    auto grow = [](auto& vector, size_t size) {
        if (vector.size() < size) vector.resize(size);
    };
    knapsack_.reserve(lights, methods);
    const size_t cells = size_t{lights} * methods;
    grow(values_, cells);
    grow(costsMs_, cells);
    grow(why_, cells);
    grow(allowed_, lights);
    grow(current_, lights);
    grow(best_, lights);
    grow(saved_, lights);
    grow(plans_, lights);
    grow(users_, methods);
    grow(otherUsers_, methods);
    grow(terms_, methods);
}

/// Allocation::None. The clock has no say, not even in ties: the incumbent, then registry order.
void PlanStep::chooseBySuitability(const PlanInput& input) noexcept
{
    for (uint32_t light = 0; light < lightCount_; ++light) {
        uint32_t best = kNone;
        for (const uint32_t m : allowed_[light]) {
            const int32_t suitability = input.candidates[at(light, m)].suitability;
            const int32_t leader = best == kNone ? 0 : input.candidates[at(light, best)].suitability;
            if (best == kNone || suitability > leader ||
                (suitability == leader && m == input.lights[light].memory->incumbent))
                best = m;
        }
        current_[light] = best_[light] = best;
    }
}

/// One standard error of the sum, lights taken as independent; at least the policy's share, at most kMostHeadroom.
double PlanStep::headroomMs(const PlanInput& input, std::span<const uint32_t> chosen, double& errorMs) const noexcept
{
    double variance = 0.0;
    for (uint32_t light = 0; light < lightCount_; ++light) {
        uint32_t m = chosen[light];
        if (m == kNone && !allowed_[light].empty()) m = *allowed_[light].begin();
        if (m == kNone) continue;
        const double sigma = input.candidates[at(light, m)].sigmaMs;
        if (std::isfinite(sigma)) variance += sigma * sigma;
    }
    errorMs = std::sqrt(variance);
    return std::min(std::max(input.inForce().budget.headroom * input.budgetMs, errorMs),
                    kMostHeadroom * input.budgetMs);
}

void PlanStep::countUsers() noexcept
{
    std::ranges::fill(users_, 0);
    for (uint32_t light = 0; light < lightCount_; ++light)
        if (current_[light] != kNone) ++users_[current_[light]];
    used_ = {};
    for (uint32_t m = 0; m < methods_; ++m)
        if (users_[m] > 0) used_.add(m);
    sums_ = sumOf(problem_, std::span(current_).first(lightCount_));
}

/// The methods of the other lights.
MethodSet PlanStep::usedWithout(uint32_t light) const noexcept
{
    const uint32_t own = current_[light];
    return own != kNone && users_[own] == 1 ? used_ - MethodSet{own} : used_;
}

/// What `method` needs of shared parts beyond those of the `used` ones.
double PlanStep::addedMs(const MethodSet& used, uint32_t method) const noexcept
{
    return partsMs(problem_.parts, used | MethodSet{method}) - partsMs(problem_.parts, used);
}

/// How the plan's cost changes if one light moves, shared parts included.
double PlanStep::moveMs(uint32_t light, uint32_t to) const noexcept
{
    const uint32_t from = current_[light];
    double change = costsMs_[at(light, to)];
    if (from != kNone) change -= costsMs_[at(light, from)];
    if (from == to || problem_.parts.empty()) return change;
    const MethodSet others = usedWithout(light);
    return change + addedMs(others, to) - (from == kNone ? 0.0 : addedMs(others, from));
}

void PlanStep::move(uint32_t light, uint32_t to) noexcept
{
    sums_.costMs += moveMs(light, to);
    sums_.value += values_[at(light, to)];
    const MethodSet others = usedWithout(light);
    if (const uint32_t from = current_[light]; from != kNone) {
        sums_.value -= values_[at(light, from)];
        --users_[from];
    }
    ++users_[to];
    used_ = others | MethodSet{to};
    current_[light] = to;
}

/// The single downgrade that loses least among those that suffice; where none does, the best loss per millisecond, and
/// again. False if kMostRepairs were not enough.
bool PlanStep::repair(const PlanInput& input, double usableMs) noexcept
{
    const rules::Policy::Hysteresis& hysteresis = input.inForce().hysteresis;
    for (uint32_t round = 0; sums_.costMs > usableMs; ++round) {
        if (round == kMostRepairs) return false;
        const double excess = sums_.costMs - usableMs;
        bool suffices = false;
        double bestScore = std::numeric_limits<double>::infinity();
        uint32_t bestLight = kNone, bestMethod = kNone;
        for (uint32_t light = 0; light < lightCount_; ++light) {
            if (current_[light] == kNone) continue;
            for (const uint32_t m : allowed_[light]) {
                const double saved = -moveMs(light, m);
                if (!(saved > 0.0)) continue;
                const bool enough = saved >= excess;
                if (suffices && !enough) continue;
                double loss = values_[at(light, current_[light])] - values_[at(light, m)];
                if (wouldFlip(*input.lights[light].memory, m, input.frame, hysteresis.flipWindowFrames))
                    loss += hysteresis.planGain * sums_.value; // a flip is worth what a change must gain
                const double score = enough ? loss : loss / saved;
                if (enough == suffices && score >= bestScore) continue;
                suffices = enough, bestScore = score, bestLight = light, bestMethod = m;
            }
        }
        if (bestLight == kNone) return false;
        move(bestLight, bestMethod);
    }
    return true;
}

/// Whether the light has just left that method, or flipped between it and its own.
bool PlanStep::isHeld(const PlanInput& input, uint32_t light, uint32_t to) const noexcept
{
    const LightMemory& memory = *input.lights[light].memory;
    return isBanned(memory, current_[light], to, input.frame) ||
           wouldFlip(memory, to, input.frame, input.inForce().hysteresis.flipWindowFrames);
}

/// What forbids a light to move to the best plan's method, before prices are compared.
Hold PlanStep::holdOf(const PlanInput& input, uint32_t light) const noexcept
{
    const uint32_t to = best_[light];
    if (isHeld(input, light, to)) return Hold::ban;
    // Worth of the gain in milliseconds, at the plan's average price; the stay must earn the first frame.
    const double gain = values_[at(light, to)] - values_[at(light, current_[light])];
    const double utilityMs = sums_.value > 0.0 ? gain / sums_.value * sums_.costMs : input.budgetMs;
    const double firstFrameMs = input.candidates[at(light, to)].firstFrameMs;
    if (firstFrameMs > 0.0 && utilityMs * kExpectedStayFrames <= firstFrameMs) return Hold::firstFrame;
    return Hold::none;
}

/// Moves one light up and, where that does not fit, others down towards the best plan, cheapest loss per millisecond
/// first. Leaves the plan as it was unless all of it pays.
Hold PlanStep::tryUpgrade(const PlanInput& input, uint32_t light, double usableMs) noexcept
{
    const Sums before = sums_;
    std::copy_n(current_.begin(), lightCount_, saved_.begin());
    move(light, best_[light]);
    while (sums_.costMs > usableMs) {
        double bestScore = std::numeric_limits<double>::infinity();
        uint32_t payer = kNone;
        for (uint32_t i = 0; i < lightCount_; ++i) {
            if (best_[i] == kNone || best_[i] == current_[i]) continue;
            const double saved = -moveMs(i, best_[i]);
            const double loss = values_[at(i, current_[i])] - values_[at(i, best_[i])];
            if (!(saved > 0.0) || loss / saved >= bestScore || holdOf(input, i) == Hold::ban) continue;
            bestScore = loss / saved, payer = i;
        }
        if (payer == kNone) break;
        move(payer, best_[payer]);
    }
    Hold hold = Hold::none;
    if (sums_.costMs > usableMs || sums_.value <= before.value)
        hold = Hold::payers;
    else if (sums_.costMs > before.costMs && calmFrames_ < kSpareFrames)
        hold = Hold::spareTime;
    if (hold == Hold::none) return hold;
    std::copy_n(saved_.begin(), lightCount_, current_.begin());
    countUsers();
    sums_ = before; // to the last bit
    return hold;
}

/// Voluntary changes: only if the whole plan gains enough, then few at a time, largest gain first.
void PlanStep::improve(const PlanInput& input, PlanReport& report) noexcept
{
    const rules::Policy::Hysteresis& hysteresis = input.inForce().hysteresis;
    // A gain below the threshold is taken all the same once what was missed adds up: then it is no passing thing.
    const double missed = report.bestValue - sums_.value;
    missedGain_ = missed > 0.0 && sums_.value > 0.0 ? missedGain_ + missed / sums_.value : 0.0;
    const bool worthwhile =
        missed > hysteresis.planGain * sums_.value || missedGain_ > kPatienceFrames * hysteresis.planGain;
    for (;;) {
        uint32_t next = kNone;
        double bestGain = 0.0;
        for (uint32_t light = 0; light < lightCount_; ++light) {
            if (best_[light] == kNone || best_[light] == current_[light] || plans_[light].hold != Hold::none) continue;
            const double gain = values_[at(light, best_[light])] - values_[at(light, current_[light])];
            if (!worthwhile)
                plans_[light].hold = Hold::threshold;
            else if (report.upgrades >= hysteresis.upgradesPerFrame)
                plans_[light].hold = Hold::quota;
            else if (gain > bestGain)
                bestGain = gain, next = light;
        }
        if (next == kNone) break;
        Hold hold = holdOf(input, next);
        if (hold == Hold::none) hold = tryUpgrade(input, next, report.usableMs);
        plans_[next].hold = hold;
        if (hold != Hold::none) continue;
        ++report.upgrades;
        report.cause = Cause::gain;
        missedGain_ = 0.0;
    }
    // Many change at once: not while the budget is kept and broken in turn.
    if (report.upgrades > 0 || calmFrames_ < kSpareFrames || !isStuck()) return;
    if (!takeTogether(input, report.usableMs, hysteresis.planGain)) return;
    report.upgrades = hysteresis.upgradesPerFrame;
    report.cause = Cause::gain;
    missedGain_ = 0.0;
}

/// Whether a light would change if others paid for it.
bool PlanStep::isStuck() const noexcept
{
    const auto lights = std::span(plans_).first(lightCount_);
    return std::any_of(lights.begin(), lights.end(), [](const LightPlan& plan) { return plan.hold == Hold::payers; });
}

/// The best plan's methods at once, for all lights that nothing holds. So lights leave a part that they share, where
/// none of them saves it alone, and so a plan is reached to which no single step leads. All stays as it was if that
/// takes more than `limitMs`, or gains no more than `enough` of the plan's value.
bool PlanStep::takeTogether(const PlanInput& input, double limitMs, double enough) noexcept
{
    const double least = (1.0 + enough) * sums_.value;
    std::copy_n(current_.begin(), lightCount_, saved_.begin());
    for (uint32_t light = 0; light < lightCount_; ++light) {
        const uint32_t from = saved_[light], to = best_[light];
        if (from == to || from == kNone || to == kNone) continue;
        const Hold hold = holdOf(input, light);
        const bool gains = values_[at(light, to)] > values_[at(light, from)];
        if (hold == Hold::ban || (gains && hold == Hold::firstFrame))
            plans_[light].hold = hold;
        else
            current_[light] = to;
    }
    countUsers();
    if (sums_.costMs <= limitMs && sums_.value > least) return true;
    std::copy_n(saved_.begin(), lightCount_, current_.begin());
    countUsers();
    return false;
}

/// What the lights have, as far as they may keep it.
void PlanStep::keepIncumbents(const PlanInput& input) noexcept
{
    for (uint32_t light = 0; light < lightCount_; ++light) {
        const uint32_t incumbent = input.lights[light].memory->incumbent;
        const bool holds = incumbent < methods_ && allowed_[light].has(incumbent);
        current_[light] = holds ? incumbent : kNone;
    }
}

/// The best plan for the budget less `headroom` (ms), or for what its own methods need as headroom.
Solution PlanStep::solveWithin(const PlanInput& input, double headroom, PlanReport& report) noexcept
{
    const auto best = std::span(best_).first(lightCount_);
    report.usableMs = problem_.budgetMs = input.budgetMs - headroom;
    Solution solution = knapsack_.solve(problem_, best);
    // Methods that the lights have not shown yet are less sure than the incumbents: once more with their own headroom.
    double errorMs = 0.0;
    const double bestHeadroom = headroomMs(input, best, errorMs);
    if (solution.fits && solution.costMs > input.budgetMs - bestHeadroom) {
        report.usableMs = problem_.budgetMs = input.budgetMs - bestHeadroom;
        solution = knapsack_.solve(problem_, best);
    }
    // Above the headroom alone the cheapest still keeps the budget; only beyond it nothing is lost by a tenth more.
    if (!solution.fits && solution.costMs > input.budgetMs) {
        reduceCost(input, best);
        const Sums sums = sumOf(problem_, best);
        solution.value = sums.value, solution.costMs = sums.costMs;
    }
    report.bestValue = solution.value;
    report.bestMs = solution.costMs;
    return solution;
}

/// False if it was the plan already.
bool PlanStep::takeBest() noexcept
{
    if (std::equal(best_.begin(), best_.begin() + lightCount_, current_.begin())) return false;
    std::copy_n(best_.begin(), lightCount_, current_.begin());
    countUsers();
    return true;
}

/// A plan over its budget: repaired where one fits, else for what is cheaper, or worth more and no dearer.
void PlanStep::reduceOverrun(const PlanInput& input, const Solution& best, PlanReport& report) noexcept
{
    // Where no plan fits, noise decides which is the cheapest: only a fair gain, or the budget itself, is worth a
    // change.
    const double planGain = input.inForce().hysteresis.planGain;
    const bool saves = best.fits || best.costMs < (1.0 - planGain) * sums_.costMs ||
                       (sums_.costMs > input.budgetMs && best.costMs <= input.budgetMs);
    if (saves) {
        if ((best.fits && repair(input, report.usableMs)) || takeBest()) report.cause = Cause::repaired;
    } else if (takeTogether(input, (1.0 + kNoDearer) * sums_.costMs, planGain)) {
        report.cause = Cause::gain;
    } else {
        for (uint32_t light = 0; light < lightCount_; ++light)
            if (best_[light] != current_[light] && plans_[light].hold == Hold::none)
                plans_[light].hold = Hold::threshold;
    }
}

void PlanStep::planWithinBudget(const PlanInput& input, PlanReport& report) noexcept
{
    keepIncumbents(input);
    const auto current = std::span(current_).first(lightCount_);
    const double headroom = headroomMs(input, current, report.standardErrorMs);
    const Solution solution = solveWithin(input, headroom, report);
    if (input.cut || !started_) {
        takeBest();
        calmFrames_ = kSpareFrames;
        report.cause = Cause::fresh;
        return;
    }
    for (uint32_t light = 0; light < lightCount_; ++light)
        if (current[light] == kNone && best_[light] != kNone) {
            current[light] = best_[light];
            report.cause = Cause::forced;
        }
    countUsers();
    const double keepMs = input.budgetMs - (1.0 - kKeepShare) * headroom;
    const bool over = sums_.costMs > keepMs;
    calmFrames_ = over || input.measuredMs > input.budgetMs ? 0 : std::min(calmFrames_ + 1, kSpareFrames);
    if (over) return reduceOverrun(input, solution, report);
    improve(input, report);
    economise(input, report);
}

/// Writes the decision into the lights' memories; finds flips.
void PlanStep::remember(const PlanInput& input, PlanReport& report) noexcept
{
    const rules::Policy::Hysteresis& hysteresis = input.inForce().hysteresis;
    for (uint32_t light = 0; light < lightCount_; ++light) {
        LightMemory& memory = *input.lights[light].memory;
        LightPlan& plan = plans_[light];
        plan.chosen = current_[light];
        plan.wanted = best_[light];
        if (plan.chosen != kNone) {
            plan.benefit = values_[at(light, plan.chosen)];
            plan.ms = costsMs_[at(light, plan.chosen)];
        }
        report.floorsUnmet += plan.floorUnmet;
        if (input.cut) memory.bans.fill({}), memory.previous = kNone;
        if (plan.chosen == memory.incumbent || plan.chosen == kNone) continue;
        plan.switched = memory.incumbent != kNone;
        plan.flipped = plan.switched && wouldFlip(memory, plan.chosen, input.frame, hysteresis.flipWindowFrames);
        if (plan.flipped) ban(memory, memory.incumbent, plan.chosen, input.frame + hysteresis.flipBanFrames);
        report.switches += plan.switched;
        report.flips += plan.flipped;
        memory.previous = input.cut ? kNone : memory.incumbent;
        memory.incumbent = plan.chosen;
        memory.switchedAt = input.frame;
    }
}

/// What concerns the lights alone: budget and measurement less what is shared.
PlanInput PlanStep::lightsPart(const PlanInput& whole, double budgetMs) noexcept
{
    PlanInput lights = whole;
    lights.budgetMs = std::max(budgetMs - whole.sharedMs, kLeastShare * budgetMs);
    if (whole.measuredMs >= 0.0) lights.measuredMs = std::max(whole.measuredMs - whole.sharedMs, 0.0);
    return lights;
}

PlanReport PlanStep::step(const PlanInput& whole) noexcept
{
    admit(whole);
    const double cheapestMs = plan::cheapestMs(problem_);
    double budgetMs = whole.perCheapest > 0.0 ? whole.perCheapest * cheapestMs : whole.budgetMs;
    if (whole.budgetMs > 0.0) budgetMs = std::clamp(budgetMs, whole.budgetMs / kLeash, whole.budgetMs * kLeash);
    const PlanInput input = lightsPart(whole, budgetMs);
    PlanReport report{.budgetMs = budgetMs, .cheapestMs = cheapestMs};
    if (input.allocation == rules::Options::Allocation::Budget) {
        planWithinBudget(input, report);
    } else {
        chooseBySuitability(input);
        headroomMs(input, current_, report.standardErrorMs);
        report.cause = Cause::unbudgeted;
        report.usableMs = input.budgetMs;
    }
    started_ = true;
    countUsers(); // sums in the order of lights, without the rounding of single moves
    report.value = sums_.value;
    report.predictedMs = sums_.costMs;
    report.partsMs = partsMs(problem_.parts, used_);
    if (report.cause == Cause::unbudgeted) report.bestValue = report.value, report.bestMs = report.predictedMs;
    report.overMs = std::max(0.0, report.predictedMs - input.budgetMs);
    remember(input, report);
    for (uint32_t light = 0; light < lightCount_; ++light)
        explainLight(input, light, report.usableMs, report.predictedMs);
    return report;
}

} // namespace gnomon::plan
