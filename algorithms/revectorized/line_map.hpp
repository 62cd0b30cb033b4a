#pragma once
// A light's depth map whose edges are lines, and the pass that asks it (shaders/revectorized/lines.frag).
#include "algorithms/shared/light_map.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "shaders/revectorized/lines.h"

namespace gnomon {

/// What is made of a map's edges.
struct Lines {
    std::uint32_t mode = gpu::REVECTORIZE_NONCONSERVATIVE;
    std::uint32_t longest = 0;    ///< Texels that a stair is followed to each side.
    std::uint32_t filterSide = 1; ///< Of the box, texels, odd; REVECTORIZE_KERNEL.
};

/// The setting `longest`. 16: the thesis's listings A.3 and B.2. Half-planes at any angle are wrong by 0.096, 0.089 and
/// 0.084 texels per texel of edge with 8, 16 and 32 (revectorized_test prints it).
inline constexpr SettingSpec kLongestSetting = {"longest", "Texels that a stair is followed to each side.", 8,
                                                gpu::MAX_STAIR, 16};

/// Texels around each face of a cube: as many as a kernel and the stairs from its outermost tap reach, so that no stair
/// ends where a face does. Elsewhere stairs end at a map's edge, beyond which there are no receivers or no casters.
std::uint32_t lineBorder(const LightView& light, std::uint32_t resolution, const Lines& lines);

class LineMap {
public:
    /// @param name of the pass
    LineMap(const AlgorithmServices& services, const char* name);

    /// Draws what is missing of the map and writes the task's layer of visibility. @return what hosts find of the map
    ShadowAlgorithm::Map declare(PassBuilder& passes, const ShadowTask& task, std::uint32_t resolution,
                                 const Lines& lines) const;

private:
    DepthMapPipelines casters_;
    MapResolve resolve_;
};

} // namespace gnomon
