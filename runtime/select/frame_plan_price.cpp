#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "runtime/plan/utility.hpp"
#include "runtime/select/frame_plan.hpp"

// The choice where no budget says what time is worth.
namespace gnomon {

namespace {

// The frames timed after a switch, when their timings are known (two frames late), twice: the first change may have
// been one of many, and those of the same frames are learned from together.
constexpr std::uint64_t kTimingLag = 2;
constexpr std::uint64_t kPriceFrames = 2 * (cost::kLearnFrames + kTimingLag);
static_assert(plan::kTrialFrames == cost::kLearnFrames + kTimingLag);
// Beyond this nothing has to be learned: most fits of rules/knowledge are off by half an octave or less. A light that
// turns out to move would pay for its maps until kPriceFrames are over.
constexpr float kNotOnePrice = 1.5f;
// Rounds in which lights ask again what their share makes of a price. Each is a best answer to the others, and where
// shares are divided evenly those come to rest; where they need longer, the next frame goes on.
constexpr std::uint32_t kPriceRounds = 4;

/// What a method takes of work that a light shares with so many users of each part already.
float shareMs(std::span<const plan::SharedPart> parts, std::span<const std::int32_t> users, std::uint32_t method)
{
    double ms = 0.0;
    for (std::size_t p = 0; p < parts.size(); ++p)
        if (parts[p].methods.has(method)) ms += parts[p].ms / (1.0 + users[p]);
    return static_cast<float>(ms);
}

/// Whether the incumbent could go on where `method` serves, and nobody would see a difference.
bool servesAsWell(std::span<const Candidate> all, std::uint32_t incumbent, std::uint32_t method)
{
    return incumbent < all.size() && method < all.size() && all[incumbent].exclusion == Exclusion::none &&
           all[incumbent].quality >= all[method].quality - plan::kSameQuality;
}

} // namespace

/// No budget says what time is worth: of methods that show as much, the cheapest (cheaperEqual). What lights share is
/// first divided as if all had the method, so that they may leave for it together; who does not find company pays more
/// of it, and asks again.
void FramePlan::economise(const rules::Policy& policy, const Budget& budget)
{
    const auto lights = static_cast<std::uint32_t>(requests_.size());
    priced_.resize(lights);
    for (std::uint32_t i = 0; i < lights; ++i) {
        holdFloor(requests_[i], lights_[i], policy, budget);
        priced_[i] = forItsPrice(requests_[i], budget);
    }
    std::array<std::int32_t, plan::kMaxParts> users{};
    const auto count = [&](std::uint32_t method, std::int32_t more) {
        for (std::size_t p = 0; p < budget.parts.size() && method < methods_.size(); ++p)
            if (budget.parts[p].methods.has(method)) users[p] += more;
    };
    for (const std::uint32_t method : priced_)
        count(method, 1);
    const auto shared = std::span(users).first(budget.parts.size());
    const auto all = static_cast<std::int32_t>(lights);
    bool asked = std::any_of(shared.begin(), shared.end(), [=](std::int32_t of) { return of != 0 && of != all; });
    for (std::uint32_t round = 0; asked && round < kPriceRounds; ++round) {
        asked = false;
        for (std::uint32_t i = 0; i < lights; ++i) {
            count(priced_[i], -1);
            for (std::uint32_t m = 0; m < methods_.size(); ++m)
                requests_[i].decision->candidates[m].sharedMs = shareMs(budget.parts, users, m);
            const std::uint32_t method = forItsPrice(requests_[i], budget);
            asked = asked || method != priced_[i];
            count(priced_[i] = method, 1);
        }
    }
    tryUnknown(policy, shared, budget);
    double steadyMs = 0.0, firstMs = 0.0;
    for (std::uint32_t i = 0; i < lights; ++i)
        if (requests_[i].memory->incumbent < methods_.size())
            steadyMs += costs_[cellOf(*requests_[i].memory, requests_[i].memory->incumbent)].steady.ms;
    for (std::uint32_t k = 0; k < lights; ++k) {
        const auto i = static_cast<std::uint32_t>((k + budget.frame) % lights); // where not all may, they take turns
        const double roomMs = firstMs > 0.0 ? std::max(plan::kMostFirst * steadyMs - firstMs, 0.0) : HUGE_VAL;
        firstMs += takePrice(requests_[i], priced_[i], budget, roomMs);
    }
}

/// What was changed for its price stays long enough for its timings to be learned, unless it is costlier by far, or two
/// methods of about one price would take turns. A choice made before it was measured what the light reaches, when it
/// may not even be known that it moves, is not worth learning from and binds nobody once that is known; until then it
/// has the incumbent's margin, or guesses of about one price would take turns. Nor has what was on trial any margin.
std::uint32_t FramePlan::forItsPrice(const Request& request, const Budget& budget) const
{
    const LightDecision& decision = *request.decision;
    const LightMemory& memory = *request.memory;
    if (!isByRules(decision.reason) || decision.method >= methods_.size()) return decision.method;
    const std::span all = std::span<const Candidate>(decision.candidates);
    const std::uint64_t learns = memory.isOnTrial() ? plan::kTrialFrames : kPriceFrames;
    const bool learning =
        memory.pricedAt != 0 && budget.frame - memory.pricedAt < learns && !budget.cut && !memory.guessed;
    const bool unbound = decision.guessed || (memory.isOnTrial() && !learning);
    const std::uint32_t method = cheaperEqual(all, request.suited, unbound ? UINT32_MAX : memory.incumbent);
    if (!learning || !servesAsWell(all, memory.incumbent, request.suited)) return method;
    const float own = priceOf(all, memory.incumbent, memory.incumbent), other = priceOf(all, method, memory.incumbent);
    return own > kNotOnePrice * other ? method : memory.incumbent;
}

/// Whether a change to the method would be a trial: nobody has timed it here, and the incumbent serves as well.
bool FramePlan::isTrial(const Request& request, std::uint32_t method, const Budget& budget) const
{
    const LightMemory& memory = *request.memory;
    if (method == memory.incumbent || method >= methods_.size() || budget.cut) return false;
    if (costs_[cellOf(memory, method)].steady.familiar) return false;
    return servesAsWell(request.decision->candidates, memory.incumbent, method);
}

/// Trials are of one light at a time, until the timings are known: they are then expected of all lights.
bool FramePlan::mayTry(const Request& request, std::uint32_t method, const Budget& budget)
{
    if (!isTrial(request, method, budget)) return true;
    if (budget.frame < triedUntil_) return false;
    triedUntil_ = budget.frame + plan::kTrialFrames;
    return true;
}

/// What a trial of a method may cost beyond what the light takes now, ms: until it ends, by what its class hardly
/// exceeds.
double FramePlan::trialMs(const Request& request, std::uint32_t own, std::uint32_t method, double shareMs) const
{
    const std::span all = std::span<const Candidate>(request.decision->candidates);
    const double overMs = double{all[method].sureMs} + shareMs - double{priceOf(all, own, own)};
    return std::max(overMs, 0.0) * double{plan::kTrialFrames} + double{all[method].firstMs};
}

/// One light serves for a few frames by what shows as much, is not known to be cheaper, and may well be: if it took
/// `probing.sigma` standard errors less than predicted. What that may cost is saved up for, a small share of all shadow
/// time, at most that of a second or of kExpectedStayFrames, whichever is longer: where a frame takes half a second
/// nothing could be tried otherwise. Of all lights and methods, the one that would win most. What is predicted to win
/// goes before (mayTry).
void FramePlan::tryUnknown(const rules::Policy& policy, std::span<const std::int32_t> users, const Budget& budget)
{
    const double frameMs = std::max(budget.measuredMs, 0.0);
    const double wholeMs = std::max(budget.lastSecondMs, frameMs * plan::kExpectedStayFrames);
    savedMs_ = std::min(savedMs_ + plan::kMostWaste * frameMs, plan::kMostWaste * wholeMs);
    if (policy.probing.everyFrames == 0 || budget.frame < triedUntil_ || budget.cut || !(savedMs_ > 0.0)) return;
    for (std::size_t i = 0; i < requests_.size(); ++i)
        if (isByRules(requests_[i].decision->reason) && isTrial(requests_[i], priced_[i], budget)) return;
    std::size_t light = requests_.size();
    std::uint32_t tried = UINT32_MAX;
    double mostMs = 0.0, ms = 0.0;
    for (std::size_t i = 0; i < requests_.size(); ++i) {
        const Request& request = requests_[i];
        const LightMemory& memory = *request.memory;
        const std::span costs = std::span(costs_).subspan(std::size_t{memory.costSlot} * methods_.size());
        const std::uint32_t own = priced_[i], wanted = request.suited;
        const bool settled = own == memory.incumbent && own < methods_.size() && !memory.isOnTrial() && memory.measured;
        if (!isByRules(request.decision->reason) || !settled || !costs[own].steady.measured) continue;
        const std::span all = std::span<const Candidate>(request.decision->candidates);
        for (std::uint32_t m = 0; m < methods_.size(); ++m) {
            const cost::Prediction& guess = costs[m].steady;
            if (m == own || guess.measured || !(guess.ownOctaves > 0.0) || !doesAsWell(all, m, own, wanted)) continue;
            // Whether it pays is asked as if all lights had it; what it takes now it takes alone.
            const double luckyMs = guess.luckyMs(policy.probing.sigma) + double{sharesMs_[m]};
            const double gainMs = double{priceOf(all, own, own)} - luckyMs;
            if (gainMs <= mostMs) continue;
            const double share = double{shareMs(budget.parts, users, m)};
            const double wasteMs = trialMs(request, own, m, share);
            if (wasteMs <= savedMs_) light = i, tried = m, mostMs = gainMs, ms = wasteMs;
        }
    }
    if (light == requests_.size()) return;
    priced_[light] = requests_[light].memory->tried = tried;
    requests_[light].memory->pricedAt = budget.frame;
    savedMs_ -= ms;
    triedUntil_ = budget.frame + plan::kTrialFrames;
}

/// Makes the choice final. Where the incumbent serves as well, a change waits until there is room for its first frame:
/// all first frames in one frame take half of what all lights take, at most, but for one light's.
/// @return ms that it takes of the room
double FramePlan::takePrice(const Request& request, std::uint32_t method, const Budget& budget, double roomMs)
{
    LightDecision& decision = *request.decision;
    LightMemory& memory = *request.memory;
    const bool begins = method == memory.tried && method != memory.incumbent;
    const bool byRules = isByRules(decision.reason);
    double firstMs = 0.0;
    if (byRules && !begins && method != memory.incumbent && !budget.cut &&
        servesAsWell(decision.candidates, memory.incumbent, method)) {
        firstMs = costs_[cellOf(memory, method)].firstMs;
        if (firstMs > roomMs) {
            if (decision.method != memory.incumbent) {
                decision.wanted = std::exchange(decision.method, memory.incumbent);
                decision.reason = GN_REASON_HELD;
                decision.hold = plan::Hold::quota;
            }
            return 0.0;
        }
    }
    if (byRules && !begins && !mayTry(request, method, budget)) method = memory.incumbent, firstMs = 0.0;
    const bool onTrial = method == memory.tried;
    if (!onTrial || budget.frame - memory.pricedAt >= plan::kTrialFrames) memory.tried = UINT32_MAX;
    const std::span all = std::span<const Candidate>(decision.candidates);
    const bool forPrice =
        isByRules(decision.reason) && (method != decision.method || servesAsWell(all, memory.incumbent, method));
    if (forPrice && method != memory.incumbent) memory.pricedAt = budget.frame;
    if (method == decision.method) return firstMs;
    decision.wanted = decision.method;
    decision.method = method;
    decision.reason = memory.isOnTrial()                  ? GN_REASON_TRIAL
                      : request.suited != decision.wanted ? GN_REASON_FLOOR
                                                          : GN_REASON_PRICE;
    return firstMs;
}

/// The best suitability decided: why every other method lost.
void FramePlan::explainWithoutPlan(const Request& request, bool hasRules) const
{
    LightDecision& decision = *request.decision;
    const float limit =
        decision.floor ? std::min(request.memory->plan.nearQuality, decision.candidates[request.suited].quality) : 0.0f;
    const bool forPrice = decision.reason == GN_REASON_PRICE || decision.reason == GN_REASON_FLOOR;
    for (std::uint32_t m = 0; m < methods_.size(); ++m) {
        Candidate& candidate = decision.candidates[m];
        candidate.why = m == decision.method                                        ? plan::Why::chosen
                        : candidate.exclusion == Exclusion::vetoed                  ? plan::Why::never
                        : candidate.exclusion != Exclusion::none                    ? plan::Why::trait
                        : decision.reason == GN_REASON_PINNED                       ? plan::Why::pinned
                        : hasRules && candidate.quantised < 0                       ? plan::Why::noOpinion
                        : candidate.quality < limit                                 ? plan::Why::floor
                        : decision.reason == GN_REASON_HELD && m == decision.wanted ? plan::Why::hysteresis
                        : forPrice && decision.method < methods_.size() &&
                                candidate.quantised > decision.candidates[decision.method].quantised
                            ? plan::Why::price
                            : plan::Why::outscored;
    }
}

} // namespace gnomon
