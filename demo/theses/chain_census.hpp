#pragma once
// The counts of which the tables of Moderno's thesis are made: per view, size of map and contour, what each stage of
// contour_chain settles, rightly and wrongly. Measured from pictures of votes (shaders/hybrid/reasons.h), or printed.

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "demo/theses/thesis_view.hpp"

namespace gnomon::demo {

/// The techniques that name triangles, in the order of the thesis's tables 9 to 11.
enum class CandidateOccluder : uint8_t { st, nb4, nb9, ag1, ag2 };
inline constexpr size_t kCandidates = 5;
const char* nameOf(CandidateOccluder candidate) noexcept;

/// The pixels of one contour. "Lit" and "dark" are what the plain map says.
struct ContourCounts {
    uint64_t pixels = 0, lit = 0;
    uint64_t wrongLit = 0, wrongDark = 0;           ///< By the map.
    uint64_t hintedLit = 0, hintedDark = 0;         ///< By four texels that agree ("TC4"), ...
    uint64_t wrongHintsLit = 0, wrongHintsDark = 0; ///< ... and wrong ones among them.
    uint64_t corrected = 0;                         ///< Lit, not hinted, a triangle of nine texels blocks.
    uint64_t darkAfterNb = 0, darkAfterAg = 0;      ///< Dark ones settled so far: hints, nine texels, vertex ring.
    // The rest is in no printed row.
    uint64_t hintedLit9 = 0, hintedDark9 = 0, wrongHintsLit9 = 0, wrongHintsDark9 = 0; ///< By nine texels.
    std::array<uint64_t, kCandidates> confirms{}, corrects{}; ///< Dark and lit pixels with such a candidate occluder.
    uint64_t provedDark = 0;                                  ///< Dark, by nine texels or the vertex ring.
    uint64_t missedByNb = 0, missedProvedByAg = 0; ///< Rightly dark ones without a candidate occluder in nine texels,
                                                   ///< and the vertex ring's among them.

    uint64_t dark() const { return pixels - lit; }
    uint64_t wrong() const { return wrongLit + wrongDark; }
    uint64_t rightDark() const { return dark() - wrongDark; }
    uint64_t leftAfterTc() const { return pixels - hintedLit - hintedDark; }
    uint64_t leftLit() const { return lit - hintedLit - corrected; }
    uint64_t leftDark() const { return dark() - darkAfterAg; }
    uint64_t left() const { return leftLit() + leftDark(); }
    uint64_t wrongHints() const { return wrongHintsLit + wrongHintsDark; }
    /// With leftovers lit: the thesis's table 15.
    uint64_t wrongWithoutRays() const
    {
        return wrongLit - corrected + (rightDark() - (darkAfterAg - wrongHintsDark)) + wrongHintsDark;
    }
    /// Where no hint is believed.
    uint64_t leftStrict() const { return lit - corrects[size_t(CandidateOccluder::nb9)] + dark() - provedDark; }
    /// One technique alone, what it does not hit lit: tables 9 to 11.
    uint64_t wrongAlone(CandidateOccluder w) const
    {
        return wrongLit - corrects[size_t(w)] + rightDark() - confirms[size_t(w)];
    }
};

/// Triangles that a technique could ask about a pixel, means over a contour.
struct Candidates {
    double used = 0.0;      ///< Of all its pixels; those turned away from the light ask none.
    double available = 0.0; ///< Of those that have any.
};

inline constexpr uint32_t kContours[] = {2, 4, 6};
inline constexpr uint32_t kChainMaps[] = {1024, 2048};

/// One view and map: contours of 2, 4 and 6 pixels, and the whole image.
struct ChainView {
    const char* scene; ///< The thesis's.
    Look look;
    uint32_t map = 0; ///< The thesis's.
    uint64_t image = 0;
    std::array<ContourCounts, 3> contours{};
    std::array<Candidates, 4> candidates{}; ///< NB4, NB9, AG1, AG2; of the finer map and the contour of 4 pixels alone.
    ContourCounts whole; ///< Printed: pixels, wrongLit + wrongDark as wrongLit, and of TC4 the undecided and wrong.
    uint32_t side = 0;   ///< Of our map.
};

struct ChainScene {
    const char* printed; ///< The thesis's name.
    ViewScene view;
};
inline constexpr std::array<ChainScene, 4> kChainScenes = {
    {{"primitives", kPrimitivesView}, {"bench", kBenchView}, {"trees", kFoliageView}, {"flowers", kFlowersView}}};

struct ChainCensusOptions {
    uint32_t picture = 1024;     ///< Pixels a side; maps keep the thesis's ratio to it.
    MapFit fit = MapFit::square; ///< The thesis has its map "fitted to the camera's frustum", and says no more.
    std::function<void(const ChainView&)> measured; ///< After each.
};
/// All views, in the order of kChainScenes, kLooks, kChainMaps.
std::vector<ChainView> measureChain(Device& device, const ChainCensusOptions& options);

/// From pictures of votes and of candidates (`reasons` 2, 3 and 4).
std::array<Candidates, 4> countCandidates(const Image8& votes, const Image8& texels, const Image8& rings);
/// Counts of one picture of votes.
ChainView countVotes(const Image8& votes, const Image8& truth);

} // namespace gnomon::demo
