#pragma once
// The exact Euclidean distance transform with the nearest site of every pixel, in two compute passes. Their loops
// depend on the size of the rectangle alone, so the price does not depend on the sites.
#include "runtime/algorithm.hpp"

namespace gnomon {

/// Of the image that says which pixels are sites.
inline constexpr VkFormat kSeedFormat = VK_FORMAT_R16G16_SFLOAT;

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

} // namespace gnomon
