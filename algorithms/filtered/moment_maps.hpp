#pragma once
// Moments of a light's depths, averaged over boxes: a filtered image beside the depth map, kept as long as that is.
#include <array>
#include <cmath>
#include <cstdint>

#include "algorithms/shared/light_map.hpp"
#include "runtime/algorithm.hpp"
#include "shaders/filtered/moments.h"

namespace gnomon {

/// How moments are made of depths.
struct MomentFilter {
    std::uint32_t kind = gpu::MOMENTS_EVSM4; ///< gpu::MOMENTS_*.
    std::uint32_t bits = 32;                 ///< A channel: 16 or 32.
    float exponent = 1.0f;                   ///< gpu::momentExponent().
    std::uint32_t box = 1;                   ///< Texels, odd, at most gpu::MAX_MOMENT_FILTER.
    std::uint32_t boxes = 1; ///< How often the box is applied along either axis; 3 is nearly a Gaussian.
    bool mips = false;       ///< Whether smaller maps are made, gpu::MOMENT_LEVELS of them.

    /// Standard deviation along an axis of the places that a filtered value is the mean of, texels.
    float deviation() const { return static_cast<float>(box) * std::sqrt(static_cast<float>(boxes) / 12.0f); }
    /// That maps need around what they cover.
    std::uint32_t border() const { return boxes * (box / 2) + 1; }
};

/// Depths of a fit as z of shaders/filtered/moments.h: 0 at its near end, 1 where it ends.
gpu::LinearDepth linearDepthOf(const LightFit& fit, const LightView& light);

/// Whether a layer of what is made of a map's layer has to be made again, and notes that it is; where not, that it was
/// kept. @param scope LightMap::scope @param mapStamp LightMap::stamps of the layer
bool staleLayer(PassBuilder& passes, const char* stampName, Scope scope, std::uint32_t variant, ImageId image,
                std::uint64_t mapStamp);

/// Where shaders read statistics of a map's layers, in images that hold unsigned integers.
constexpr BindingInfo momentsAt(std::uint32_t binding)
{
    BindingInfo info = mapAt(binding, VK_FORMAT_R32G32B32A32_UINT);
    info.array = true;
    return info;
}

/// Both have the layers of the map, and MomentMaps::format().
struct MomentImages {
    ImageId map;
    ImageId levels; ///< Smaller ones, gpu::momentLevelCorner(); null without MomentFilter::mips.
};

class MomentMaps {
public:
    explicit MomentMaps(const AlgorithmServices& services);

    /// Declares what is missing of the filtered moments of a map that this frame has declared; none of it where the map
    /// stands still.
    MomentImages declare(PassBuilder& passes, const LightMap& map, const ShadowTask& task, std::uint32_t resolution,
                         const MomentFilter& filter) const;

    /// Device bytes without the depth map.
    static VkDeviceSize memory(const MomentFilter& filter, std::uint32_t resolution, std::uint32_t layers);
    /// Of a storage buffer that the filter works in.
    static VkDeviceSize scratchBytes(const MomentFilter& filter, std::uint32_t resolution);
    /// Of the image: unsigned integers, whatever they hold, since these are what every device may write.
    static VkFormat format(const MomentFilter& filter);

private:
    struct Layer;
    void declareLayer(PassBuilder& passes, const Layer& layer) const;
    void declareLevels(PassBuilder& passes, const Layer* layer) const;

    std::array<PipelineId, gpu::MOMENT_KINDS> rows_;     ///< By kind.
    std::array<PipelineId, 3> means_;                    ///< By channels: 1, 2, 4.
    std::array<std::array<PipelineId, 3>, 3> columns_{}; ///< By channels and words.
    std::array<PipelineId, 3> levels_;                   ///< By words.
};

} // namespace gnomon
