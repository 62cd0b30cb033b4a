#pragma once
// The main tables of Moderno's thesis with our numbers beside the printed ones, and the shares that they are made of.

#include <span>

#include "demo/theses/chain_census.hpp"
#include "demo/theses/moderno_printed.hpp"
#include "demo/theses/pair_table.hpp"

namespace gnomon::demo {

/// Of one contour of one view, percent.
using ChainShare = double (*)(const ChainView& view, const ContourCounts& contour);

namespace chain {
inline double ofImage(const ChainView& v, const ContourCounts& c)
{
    return percentOf(c.pixels, v.image);
}
/// The map's errors that lie in the contour.
inline double caught(const ChainView& v, const ContourCounts& c)
{
    return percentOf(c.wrong(), v.whole.wrong());
}
inline double mapWrong(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.wrong(), c.pixels);
}
inline double hinted(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.pixels - c.leftAfterTc(), c.pixels);
}
inline double leftAfterTc(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.leftAfterTc(), c.pixels);
}
inline double settledByNb(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.hintedLit + c.corrected + c.darkAfterNb, c.pixels);
}
inline double settled(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.pixels - c.left(), c.pixels);
}
inline double settledOfLit(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.hintedLit + c.corrected, c.lit);
}
inline double settledOfDarkByNb(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.darkAfterNb, c.dark());
}
inline double settledOfDark(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.darkAfterAg, c.dark());
}
inline double left(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.left(), c.pixels);
}
inline double strictLeft(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.leftStrict(), c.pixels);
}
inline double litOfLeft(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.leftLit(), c.left());
}
/// Rays of what texels alone would leave.
inline double raysOfTc(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.left(), c.leftAfterTc());
}
inline double traced(const ChainView& v, const ContourCounts& c)
{
    return percentOf(c.left(), v.image);
}
/// Of the map's errors in the whole image, after rays: hints that were wrong, and what lies outside the contour.
inline double errorsLeft(const ChainView& v, const ContourCounts& c)
{
    return percentOf(v.whole.wrong() - c.wrong() + c.wrongHints(), v.whole.wrong());
}
inline double wrongHints(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.wrongHints(), c.pixels);
}
inline double wrongHintsOfLit(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.wrongHintsLit, c.lit);
}
inline double wrongHintsOfDark(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.wrongHintsDark, c.dark());
}
inline double withoutRays(const ChainView&, const ContourCounts& c)
{
    return percentOf(c.wrongWithoutRays(), c.pixels);
}
} // namespace chain

struct ChainFilter {
    const char* scene = nullptr; ///< Null: all.
    uint32_t map = 0;            ///< 0: both.
    int contour = -1;            ///< Index into kContours; -1: all.
};
/// Every view, map and contour that passes.
std::vector<double> shares(std::span<const ChainView> views, const ChainFilter& filter, ChainShare share);
/// All weighted alike, as the thesis does.
double mean(std::span<const ChainView> views, const ChainFilter& filter, ChainShare share);

PrintedHints meanHints(std::span<const ChainView> views, bool nineTexels);
PrintedOccluder meanCandidate(std::span<const ChainView> views, CandidateOccluder candidate);
/// Of the rightly dark pixels that nine texels prove nothing of, what the vertex ring proves, all of a scene's contours
/// together.
double ringProves(std::span<const ChainView> views, const char* scene);

std::vector<PairTable> modernoTables(std::span<const ChainView> ours);

} // namespace gnomon::demo
