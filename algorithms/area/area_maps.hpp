#pragma once
// Depth maps from points of a light's source, and how they are looked up (shaders/area/area_light.h).
#include "algorithms/shared/depth_map.hpp"
#include "runtime/algorithm.hpp"
#include "shaders/area/area_light.h"

namespace gnomon {

/// From the light to the nearest caster, metres.
float nearestCaster(const ShadowTask& task);

/// Of the whole light: what it reaches, and which receivers face it.
gpu::MapConstants centreConstants(const ShadowTask& task, std::uint32_t resolution);

/// A map to be drawn: one of a light without a surface.
struct PointMap {
    const char* name = ""; ///< Of the pass.
    ImageId image;
    std::uint32_t resolution = 0, layer = 0;
    Scope scope = Scope::task;
    std::uint32_t variant = 0;
    bool seen = false;             ///< It covers what the view sees, not all casters.
    bool due = true;               ///< It is to be drawn in this frame.
    BufferId after;                ///< The pass comes after what writes it.
    const bool* skipped = nullptr; ///< Read while recording: the map is cleared only. In the frame's memory.
};

/// What methods of maps from points serve, and what of a light without a surface's pixels they get wrong: shadow_map's
/// at half its side.
inline constexpr GnTraits kAreaTraits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_HARD_BIT |
                                        GN_TRAIT_SOFT_PENUMBRA_BIT | GN_TRAIT_FLAT_SOURCE_BIT;
inline constexpr float kAreaWrongPercent = 1.0f;

/// Declares the pass that draws it. @param task its light has no surface, and lives as long as the frame
gpu::MapLookup declarePointMap(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                               const PointMap& map);

/// Pipelines [has normals] of a shader that looks such maps up, area_light.frag. @param sums it reads binding 5, too
struct PointLookups {
    PipelineId of[2];
};
PointLookups makePointLookups(const AlgorithmServices& services, const char* name,
                              std::span<const std::uint32_t> fragment, VkFormat format, bool sums = false,
                              bool blend = false);

} // namespace gnomon
