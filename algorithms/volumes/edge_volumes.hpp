#pragma once
// Volumes of which the device makes corners from all edges and faces of a mesh: nothing is found on the CPU, and lists
// belong to meshes, not to lights.
#include "algorithms/volumes/volume_draw.hpp"

namespace gnomon {

/// Declares the lists and picks the volumes that the view can see, for pipelines of VolumeShape::allEdges.
/// @param findPlanes makeFindPlanes()
VolumePlan* planEdgeVolumes(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil,
                            PipelineId findPlanes, bool bounded, bool zFailForAll);

/// Why the device cannot draw them for the task, or null. Static storage.
const char* refusesEdgeVolumes(const DeviceTable& vk, const ShadowTask& task);

} // namespace gnomon
