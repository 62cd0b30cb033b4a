#pragma once
// What can be said about a pixel near a shadow's edge before a ray is traced: by texels that agree, by triangles that
// neighbouring texels name, by triangles around the own texel's. Source: Moderno, 3.2 to 3.6.
#include <cstdint>

#include "algorithms/hybrid/candidate_occluder.hpp"
#include "algorithms/hybrid/map_classification.hpp"
#include "algorithms/hybrid/map_texels.hpp"
#include "shaders/hybrid/reasons.h"

namespace gnomon {

/// Values of the setting `mode`.
enum class ChainMode : std::uint8_t {
    chain,   ///< Texels that agree are believed, then candidate occluders, then rays: the thesis's.
    tcOnly,  ///< No candidate occluders.
    tcLit,   ///< Texels that agree are believed only where they say lit, by more than depths may be off.
    strict,  ///< Texels are not believed at all.
    noRay,   ///< As `chain`, but what is left over is lit.
    wholeTc, ///< As `tcOnly`, on the whole image.
};

/// Which triangles are asked before rays.
enum class CandidateUse : std::uint8_t {
    none,
    texels, ///< NB: those that nine texels name.
    chain,  ///< NB and AG: and those around the own one's.
};

/// The stages a mode has.
struct ChainStages {
    bool hintLit = false, hintShadow = false; ///< Agreeing texels are believed where they say so.
    bool clearly = false;                     ///< Only by more than depths may be off; of texels that say lit.
    CandidateUse candidates = CandidateUse::none;
    bool rays = true;

    /// Of what the four texels say before anything else is asked.
    Believed believed() const
    {
        if (clearly) return Believed::clearlyLit;
        return hintLit && hintShadow ? Believed::agreeing : Believed::never;
    }
};
ChainStages stagesOf(ChainMode mode);

/// What one light's pixels are asked against, by one thread.
struct ChainScene {
    const HostMap& map;
    const gpu::MapConstants& constants;
    bool cube = false;
    CandidateOccluders& candidates;
};

/// Whether any triangle named by the block blocks the ray.
bool blockBlocks(const ChainScene& scene, const MapTexels& texels, TexelBlock block, const ShadowRay& ray);
/// Whether the own texel's triangle or one that shares at least `shared` of its vertices (2: an edge, 1: any) does.
/// \param own false: that one has been asked already.
bool ringBlocks(const ChainScene& scene, const MapTexels& texels, int shared, bool own, const ShadowRay& ray);

/// Why the pixel is as it is, a REASON_ of shaders/hybrid/reasons.h; REASON_RT_LIT: only its ray can say.
/// \param lit what the map says. \param normals whether the receiver's normal is the surface's: without it texels
/// cannot be compared, and none is believed.
std::uint32_t chainReason(const ChainScene& scene, const ChainStages& stages, bool lit, bool normals,
                          const MapTexels& texels, const ShadowRay& ray);

/// What every stage would say by itself, asked or not: the VOTE_ bits of shaders/hybrid/reasons.h.
std::uint32_t chainVotes(const ChainScene& scene, bool lit, bool normals, const MapTexels& texels,
                         const ShadowRay& ray);

/// How many triangles the stages could ask, hits or not: CANDIDATES_ of shaders/hybrid/reasons.h.
std::uint32_t texelCandidates(const MapTexels& texels);
std::uint32_t ringCandidates(const ChainScene& scene, const MapTexels& texels);

/// What a reason means: lit or dark.
bool isLit(std::uint32_t reason);

} // namespace gnomon
