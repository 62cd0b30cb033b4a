// Soft shadows of spherical lights: hard volumes counted from the light's centre, and a wedge under every
// silhouette edge in which a fragment shader integrates, in closed form, how much of the light's disc the edge
// covers or uncovers.
// Source:    Akenine-Moeller and Assarsson 2002; Assarsson and Akenine-Moeller 2003; Rautenbach 2008, 2.4.4.3.
// Reads:     topology and positions of the casters, receiver depth, geometric normals.     Writes: visibility.
// Strong at: penumbrae that follow light, caster and receiver, without noise and without a map; hard at contacts.
// Weak at:   casters that overlap (their coverage adds up); silhouettes as the light's centre sees them; fill.
#include "algorithms/entries.hpp"

#include "algorithms/volumes/volume_count.hpp"
#include "algorithms/volumes/wedge_draw.hpp"
#include "runtime/scene/light_pixels.hpp"

#include "shaders/volumes_resolve_vert.h"
#include "shaders/volumes_wedge_resolve_frag.h"

namespace gnomon {

namespace {

constexpr SettingSpec kSettings[] = {
    {"bounded", "1: volumes and wedges end behind the farthest visible receiver; 0: they go on to infinity", 0, 1, 1},
    {"z_fail", "0: z-pass for every caster that cannot shadow the near plane; 1: z-fail for all", 0, 1, 0},
};
enum Setting : std::size_t { kBounded, kZFail };

constexpr VolumeCountNames kNames{.volumes = {.zPass = "penumbra_wedges.z_pass", .zFail = "penumbra_wedges.z_fail"},
                                  .resolve = "penumbra_wedges.hard"};

PipelineId makeResolvePipeline(const AlgorithmServices& services)
{
    constexpr BindingInfo bindings[] = {
        constantsAt(0),
        sampledAt(1, VK_FORMAT_D32_SFLOAT),
        sampledAt(2, VK_FORMAT_R16G16B16A16_SFLOAT),
        {.binding = 3, .kind = BindingKind::sampledImage, .format = kStencilFormat, .stencil = true},
        sampledAt(4, kCoverageFormat)};
    return services.pipelines->graphics({.name = "penumbra_wedges.resolve",
                                         .vertex = {.code = k_volumes_resolve_vert},
                                         .fragment = {.code = k_volumes_wedge_resolve_frag},
                                         .bindings = bindings,
                                         .colorFormat = VK_FORMAT_R8_UNORM});
}

class PenumbraWedges final : public ShadowAlgorithm {
public:
    explicit PenumbraWedges(const AlgorithmServices& services)
        : vk_(*services.vk), count_(makeVolumeCountPipelines(services, kNames)),
          view_(makeViewStencilPipelines(services)), wedges_(makeWedgePipelines(services)),
          resolve_(makeResolvePipeline(services))
    {
    }
    void declare(PassBuilder& passes, const ShadowTask& task) override;
    const char* refuses(const ShadowTask& task) const override
    {
        const char* reason = refusesVolumes(vk_, task);
        return reason ? reason : refusesReadSides(vk_, task);
    }

private:
    const DeviceTable& vk_;
    VolumeCountPipelines count_;
    ViewStencilPipelines view_;
    WedgePipelines wedges_;
    PipelineId resolve_;
};

/// Counts only; what the counts mean is for the resolve pass to say.
void declareVolumes(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil, const VolumePlan& volumes,
                    const VolumePipelines& pipelines)
{
    StencilResolve* resolve = passes.arena().make<StencilResolve>();
    PassRef pass = declareStencilPass(passes, task, "penumbra_wedges.count", stencil, *resolve);
    usesVolumes(pass, volumes);
    pass.record([plan = &volumes, used = &pipelines](PassContext& gpu) {
        if (!gpu.clipTo(plan->pixels)) return;
        drawVolumes(gpu, *plan, *used);
    });
}

struct ResolveInputs {
    gpu::WedgeResolve constants{};
    ImageId depth, normals, stencil, coverage;
    VkRect2D pixels{};
};

void declareResolve(PassBuilder& passes, const ShadowTask& task, const ViewStencil& stencil, ImageId coverage,
                    PipelineId pipeline)
{
    ResolveInputs* inputs = passes.arena().make<ResolveInputs>();
    *inputs = {.constants = wedgeResolve(*task.view, *task.light),
               .depth = task.depth,
               .normals = task.normals ? task.normals : task.depth, // without normals the shader does not read them
               .stencil = stencil.image,
               .coverage = coverage,
               .pixels = lightPixels(*task.light, *task.view)};
    PassRef pass = passes.raster("penumbra_wedges.resolve");
    pass.area(drawnArea(*task.view))
        .writes(task.visibility, {.layer = task.layer, .blend = true}) // 1 outside of `pixels`, as the count left it
        .samples(task.depth)
        .samples(stencil.image)
        .samples(coverage);
    if (task.normals) pass.samples(task.normals);
    pass.record([=](PassContext& gpu) {
        if (!gpu.clipTo(inputs->pixels)) return;
        gpu.bind(pipeline, {gpu.constants(0, inputs->constants), gpu.sampled(1, inputs->depth, SamplerKind::nearest, 0),
                            gpu.sampled(2, inputs->normals, SamplerKind::nearest, 0), gpu.stencilOf(3, inputs->stencil),
                            gpu.sampled(4, inputs->coverage, SamplerKind::nearest, 0)});
        gpu.drawFullscreen();
    });
}

void PenumbraWedges::declare(PassBuilder& passes, const ShadowTask& task)
{
    const bool bounded = task.settings[kBounded] != 0.0, zFail = task.settings[kZFail] != 0.0;
    const ViewStencil stencil = declareViewStencil(passes, view_, task);
    const VolumeList sides[2] = {declareSides(passes, task, true), declareSides(passes, task, false)};
    const VolumePlan* volumes = planVolumes(passes, task, stencil, sides, bounded, zFail);
    if (task.light->constants.sourceRadius <= 0.0f) { // no penumbra: stencil_volume
        declareCount(passes, task, "penumbra_wedges.count", stencil, *volumes, count_);
        return;
    }
    declareVolumes(passes, task, stencil, *volumes, count_.volumes);
    const WedgePlan* wedges = planWedges(passes, task, stencil, sides, bounded);
    const ImageId coverage = declareWedges(passes, task, "penumbra_wedges.wedges", stencil, *wedges, wedges_);
    declareResolve(passes, task, stencil, coverage, resolve_);
}

VkDeviceSize memoryPerLight(std::span<const double>, VkExtent2D extent, GnLightType)
{
    return viewStencilMemory(extent) + storedImageSize(extent, 4); // coverage
}

} // namespace

const AlgorithmEntry kPenumbraWedges{
    .name = "penumbra_wedges",
    .source = "Assarsson and Akenine-Moeller 2003; Rautenbach 2008, 2.4.4.3",
    .traits = GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT |
              GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_TOPOLOGY_BIT,
    .settings = kSettings,
    .memoryPerLight = memoryPerLight,
    .missing = missingForWedges,
    .create = makeAlgorithm<PenumbraWedges>,
    .typicalWrongPercent = 0.004f, // stencil_volume's: lights of shipped scenes have no radius
};

} // namespace gnomon
