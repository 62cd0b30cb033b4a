#include "algorithms/hybrid/conservative_layers.hpp"

#include <algorithm>

#include "algorithms/shared/light_map.hpp"
#include "shaders/hybrid_conservative_classify_cube_frag.h"
#include "shaders/hybrid_conservative_classify_frag.h"

namespace gnomon {

namespace {

struct LayerKind {
    const char *image, *statics, *stamp;
    LayerNames passes; ///< Of all faces of a point light.
    ConservativeLayer content;
};
constexpr LayerKind kKinds[2][2] = {
    {{"conservative.near",
      "conservative.near_statics",
      "conservative.near_stamp",
      {"conservative.near.casters", "conservative.near.statics", "conservative.near.copy_statics"},
      ConservativeLayer::nearest},
     {"conservative.covered",
      "conservative.covered_statics",
      "conservative.covered_stamp",
      {"conservative.covered.casters", "conservative.covered.statics", "conservative.covered.copy_statics"},
      ConservativeLayer::covered}},
    {{"conservative.thesis_near",
      "conservative.thesis_near_statics",
      "conservative.thesis_near_stamp",
      {"conservative.thesis_near.casters", "conservative.thesis_near.statics", "conservative.thesis_near.copy_statics"},
      ConservativeLayer::thesisNearest},
     {"conservative.thesis_covered",
      "conservative.thesis_covered_statics",
      "conservative.thesis_covered_stamp",
      {"conservative.thesis_covered.casters", "conservative.thesis_covered.statics",
       "conservative.thesis_covered.copy_statics"},
      ConservativeLayer::thesisCovered}},
};

} // namespace

// --- projections and content ---

ConservativeMapView conservativeView(const ShadowTask& task, std::uint32_t resolution, ThesisOffset offset,
                                     FrameArena& arena)
{
    // Depths before the near end are written as 0, whether the device can clamp or not.
    const std::span<const LightFit> fits = fitLightMap(Clamped::all, task, resolution, arena);
    const std::span<ConservativeProjection> projections = arena.array<ConservativeProjection>(fits.size());
    for (std::size_t i = 0; i < fits.size(); ++i) {
        projections[i] = conservativeProjection(fits[i], *task.light, resolution);
        projections[i].offset = offset;
    }
    return {.fits = fits,
            .projections = projections,
            .resolution = resolution,
            .needed = neededLayers(task),
            .offset = offset};
}

LayerContent conservativeContent(const ShadowTask& task, const ConservativeMapView& view, std::uint32_t layer,
                                 std::uint64_t salt, FrameArena& arena)
{
    const LightFit& fit = view.fits[layer];
    const std::uint64_t projection =
        Stamp().add(fit.clipFromWorld).add(salt).add(static_cast<std::uint64_t>(view.offset)).value();
    return layerContent(*task.light, meshesIn(task.casters->statics, fit.volume, arena),
                        meshesIn(task.casters->dynamics, fit.volume, arena), projection);
}

std::uint32_t formOf(const ConservativeMapView& view)
{
    return static_cast<std::uint32_t>(view.offset);
}

// --- layers ---

ConservativeMaps::ConservativeMaps(const AlgorithmServices& services)
{
    for (const int thesis : {0, 1})
        for (const int covered : {0, 1})
            layers_[thesis][covered] = makeConservativePipeline(services, kKinds[thesis][covered].passes.casters,
                                                                kKinds[thesis][covered].content);
}

ImageId ConservativeMaps::declareLayer(PassBuilder& passes, const ShadowTask& task, const ConservativeMapView& view,
                                       bool thesis, bool covered) const
{
    const LayerKind& kind = kKinds[thesis][covered];
    const auto layers = static_cast<std::uint32_t>(view.fits.size());
    KeptMap map(passes, {.name = kind.image,
                         .staticsName = kind.statics,
                         .stampName = kind.stamp,
                         .format = kMapFormat,
                         .resolution = view.resolution,
                         .layers = layers,
                         .form = formOf(view)});
    for (std::uint32_t layer = 0; layer < layers; ++layer) {
        if ((view.needed & (1u << layer)) == 0) continue;
        const ConservativeCasters casters(layers_[thesis][covered], kind.content, &view.projections[layer]);
        const LayerContent content = conservativeContent(task, view, layer, 0, passes.arena());
        map.update(layer, kind.passes, content, casters);
    }
    return map.image();
}

ImageId ConservativeMaps::declareNearest(PassBuilder& passes, const ShadowTask& task, const ConservativeMapView& view,
                                         bool thesis) const
{
    return declareLayer(passes, task, view, thesis, false);
}

ImageId ConservativeMaps::declareCovered(PassBuilder& passes, const ShadowTask& task, const ConservativeMapView& view,
                                         bool thesis) const
{
    return declareLayer(passes, task, view, thesis, true);
}

// --- the methods ---

namespace {

/// Of the under-estimated layer, beside the other's at binding 4.
constexpr BindingInfo kCovered[] = {mapAt(6, kMapFormat)};

gpu::ConservativeConstants constantsOf(const ShadowTask& task, const ConservativeMapView& view, bool thesis,
                                       bool reasons)
{
    gpu::ConservativeConstants constants{};
    gpu::MapConstants& base = constants.hybrid.base;
    base = mapConstants(task, view.resolution, 1);
    addLightProjection(base, view.fits, task);
    constants.hybrid.reasons = reasons;
    constants.light = task.light->constants;
    constants.thesis = thesis;
    addRounding(constants, view.projections.front(), task.casters->all);
    return constants;
}

} // namespace

ConservativeMethod::ConservativeMethod(const AlgorithmServices& services, const char* classify,
                                       const UndecidedNames& names)
    : vk_(*services.vk), maps_(services),
      classify_(services, {.name = classify, // UNDECIDED where the map cannot answer
                           .fragment = k_hybrid_conservative_classify_frag,
                           .cube = k_hybrid_conservative_classify_cube_frag,
                           .filters = false,
                           .more = kCovered,
                           .sampler = SamplerKind::nearest}),
      names_(names)
{
    if (vk_.prefersRays) onDevice_.emplace(services, names);
}

void ConservativeMethod::declare(PassBuilder& passes, const ShadowTask& task)
{
    const bool thesis = task.settings[kMode] != 0.0;
    const auto offset = static_cast<ThesisOffset>(static_cast<std::uint32_t>(task.settings[kLambda]));
    const ConservativeMapView view = conservativeView(task, static_cast<std::uint32_t>(task.settings[kResolution]),
                                                      thesis ? offset : ThesisOffset::halfDiagonal, passes.arena());
    const ImageId nearest = maps_.declareNearest(passes, task, view, thesis);
    const ImageId covered = declareCovered(passes, task, view, maps_, thesis);
    const bool reasons = task.settings[kReasons] != 0.0;
    // That only faces turned away from the light need be drawn holds for receivers outside of what is closed.
    Doubt insides;
    if (!thesis) {
        insides.byte = reasons ? static_cast<std::uint8_t>(gpu::REASON_MAP_LIT) : std::uint8_t{255};
        insides.where = nearClip(*task.view, task.casters->all);
    }
    classify_.declare(passes, task, nearest, constantsOf(task, view, thesis, reasons),
                      {.more = {{{.image = covered}}}});
    if (task.rays)
        onDevice_->declare(passes, task, reasons, insides);
    else
        declareUndecided(passes, task, names_, reasons ? traceReasons : traceHard, insides);
}

const char* ConservativeMethod::refuses(const ShadowTask& task) const
{
    const VkDeviceSize most = vk_.properties.limits.maxStorageBufferRange;
    for (const Caster* caster : task.casters->all) {
        if (!caster->mesh) continue;
        const std::uint32_t largest = std::max(caster->mesh->positionCount(), caster->mesh->triangleCount());
        if (VkDeviceSize{12} * largest > most) return "a caster's mesh is larger than a storage buffer";
    }
    return nullptr;
}

namespace {

/// Two layers, each as many images as the light needs.
VkDeviceSize layersMemory(std::span<const double> settings, GnLightType type)
{
    const double resolution = settings[ConservativeMethod::kResolution];
    return 2 * depthMapMemory(static_cast<std::uint32_t>(resolution), mapLayers(type));
}

} // namespace

VkDeviceSize ConservativeMethod::memory(std::span<const double> settings, VkExtent2D extent, GnLightType type)
{
    return layersMemory(settings, type) + undecidedMemory(extent);
}

VkDeviceSize ConservativeMethod::memoryWithDeviceRays(std::span<const double> settings, VkExtent2D extent,
                                                      GnLightType type)
{
    return layersMemory(settings, type) + UndecidedOnDevice::memory(extent);
}

} // namespace gnomon
