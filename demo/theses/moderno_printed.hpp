#pragma once
// D. L. Moderno, "Shadow Mapping and Ray-Tracing", Universidade do Minho: the counts his tables print.

#include <span>

#include "demo/theses/chain_census.hpp"

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
    std::array<std::array<uint32_t, 4>, kCandidates> alone;
};

/// In the order of measureChain().
std::span<const PrintedChainView> printedChainViews();

/// As counts; what is not printed stays 0.
ChainView countsOf(const PrintedChainView& printed);

/// Means over all views, maps and contours.
struct PrintedOccluder {
    double error, corrected, ofWrongLit, confirmed, ofRightDark; ///< Percent.
};
/// Tables 9 to 11. NB9's corrected is 7.46 there, 7.50 by the counts.
inline constexpr PrintedOccluder kPrintedOccluders[kCandidates] = {{12.06, 0.09, 0.77, 76.39, 85.50},
                                                                   {6.39, 6.80, 58.20, 81.03, 90.68},
                                                                   {5.30, 7.50, 64.25, 82.61, 92.46},
                                                                   {8.93, 0.17, 1.42, 82.71, 92.59},
                                                                   {7.19, 0.25, 2.14, 86.19, 96.51}};
/// Triangles per pixel of the contour, used and available, of NB4, NB9, AG1, AG2; map 2048, contour of 4 pixels (tables
/// 25 to 197). 0: misprinted.
struct PrintedCandidates {
    const char* scene;
    Look look;
    std::array<Candidates, 4> of;
};
inline constexpr PrintedCandidates kPrintedCandidates[] = {
    {"primitives", Look::side, {{{1.449, 1.899}, {2.425, 2.900}, {2.342, 4.000}, {7.096, 12.117}}}},
    {"primitives", Look::with, {{{1.584, 2.059}, {2.590, 3.202}, {2.608, 4.000}, {0.0, 12.210}}}},
    {"primitives", Look::against, {{{1.399, 1.702}, {2.286, 2.563}, {2.258, 4.000}, {0.0, 12.086}}}},
    {"bench", Look::side, {{{1.359, 1.871}, {2.258, 2.945}, {2.501, 3.858}, {7.960, 12.278}}}},
    {"bench", Look::with, {{{1.324, 1.721}, {2.113, 2.529}, {2.624, 3.867}, {8.313, 12.252}}}},
    {"bench", Look::against, {{{1.493, 1.836}, {2.496, 2.816}, {2.484, 3.917}, {7.363, 11.609}}}},
    {"trees", Look::side, {{{0.714, 1.086}, {0.903, 1.161}, {2.027, 4.000}, {7.320, 14.445}}}},
    {"trees", Look::with, {{{0.793, 1.071}, {1.025, 1.135}, {2.009, 4.000}, {7.194, 14.322}}}},
    {"trees", Look::against, {{{0.732, 1.076}, {0.955, 1.139}, {2.013, 4.000}, {7.255, 14.419}}}},
    {"flowers", Look::side, {{{1.914, 2.433}, {3.416, 4.268}, {2.754, 3.875}, {8.737, 12.293}}}},
    {"flowers", Look::with, {{{2.133, 2.356}, {3.832, 4.057}, {3.107, 3.864}, {9.687, 12.047}}}},
    {"flowers", Look::against, {{{1.904, 2.310}, {3.382, 3.985}, {2.844, 3.901}, {8.759, 12.015}}}}};
struct PrintedHints {
    double settled, ofLit, ofDark, wrongOfLit, wrongOfDark;
};
/// Tables 7 and 8: by four and by nine texels.
inline constexpr PrintedHints kPrintedHints[] = {{58.30, 58.52, 57.96, 0.55, 0.12}, {43.02, 42.76, 43.15, 0.28, 0.02}};
/// What no hint leaves of a contour, by map and contour: from the counts of tables 16 ff.
inline constexpr double kPrintedStrictLeft[2][3] = {{54.75, 54.39, 53.98}, {52.64, 52.30, 52.12}};

} // namespace gnomon::demo
