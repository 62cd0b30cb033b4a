#include "algorithms/omni/dual_paraboloid.hpp"

#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "algorithms/omni/cut_casters.hpp"
#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/frusta.hpp"
#include "algorithms/shared/kept_map.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "runtime/scene/bias.hpp"
#include "shaders/omni_dual_paraboloid_frag.h"
#include "shaders/omni_paraboloid_vert.h"
#include "shaders/omni_paraboloid_world_vert.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kFilter, kPlaneCulling };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of each of the two halves.", 64, 4096, 1024, true},
    {"filter", "Texels per side of the box that is averaged: 1 (nearest), 3, 5 or 7.", 1, gpu::MAX_FILTER_SIDE, 1},
    {"plane_culling", "1: a half space that no visible receiver lies in is not drawn; 0: both always are.", 0, 1, 1},
};

constexpr LayerNames kHalfNames[2] = {
    {"dual_paraboloid.casters.lower", "dual_paraboloid.statics.lower", "dual_paraboloid.copy_statics.lower"},
    {"dual_paraboloid.casters.upper", "dual_paraboloid.statics.upper", "dual_paraboloid.copy_statics.upper"},
};

// The disc leaves this many texels of the square to receivers just past the rim and to 8 x 8 filters around them.
constexpr float kBorderTexels = 5.0f;

struct Pipelines {
    PipelineId objects; ///< Meshes through the table of transforms.
    PipelineId cut;     ///< World-space triangles.
};

struct Push {
    glm::vec4 lightWs; ///< w: 1 / distance of depth 1
    float discRadius;
    std::uint32_t hemi;
};

/// Records one half's casters; what KeptMap::update takes.
struct HalfDraw {
    Pipelines pipelines;
    Push push;
    CutCasters cut[2];                      ///< Moving, static.
    std::span<const Caster* const> fine[2]; ///< Moving, static.

    void uses(PassRef& pass) const
    {
        for (const CutCasters& group : cut)
            if (group.indices) pass.vertices(group.vertices).indices(group.indices);
    }

    void operator()(PassContext& gpu, std::span<const Caster* const>, bool statics) const
    {
        if (!fine[statics].empty())
            gpu.drawCasters(
                {.pipeline = pipelines.objects, .casters = fine[statics], .push = &push, .pushSize = sizeof(push)});
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

Pipelines makePipelines(const AlgorithmServices& services)
{
    GraphicsPipelineInfo objects = casterPipeline("dual_paraboloid.casters", k_omni_paraboloid_vert);
    objects.transforms = true;
    return {services.pipelines->graphics(objects),
            services.pipelines->graphics(casterPipeline("dual_paraboloid.cut", k_omni_paraboloid_world_vert))};
}

/// Whether any of the box appears on a half's disc or its border: at most asin(`past`) past the dividing plane.
bool inHalf(const Aabb& box, glm::vec3 light, std::uint32_t hemi, float past)
{
    const float beyond = hemi == 0 ? light.y - box.lower.y : box.upper.y - light.y;
    if (beyond >= 0.0f) return true;
    const glm::vec3 farthest = glm::max(glm::abs(box.lower - light), glm::abs(box.upper - light));
    return -beyond <= past * glm::length(farthest);
}

/// Without those that the host draws, which cannot be in the map: most are other casters in every frame.
std::span<const Caster* const> castersInHalf(std::span<const Caster* const> casters, glm::vec3 light,
                                             std::uint32_t hemi, float past, FrameArena& arena)
{
    const std::span<const Caster*> kept = arena.array<const Caster*>(casters.size());
    std::size_t count = 0;
    for (const Caster* caster : casters)
        if (!caster->hostDrawn && inHalf(caster->bounds, light, hemi, past)) kept[count++] = caster;
    return kept.first(count);
}

/// Bit h: a receiver in the task's view can lie in half h, or both are asked for.
std::uint32_t neededHalves(const ShadowTask& task)
{
    if (task.settings[kPlaneCulling] == 0.0) return 3;
    const Frustum visible = frustumOf(*task.view, *task.light);
    std::uint32_t needed = 0;
    for (std::uint32_t hemi = 0; hemi < 2; ++hemi) {
        const glm::vec3 inward(0.0f, hemi == 0 ? -1.0f : 1.0f, 0.0f);
        if (touches(visible, Plane{inward, -glm::dot(inward, task.light->position())})) needed |= 1u << hemi;
    }
    return needed;
}

class DualParaboloid final : public ShadowAlgorithm {
public:
    explicit DualParaboloid(const AlgorithmServices& services)
        : pipelines_(makePipelines(services)),
          resolve_(services,
                   {.name = "dual_paraboloid.resolve", .fragment = k_omni_dual_paraboloid_frag, .layers = true})
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const std::uint32_t resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const float farWs = casterReach(*task.light, sceneBounds(*task.casters));
        const float discRadius = 1.0f - 2.0f * kBorderTexels / static_cast<float>(resolution);
        const std::uint32_t needed = neededHalves(task);
        const ImageId map = declareHalves(passes, task, needed, resolution, farWs, discRadius);

        gpu::MapConstants constants = mapConstants(task, resolution, filterSide(task.settings[kFilter]));
        constants.map.slope = 0.5f * discRadius * static_cast<float>(resolution);
        constants.map.farWs = farWs;
        resolve_.declare(passes, task, map, constants);
        map_ = {.image = map, .clipFromWorld = {}, .validLayers = needed};
        for (glm::mat4& matrix : map_.clipFromWorld)
            matrix = glm::mat4(0.0f);
    }

    const Map* lightMap() const override { return &map_; }

private:
    ImageId declareHalves(PassBuilder& passes, const ShadowTask& task, std::uint32_t needed, std::uint32_t resolution,
                          float farWs, float discRadius)
    {
        FrameArena& arena = passes.arena();
        const LightView& light = *task.light;
        KeptMap map(passes, {.name = "dual_paraboloid.depth",
                             .staticsName = "dual_paraboloid.statics",
                             .stampName = "dual_paraboloid.stamp",
                             .format = kMapFormat,
                             .resolution = resolution,
                             .layers = 2});
        HalfDraw draw{.pipelines = pipelines_,
                      .push = {glm::vec4(light.position(), 1.0f / farWs), discRadius, 0},
                      .cut = {cutter_.declare(passes, light, task.casters->dynamics, 1, resolution),
                              cutter_.declare(passes, light, task.casters->statics, 0, resolution)},
                      .fine = {}};
        const float past = 1.0f - discRadius; // sine of the angle past the rim that the border shows, and more
        for (std::uint32_t hemi = 0; hemi < 2; ++hemi) {
            if ((needed >> hemi & 1) == 0) continue;
            const auto statics = castersInHalf(task.casters->statics, light.position(), hemi, past, arena);
            const auto dynamics = castersInHalf(task.casters->dynamics, light.position(), hemi, past, arena);
            draw.push.hemi = hemi;
            draw.fine[0] = fineOnes(dynamics, light, resolution, arena);
            draw.fine[1] = fineOnes(statics, light, resolution, arena);
            const std::uint64_t projection = Stamp().add(farWs).value();
            map.update(hemi, kHalfNames[hemi], layerContent(light, statics, dynamics, projection), draw);
        }
        return map.image();
    }

    std::span<const Caster* const> fineOnes(std::span<const Caster* const> casters, const LightView& light,
                                            std::uint32_t resolution, FrameArena& arena)
    {
        const std::span<const Caster*> kept = arena.array<const Caster*>(casters.size());
        std::size_t count = 0;
        for (const Caster* caster : casters)
            if (cutter_.isFine(*caster, light, resolution)) kept[count++] = caster;
        return kept.first(count);
    }

    Pipelines pipelines_;
    MapResolve resolve_;
    CasterCutter cutter_;
    Map map_;
};

} // namespace

constinit const AlgorithmEntry kDualParaboloid{
    .name = "dual_paraboloid",
    .source = "Brabec, Annen and Seidel 2002; Navratil 2015, 3.3.2",
    .traits = GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT | GN_TRAIT_CPU_GEOMETRY_BIT,
    .roundTrips = 0,
    .maxRounds = 0,
    .settings = kSettings,
    .memoryPerLight = [](std::span<const double> settings, VkExtent2D,
                         GnLightType) { return depthMapMemory(static_cast<std::uint32_t>(settings[kResolution]), 2); },
    .missing = nullptr,
    .create = makeAlgorithm<DualParaboloid>,
    .typicalWrongPercent = 0.64f, // docs/benchmarks-2026-11.md
};

} // namespace gnomon
