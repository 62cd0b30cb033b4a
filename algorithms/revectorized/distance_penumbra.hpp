#pragma once
// Penumbrae from distances to the edges of a hard shadow on the screen: what edt and edt_soft have in common.
#include "algorithms/revectorized/distance_transform.hpp"
#include "algorithms/shared/light_map.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "shaders/revectorized/distance.h"

namespace gnomon {

class DistancePenumbra {
public:
    explicit DistancePenumbra(const AlgorithmServices& services);

    /// Draws the map and turns it into visibility.
    /// @param width of penumbrae, metres
    /// @param disc  half width of the light's disc, as discRadius() has it, which makes the width where `width` is 0.
    ///              With neither the shadow is hard.
    /// @param show  of DistanceConstants
    /// @return what hosts may look up
    ShadowAlgorithm::Map declare(PassBuilder& passes, const ShadowTask& task, float width, float disc,
                                 std::uint32_t show) const;

    /// Why a view is too large, or null.
    const char* refuses(const ShadowTask& task) const;

    /// Device bytes.
    static VkDeviceSize memory(std::uint32_t resolution, VkExtent2D extent, GnLightType type);

private:
    struct Images {
        ImageId states, seeds;
        BufferId sites;
    };
    void declareSeeds(PassBuilder& passes, const ShadowTask& task, ImageId map, const Images& images,
                      const gpu::DistanceConstants& constants) const;
    void declareRamp(PassBuilder& passes, const ShadowTask& task, const Images& images,
                     const gpu::DistanceConstants& constants) const;

    const DeviceTable& vk_;
    DepthMapPipelines casters_;
    MapResolve hard_[2]; ///< [point light]; filtered: states
    DistanceTransform transform_;
    PipelineId seeds_[2][2]; ///< [point light][has normals]
    PipelineId ramp_[2];     ///< [has normals]
};

/// Settings of both.
inline constexpr SettingSpec kShowSetting = {
    "show",
    "0: visibility. For tests, by the bytes of shaders/revectorized/distance.h, 1: edges, 2 and 3: column and row of "
    "the "
    "nearest edge.",
    0, 3, 0};

} // namespace gnomon
