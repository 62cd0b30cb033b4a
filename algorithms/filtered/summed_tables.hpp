#pragma once
// Four moments of a light's depths, summed over areas: the mean over any box is differences of entries.
#include <cstdint>

#include "algorithms/shared/light_map.hpp"
#include "runtime/algorithm.hpp"

namespace gnomon {

class SummedTables {
public:
    explicit SummedTables(const AlgorithmServices& services);

    /// Declares what is missing of the tables of a map that this frame has declared; none of it where the map stands
    /// still. @return an image of VK_FORMAT_R32G32B32A32_UINT with the layers of the map (shaders/filtered/summed.h)
    ImageId declare(PassBuilder& passes, const LightMap& map, const ShadowTask& task, std::uint32_t resolution) const;

    /// Device bytes without the depth map.
    static VkDeviceSize memory(std::uint32_t resolution, std::uint32_t layers);

private:
    PipelineId rows_, columns_;
};

} // namespace gnomon
