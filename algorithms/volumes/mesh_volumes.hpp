#pragma once
// Sides and caps found by compute shaders from edges, faces and planes of meshes, in the form of volume_list.hpp: of
// casters whose positions the GPU alone knows, and of all where a method asks for it.
#include "algorithms/volumes/volume_draw.hpp"

namespace gnomon {

struct MeshVolumePipelines {
    PipelineId planes, sides, caps;
};
MeshVolumePipelines makeMeshVolumePipelines(const AlgorithmServices& services);

/// The list of these pieces, with commands and indices that the device writes. @param info its name is the pass's, too.
/// @param stamp of light and casters: unchanged, the list is kept. @pre caps: pieces of whole meshes
BufferId declareFound(PassBuilder& passes, const LightView& light, const MeshVolumePipelines& pipelines, ListKind kind,
                      std::span<const VolumePiece> pieces, const BufferInfo& info, std::uint64_t stamp);

/// Why the device cannot make them, or null. Static storage. @param all sides of casters whose positions the CPU knows,
/// too
const char* refusesMeshVolumes(const DeviceTable& vk, const ShadowTask& task, bool all);

} // namespace gnomon
