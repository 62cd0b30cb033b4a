#include "algorithms/shared/screen_penumbra.hpp"

#include <algorithm>
#include <array>

#include "algorithms/shared/disc_resolve.hpp"
#include "algorithms/shared/light_map.hpp"
#include "shaders/shared_fullscreen_vert.h"
#include "shaders/shared_map_resolve_vert.h"
#include "shaders/shared_screen_blur_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kSteps };

constexpr VkFormat kSeenFormat = VK_FORMAT_R16G16B16A16_SFLOAT;
constexpr VkFormat kOnceFormat = VK_FORMAT_R16_SFLOAT;
constexpr VkClearValue kNotAsked{.color = {.float32 = {1.0f - gpu::NOT_ASKED, 0.0f, 1.0f, 0.0f}}};

std::uint32_t sideOf(const ShadowTask& task)
{
    return static_cast<std::uint32_t>(task.settings[kResolution]);
}

} // namespace

ScreenPenumbra::ScreenPenumbra(const AlgorithmServices& services, const ScreenPenumbraInfo& info)
    : vk_(*services.vk), info_(info), casters_(makeDepthMapPipelines(services)), bounds_(services)
{
    std::array<BindingInfo, 5> bindings{};
    GraphicsPipelineInfo pipeline;
    for (std::uint32_t normals = 0; normals < 2; ++normals) {
        pipeline.fragment.specialization[0] = normals;
        pipeline.name = info.seen;
        pipeline.vertex.code = k_shared_map_resolve_vert;
        pipeline.fragment.specializationCount = 1;
        pipeline.colorFormat = kSeenFormat;
        pipeline.bindings = bindings;
        for (const bool cube : {false, true}) {
            std::ranges::copy(lookupBindings(cube), bindings.begin());
            bindings[4] = {.binding = 1, .kind = BindingKind::storageBuffer};
            pipeline.fragment.code = info.soft[cube];
            seen_[cube][normals] = services.pipelines->graphics(pipeline);
        }
        std::ranges::copy(lookupBindings(false), bindings.begin());
        bindings[3] = {.binding = 4, .kind = BindingKind::sampledImage, .format = kSeenFormat};
        bindings[4] = {.binding = 5, .kind = BindingKind::sampledImage, .format = kOnceFormat};
        pipeline.vertex.code = k_shared_fullscreen_vert;
        pipeline.fragment.code = k_shared_screen_blur_frag;
        pipeline.fragment.specializationCount = 2;
        for (const bool last : {false, true}) {
            pipeline.name = last ? info.columns : info.rows;
            pipeline.fragment.specialization[1] = last;
            pipeline.colorFormat = last ? VK_FORMAT_R8_UNORM : kOnceFormat;
            blur_[normals][last] = services.pipelines->graphics(pipeline);
        }
    }
}

void ScreenPenumbra::declare(PassBuilder& passes, const ShadowTask& task)
{
    if (isSoft(*task.light)) return declareSoft(passes, task);
    map_ = declareHard(passes, task);
}

void ScreenPenumbra::declareSoft(PassBuilder& passes, const ShadowTask& task)
{
    const std::uint32_t resolution = sideOf(task);
    const LightView& light = *task.light;
    const bool cube = light.type == GN_LIGHT_TYPE_POINT;
    gpu::ScreenPenumbraConstants& constants = *passes.arena().make<gpu::ScreenPenumbraConstants>();
    constants.base = mapConstants(task, resolution, 1);
    const LightMap map = declareLightMap(passes, casters_, task, resolution, constants.base, softBorder(resolution));
    map_ = handedOut(map.image, map.fits, map.needed, constants.base);
    constants.hard = info_.look;
    constants.disc = discCone(light, map.fits.front(), constants.base.map);
    constants.light = light.constants;
    constants.steps = static_cast<std::uint32_t>(task.settings[kSteps]);
    const BufferId bounds = bounds_.declare(passes, map, resolution);
    const ImageId seen =
        passes.transient(ImageInfo{.name = "screen_penumbra.seen", .format = kSeenFormat, .extent = task.view->extent});
    const LookupImages look(task, map.image);
    LookupPass pass(passes, task, info_.seen, look, seen, kNotAsked);
    pass.uses.reads(bounds);
    pass.record([=, pipeline = seen_[cube][look.hasNormals], block = &constants](PassContext& gpu) {
        gpu.bind(pipeline, {gpu.constants(0, *block), gpu.storage(1, bounds), gpu.sampled(2, look.depth),
                            gpu.sampled(3, look.normals), gpu.sampled(4, look.map, SamplerKind::nearestBorderFar)});
    });
    declareBlur(passes, task, seen, constants);
}

void ScreenPenumbra::declareBlur(PassBuilder& passes, const ShadowTask& task, ImageId seen,
                                 const gpu::ScreenPenumbraConstants& constants) const
{
    const ImageId once =
        passes.transient(ImageInfo{.name = "screen_penumbra.once", .format = kOnceFormat, .extent = task.view->extent});
    const LookupImages look(task, seen);
    const auto bindings = [=, this, block = &constants](LookupPass& pass, bool last) {
        const ImageId source = last ? once : seen;
        pass.record([=, pipeline = blur_[look.hasNormals][last]](PassContext& gpu) {
            gpu.bind(pipeline, {gpu.constants(0, *block), gpu.sampled(2, look.depth), gpu.sampled(3, look.normals),
                                gpu.sampled(4, seen), gpu.sampled(5, source)});
        });
    };
    LookupPass rows(passes, task, info_.rows, look, once, kNotAsked);
    bindings(rows, false);
    LookupPass columns(passes, task, info_.columns, look);
    columns.uses.samples(once);
    bindings(columns, true);
}

const char* ScreenPenumbra::refuses(const ShadowTask& task) const
{
    return refusesSearch(vk_, task, sideOf(task));
}

VkDeviceSize ScreenPenumbra::memory(std::span<const double> settings, VkExtent2D extent, GnLightType type)
{
    const auto resolution = static_cast<std::uint32_t>(settings[kResolution]);
    const std::uint32_t layers = mapLayers(type);
    return depthMapMemory(resolution, layers) + DepthBounds::memory(resolution, layers) + storedImageSize(extent, 8) +
           storedImageSize(extent, 2);
}

} // namespace gnomon
