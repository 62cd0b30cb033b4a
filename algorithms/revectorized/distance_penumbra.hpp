#pragma once
// Penumbrae from distances to the edges of a hard shadow on the screen: what edt and edt_soft have in common.
#include "algorithms/shared/light_map.hpp"
#include "algorithms/shared/screen_blur.hpp"
#include "shaders/revectorized/distance.h"

namespace gnomon {

/// Of the image that says which pixels are sites.
inline constexpr VkFormat kSeedFormat = VK_FORMAT_R16G16_SFLOAT;

/// The exact Euclidean distance transform with the nearest site of every pixel, in two compute passes. Their loops
/// depend on the size of the rectangle alone, so the price does not depend on the sites.
class DistanceTransform {
public:
    explicit DistanceTransform(const AlgorithmServices& services);

    /// @param seeds  of kSeedFormat: pixels whose first channel is above 0 are sites
    /// @param pixels the rectangle of it that counts; sides of MAX_DISTANCE_SIDE at most
    /// @return a storage buffer of uint by columns: site [column * height + row] of the rectangle, or NO_SITE
    ///         (shaders/revectorized/distance.h)
    BufferId declare(PassBuilder& passes, const CameraView& view, ImageId seeds, const VkRect2D& pixels) const;

    /// Device bytes.
    static VkDeviceSize memory(VkExtent2D extent);

private:
    PipelineId columns_, rows_;
};

/// What penumbrae look like.
struct DistanceRamp {
    float width = 0.0f;     ///< Metres.
    float disc = 0.0f;      ///< Half width of the light's disc, as discRadius() has it, which makes the width where
                            ///< `width` is 0. With neither the shadow is hard.
    std::uint32_t show = 0; ///< Of DistanceConstants.
    float mean = 0.0f;      ///< Of DistanceConstants.
};

class DistancePenumbra {
public:
    explicit DistancePenumbra(const AlgorithmServices& services);

    /// Draws the map and turns it into visibility. @return what hosts may look up
    ShadowAlgorithm::Map declare(PassBuilder& passes, const ShadowTask& task, const DistanceRamp& ramp) const;

    /// Why a view is too large, or null.
    const char* refuses(const ShadowTask& task) const;

    /// Device bytes.
    static VkDeviceSize memory(std::uint32_t resolution, VkExtent2D extent, GnLightType type, double mean);

private:
    struct Images {
        ImageId map, states, seeds;
        BufferId sites;
    };
    void declareRamp(PassBuilder& passes, const ShadowTask& task, const Images& images,
                     const gpu::DistanceConstants& constants) const;

    const DeviceTable& vk_;
    DepthMapPipelines casters_;
    MapResolve hard_; ///< Filtered: states.
    DistanceTransform transform_;
    ScreenBlur mean_;
    MapResolve seeds_;
    MapResolve ramp_[2]; ///< [a mean is taken]
};

/// Settings of both.
inline constexpr SettingSpec kShowSetting = {
    "show",
    "0: visibility. For tests, by the bytes of shaders/revectorized/distance.h, 1: edges, 2 and 3: column and row of "
    "the nearest edge.",
    0, 3, 0};
inline constexpr SettingSpec kMeanSetting = {
    "mean", "Width of the mean that smooths creases of the ramp, over the ramp's; 0: none.", 0, 1, 0};

} // namespace gnomon
