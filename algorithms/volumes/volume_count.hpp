#pragma once
// From volumes to visibility in one raster pass: clear, count, resolve where the count is not 0.
#include "algorithms/volumes/volume_draw.hpp"
#include "shaders/volumes/volume.h"

namespace gnomon {

struct VolumeCountNames {
    VolumePipelineNames volumes;
    const char* counted;
    const char* withoutCasters;
};
struct VolumeCountPipelines {
    VolumePipelines volumes;
    PipelineId counted, withoutCasters; ///< Resolve: where the stencil is not 0, and everywhere.
};
VolumeCountPipelines makeVolumeCountPipelines(const AlgorithmServices& services, const VolumeCountNames& names,
                                              VolumeShape shape = VolumeShape::lists);

/// What a resolve pass asks of view and light.
gpu::VolumeResolve volumeResolve(const CameraView& view, const LightView& light);

/// Declares the pass that writes the task's layer. Plan and pipelines are read while recording.
void declareCount(PassBuilder& passes, const ShadowTask& task, const char* name, const ViewStencil& stencil,
                  const VolumePlan& volumes, const VolumeCountPipelines& pipelines);

} // namespace gnomon
