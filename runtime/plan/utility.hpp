#pragma once
// What a method is worth to a light, time apart.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "rules/engine/engine.hpp" // kSuitabilitySteps
#include "runtime/base/method_set.hpp"

namespace gnomon::plan {

/// Qualities so close count as the same: one wrong pixel in ten thousand more.
inline constexpr float kSameQuality = 0.01f;
/// What the rules like less than half as well is not taken for another's equal, whatever it shows: they avoid it.
inline constexpr std::int32_t kLikedAtMost = 2;

/// What worth is made of.
struct UtilityTerms {
    std::int32_t suitability = -1; ///< In steps of 1/4096; negative: nobody speaks of it.
    float quality = 1.0f;          ///< [0, 1].
    bool eligible = false;         ///< May serve. What may not lends its suitability to nobody.
};

/// Whether a viewer sees as much with the one as with the other, and the rules do not avoid it.
inline bool showsAsMuch(const UtilityTerms& own, const UtilityTerms& other) noexcept
{
    return (own.quality >= other.quality - kSameQuality) & (kLikedAtMost * own.suitability >= other.suitability);
}

/// What counts for `own`, which shows as much as `lender`.
inline UtilityTerms lentTerms(const UtilityTerms& own, const UtilityTerms& lender) noexcept
{
    return {lender.suitability, own.quality > lender.quality + kSameQuality ? own.quality : lender.quality,
            own.eligible};
}

/// Whether `a` comes before `b` as a lender.
inline bool isBetterSuited(const UtilityTerms& a, const UtilityTerms& b) noexcept
{
    return a.suitability != b.suitability ? a.suitability > b.suitability : a.quality > b.quality;
}

/// What counts for a method: its own suitability and quality, or those of the best suited one which it shows as much
/// as. What the rules say for the one then holds for the other, a difference that nobody sees is none, and which of
/// them serves is a matter of time alone. Otherwise a budget with room would be spent on a costlier way to the same
/// picture.
inline UtilityTerms sharedTerms(std::span<const UtilityTerms> terms, std::size_t method) noexcept
{
    UtilityTerms lender = terms[method];
    lender.suitability = std::max(lender.suitability, 0);
    for (const UtilityTerms& other : terms)
        if (other.eligible && showsAsMuch(terms[method], other) && isBetterSuited(other, lender)) lender = other;
    return lentTerms(terms[method], lender);
}

/// A switch must earn back its first frame within so many frames. Stress scenes move a light about once a second
/// (README.md).
inline constexpr std::uint32_t kExpectedStayFrames = 60;

/// What a frame with a method takes that does not serve yet, ms: as predicted, and its share of the first frame's
/// surplus (maps and lists of what stands still).
inline double changePriceMs(double predictedMs, double firstFrameMs) noexcept
{
    return predictedMs + firstFrameMs / kExpectedStayFrames;
}

/// Whether a time is known to a half: what is not is no reason to change a method for its price.
inline bool isPriceKnown(double predictedMs, double sigmaMs) noexcept
{
    return predictedMs > 0.0 && sigmaMs <= 0.5 * predictedMs;
}

/// Those of `methods` that show at least `minimum`; where none does, those that show most.
/// @param qualityOf a method's, [0, 1]
template <typename QualityOf>
MethodSet withinFloor(const MethodSet& methods, float minimum, QualityOf&& qualityOf) noexcept
{
    float best = 0.0f;
    for (const std::uint32_t m : methods)
        best = std::max(best, qualityOf(m));
    MethodSet within = methods;
    for (const std::uint32_t m : methods)
        if (qualityOf(m) < std::min(minimum, best)) within.remove(m);
    return within;
}

/// suitability * quality, [0, 1]; times importance it is what the plan sums up.
inline double utility(const UtilityTerms& terms) noexcept
{
    return terms.suitability / double{rules::kSuitabilitySteps} * double{terms.quality};
}

/// utility(sharedTerms()) of all methods.
/// @param order Any order of the methods; left as that of their suitability. Nearly right, it makes this quick.
inline void sharedUtilities(std::span<const UtilityTerms> terms, std::span<std::uint8_t> order,
                            std::span<double> utilities) noexcept
{
    std::array<std::int32_t, kMaxMethods> suitabilities; // as `order`, like all three
    std::array<float, kMaxMethods> qualities, asked;     // quality that shows as much; infinite of what does not lend
    for (std::size_t i = 0; i < order.size(); ++i) {
        const std::uint8_t method = order[i];
        std::size_t place = i;
        for (; place > 0; --place) {
            const UtilityTerms before{suitabilities[place - 1], qualities[place - 1]};
            if (!isBetterSuited(terms[method], before)) break;
            order[place] = order[place - 1];
            suitabilities[place] = before.suitability, qualities[place] = before.quality;
        }
        order[place] = method;
        suitabilities[place] = terms[method].suitability, qualities[place] = terms[method].quality;
    }
    std::size_t first = 0; // of those that the one at hand is not avoided beside
    for (std::size_t i = 0; i < order.size(); ++i) {
        const std::uint8_t method = order[i];
        const float quality = qualities[i];
        std::size_t lender = i;
        if (suitabilities[i] >= 0) { // what nobody speaks of is liked less than all that lend
            while (kLikedAtMost * suitabilities[i] < suitabilities[first])
                ++first;
            asked[i] = -std::numeric_limits<float>::infinity(); // at the latest its own
            for (lender = first; quality < asked[lender];)
                ++lender;
        }
        asked[i] = terms[method].eligible ? quality - kSameQuality : std::numeric_limits<float>::infinity();
        const UtilityTerms own{std::max(suitabilities[i], 0), quality};
        utilities[method] = utility(lentTerms(own, {std::max(suitabilities[lender], 0), qualities[lender]}));
    }
}

} // namespace gnomon::plan
