#pragma once
// Kept volumes that matter to no visible receiver are left undrawn, decided on the GPU: the depth image becomes boxes
// of receivers, the boxes choose volumes, and the choice is written as indirect commands. Nothing comes back to the
// CPU.
#include <cstdint>
#include <span>

#include "algorithms/volumes/static_volumes.hpp"
#include "algorithms/volumes/view_stencil.hpp"
#include "algorithms/volumes/volume_list.hpp"

namespace gnomon {

struct VolumeCullPipelines {
    PipelineId reached, cull;
};
VolumeCullPipelines makeVolumeCullPipelines(const AlgorithmServices& services);

/// One light's kept volumes in one view.
struct VolumeCull {
    const StaticVolumes* volumes = nullptr;
    VolumeList sides, caps;                    ///< Of StaticVolumes::drawn; no caps: none are drawn in this frame.
    std::uint32_t variant = 0;                 ///< Of the choice, as in VolumeChoice.
    std::span<const std::uint32_t> candidates; ///< Positions in `drawn`: those that the frustum leaves. Frame memory.
};

/// Commands of the candidates, in the places they have in the lists; caps: null id without any.
struct CulledCommands {
    BufferId sides, caps;
};

/// Declares the choice.
CulledCommands declareCull(PassBuilder& passes, const VolumeCullPipelines& pipelines, const ShadowTask& task,
                           const ViewStencil& stencil, const VolumeCull& cull);

/// Device bytes of the tiles that one light reaches, in a view of this extent.
VkDeviceSize cullMemory(VkExtent2D extent);

} // namespace gnomon
