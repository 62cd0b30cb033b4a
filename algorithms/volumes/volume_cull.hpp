#pragma once
// Volumes that matter to no visible receiver are left undrawn, decided on the GPU: the depth image becomes boxes of
// receivers, the boxes choose volumes, and the choice is written as indirect commands. Nothing comes back to the CPU.
#include <cstdint>
#include <span>

#include "algorithms/volumes/static_volumes.hpp"
#include "algorithms/volumes/view_stencil.hpp"
#include "algorithms/volumes/volume_draw.hpp"
#include "algorithms/volumes/volume_list.hpp"

namespace gnomon {

struct VolumeCullPipelines {
    PipelineId reached, cull;
};
VolumeCullPipelines makeVolumeCullPipelines(const AlgorithmServices& services);

/// Those draws of a plan that come from one of its lists of sides, with the caps of the ones that z-fail counts.
struct CulledList {
    std::uint32_t index = 0;                            ///< In VolumePlan::lists: 0 static casters, 1 moving ones.
    std::uint64_t stamp = 0;                            ///< Of the light and the casters of the list.
    std::uint32_t variant = 0;                          ///< Distinguishes a light's lists.
    std::span<const StaticVolumes::Occluder> occluders; ///< Of the first list alone; by position in it.
};

/// Declares the choice: the draws get commands without an instance where nobody sees anything that the volume can hold.
/// Lists of which the plan draws fewer than four volumes stay as they are.
void declareCull(PassBuilder& passes, const VolumeCullPipelines& pipelines, const ShadowTask& task,
                 const ViewStencil& stencil, std::span<const CulledList> lists, VolumePlan& plan);

/// Device bytes of the tiles that one light reaches, in a view of this extent.
VkDeviceSize cullMemory(VkExtent2D extent);

} // namespace gnomon
