#include "algorithms/hybrid/eight_point_hybrid.hpp"

#include <algorithm>
#include <array>

#include "algorithms/hybrid/pixel_list.hpp"
#include "algorithms/hybrid/point_maps.hpp"
#include "algorithms/hybrid/ray_list.hpp"
#include "algorithms/hybrid/receivers.hpp"
#include "algorithms/hybrid/traced_pixels.hpp"
#include "algorithms/maps/map_resolve.hpp"
#include "shaders/hybrid_eight_point_hybrid_frag.h"
#include "shaders/maps_map_resolve_vert.h"

namespace gnomon {

namespace {

enum Setting { kResolution };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of each of the eight maps.", 64, 4096, 512},
};

constexpr RayListNames kNames = {.list = "eight_point_hybrid.uncertain",
                                 .clear = "eight_point_hybrid.clear",
                                 .trace = "eight_point_hybrid.trace",
                                 .umbra = "eight_point_hybrid.penumbra"};
constexpr TracedNames kHardNames{"eight_point_hybrid.visibility", "eight_point_hybrid.trace",
                                 "eight_point_hybrid.copy"};

PipelineId classifyPipeline(const AlgorithmServices& services, bool normals)
{
    BindingInfo bindings[5];
    std::ranges::copy(lookBindings(true), bindings);
    bindings[4] = RayLists::binding();
    GraphicsPipelineInfo pipeline;
    pipeline.name = "eight_point_hybrid.classify";
    pipeline.vertex.code = k_maps_map_resolve_vert;
    pipeline.fragment.code = k_hybrid_eight_point_hybrid_frag;
    pipeline.fragment.specializationCount = 1;
    pipeline.fragment.specialization[0] = normals;
    pipeline.bindings = bindings;
    pipeline.colorFormat = VK_FORMAT_R8_UNORM;
    return services.pipelines->graphics(pipeline);
}

/// One range of the list a shade: what is seen of the eight points. All eight: it shows as lit already.
using Shades = std::array<MarkRange, kLightPoints>;

/// Everything the host pass needs; copied into the frame.
struct PointsJob {
    const CameraView* view;
    const LightView* light;
    RayList list;
    Shades* shades; ///< Of this frame; read when the points are drawn.
};

/// Traces the pixels of a part of the list; seen[i] answers pixels[i].
void tracePoints(const PointsJob& job, const HostContext& host, const Receivers& receivers,
                 std::span<const std::uint32_t> pixels, std::span<std::uint8_t> seen)
{
    const PointDisc own(*job.light);
    const std::array points = lightPoints();
    RayBatch<256> batch; // 32 pixels
    const auto answer = [&](std::uint32_t i, bool occluded) {
        seen[i] = static_cast<std::uint8_t>(seen[i] - occluded);
    };
    for (std::uint32_t i = 0; i < pixels.size(); ++i) {
        ShadowRay centre;
        const Asked asked = receivers.at(gpu::pixelX(pixels[i]), gpu::pixelY(pixels[i]), centre);
        seen[i] = asked == Asked::dark ? 0 : kLightPoints; // CPU and GPU may round n.l to different sides of zero
        if (asked != Asked::ray) continue;
        const LightDisc disc(centre.direction, own.across, own.radius);
        for (const glm::vec2 point : points) {
            batch.rays[batch.count] = disc.ray(centre, point);
            batch.tags[batch.count++] = i;
        }
        if (batch.full()) batch.flush(host, job.light->mask, RayCoherence::tiles, answer);
    }
    batch.flush(host, job.light->mask, RayCoherence::tiles, answer);
}

/// Puts the pixels into the list shade by shade.
void sortByShade(std::span<const std::uint32_t> pixels, std::span<const std::uint8_t> seen,
                 std::span<std::uint32_t> list, Shades& shades)
{
    for (std::uint32_t shade = 0; shade < kLightPoints; ++shade)
        shades[shade].value = static_cast<float>(shade) / static_cast<float>(kLightPoints);
    for (const std::uint8_t points : seen)
        if (points < kLightPoints) ++shades[points].count;
    std::array<std::uint32_t, kLightPoints> next{};
    for (std::uint32_t shade = 1; shade < kLightPoints; ++shade)
        next[shade] = shades[shade].first = shades[shade - 1].first + shades[shade - 1].count;
    for (std::size_t i = 0; i < pixels.size(); ++i)
        if (seen[i] < kLightPoints) list[next[seen[i]]++] = pixels[i];
}

void trace(const PointsJob& job, const HostContext& host)
{
    const std::span<const std::uint32_t> list = host.read<std::uint32_t>(job.list.pixels);
    const std::uint32_t count = std::min(list[0], job.list.capacity);
    const std::span<const std::uint32_t> pixels = inTileOrder(list.subspan(1, count), job.view->extent, *host.arena);
    const std::span<std::uint8_t> seen = host.arena->array<std::uint8_t>(count);
    const Receivers receivers(*job.view, *job.light, host.read<float>(job.list.depth),
                              job.list.normals ? host.read<std::byte>(job.list.normals) : std::span<const std::byte>());
    host.jobs->parallelFor(count, 512, [&](std::size_t begin, std::size_t end, std::uint32_t) {
        tracePoints(job, host, receivers, pixels.subspan(begin, end - begin), seen.subspan(begin, end - begin));
    });
    sortByShade(pixels, seen, host.write<std::uint32_t>(job.list.umbra), *job.shades);
}

class EightPointHybrid final : public ShadowAlgorithm {
public:
    explicit EightPointHybrid(const AlgorithmServices& services)
        : casters_(makeDepthMapPipelines(services)), lists_(services, kNames), marks_(services, kNames.umbra)
    {
        for (const bool normals : {false, true})
            classify_[normals] = classifyPipeline(services, normals);
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        if (task.light->constants.sourceRadius <= 0.0f) { // eight times the same point: ray_traced
            declareTracedPixels(passes, task, kHardNames);
            return;
        }
        gpu::EightPointConstants* constants = passes.arena().make<gpu::EightPointConstants>();
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const ImageId map = declarePointMaps(passes, casters_, task, resolution,
                                             std::span<gpu::MapLook, kLightPoints>(constants->points));
        constants->hybrid.base = mapConstants(task, resolution, 1);
        constants->hybrid.base.map.axisWs = constants->points[0].axisWs;
        const RayList list = lists_.open(passes, task, false);
        constants->hybrid.capacity = list.capacity;
        declareClassify(passes, task, map, constants, list.pixels);
        declareTrace(passes, task, list);
    }

    const char* refuses(const ShadowTask& task) const override { return refusesDisc(*task.light); }

private:
    void declareClassify(PassBuilder& passes, const ShadowTask& task, ImageId map,
                         const gpu::EightPointConstants* constants, BufferId list) const
    {
        const LookImages look(task, map);
        LookPass pass(passes, task, "eight_point_hybrid.classify", look);
        pass.uses.updates(list);
        pass.record([=, pipeline = classify_[look.hasNormals]](PassContext& gpu) {
            gpu.bind(pipeline, {gpu.constants(0, *constants), gpu.sampled(2, look.depth), gpu.sampled(3, look.normals),
                                gpu.sampled(4, look.map, SamplerKind::nearestBorderFar), gpu.storage(5, list)});
        });
    }

    void declareTrace(PassBuilder& passes, const ShadowTask& task, const RayList& list) const
    {
        Shades* shades = passes.arena().make<Shades>();
        const PointsJob job{.view = task.view, .light = task.light, .list = list, .shades = shades};
        PassRef host = passes.host(kNames.trace);
        host.reads(list.pixels).reads(list.depth).writes(list.umbra);
        if (list.normals) host.reads(list.normals);
        host.run([job](HostContext& context) { trace(job, context); });
        marks_.declare(passes, task, list.umbra, *shades);
    }

    DepthMapPipelines casters_;
    PipelineId classify_[2]; ///< [has normals]
    RayLists lists_;
    PointMarks marks_;
};

} // namespace

constinit const AlgorithmEntry kEightPointHybrid{
    .name = "eight_point_hybrid",
    .source = "Beister, Ernst and Stamminger 2005",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT |
              GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_RAYS_BIT,
    .roundTrips = 1,
    .maxRounds = 0,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D extent, GnLightType) {
            return depthMapMemory(static_cast<std::uint32_t>(settings[kResolution]), kLightPoints) +
                   RayLists::memory(extent);
        },
    .missing = [](const DeviceTable& vk) -> const char* {
        return vk.enabled.fragmentStoresAndAtomics ? nullptr : "needs fragmentStoresAndAtomics";
    },
    .create = [](const AlgorithmServices& services) -> std::unique_ptr<ShadowAlgorithm> {
        return std::make_unique<EightPointHybrid>(services);
    },
    .typicalWrongPercent = 0.0f, // ray_traced's: lights of shipped scenes have no radius
};

} // namespace gnomon
