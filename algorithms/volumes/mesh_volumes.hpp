#pragma once
// Volumes of casters whose positions the GPU alone knows: sides and caps found by compute shaders from the planes of
// their faces, in the form of volume_list.hpp. The CPU knows edges and faces, but not where they are.
#include "algorithms/volumes/volume_draw.hpp"

namespace gnomon {

struct MeshVolumePipelines {
    PipelineId planes, sides, caps;
};
MeshVolumePipelines makeMeshVolumePipelines(const AlgorithmServices& services);

/// Declares the lists of a task's casters of that kind, if there are any, and adds those volumes that the view can see:
/// sides once per light, caps of those that z-fail counts. Each caster is one volume, since bounds of clusters are of
/// another pose.
void addMeshVolumes(PassBuilder& passes, const ShadowTask& task, const MeshVolumePipelines& pipelines, bool zFailForAll,
                    VolumePlan& plan);

/// Why the device cannot make them, or null. Static storage.
const char* refusesMeshVolumes(const DeviceTable& vk, const ShadowTask& task);

} // namespace gnomon
