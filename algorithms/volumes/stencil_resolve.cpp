#include "algorithms/volumes/stencil_resolve.hpp"

#include <cmath>

#include "runtime/scene/light_pixels.hpp"
#include "shaders/volumes_resolve_frag.h"
#include "shaders/volumes_resolve_tiles_vert.h"

namespace gnomon {

namespace {

constexpr BindingInfo kResolveBindings[] = {constantsAt(0), sampledAt(1, VK_FORMAT_D32_SFLOAT),
                                            sampledAt(2, VK_FORMAT_R16G16B16A16_SFLOAT), bufferAt(3)};

PipelineId makeResolvePipeline(const AlgorithmServices& services, const char* name, std::uint32_t part)
{
    return services.pipelines->graphics(
        {.name = name,
         .vertex = {k_volumes_resolve_tiles_vert, 1, {part}},
         .fragment = {k_volumes_resolve_frag, 1, {part}},
         .bindings = kResolveBindings,
         .stencil = stencilTest(part == gpu::RESOLVE_UNCOUNTED ? VK_COMPARE_OP_EQUAL : VK_COMPARE_OP_NOT_EQUAL),
         .colorFormat = VK_FORMAT_R8_UNORM,
         .depthFormat = kStencilFormat});
}

} // namespace

gpu::VolumeResolve volumeResolve(const CameraView& view, const LightView& light, const Darkness& darkness)
{
    const float cosine = light.constants.directionWs.w, range = light.constants.range;
    gpu::VolumeResolve block{};
    block.view = view.constants;
    block.lightEs = light.type == GN_LIGHT_TYPE_DIRECTIONAL ? glm::vec4(-light.direction(), 0.0f)
                                                            : glm::vec4(light.position() - view.eye, 1.0f);
    block.cone = glm::vec4(light.direction(), cosine * std::abs(cosine));
    const VkRect2D& area = view.area;
    block.area = {static_cast<float>(area.offset.x), static_cast<float>(area.offset.y),
                  static_cast<float>(area.extent.width), static_cast<float>(area.extent.height)};
    block.rangeSquared = range * range;
    block.shadow = darkness.shadow;
    block.turnedAway = darkness.turnedAway;
    block.tileColumns = tileExtent(area).width;
    return block;
}

ResolvePipelines makeResolvePipelines(const AlgorithmServices& services, const char* name)
{
    ResolvePipelines pipelines;
    for (std::uint32_t part = 0; part < gpu::RESOLVE_PARTS; ++part)
        pipelines.of[part] = makeResolvePipeline(services, name, part);
    return pipelines;
}

PassRef declareStencilPass(PassBuilder& passes, const ShadowTask& task, const char* name, const ViewStencil& stencil,
                           StencilResolve& resolve)
{
    resolve.view = task.view;
    resolve.light = task.light;
    resolve.depth = task.depth;
    resolve.normals = task.normals;
    resolve.tiles = stencil.tiles;
    resolve.pixels = lightPixels(*task.light, *task.view);

    PassRef pass = passes.raster(name);
    pass.area(drawnArea(*task.view))
        .writes(task.visibility, visibilityIn(*task.view, task.layer, {}))
        .depthTest(stencil.image)
        .stencilWrite(stencil.image, {.clear = true})
        .samples(task.depth)
        .reads(stencil.tiles);
    if (task.normals) pass.samples(task.normals);
    return pass;
}

void recordResolve(PassContext& gpu, const StencilResolve& resolve, const ResolvePipelines& pipelines)
{
    const Bound constants = gpu.constants(0, volumeResolve(*resolve.view, *resolve.light, resolve.darkness));
    const Bound depth = gpu.sampled(1, resolve.depth, SamplerKind::nearest, 0);
    // Without normals the shader does not read them; something must be bound.
    const Bound normals = gpu.sampled(2, resolve.normals ? resolve.normals : resolve.depth, SamplerKind::nearest, 0);
    const Bound tiles = gpu.storage(3, resolve.tiles);
    const VkExtent2D count = tileExtent(resolve.view->area);
    for (const PipelineId pipeline : pipelines.of) {
        gpu.bind(pipeline, {constants, depth, normals, tiles});
        gpu.vk->vkCmdDraw(gpu.cmd, 6 * count.width * count.height, 1, 0, 0); // resolve_tiles.vert
    }
}

} // namespace gnomon
