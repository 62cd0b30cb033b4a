#pragma once
// What a method is worth to a light, time apart.
#include <cstddef>
#include <cstdint>
#include <span>

#include "rules/engine/engine.hpp" // kSuitabilitySteps

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

/// What counts for a method: its own suitability and quality, or those of better ones which it shows as much as. What
/// the rules say for the one then holds for the other, a difference that nobody sees is none, and which of them serves
/// is a matter of time alone. Otherwise a budget with room would be spent on a dearer way to the same picture.
inline UtilityTerms sharedTerms(std::span<const UtilityTerms> terms, std::size_t method) noexcept
{
    const UtilityTerms& own = terms[method];
    UtilityTerms best{own.suitability > 0 ? own.suitability : 0, own.quality, own.eligible};
    for (const UtilityTerms& other : terms) {
        const bool counts = other.eligible & showsAsMuch(own, other);
        best.suitability = (counts & (other.suitability > best.suitability)) ? other.suitability : best.suitability;
        const bool spokenOf = other.suitability >= 0;
        best.quality = (counts & spokenOf & (other.quality > best.quality)) ? other.quality : best.quality;
    }
    return best;
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

/// suitability * quality, [0, 1]; times importance it is what the plan sums up.
inline double utility(const UtilityTerms& terms) noexcept
{
    return terms.suitability / double{rules::kSuitabilitySteps} * double{terms.quality};
}

} // namespace gnomon::plan
