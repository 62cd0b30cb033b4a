#pragma once
// Nearest and farthest depths in squares of a light's map, by which a whole neighbourhood of a receiver is known to be
// lit or dark (shaders/shared/depth_bounds.h). Kept with the map.
#include "algorithms/shared/light_map.hpp"

namespace gnomon {

class DepthBounds {
public:
    explicit DepthBounds(const AlgorithmServices& services);

    /// Declares what is missing of the pyramids of the layers needed. @return a storage buffer, for depth_range.glsl
    BufferId declare(PassBuilder& passes, const LightMap& map, std::uint32_t resolution) const;

    /// For MapResolveInfo::more of shaders that search the bounds for a light's disc (blocker_search.glsl).
    static constexpr BindingInfo kBinding[] = {bufferAt(1)};

    /// Device bytes.
    static VkDeviceSize memory(std::uint32_t resolution, std::uint32_t layers);

private:
    PipelineId reduce_;
};

/// AlgorithmEntry::memoryPerLight of methods whose first setting is the side of a light's map with its bounds.
VkDeviceSize searchedMapMemory(std::span<const double> settings, VkExtent2D extent, GnLightType type);

/// Why a map of that side cannot be searched for the light's blockers, or null.
const char* refusesSearch(const DeviceTable& vk, const ShadowTask& task, std::uint32_t resolution);

} // namespace gnomon
