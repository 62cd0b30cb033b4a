#pragma once
// The choice for one light, from its candidates alone: for the decision itself, and for "what if" afterwards.
#include <span>
#include <vector>

#include "runtime/select/record.hpp"

namespace gnomon {

struct Choice {
    std::uint32_t method = UINT32_MAX; ///< UINT32_MAX: nothing can serve.
    std::uint32_t wanted = UINT32_MAX; ///< The best that could serve if it were ready.
    GnReason reason = GN_REASON_RULES;
};

/// The rules had the say, not a pin, a fallback or their silence.
constexpr bool isByRules(GnReason reason)
{
    return reason == GN_REASON_RULES || reason == GN_REASON_INCUMBENT;
}

/// Whether predicted times have a say (`allocation: budget`); `allocation: none` takes the best suitability. Null: no
/// rules.
inline bool countsTime(const rules::RuleBase* base)
{
    return base && base->options.allocation == rules::Options::Allocation::Budget;
}

struct ChoiceInput {
    std::uint32_t incumbent = UINT32_MAX;
    std::uint32_t pinned = UINT32_MAX;
    MethodSet fallbacks;  ///< What serves while another is not ready.
    bool hasRules = true; ///< Without rules, no opinion bars nobody.
};

/// The highest suitability among the eligible; ties go to the incumbent, then to registry order. A pin overrules
/// rules and vetoes. Where what is wanted is not ready, or nobody has an opinion, a fallback, else anything eligible.
Choice chooseBySuitability(std::span<const Candidate> candidates, const ChoiceInput& input) noexcept;

/// What serves a light as one method after another turns out to fail: each entry is what chooseBySuitability() says
/// without an incumbent once the methods of the entries before are excluded. In the last one nothing can serve.
std::vector<Choice> replacementsInOrder(std::span<const Candidate> candidates, const ChoiceInput& input);

/// Share by which a method must be cheaper to be taken for its price. A prediction's own noise (8 %) alone changes
/// nothing.
inline constexpr float kPriceMargin = 0.1f;

/// What a frame with a method takes, ms: Candidate::sureMs with its part of what the view's lights share, and where it
/// does not serve yet, its share of the first frame's surplus (maps and lists of what stands still), spread over
/// plan::kExpectedStayFrames.
float priceOf(std::span<const Candidate> candidates, std::uint32_t method, std::uint32_t incumbent) noexcept;

/// Whether a method may serve and shows as much as `as`, and the rules do not avoid it where `wanted` is what they like
/// best.
bool doesAsWell(std::span<const Candidate> candidates, std::uint32_t method, std::uint32_t as,
                std::uint32_t wanted) noexcept;

/// `wanted` and what else may serve, of these what shows at least `minimum`, or, where nothing does, what shows most.
/// @param wanted the best suited, a valid index
MethodSet withinFloor(std::span<const Candidate> candidates, std::uint32_t wanted, float minimum) noexcept;

/// `wanted` where it shows at least `minimum`; else the best suited of withinFloor().
std::uint32_t suitedWithinFloor(std::span<const Candidate> candidates, std::uint32_t wanted, float minimum) noexcept;

/// What serves where no budget says what time is worth: then time buys quality and nothing else. Of methods that the
/// rules like at least half as well as `wanted` (what they avoid is not taken for its
/// price): the cheapest that shows as much as `wanted`; or one that shows more and is costlier than that by no more
/// than kPriceMargin, or twice that where it serves already, and of those that show as much as it the cheapest. An
/// incumbent that does as well, and is no costlier than what is wanted, stays until something is cheaper by
/// kPriceMargin.
std::uint32_t cheaperEqual(std::span<const Candidate> candidates, std::uint32_t wanted,
                           std::uint32_t incumbent) noexcept;

/// What the cheapest of the methods that may serve is predicted to take, ms; what is pinned, where that may. It depends
/// on no choice, so that rules which ask for it (Fact::frameBudget) do not answer to themselves. 0 where nothing may
/// serve.
float cheapestMs(std::span<const Candidate> candidates, std::uint32_t pinned) noexcept;

/// The budget of a frame for which the host gives `hostMs` (0: none): that, but no more than the cap of rules that
/// plan. 0: none.
double budgetInForce(const rules::RuleBase* base, double hostMs) noexcept;

/// Why the plan's choice is not the best suited method, of which it says `why`. A hold that keeps the light from
/// another one is no reason: without it the best suited would serve no more.
GnReason reasonOf(const plan::LightPlan& plan, std::uint32_t bestSuited, plan::Why why) noexcept;

/// The plan's word on a decision by suitability whose candidates hold what the plan says of each (Candidate::why).
/// Where the rules had no say, because what is wanted is not ready or nobody has an opinion, that stays the reason.
void takePlan(const plan::LightPlan& plan, LightDecision& decision) noexcept;

/// What the plan counts for a method: importance * suitability * quality, the suitability shared by what shows as much
/// (plan/utility.hpp).
double utilityOf(const DecisionRecord& record, std::span<const Candidate> candidates, std::uint32_t method);

/// A decision made again with other facts, everything else as it was: pins, capabilities, predictions, the other lights
/// of the plan. With the facts of the record the answer is the record's method.
///
/// Where a plan decided, the light keeps its method unless that is forbidden by a veto or the near floor, or another
/// one is affordable with what the others leave and worth more by the threshold.
class Rechoice {
public:
    /// `engine` holds the rules of the record; both outlive this.
    Rechoice(const DecisionRecord& record, const rules::Engine& engine);

    std::uint32_t choose(std::span<const double> facts);
    const rules::Inference& inference() const { return inference_; } ///< Of the last choose().

private:
    std::uint32_t chooseInPlan() const;
    bool asksFloor() const;
    bool keepsFloor() const;
    MethodSet allowed() const;
    double valueOf(std::uint32_t method) const;
    double takenMs(std::uint32_t method) const noexcept;
    double changedMs(std::uint32_t method) const noexcept;
    bool fits(double methodMs) const noexcept;

    const DecisionRecord& record_;
    const rules::Engine& engine_;
    rules::Inference inference_;
    std::vector<Candidate> candidates_;
    MethodSet barred_; ///< Methods that other lights, or a hold, keep from this one.
};

/// The smallest change of one fact that flips the choice.
struct NearMiss {
    std::uint32_t fact = 0;
    double from = 0.0;                 ///< NaN: unknown when it was decided.
    double to = 0.0;                   ///< The choice made with this very number is `method`.
    std::uint32_t method = UINT32_MAX; ///< UINT32_MAX: nothing could serve any more.
    double distance = 0.0; ///< |to - from| as a share of the fact's universe; infinite from an unknown fact.
};
constexpr std::uint32_t kBisections = 20; ///< A millionth of the universe.

/// At most one per fact, nearest first; only flips to `method`, if one is given. Each fact is walked outward from where
/// it is over the corners of its terms and the middles between them, then bisected: between corners memberships are
/// straight lines.
std::vector<NearMiss> nearMisses(const DecisionRecord& record, const rules::Engine& engine,
                                 std::uint32_t method = UINT32_MAX);

} // namespace gnomon
