#pragma once
// D. L. Moderno, "Shadow Mapping and Ray-Tracing", Universidade do Minho: the counts his tables print.

#include <span>

#include "demo/program/chain_census.hpp"

namespace gnomon::demo {

/// One view and map. His misprints are put right where other tables tell what is meant (tables 61, 93, 121, 153).
struct PrintedChainView {
    const char* scene;
    Look look;
    uint32_t map;
    uint32_t table; ///< Of the contours; the whole image's and `alone` are in the tables beside it.
    /// By contour of 2, 4 and 6 pixels, in the order of ContourCounts up to darkAfterAg.
    std::array<std::array<uint32_t, 11>, 3> contours;
    /// Of the whole image: wrong by the map; undecided by TC4; its wrong hints, lit and dark.
    std::array<uint32_t, 4> whole;
    /// Wrong with one technique alone, in contours of 2, 4 and 6 pixels and the whole image.
    std::array<std::array<uint32_t, 4>, kWitnesses> alone;
};

/// In the order of measureChain().
std::span<const PrintedChainView> printedChainViews();

/// As counts; what is not printed stays 0.
ChainView countsOf(const PrintedChainView& printed);

/// Means over all views, maps and contours.
struct PrintedWitness {
    double error, corrected, ofWrongLit, confirmed, ofRightDark; ///< Percent.
};
/// Tables 9 to 11. NB9's corrected is 7.46 there, 7.50 by the counts.
inline constexpr PrintedWitness kPrintedWitnesses[kWitnesses] = {{12.06, 0.09, 0.77, 76.39, 85.50},
                                                                 {6.39, 6.80, 58.20, 81.03, 90.68},
                                                                 {5.30, 7.50, 64.25, 82.61, 92.46},
                                                                 {8.93, 0.17, 1.42, 82.71, 92.59},
                                                                 {7.19, 0.25, 2.14, 86.19, 96.51}};
struct PrintedHints {
    double settled, ofLit, ofDark, wrongOfLit, wrongOfDark;
};
/// Tables 7 and 8: by four and by nine texels.
inline constexpr PrintedHints kPrintedHints[] = {{58.30, 58.52, 57.96, 0.55, 0.12}, {43.02, 42.76, 43.15, 0.28, 0.02}};
/// Of the rightly dark pixels that nine texels prove nothing of, what the vertex ring proves (from tables 13 and 16
/// ff.).
inline constexpr double kPrintedRingProves = 73.8;
/// What no hint leaves of a contour, by map and contour: from the counts of tables 16 ff.
inline constexpr double kPrintedStrictLeft[2][3] = {{54.75, 54.39, 53.98}, {52.64, 52.30, 52.12}};

} // namespace gnomon::demo
