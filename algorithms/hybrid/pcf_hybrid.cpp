#include "algorithms/hybrid/pcf_hybrid.hpp"

#include <algorithm>

#include "algorithms/hybrid/pixel_list.hpp"
#include "algorithms/hybrid/receivers.hpp"
#include "algorithms/maps/map_resolve.hpp"
#include "algorithms/omni/light_map.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "shaders/hybrid/pcf_hybrid.h"
#include "shaders/hybrid_pcf_hybrid_cube_frag.h"
#include "shaders/hybrid_pcf_hybrid_frag.h"
#include "shaders/hybrid_points_vert.h"
#include "shaders/maps_map_resolve_vert.h"
#include "shaders/shared_umbra_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map, or of each of a point light's six.", 64, 8192, 1024},
};

struct Pipelines {
    DepthMapPipelines casters;
    PipelineId classify[2][2]; ///< [cube][has normals]
    PipelineId points;
};

PipelineId classifyPipeline(const AlgorithmServices& services, bool cube, bool normals)
{
    BindingInfo bindings[5];
    std::ranges::copy(lookBindings(cube), bindings);
    bindings[4] = {.binding = 5, .kind = BindingKind::storageBuffer};
    GraphicsPipelineInfo pipeline;
    pipeline.name = "pcf_hybrid.classify";
    pipeline.vertex.code = k_maps_map_resolve_vert;
    pipeline.fragment.code = cube ? std::span<const std::uint32_t>(k_hybrid_pcf_hybrid_cube_frag)
                                  : std::span<const std::uint32_t>(k_hybrid_pcf_hybrid_frag);
    pipeline.fragment.specializationCount = 1;
    pipeline.fragment.specialization[0] = normals;
    pipeline.bindings = bindings;
    pipeline.colorFormat = VK_FORMAT_R8_UNORM;
    return services.pipelines->graphics(pipeline);
}

PipelineId pointsPipeline(const AlgorithmServices& services)
{
    const BindingInfo bindings[] = {{.binding = 5, .kind = BindingKind::storageBuffer}};
    GraphicsPipelineInfo pipeline;
    pipeline.name = "pcf_hybrid.umbra";
    pipeline.vertex.code = k_hybrid_points_vert;
    pipeline.fragment.code = k_shared_umbra_frag;
    pipeline.bindings = bindings;
    pipeline.pushBytes = sizeof(glm::vec4);
    pipeline.topology = VK_PRIMITIVE_TOPOLOGY_POINT_LIST;
    pipeline.colorFormat = VK_FORMAT_R8_UNORM;
    return services.pipelines->graphics(pipeline);
}

/// Everything the host pass needs; copied into the frame.
struct TraceJob {
    const CameraView* view;
    const LightView* light;
    BufferId depth, normals;
    BufferId uncertain; ///< Count, then pixels.
    BufferId umbra;     ///< Pixels whose ray was blocked.
    std::uint32_t capacity;
    std::uint32_t* umbraCount; ///< Of this frame; read when the points are drawn.
};

/// Traces the pixels of a part of the list; blocked[i] answers pixels[i].
void traceList(const TraceJob& job, const HostContext& host, const Receivers& receivers,
               std::span<const std::uint32_t> pixels, std::span<std::uint8_t> blocked)
{
    RayBatch<256> batch; // the width of RayScene's sparse packets
    const auto answer = [&](std::uint32_t i, bool occluded) { blocked[i] = occluded; };
    for (std::uint32_t i = 0; i < pixels.size(); ++i) {
        const Asked asked = receivers.at(gpu::pixelX(pixels[i]), gpu::pixelY(pixels[i]), batch.rays[batch.count]);
        blocked[i] = asked == Asked::dark; // CPU and GPU may round n.l to different sides of zero
        if (asked != Asked::ray) continue;
        batch.tags[batch.count++] = i;
        if (batch.full()) batch.flush(host, job.light->mask, RayCoherence::sparse, answer);
    }
    batch.flush(host, job.light->mask, RayCoherence::sparse, answer);
}

void trace(const TraceJob& job, const HostContext& host)
{
    const std::span<const std::uint32_t> list = host.read<std::uint32_t>(job.uncertain);
    const std::uint32_t count = std::min(list[0], job.capacity);
    const std::span<const std::uint32_t> pixels = inTileOrder(list.subspan(1, count), job.view->extent, *host.arena);
    const std::span<std::uint8_t> blocked = host.arena->array<std::uint8_t>(count);
    const Receivers receivers(*job.view, *job.light, host.read<float>(job.depth),
                              job.normals ? host.read<std::byte>(job.normals) : std::span<const std::byte>());
    host.jobs->parallelFor(count, 2048, [&](std::size_t begin, std::size_t end, std::uint32_t) {
        traceList(job, host, receivers, pixels.subspan(begin, end - begin), blocked.subspan(begin, end - begin));
    });

    const std::span<std::uint32_t> umbra = host.write<std::uint32_t>(job.umbra);
    std::uint32_t written = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (blocked[i]) umbra[written++] = pixels[i];
    }
    *job.umbraCount = written;
}

glm::vec4 areaOf(const CameraView& view)
{
    return {static_cast<float>(view.area.offset.x), static_cast<float>(view.area.offset.y),
            static_cast<float>(view.area.extent.width), static_cast<float>(view.area.extent.height)};
}

class PcfHybrid final : public ShadowAlgorithm {
public:
    explicit PcfHybrid(const AlgorithmServices& services)
    {
        pipelines_.casters = makeDepthMapPipelines(services);
        for (const bool cube : {false, true}) {
            for (const bool normals : {false, true})
                pipelines_.classify[cube][normals] = classifyPipeline(services, cube, normals);
        }
        pipelines_.points = pointsPipeline(services);
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const VkExtent2D extent = task.view->area.extent;
        const auto pixels = extent.width * extent.height;
        gpu::HybridConstants* constants = passes.arena().make<gpu::HybridConstants>();
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        constants->base = mapConstants(task, resolution, 1);
        const ImageId map = declareLightMap(passes, pipelines_.casters, task, resolution, constants->base).image;
        constants->capacity = pixels;

        const TraceJob job{
            .view = task.view,
            .light = task.light,
            .depth = passes.depthOnHost(),
            .normals = passes.normalsOnHost(),
            .uncertain = passes.transient(BufferInfo{.name = "pcf_hybrid.uncertain",
                                                     .size = sizeof(std::uint32_t) * (VkDeviceSize(pixels) + 1),
                                                     .place = BufferPlace::readback}),
            .umbra = passes.transient(BufferInfo{.name = "pcf_hybrid.umbra",
                                                 .size = sizeof(std::uint32_t) * VkDeviceSize(pixels),
                                                 .place = BufferPlace::upload}),
            .capacity = pixels,
            .umbraCount = passes.arena().make<std::uint32_t>(),
        };
        declareClassify(passes, task, map, constants, job);
        PassRef host = passes.host("pcf_hybrid.trace");
        host.reads(job.uncertain).reads(job.depth).writes(job.umbra);
        if (job.normals) host.reads(job.normals);
        host.run([job](HostContext& context) { trace(job, context); });
        declareUmbra(passes, task, job);
    }

private:
    void declareClassify(PassBuilder& passes, const ShadowTask& task, ImageId map,
                         const gpu::HybridConstants* constants, const TraceJob& job) const
    {
        const BufferId list = job.uncertain;
        passes.transfer("pcf_hybrid.clear").writes(list).record([=](PassContext& gpu) {
            gpu.vk->vkCmdFillBuffer(gpu.cmd, gpu.buffer(list), 0, sizeof(std::uint32_t), 0);
        });
        const LookImages look(task, map);
        const PipelineId pipeline = pipelines_.classify[task.light->type == GN_LIGHT_TYPE_POINT][look.hasNormals];
        const VkRect2D& area = task.view->area;
        PassRef pass = passes.raster("pcf_hybrid.classify");
        pass.updates(list);
        look.uses(pass);
        const VkRect2D pixels = lightPixels(*task.light, *task.view);
        pass.writes(task.visibility, visibilityIn(task, pixels))
            .area({area.offset.x, area.offset.y, area.extent.width, area.extent.height})
            .record([=](PassContext& gpu) {
                if (pixels.extent.width == 0) return;
                gpu.vk->vkCmdSetScissor(gpu.cmd, 0, 1, &pixels);
                gpu.bind(pipeline,
                         {gpu.constants(0, *constants), gpu.sampled(2, look.depth), gpu.sampled(3, look.normals),
                          gpu.sampled(4, look.map, SamplerKind::nearestBorderFar), gpu.storage(5, list)});
                gpu.drawFullscreen();
            });
    }

    void declareUmbra(PassBuilder& passes, const ShadowTask& task, const TraceJob& job) const
    {
        const VkRect2D& area = task.view->area;
        passes.raster("pcf_hybrid.umbra")
            .reads(job.umbra)
            .writes(task.visibility, {.layer = task.layer, .blend = true})
            .area({area.offset.x, area.offset.y, area.extent.width, area.extent.height})
            .record([umbra = job.umbra, count = job.umbraCount, pipeline = pipelines_.points,
                     rect = areaOf(*task.view)](PassContext& gpu) {
                if (*count == 0) return;
                gpu.bind(pipeline, {gpu.storage(5, umbra)});
                gpu.push(rect);
                gpu.vk->vkCmdDraw(gpu.cmd, *count, 1, 0, 0);
            });
    }

    Pipelines pipelines_;
};

} // namespace

constinit const AlgorithmEntry kPcfHybrid{
    .name = "pcf_hybrid",
    .source = "Beister, Ernst and Stamminger 2005; Morais 2015, 3.4.1",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT |
              GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_RAYS_BIT,
    .roundTrips = 1,
    .maxRounds = 0,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D extent) {
            const VkDeviceSize lists = 2 * sizeof(std::uint32_t) * VkDeviceSize(extent.width) * extent.height;
            // As many layers as a point light may need; the two other kinds need one.
            return depthMapMemory(static_cast<std::uint32_t>(settings[kResolution]), 6) + lists;
        },
    .missing = [](const DeviceTable& vk) -> const char* {
        return vk.enabled.fragmentStoresAndAtomics ? nullptr : "needs fragmentStoresAndAtomics";
    },
    .create = [](const AlgorithmServices& services) -> std::unique_ptr<ShadowAlgorithm> {
        return std::make_unique<PcfHybrid>(services);
    },
    .typicalWrongPercent = 0.032f, // README.md, table of methods
};

} // namespace gnomon
