#pragma once
// From volumes to visibility in one raster pass: clear, count, resolve where the count is not 0.
#include "algorithms/volumes/stencil_resolve.hpp"
#include "algorithms/volumes/volume_draw.hpp"

namespace gnomon {

struct VolumeCountNames {
    VolumePipelineNames volumes;
    const char* resolve;
};
struct VolumeCountPipelines {
    VolumePipelines volumes;
    ResolvePipelines resolve;
};
VolumeCountPipelines makeVolumeCountPipelines(const AlgorithmServices& services, const VolumeCountNames& names,
                                              VolumeShape shape = VolumeShape::lists);

/// Declares the pass that writes the task's layer. Plan and pipelines are read while recording.
void declareCount(PassBuilder& passes, const ShadowTask& task, const char* name, const ViewStencil& stencil,
                  const VolumePlan& volumes, const VolumeCountPipelines& pipelines);

} // namespace gnomon
