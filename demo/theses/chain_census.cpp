#include "demo/theses/chain_census.hpp"

#include "algorithms/hybrid/bit_rows.hpp"
#include "shaders/hybrid/reasons.h"

namespace gnomon::demo {
namespace {

constexpr uint32_t kCandidateBits[kCandidates] = {gpu::VOTE_ST, gpu::VOTE_NB4, gpu::VOTE_NB9, gpu::VOTE_AG1,
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
    for (size_t i = 0; i < kCandidates; ++i)
        (lit ? out.corrects : out.confirms)[i] += (votes & kCandidateBits[i]) != 0;
}

} // namespace

const char* nameOf(CandidateOccluder candidate) noexcept
{
    constexpr const char* names[] = {"ST", "NB4", "NB9", "AG1", "AG2"};
    return names[size_t(candidate)];
}

namespace {

/// What the map has lit, with its memory.
struct LitRows {
    std::vector<uint64_t> memory;
    BitRows rows;

    explicit LitRows(const Image8& votes)
        : memory(BitRows::wordsPerRow(votes.width) * votes.height), rows{votes.width, votes.height, memory}
    {
        for (uint32_t y = 0; y < votes.height; ++y)
            packBits({votes.at(0, y), votes.width}, rows.row(y));
    }
    LitRows(const LitRows&) = delete;
    LitRows& operator=(const LitRows&) = delete;
};

} // namespace

std::array<Candidates, 4> countCandidates(const Image8& votes, const Image8& texels, const Image8& rings)
{
    const LitRows lit(votes);
    std::vector<uint64_t> row(BitRows::wordsPerRow(votes.width));
    uint64_t pixels = 0;
    std::array<uint64_t, 4> sums{}, with{};
    for (uint32_t y = 0; y < votes.height; ++y) {
        contourRow(lit.rows, y, (kContours[1] - 1) / 2, row);
        for (uint32_t x = 0; x < votes.width; ++x) {
            if ((row[x / 64] >> (x % 64) & 1) == 0) continue;
            ++pixels;
            const uint32_t t = *texels.at(x, y), r = *rings.at(x, y);
            const std::array<uint32_t, 4> counts = {t % gpu::CANDIDATES_STEP, t / gpu::CANDIDATES_STEP,
                                                    r % gpu::CANDIDATES_STEP, r / gpu::CANDIDATES_STEP};
            for (size_t i = 0; i < counts.size(); ++i) {
                sums[i] += counts[i];
                with[i] += counts[i] > 0;
            }
        }
    }
    std::array<Candidates, 4> out;
    for (size_t i = 0; i < out.size(); ++i)
        out[i] = {pixels ? double(sums[i]) / double(pixels) : 0.0, with[i] ? double(sums[i]) / double(with[i]) : 0.0};
    return out;
}

ChainView countVotes(const Image8& votes, const Image8& truth)
{
    const uint32_t width = votes.width, height = votes.height;
    const LitRows lit(votes);
    std::vector<uint64_t> row(BitRows::wordsPerRow(width));
    ChainView view{};
    view.image = uint64_t(width) * height;
    for (uint32_t y = 0; y < height; ++y) {
        const auto isLit = [&](uint32_t x) { return *truth.at(x, y) >= 128; };
        for (uint32_t x = 0; x < width; ++x)
            count(*votes.at(x, y), isLit(x), view.whole);
        for (size_t i = 0; i < std::size(kContours); ++i) {
            contourRow(lit.rows, y, (kContours[i] - 1) / 2, row);
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
                const auto draw = [&](double reasons) {
                    return stage.draw("contour_chain", {{"resolution", double(side)}, {"reasons", reasons}});
                };
                const Image8 votes = draw(2.0);
                ChainView view = countVotes(votes, stage.truth());
                if (map == kChainMaps[1]) view.candidates = countCandidates(votes, draw(3.0), draw(4.0));
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
