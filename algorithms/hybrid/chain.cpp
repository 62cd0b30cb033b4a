#include "algorithms/hybrid/chain.hpp"

#include <algorithm>

namespace gnomon {

ChainStages stagesOf(ChainMode mode)
{
    switch (mode) {
    case ChainMode::chain:
        return {.hintLit = true, .hintShadow = true, .candidates = CandidateUse::chain};
    case ChainMode::tcOnly:
    case ChainMode::wholeTc:
        return {.hintLit = true, .hintShadow = true};
    case ChainMode::tcLit:
        return {.hintLit = true, .clearly = true, .candidates = CandidateUse::texels};
    case ChainMode::strict:
        return {.candidates = CandidateUse::chain};
    case ChainMode::noRay:
        return {.hintLit = true, .hintShadow = true, .candidates = CandidateUse::chain, .rays = false};
    }
    return {};
}

bool blockBlocks(const ChainScene& scene, const MapTexels& texels, TexelBlock block, const ShadowRay& ray)
{
    return texels.anyTriangle(block, [&](std::uint32_t number) { return scene.candidates.blocks(number, ray); });
}

namespace {

/// Calls `visit(number)` for triangles that share at least `shared` vertices with the given one, until it returns true.
template <typename Visit>
bool anyAround(const NumberedTriangles& triangles, std::uint32_t number, int shared, Visit&& visit)
{
    const NumberedTriangles::Entry& entry = triangles.of(number);
    if (!entry.rings || !entry.rings->built || !entry.testifies) return false;
    return entry.rings->rings.around(*entry.caster->mesh->topology, number - entry.first, shared,
                                     [&](std::uint32_t face) { return visit(entry.first + face); });
}

} // namespace

bool ringBlocks(const ChainScene& scene, const MapTexels& texels, int shared, bool own, const ShadowRay& ray)
{
    const std::uint32_t number = texels.ownTriangle();
    if (number == kNoTriangle) return false;
    if (own && scene.candidates.blocks(number, ray)) return true;
    return anyAround(scene.candidates.triangles(), number, shared,
                     [&](std::uint32_t other) { return scene.candidates.blocks(other, ray); });
}

std::uint32_t chainReason(const ChainScene& scene, const ChainStages& stages, bool lit, bool normals,
                          const MapTexels& texels, const ShadowRay& ray)
{
    const bool hints = normals && (lit ? stages.hintLit : stages.hintShadow);
    if (hints && (stages.clearly ? texels.clearlyLit() : texels.agree(lit, TexelBlock::four)))
        return lit ? gpu::REASON_TC_LIT : gpu::REASON_TC_SHADOW;
    if (stages.candidates != CandidateUse::none) {
        if (blockBlocks(scene, texels, TexelBlock::nine, ray))
            return lit ? gpu::REASON_NB_CORRECTED : gpu::REASON_NB_CONFIRMED;
        if (stages.candidates == CandidateUse::chain && !lit && ringBlocks(scene, texels, 1, false, ray))
            return gpu::REASON_AG_CONFIRMED;
    }
    // No ray sees what the host draws by itself: there the map is all there is.
    if (!lit && texels.foreign()) return gpu::REASON_MAP_SHADOW;
    return stages.rays ? gpu::REASON_RT_LIT : gpu::REASON_FALLBACK_LIT;
}

std::uint32_t chainVotes(const ChainScene& scene, bool lit, bool normals, const MapTexels& texels, const ShadowRay& ray)
{
    std::uint32_t votes = lit ? gpu::VOTE_LIT : 0;
    if (normals && texels.agree(lit, TexelBlock::four)) votes |= gpu::VOTE_TC4;
    if (normals && texels.agree(lit, TexelBlock::nine)) votes |= gpu::VOTE_TC9;
    if (blockBlocks(scene, texels, TexelBlock::own, ray)) votes |= gpu::VOTE_ST;
    if (blockBlocks(scene, texels, TexelBlock::four, ray)) votes |= gpu::VOTE_NB4;
    if (blockBlocks(scene, texels, TexelBlock::nine, ray)) votes |= gpu::VOTE_NB9;
    if (ringBlocks(scene, texels, 2, true, ray)) votes |= gpu::VOTE_AG1;
    if (ringBlocks(scene, texels, 1, true, ray)) votes |= gpu::VOTE_AG2;
    return votes;
}

std::uint32_t texelCandidates(const MapTexels& texels)
{
    std::uint32_t four = 0, nine = 0;
    texels.anyTriangle(TexelBlock::four, [&](std::uint32_t) { return ++four == 0; });
    texels.anyTriangle(TexelBlock::nine, [&](std::uint32_t) { return ++nine == 0; });
    return four + gpu::CANDIDATES_STEP * nine;
}

std::uint32_t ringCandidates(const ChainScene& scene, const MapTexels& texels)
{
    const std::uint32_t number = texels.ownTriangle();
    if (number == kNoTriangle) return 0;
    std::uint32_t edges = 1, vertices = 1; // the own one
    const NumberedTriangles& triangles = scene.candidates.triangles();
    anyAround(triangles, number, 2, [&](std::uint32_t) { return ++edges == 0; });
    anyAround(triangles, number, 1, [&](std::uint32_t) { return ++vertices == 0; });
    return std::min(edges, gpu::CANDIDATES_STEP - 1) + gpu::CANDIDATES_STEP * std::min(vertices, gpu::CANDIDATES_MOST);
}

bool isLit(std::uint32_t reason)
{
    constexpr std::uint32_t lit = 1u << gpu::REASON_OUTSIDE | 1u << gpu::REASON_MAP_LIT | 1u << gpu::REASON_TC_LIT |
                                  1u << gpu::REASON_RT_LIT | 1u << gpu::REASON_FALLBACK_LIT |
                                  1u << gpu::REASON_TILE_LIT;
    return (lit >> reason & 1) != 0;
}

} // namespace gnomon
