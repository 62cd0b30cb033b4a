#pragma once
// From a stencil to visibility: the raster pass in which volumes are drawn into the view's stencil, and the draws at
// its end that darken what the stencil marks.
#include "algorithms/volumes/view_stencil.hpp"
#include "shaders/volumes/resolve.h"

namespace gnomon {

/// By the parts of resolve.h.
struct ResolvePipelines {
    PipelineId of[gpu::RESOLVE_PARTS];
};
ResolvePipelines makeResolvePipelines(const AlgorithmServices& services, const char* name);

/// Visibility of what the light does not shine on.
struct Darkness {
    float shadow = 0.0f;     ///< Where the stencil is not 0.
    float turnedAway = 0.0f; ///< On surfaces that face away from the light.
};

/// What a resolve pass asks of view and light.
gpu::VolumeResolve volumeResolve(const CameraView& view, const LightView& light, const Darkness& darkness = {});

/// What the draws need of a task; in the frame's arena.
struct StencilResolve {
    const CameraView* view = nullptr;
    const LightView* light = nullptr;
    ImageId depth, normals;
    BufferId tiles;    ///< Of ViewStencil.
    VkRect2D pixels{}; ///< Where the light can reach; of no extent: nowhere.
    Darkness darkness;
};

/// Begins the declaration of the pass that writes the task's layer: visibility cleared to 1 and the stencil of the
/// view's copy to 0, depth tested against it. Fills in `resolve`, all but the darkness.
PassRef declareStencilPass(PassBuilder& passes, const ShadowTask& task, const char* name, const ViewStencil& stencil,
                           StencilResolve& resolve);

void recordResolve(PassContext& gpu, const StencilResolve& resolve, const ResolvePipelines& pipelines);

/// Records draw(gpu) and then the resolve, both within the light's pixels; nothing where there are none.
template <typename Draw>
void recordStencilPass(PassContext& gpu, const StencilResolve& resolve, const ResolvePipelines& pipelines, Draw&& draw)
{
    if (!gpu.clipTo(resolve.pixels)) return; // the light reaches no pixel: 1 everywhere, as cleared
    draw(gpu);
    recordResolve(gpu, resolve, pipelines);
}

} // namespace gnomon
