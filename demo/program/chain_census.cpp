#include "demo/program/chain_census.hpp"

#include "algorithms/hybrid/bit_rows.hpp"
#include "shaders/hybrid/ray_list.h"

namespace gnomon::demo {
namespace {

constexpr uint32_t kWitnessBits[kWitnesses] = {gpu::VOTE_ST, gpu::VOTE_NB4, gpu::VOTE_NB9, gpu::VOTE_AG1,
                                               gpu::VOTE_AG2};

/// Of a pixel that the map has lit.
void countLit(uint32_t votes, bool truth, ContourCounts& out)
{
    ++out.lit;
    out.wrongLit += !truth;
    const bool hinted = votes & gpu::VOTE_TC4;
    out.hintedLit += hinted;
    out.wrongHintsLit += hinted && !truth;
    out.hintedLit9 += (votes & gpu::VOTE_TC9) != 0;
    out.wrongHintsLit9 += (votes & gpu::VOTE_TC9) && !truth;
    out.corrected += !hinted && (votes & gpu::VOTE_NB9);
}

void countDark(uint32_t votes, bool truth, ContourCounts& out)
{
    out.wrongDark += truth;
    const bool hinted = votes & gpu::VOTE_TC4, nine = votes & gpu::VOTE_NB9, ring = votes & gpu::VOTE_AG2;
    out.hintedDark += hinted;
    out.wrongHintsDark += hinted && truth;
    out.hintedDark9 += (votes & gpu::VOTE_TC9) != 0;
    out.wrongHintsDark9 += (votes & gpu::VOTE_TC9) && truth;
    out.darkAfterNb += hinted || nine;
    out.darkAfterAg += hinted || nine || ring;
    out.provedDark += nine || ring;
    out.missedByNb += !nine && !truth;
    out.missedProvedByAg += !nine && ring && !truth;
}

void count(uint32_t votes, bool truth, ContourCounts& out)
{
    ++out.pixels;
    const bool lit = votes & gpu::VOTE_LIT;
    if (lit)
        countLit(votes, truth, out);
    else
        countDark(votes, truth, out);
    for (size_t i = 0; i < kWitnesses; ++i)
        (lit ? out.corrects : out.confirms)[i] += (votes & kWitnessBits[i]) != 0;
}

} // namespace

const char* nameOf(Witness witness) noexcept
{
    constexpr const char* names[] = {"ST", "NB4", "NB9", "AG1", "AG2"};
    return names[size_t(witness)];
}

ChainView countVotes(const Image8& votes, const Image8& truth)
{
    const uint32_t width = votes.width, height = votes.height;
    const size_t words = BitRows::wordsPerRow(width);
    std::vector<uint64_t> memory(words * height), row(words);
    const BitRows lit{width, height, memory};
    for (uint32_t y = 0; y < height; ++y)
        packBits({votes.at(0, y), width}, lit.row(y));
    ChainView view{};
    view.image = uint64_t(width) * height;
    for (uint32_t y = 0; y < height; ++y) {
        const auto isLit = [&](uint32_t x) { return *truth.at(x, y) >= 128; };
        for (uint32_t x = 0; x < width; ++x)
            count(*votes.at(x, y), isLit(x), view.whole);
        for (size_t i = 0; i < std::size(kContours); ++i) {
            contourRow(lit, y, (kContours[i] - 1) / 2, row);
            for (uint32_t x = 0; x < width; ++x)
                if (row[x / 64] >> (x % 64) & 1) count(*votes.at(x, y), isLit(x), view.contours[i]);
        }
    }
    return view;
}

std::vector<ChainView> measureChain(Device& device, const ChainCensusOptions& options)
{
    std::vector<ChainView> views;
    for (const ChainScene& scene : kChainScenes) {
        ThesisView stage(device, scene.view, options.picture);
        for (const Look look : kLooks) {
            stage.look(look);
            // The finer map after the coarser: a method that serves already need not fit into what memory is left, and
            // its statement counts the six layers of a point light.
            for (const uint32_t map : kChainMaps) {
                const uint32_t side = stage.sideAsFitted(map * options.picture / 1024, options.fit);
                const Image8 votes = stage.draw("contour_chain", {{"resolution", double(side)}, {"reasons", 2.0}});
                ChainView view = countVotes(votes, stage.truth());
                view.scene = scene.printed;
                view.look = look;
                view.map = map;
                view.side = side;
                views.push_back(view);
                if (options.measured) options.measured(view);
            }
        }
    }
    return views;
}

} // namespace gnomon::demo
