#pragma once
// Silhouettes found by the device instead of the CPU: topology is handed over once, after that four numbers a caster.
#include "algorithms/volumes/volume_draw.hpp"

namespace gnomon {

struct GpuSilhouettes {
    PipelineId find;
};
GpuSilhouettes makeGpuSilhouettes(const AlgorithmServices& services);

/// Why the device cannot find the sides of a task's casters, or null. Static storage.
const char* refusesGpuSides(const DeviceTable& vk, const ShadowTask& task);

/// A list of sides as declareSides() has it, with the commands and indices of these pieces written on the device.
/// @param size of the list in indices. @param stamp of light and casters: unchanged, the list is kept.
BufferId declareGpuSides(PassBuilder& passes, const ShadowTask& task, const GpuSilhouettes& shader,
                         std::span<const VolumePiece> pieces, std::uint32_t size, std::uint32_t variant,
                         std::uint64_t stamp);

} // namespace gnomon
