#include "algorithms/hybrid/chain.hpp"

namespace gnomon {

ChainStages stagesOf(ChainMode mode)
{
    switch (mode) {
    case ChainMode::chain:
        return {.hintLit = true, .hintShadow = true, .witnesses = true};
    case ChainMode::tcOnly:
    case ChainMode::wholeTc:
        return {.hintLit = true, .hintShadow = true};
    case ChainMode::tcLit:
        return {.hintLit = true, .witnesses = true, .hintsLast = true};
    case ChainMode::strict:
        return {.witnesses = true};
    case ChainMode::noRay:
        return {.hintLit = true, .hintShadow = true, .witnesses = true, .rays = false};
    }
    return {};
}

bool blockBlocks(const ChainScene& scene, const MapTexels& texels, TexelBlock block, const ShadowRay& ray)
{
    return texels.anyTriangle(block, [&](std::uint32_t number) { return scene.witnesses.blocks(number, ray); });
}

bool ringBlocks(const ChainScene& scene, const MapTexels& texels, int shared, bool own, const ShadowRay& ray)
{
    const std::uint32_t number = texels.ownTriangle();
    if (number == kNoTriangle) return false;
    if (own && scene.witnesses.blocks(number, ray)) return true;
    const NumberedTriangles::Entry& entry = scene.witnesses.triangles().of(number);
    if (!entry.rings || !entry.rings->built || !entry.testifies) return false;
    return entry.rings->rings.around(
        *entry.caster->mesh->topology, number - entry.first, shared,
        [&](std::uint32_t face) { return scene.witnesses.blocks(entry.first + face, ray); });
}

std::uint32_t chainReason(const ChainScene& scene, const ChainStages& stages, bool lit, bool normals,
                          const MapTexels& texels, const ShadowRay& ray)
{
    const bool hints = normals && (lit ? stages.hintLit : stages.hintShadow);
    if (hints && !stages.hintsLast && texels.agree(lit, TexelBlock::four))
        return lit ? gpu::REASON_TC_LIT : gpu::REASON_TC_SHADOW;
    if (stages.witnesses) {
        if (blockBlocks(scene, texels, TexelBlock::nine, ray))
            return lit ? gpu::REASON_NB_CORRECTED : gpu::REASON_NB_CONFIRMED;
        if (!lit && ringBlocks(scene, texels, 1, false, ray)) return gpu::REASON_AG_CONFIRMED;
    }
    if (hints && stages.hintsLast && texels.clearlyLit()) return gpu::REASON_TC_LIT;
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

bool isLit(std::uint32_t reason)
{
    constexpr std::uint32_t lit = 1u << gpu::REASON_OUTSIDE | 1u << gpu::REASON_MAP_LIT | 1u << gpu::REASON_TC_LIT |
                                  1u << gpu::REASON_RT_LIT | 1u << gpu::REASON_FALLBACK_LIT |
                                  1u << gpu::REASON_TILE_LIT;
    return (lit >> reason & 1) != 0;
}

} // namespace gnomon
