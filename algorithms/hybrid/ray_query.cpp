#include "algorithms/hybrid/ray_query.hpp"

#include <algorithm>

#include "runtime/scene/light_pixels.hpp"
#include "shaders/hybrid/ray_query.h"
#include "shaders/hybrid_ray_query_frag.h"
#include "shaders/shared_fullscreen_vert.h"

namespace gnomon {

namespace {

class RayQuery final : public ShadowAlgorithm {
public:
    explicit RayQuery(const AlgorithmServices& services)
    {
        const BindingInfo bindings[] = {
            {.binding = 0, .kind = BindingKind::constants},
            {.binding = 2, .kind = BindingKind::sampledImage, .format = VK_FORMAT_D32_SFLOAT},
            {.binding = 3, .kind = BindingKind::sampledImage, .format = VK_FORMAT_R16G16B16A16_SFLOAT},
            {.binding = 4, .kind = BindingKind::structure},
            {.binding = 5, .kind = BindingKind::storageBuffer}};
        GraphicsPipelineInfo info;
        info.name = "ray_query.trace";
        info.vertex.code = k_shared_fullscreen_vert;
        info.fragment.code = k_hybrid_ray_query_frag;
        info.fragment.specializationCount = 1;
        info.bindings = bindings;
        info.colorFormat = VK_FORMAT_R8_UNORM;
        for (std::uint32_t normals = 0; normals < 2; ++normals) {
            info.fragment.specialization[0] = normals;
            pipelines_[normals] = services.pipelines->graphics(info);
        }
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override;

    const char* refuses(const ShadowTask& task) const override
    {
        const bool asks = std::ranges::any_of(
            task.casters->all, [](const Caster* caster) { return caster->alphaTested && caster->opacity; });
        return asks ? "casters in range are alpha-tested by pfnOpacity, which the device cannot call" : nullptr;
    }

private:
    PipelineId pipelines_[2]; ///< [has normals]
};

void RayQuery::declare(PassBuilder& passes, const ShadowTask& task)
{
    const VkRect2D pixels = lightPixels(*task.light, *task.view), area = task.view->area;
    const bool hasNormals = static_cast<bool>(task.normals);
    const ImageId depth = task.depth, normals = hasNormals ? task.normals : task.depth;
    const TracedScene scene = *task.rays;
    const PipelineId pipeline = pipelines_[hasNormals];
    const auto* block = passes.arena().make(
        gpu::RayQueryConstants{.view = task.view->constants,
                               .light = task.light->constants,
                               .area = {area.offset.x, area.offset.y, area.extent.width, area.extent.height},
                               .lightMask = {task.light->mask, 0, 0, 0}});
    PassRef pass = passes.raster("ray_query.trace");
    pass.samples(depth).traces(scene.order).reads(scene.casters);
    if (hasNormals) pass.samples(normals);
    pass.writes(task.visibility, visibilityIn(*task.view, task.layer, pixels))
        .area({area.offset.x, area.offset.y, area.extent.width, area.extent.height})
        .record([=](PassContext& gpu) {
            if (pixels.extent.width == 0) return;
            gpu.vk->vkCmdSetScissor(gpu.cmd, 0, 1, &pixels);
            gpu.bind(pipeline, {gpu.constants(0, *block), gpu.sampled(2, depth), gpu.sampled(3, normals),
                                gpu.structure(4, scene.topLevel), gpu.storage(5, scene.casters)});
            gpu.drawFullscreen();
        });
}

} // namespace

constinit const AlgorithmEntry kRayQuery{
    .name = "ray_query",
    .source = "Appel 1968; VK_KHR_ray_query",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT |
              GN_TRAIT_EXACT_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_DEVICE_RAYS_BIT,
    .roundTrips = 0,
    .maxRounds = 0,
    .settings = {},
    .memoryPerLight = [](std::span<const double>, VkExtent2D, GnLightType) { return VkDeviceSize{0}; },
    .missing = [](const DeviceTable& vk) { return vk.rayQueryMissing; },
    .create = makeAlgorithm<RayQuery>,
};

} // namespace gnomon
