#include "algorithms/volumes/volume_count.hpp"

namespace gnomon {

VolumeCountPipelines makeVolumeCountPipelines(const AlgorithmServices& services, const VolumeCountNames& names,
                                              VolumeShape shape)
{
    return {.volumes = makeVolumePipelines(services, names.volumes, {}, shape),
            .resolve = makeResolvePipelines(services, names.resolve)};
}

void declareCount(PassBuilder& passes, const ShadowTask& task, const char* name, const ViewStencil& stencil,
                  const VolumePlan& volumes, const VolumeCountPipelines& pipelines)
{
    StencilResolve* resolve = passes.arena().make<StencilResolve>();
    PassRef pass = declareStencilPass(passes, task, name, stencil, *resolve);
    usesVolumes(pass, volumes);
    const VolumePlan* plan = &volumes;
    const VolumeCountPipelines* used = &pipelines;
    pass.record([=](PassContext& gpu) {
        recordStencilPass(gpu, *resolve, used->resolve,
                          [&](PassContext& within) { drawVolumes(within, *plan, used->volumes); });
    });
}

} // namespace gnomon
