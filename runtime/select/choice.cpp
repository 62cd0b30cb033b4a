#include "runtime/select/choice.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "runtime/base/number_text.hpp"
#include "runtime/plan/utility.hpp"

namespace gnomon {

Choice chooseBySuitability(std::span<const Candidate> candidates, const ChoiceInput& input) noexcept
{
    const auto count = static_cast<std::uint32_t>(candidates.size());
    auto better = [&](std::uint32_t a, std::uint32_t b) { // a over b?
        if (b == UINT32_MAX) return true;
        if (candidates[a].quantised != candidates[b].quantised)
            return candidates[a].quantised > candidates[b].quantised;
        return a == input.incumbent;
    };
    Choice out;
    std::uint32_t equals = 0;
    if (input.pinned < count) {
        const Exclusion exclusion = candidates[input.pinned].exclusion;
        if (exclusion == Exclusion::none || exclusion == Exclusion::vetoed) out.method = input.pinned;
        if (out.method != UINT32_MAX || exclusion == Exclusion::notReady) out.wanted = input.pinned;
        out.reason = GN_REASON_PINNED;
    }
    if (out.wanted == UINT32_MAX) {
        out.reason = GN_REASON_RULES;
        for (std::uint32_t i = 0; i < count; ++i) {
            const Candidate& candidate = candidates[i];
            if (candidate.exclusion != Exclusion::none && candidate.exclusion != Exclusion::notReady) continue;
            if (input.hasRules && candidate.quantised < 0) continue;
            if (better(i, out.wanted)) out.wanted = i;
        }
        if (out.wanted == UINT32_MAX) out.reason = GN_REASON_NO_OPINION;
        if (out.wanted != UINT32_MAX && candidates[out.wanted].exclusion == Exclusion::none) out.method = out.wanted;
        for (std::uint32_t i = 0; i < count && out.method != UINT32_MAX; ++i)
            equals += candidates[i].exclusion == Exclusion::none &&
                      candidates[i].quantised == candidates[out.method].quantised;
        if (equals > 1 && out.method == input.incumbent) out.reason = GN_REASON_INCUMBENT;
    }
    if (out.method != UINT32_MAX) return out;
    // Nothing wanted is ready, or nobody has an opinion.
    for (std::uint32_t i = 0; i < count; ++i) {
        if (candidates[i].exclusion != Exclusion::none) continue;
        const bool fallback = input.fallbacks.has(i);
        if (out.method == UINT32_MAX || (fallback && !input.fallbacks.has(out.method))) out.method = i;
    }
    if (out.method == UINT32_MAX)
        out.reason = GN_REASON_NOTHING_READY;
    else if (out.wanted != UINT32_MAX)
        out.reason = GN_REASON_FALLBACK;
    return out;
}

std::vector<Choice> replacementsInOrder(std::span<const Candidate> candidates, const ChoiceInput& input)
{
    std::vector<Candidate> left(candidates.begin(), candidates.end());
    ChoiceInput without = input;
    without.incumbent = UINT32_MAX;
    std::vector<Choice> order;
    do {
        order.push_back(chooseBySuitability(left, without));
        if (const std::uint32_t method = order.back().method; method != UINT32_MAX)
            left[method].exclusion = Exclusion::refused;
    } while (order.back().method != UINT32_MAX);
    return order;
}

namespace {

plan::UtilityTerms utilityTermsOf(const Candidate& candidate)
{
    return {candidate.quantised, candidate.quality, candidate.exclusion == Exclusion::none};
}

} // namespace

float priceOf(std::span<const Candidate> candidates, std::uint32_t method, std::uint32_t incumbent) noexcept
{
    const Candidate& candidate = candidates[method];
    const double ms = double{candidate.sureMs} + double{candidate.sharedMs};
    return static_cast<float>(method == incumbent ? ms : plan::changePriceMs(ms, double{candidate.firstMs}));
}

bool doesAsWell(std::span<const Candidate> candidates, std::uint32_t method, std::uint32_t as,
                std::uint32_t wanted) noexcept
{
    const plan::UtilityTerms enough{candidates[wanted].quantised, candidates[as].quality, true};
    return candidates[method].exclusion == Exclusion::none && candidates[method].quantised >= 0 &&
           plan::showsAsMuch(utilityTermsOf(candidates[method]), enough);
}

namespace {

/// What cheaperEqual() weighs.
struct Offers {
    std::span<const Candidate> all;
    std::uint32_t wanted, incumbent;

    float price(std::uint32_t m) const noexcept { return priceOf(all, m, incumbent); }
    bool doesAsWell(std::uint32_t m, std::uint32_t as) const noexcept { return gnomon::doesAsWell(all, m, as, wanted); }
    std::uint32_t cheapestLike(std::uint32_t suited) const noexcept;
    std::uint32_t moreForNoMore(std::uint32_t cheapest) const noexcept;
    bool stays(std::uint32_t cheapest, std::uint32_t best) const noexcept;
};

std::uint32_t Offers::cheapestLike(std::uint32_t suited) const noexcept
{
    std::uint32_t cheapest = suited;
    for (std::uint32_t m = 0; m < all.size(); ++m)
        if (doesAsWell(m, suited) && price(m) < price(cheapest)) cheapest = m;
    return cheapest;
}

/// What shows most of what shows more than the cheapest like `wanted` at about its price; that if there is none.
std::uint32_t Offers::moreForNoMore(std::uint32_t cheapest) const noexcept
{
    std::uint32_t most = cheapest;
    for (std::uint32_t m = 0; m < all.size(); ++m)
        if (doesAsWell(m, wanted) && all[m].quality > all[most].quality + plan::kSameQuality &&
            price(m) <= (1.0f + kPriceMargin) * price(cheapest))
            most = m;
    return most;
}

/// Whether the incumbent goes on where `best` is what would be chosen without one. But for its first frame, which it
/// has paid, that does not depend on which method the incumbent is: so methods do not take turns.
bool Offers::stays(std::uint32_t cheapest, std::uint32_t best) const noexcept
{
    if (incumbent >= all.size() || !doesAsWell(incumbent, wanted)) return false;
    const float own = all[incumbent].quality, its = all[best].quality;
    if (own < its - plan::kSameQuality) return false;
    if (own > its + plan::kSameQuality && price(incumbent) <= (1.0f + 2.0f * kPriceMargin) * price(cheapest))
        return true;
    if (best == wanted && price(best) < price(incumbent)) return false;
    return price(best) >= (1.0f - kPriceMargin) * price(incumbent);
}

} // namespace

std::uint32_t cheaperEqual(std::span<const Candidate> candidates, std::uint32_t wanted,
                           std::uint32_t incumbent) noexcept
{
    if (wanted >= candidates.size()) return wanted;
    const Offers offers{candidates, wanted, incumbent};
    const std::uint32_t cheapest = offers.cheapestLike(wanted), more = offers.moreForNoMore(cheapest);
    const std::uint32_t best = more == cheapest ? cheapest : offers.cheapestLike(more);
    return offers.stays(cheapest, best) ? incumbent : best;
}

MethodSet withinFloor(std::span<const Candidate> candidates, std::uint32_t wanted, float minimum) noexcept
{
    MethodSet able = MethodSet::where(static_cast<std::uint32_t>(candidates.size()), [&](std::uint32_t m) {
        return candidates[m].exclusion == Exclusion::none && candidates[m].quantised >= 0;
    });
    able.add(wanted);
    return plan::withinFloor(able, minimum, [&](std::uint32_t m) { return candidates[m].quality; });
}

std::uint32_t suitedWithinFloor(std::span<const Candidate> candidates, std::uint32_t wanted, float minimum) noexcept
{
    if (candidates[wanted].quality >= minimum) return wanted;
    const MethodSet within = withinFloor(candidates, wanted, minimum);
    std::uint32_t suited = within.has(wanted) ? wanted : *within.begin();
    for (const std::uint32_t m : within)
        if (candidates[m].quantised > candidates[suited].quantised) suited = m;
    return suited;
}

Rechoice::Rechoice(const DecisionRecord& record, const rules::Engine& engine)
    : record_(record), engine_(engine), inference_(engine.makeInference()), candidates_(record.candidates)
{
    // What the plan of all lights kept from this one stays so: others did not pay for it, or it was held.
    const bool held =
        record.hold != plan::Hold::none && record.hold != plan::Hold::threshold && record.hold != plan::Hold::margin;
    for (std::uint32_t m = 0; m < record.methods && record.budgeted && held; ++m)
        if (record.candidates[m].why == plan::Why::hysteresis) barred_.add(m);
    for (std::uint32_t round = 0; round < record.methods; ++round) {
        const std::uint32_t again = choose(record.facts);
        if (again == record.method || again >= record.methods) break;
        barred_.add(again);
    }
}

std::uint32_t Rechoice::choose(std::span<const double> facts)
{
    engine_.evaluate(facts, inference_);
    const auto known = std::min(record_.methods, static_cast<std::uint32_t>(inference_.outputs.size()));
    for (std::uint32_t m = 0; m < known; ++m) {
        const rules::OutputState& output = inference_.outputs[m];
        const Exclusion before = record_.candidates[m].exclusion;
        Candidate& candidate = candidates_[m];
        candidate.quantised = output.quantised;
        if (before == Exclusion::none || before == Exclusion::vetoed)
            candidate.exclusion = output.vetoed ? Exclusion::vetoed : Exclusion::none;
    }
    const bool pinned = record_.reason == GN_REASON_PINNED;
    if (record_.budgeted && !pinned) return chooseInPlan();
    for (const std::uint32_t m : barred_)
        candidates_[m].exclusion = Exclusion::refused;
    const std::span all = std::span<const Candidate>(candidates_).first(record_.methods);
    const Choice choice = chooseBySuitability(
        all,
        {.incumbent = record_.incumbent, .pinned = record_.pinned, .fallbacks = record_.fallbacks, .hasRules = true});
    if (!record_.priced || !isByRules(choice.reason) || choice.method >= all.size()) return choice.method;
    const float minimum = record_.minimumQuality;
    std::uint32_t suited = choice.method;
    if (asksFloor())
        suited = suitedWithinFloor(all, choice.method, minimum);
    else if (keepsFloor() && record_.incumbent < all.size() && all[choice.method].quality < minimum)
        suited = record_.incumbent;
    return cheaperEqual(all, suited, record_.guessed ? UINT32_MAX : record_.incumbent);
}

float cheapestMs(std::span<const Candidate> candidates, std::uint32_t pinned) noexcept
{
    if (pinned < candidates.size() &&
        (candidates[pinned].exclusion == Exclusion::none || candidates[pinned].exclusion == Exclusion::vetoed))
        return candidates[pinned].sureMs;
    const bool spoken = std::any_of(candidates.begin(), candidates.end(), [](const Candidate& candidate) {
        return candidate.exclusion == Exclusion::none && candidate.quantised >= 0;
    });
    float least = std::numeric_limits<float>::infinity();
    for (const Candidate& candidate : candidates)
        if (candidate.exclusion == Exclusion::none && (candidate.quantised >= 0 || !spoken))
            least = std::min(least, candidate.sureMs);
    return std::isfinite(least) ? least : 0.0f;
}

double budgetInForce(const rules::RuleBase* base, double hostMs) noexcept
{
    const double cap = countsTime(base) ? base->policy.budget.shadowCapMs : 0.0;
    if (!(cap > 0.0)) return hostMs;
    return hostMs > 0.0 ? std::min(hostMs, cap) : cap;
}

GnReason reasonOf(const plan::LightPlan& plan, std::uint32_t bestSuited, plan::Why why) noexcept
{
    if (plan.hold != plan::Hold::none && plan.wanted == bestSuited) return GN_REASON_HELD;
    switch (why) {
    case plan::Why::price:
        return GN_REASON_PRICE;
    case plan::Why::floor:
        return GN_REASON_FLOOR;
    case plan::Why::hysteresis:
        return GN_REASON_HELD;
    case plan::Why::outscored:
        return GN_REASON_UTILITY;
    default: // Why::budget, or a time that is no number, which fits nothing
        return GN_REASON_BUDGET;
    }
}

void takePlan(const plan::LightPlan& plan, LightDecision& decision) noexcept
{
    decision.floor = plan.floor;
    decision.floorUnmet = plan.floorUnmet;
    decision.hold = plan.hold;
    decision.threshold = plan.threshold;
    if (plan.chosen == plan::kNone || plan.chosen == decision.method) return;
    if (isByRules(decision.reason)) {
        decision.wanted = decision.method;
        decision.reason =
            plan.onTrial ? GN_REASON_TRIAL : reasonOf(plan, decision.wanted, decision.candidates[decision.wanted].why);
    }
    decision.method = plan.chosen;
}

double utilityOf(const DecisionRecord& record, std::span<const Candidate> candidates, std::uint32_t method)
{
    std::vector<plan::UtilityTerms> terms(record.methods);
    for (std::uint32_t m = 0; m < record.methods; ++m)
        terms[m] = utilityTermsOf(candidates[m]);
    return double{record.importance} * plan::utility(plan::sharedTerms(terms, method));
}

double Rechoice::valueOf(std::uint32_t method) const
{
    return utilityOf(record_, candidates_, method);
}

/// Whether the near floor is asked for by the facts of the last evaluation.
bool Rechoice::asksFloor() const
{
    const rules::Policy::Floor& floor = engine_.base().policy.floor;
    return !floor.when.empty() && inference_.floorTruth >= floor.atStrength;
}

/// Whether it held on from before when it was decided.
bool Rechoice::keepsFloor() const
{
    return record_.floor && record_.floorTruth < record_.floorStrength;
}

/// Methods that are able, not vetoed, spoken of where any is, and good enough as far as any is.
MethodSet Rechoice::allowed() const
{
    MethodSet able, spoken;
    for (std::uint32_t m = 0; m < record_.methods; ++m) {
        if (candidates_[m].exclusion != Exclusion::none) continue;
        able.add(m);
        if (candidates_[m].quantised >= 0) spoken.add(m);
    }
    if (able.meets(spoken)) able &= spoken;
    if (!asksFloor() && !keepsFloor()) return able;
    return plan::withinFloor(able, record_.minimumQuality,
                             [&](std::uint32_t m) { return candidates_[m].quality; });
}

/// Of the plan, by this light.
double Rechoice::takenMs(std::uint32_t method) const noexcept
{
    if (method >= record_.methods) return 0.0;
    return double{candidates_[method].sureMs} + double{candidates_[method].sharedMs};
}

/// What the plan must have room for where the light has a method already: Option::price.
double Rechoice::changedMs(std::uint32_t method) const noexcept
{
    const Candidate& candidate = candidates_[method];
    return double{candidate.sharedMs} +
           plan::roomForChangeMs(double{candidate.sureMs}, double{candidate.predictedMs}, double{candidate.firstMs});
}

/// Whether the plan of all lights stays within its budget where this light takes so long.
bool Rechoice::fits(double methodMs) const noexcept
{
    return double{record_.planMs} - takenMs(record_.method) + methodMs <= double{record_.usableMs};
}

std::uint32_t Rechoice::chooseInPlan() const
{
    const std::uint32_t chosen = record_.method;
    const MethodSet able = allowed();
    if (able.empty()) return UINT32_MAX;
    const bool stays = chosen < record_.methods && able.has(chosen);
    std::uint32_t best = UINT32_MAX, cheapest = UINT32_MAX;
    for (const std::uint32_t m : able - barred_) {
        const double ms = takenMs(m);
        if (cheapest == UINT32_MAX || ms < takenMs(cheapest)) cheapest = m;
        if (!fits(stays && m != chosen ? changedMs(m) : ms)) continue;
        const double more = best == UINT32_MAX ? 1.0 : valueOf(m) - valueOf(best);
        if (more > 0.0 || (more == 0.0 && ms < takenMs(best))) best = m;
    }
    if (!stays && best == UINT32_MAX) best = cheapest;
    if (!stays) return best != UINT32_MAX ? best : *able.begin();
    if (best == UINT32_MAX || best == chosen) return chosen;
    return valueOf(best) > (1.0 + double{record_.threshold}) * valueOf(chosen) ? best : chosen;
}

namespace {

/// Where memberships of a fact may bend: the corners of its terms within the universe, its ends, and middles.
std::vector<double> probesOf(const rules::Variable& variable)
{
    std::vector<double> corners = {variable.low, variable.high};
    for (const rules::Term& term : variable.terms)
        for (const double corner : {term.shape.a, term.shape.b, term.shape.c, term.shape.d})
            if (corner > variable.low && corner < variable.high) corners.push_back(corner);
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    std::vector<double> probes;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if (i > 0) probes.push_back(0.5 * (corners[i - 1] + corners[i]));
        probes.push_back(corners[i]);
    }
    if (!variable.isCount()) return probes;
    for (double& probe : probes)
        probe = std::round(probe);
    probes.erase(std::unique(probes.begin(), probes.end()), probes.end());
    return probes;
}

/// One fact, walked up and down.
class FactWalk {
public:
    FactWalk(const DecisionRecord& record, Rechoice& rechoice, const rules::Variable& variable, std::uint32_t fact,
             std::uint32_t target)
        : rechoice_(rechoice), variable_(variable), facts_(record.facts), fact_(fact), base_(record.method),
          target_(target)
    {
    }

    /// The nearer flip of both directions.
    std::optional<NearMiss> nearest()
    {
        const std::vector<double> probes = probesOf(variable_);
        const double from = facts_[fact_];
        if (std::isnan(from)) {
            for (const double probe : probes)
                if (!found_ && flips(probe)) take(probe);
            return found_;
        }
        const double start = std::clamp(from, variable_.low, variable_.high);
        search(start, std::upper_bound(probes.begin(), probes.end(), start), probes.end());
        search(start, std::make_reverse_iterator(std::lower_bound(probes.begin(), probes.end(), start)), probes.rend());
        return found_;
    }

private:
    template <typename Iterator>
    void search(double start, Iterator probe, Iterator end)
    {
        const double from = facts_[fact_];
        double same = start;
        for (; probe != end; same = *probe++) {
            double next = *probe;
            if (found_) { // no farther than the flip on the other side
                const double most = std::abs(found_->to - from);
                if (std::abs(same - from) >= most) return;
                if (std::abs(next - from) > most) next = next > from ? from + most : from - most;
                if (variable_.isCount()) next = std::round(next);
            }
            if (flips(next)) {
                const double flipped = bisect(same, next);
                if (!found_ || std::abs(flipped - from) < std::abs(found_->to - from)) take(flipped);
                return;
            }
            if (next != *probe) return;
        }
    }

    double bisect(double same, double flipped)
    {
        for (std::uint32_t i = 0; i < kBisections; ++i) {
            double middle = 0.5 * (same + flipped);
            if (variable_.isCount()) middle = same < flipped ? std::floor(middle) : std::ceil(middle);
            if (middle == same || middle == flipped) break;
            (flips(middle) ? flipped : same) = middle;
        }
        return rounded(same, flipped);
    }

    /// The shortest number just beyond the flip that still flips.
    double rounded(double same, double flipped)
    {
        if (variable_.isCount()) return flipped;
        const int first = 3 - static_cast<int>(std::ceil(std::log10(variable_.high - variable_.low)));
        for (int decimals = std::max(first, 0); decimals < std::max(first, 0) + 4; ++decimals) {
            const double scale = std::pow(10.0, decimals);
            const double near = same < flipped ? std::ceil(flipped * scale) : std::floor(flipped * scale);
            const double number = parseNumber(fixedText(near / scale, decimals)).value_or(flipped);
            if (number >= variable_.low && number <= variable_.high && flips(number)) return number;
        }
        return flipped;
    }

    bool flips(double value)
    {
        const double kept = std::exchange(facts_[fact_], value);
        const std::uint32_t method = rechoice_.choose(facts_);
        facts_[fact_] = kept;
        return target_ == UINT32_MAX ? method != base_ : method == target_;
    }

    void take(double value)
    {
        FactValues facts = facts_;
        facts[fact_] = value;
        found_ = {.fact = fact_,
                  .from = facts_[fact_],
                  .to = value,
                  .method = rechoice_.choose(facts),
                  .distance = std::isnan(facts_[fact_])
                                  ? std::numeric_limits<double>::infinity()
                                  : std::abs(value - facts_[fact_]) / (variable_.high - variable_.low)};
    }

    Rechoice& rechoice_;
    const rules::Variable& variable_;
    FactValues facts_;
    std::uint32_t fact_, base_, target_;
    std::optional<NearMiss> found_;
};

} // namespace

std::vector<NearMiss> nearMisses(const DecisionRecord& record, const rules::Engine& engine, std::uint32_t method)
{
    Rechoice rechoice(record, engine);
    std::vector<NearMiss> found;
    const auto& variables = engine.compiled().variables;
    for (std::size_t i = 0; i < variables.size(); ++i) {
        if (variables[i].fact >= kFactCount) continue;
        FactWalk walk(record, rechoice, engine.base().variables[i], variables[i].fact, method);
        if (const std::optional<NearMiss> miss = walk.nearest()) found.push_back(*miss);
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const NearMiss& a, const NearMiss& b) { return a.distance < b.distance; });
    return found;
}

} // namespace gnomon
