#include "algorithms/omni/paraboloid_maps.hpp"

#include <cstring>

#include "runtime/scene/bias.hpp"
#include "shaders/omni_paraboloid_frag.h"
#include "shaders/omni_paraboloid_vert.h"
#include "shaders/omni_paraboloid_world_vert.h"

namespace gnomon {

namespace {

struct Push {
    glm::vec4 lightWs; ///< w: 1 / distance of depth 1
    gpu::Paraboloid part;
};

GraphicsPipelineInfo casterPipeline(const char* name, std::span<const std::uint32_t> vertex)
{
    GraphicsPipelineInfo info;
    info.name = name;
    info.vertex.code = vertex;
    info.pushBytes = sizeof(Push);
    info.vertexStride = sizeof(glm::vec3);
    info.casters = true;
    info.depthTest = info.depthWrite = true;
    info.depthCompare = VK_COMPARE_OP_LESS;
    info.depthFormat = kMapFormat;
    return info;
}

std::uint64_t stampOf(const gpu::Paraboloid& part, float reach)
{
    Stamp stamp;
    for (const glm::vec4& row : {part.rightWs, part.downWs, part.axisWs, part.poleWs})
        for (int i = 0; i < 4; ++i)
            stamp.add(row[i]);
    return stamp.add(reach).value();
}

} // namespace

/// Records one part's casters; what KeptMap::update takes.
struct ParaboloidMaps::Draw {
    Pipelines pipelines;
    Push push;
    CutCasters cut[2];                      ///< Moving, static.
    std::span<const Caster* const> fine[2]; ///< Moving, static.
    std::span<const Plane> volume;

    void uses(PassRef& pass) const
    {
        for (const CutCasters& group : cut)
            if (group.indices) pass.vertices(group.vertices).indices(group.indices);
    }

    void operator()(PassContext& gpu, std::span<const Caster* const>, bool statics) const
    {
        if (!fine[statics].empty())
            gpu.drawCasters({.pipeline = pipelines.objects,
                             .casters = fine[statics],
                             .volume = volume,
                             .push = &push,
                             .pushSize = sizeof(push)});
        if (cut[statics].indices) drawCut(gpu, cut[statics]);
    }

    void drawCut(PassContext& gpu, const CutCasters& group) const
    {
        gpu.bind(pipelines.cut, {});
        gpu.push(push);
        const VkBuffer vertices = gpu.buffer(group.vertices);
        const VkDeviceSize zero = 0;
        gpu.vk->vkCmdBindVertexBuffers(gpu.cmd, 0, 1, &vertices, &zero);
        gpu.vk->vkCmdBindIndexBuffer(gpu.cmd, gpu.buffer(group.indices), 0, VK_INDEX_TYPE_UINT32);
        const std::uint32_t counts[2] = {group.closedIndices, group.openIndices};
        std::uint32_t first = 0;
        for (const bool open : {false, true}) {
            Caster like;
            like.closed = !open;
            const CasterRaster raster = casterRaster(like);
            gpu.vk->vkCmdSetCullMode(gpu.cmd, raster.cullMode);
            gpu.vk->vkCmdSetFrontFace(gpu.cmd, raster.frontFace);
            gpu.vk->vkCmdSetDepthBias(gpu.cmd, 0.0f, 0.0f, raster.slopeBias);
            if (counts[open]) gpu.vk->vkCmdDrawIndexed(gpu.cmd, counts[open], 1, first, 0, 0);
            first += counts[open];
        }
    }
};

ParaboloidMaps::Pipelines ParaboloidMaps::makePipelines(const AlgorithmServices& services)
{
    GraphicsPipelineInfo objects = casterPipeline("paraboloid.casters", k_omni_paraboloid_vert);
    objects.transforms = true;
    return {services.pipelines->graphics(objects),
            services.pipelines->graphics(casterPipeline("paraboloid.cut", k_omni_paraboloid_world_vert))};
}

ParaboloidMaps::ParaboloidMaps(const AlgorithmServices& services, const ParaboloidNames& names)
    : names_(names), pipelines_(makePipelines(services)),
      resolve_(services, {.name = names.resolve, .fragment = k_omni_paraboloid_frag, .layers = true}),
      contact_(services)
{
}

void ParaboloidMaps::declare(PassBuilder& passes, const ShadowTask& task)
{
    const auto resolution = static_cast<std::uint32_t>(task.settings[0]);
    const std::uint32_t side = filterSide(task.settings[1]);
    const MapCulling culling = mapCulling(task.settings[2]);
    const float reach = casterReach(*task.light, sceneBounds(*task.casters));
    const ParaboloidSet set = partsOf(task, resolution, reach, culling);
    const ImageId image = declareParts(passes, task, set, resolution, reach, culling);
    gpu::ParaboloidConstants constants{};
    constants.base = mapConstants(task, resolution, side);
    constants.base.map.farWs = reach;
    constants.parts[0] = set.parts[0];
    constants.parts[1] = set.parts[1];
    constants.firstWs = glm::vec4(set.firstWs, 0.0f);
    resolve_.declare(passes, task, image, constants, {.filtered = side > 1});
    contact_.declare(passes, task, task.settings.back());
    map_ = {.image = image,
            .clipFromWorld = {},
            .validLayers = set.needed,
            .sample = sampleOf(constants.base.map, gpu::SAMPLE_DISCS)};
    static_assert(sizeof(set.parts) == 8 * sizeof(glm::vec4));
    std::memcpy(map_.sample.parts, set.parts.data(), sizeof(set.parts));
    map_.sample.parts[8] = constants.firstWs;
    for (glm::mat4& matrix : map_.clipFromWorld)
        matrix = glm::mat4(0.0f);
}

ImageId ParaboloidMaps::declareParts(PassBuilder& passes, const ShadowTask& task, const ParaboloidSet& set,
                                     std::uint32_t resolution, float reach, MapCulling culling)
{
    FrameArena& arena = passes.arena();
    const LightView& light = *task.light;
    const bool ownMap = set.followsView || culling == MapCulling::shadows;
    KeptMap map(passes, {.name = names_.depth,
                         .staticsName = names_.statics,
                         .stampName = names_.stamp,
                         .format = kMapFormat,
                         .resolution = resolution,
                         .layers = 2,
                         .scope = ownMap ? Scope::task : Scope::light});
    Draw draw{.pipelines = pipelines_,
              .push = {glm::vec4(light.position(), 1.0f / reach), {}},
              .cut = {cutter_.declare(passes, light, task.casters->dynamics, 1, set.cutSide),
                      cutter_.declare(passes, light, task.casters->statics, 0, set.cutSide)},
              .fine = {},
              .volume = {}};
    const Frustum visible = frustumOf(*task.view, light);
    // A texel spans at most 4 / resolution radians; filters stay within the border.
    const float angle = 4.0f * kParaboloidBorderTexels / static_cast<float>(resolution);
    for (std::uint32_t part = 0; part < 2; ++part) {
        if ((set.needed >> part & 1) == 0) continue;
        if (culling != MapCulling::none) draw.volume = {arena.make(set.volumes[part])->data(), 4};
        // Without those that the host draws, which cannot be in the map: most are other casters in every frame.
        const auto drawn = [&](std::span<const Caster* const> casters) {
            return castersSeen(culling, visible, light.position(), angle, meshesIn(casters, draw.volume, arena), arena);
        };
        const auto statics = drawn(task.casters->statics), dynamics = drawn(task.casters->dynamics);
        draw.push.part = set.parts[part];
        draw.fine[0] = fineOnes(dynamics, light, set.cutSide, arena);
        draw.fine[1] = fineOnes(statics, light, set.cutSide, arena);
        map.update(part, names_.parts[part], layerContent(light, statics, dynamics, stampOf(set.parts[part], reach)),
                   draw);
    }
    return map.image();
}

std::span<const Caster* const> ParaboloidMaps::fineOnes(std::span<const Caster* const> casters, const LightView& light,
                                                        std::uint32_t cutSide, FrameArena& arena)
{
    const std::span<const Caster*> kept = arena.array<const Caster*>(casters.size());
    std::size_t count = 0;
    for (const Caster* caster : casters)
        if (cutter_.isFine(*caster, light, cutSide)) kept[count++] = caster;
    return kept.first(count);
}

VkDeviceSize ParaboloidMaps::memory(std::span<const double> settings, VkExtent2D, GnLightType)
{
    return depthMapMemory(static_cast<std::uint32_t>(settings[0]), 2);
}

} // namespace gnomon
