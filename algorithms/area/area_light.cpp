// A light with a surface as the mean of many lights without: a depth map for each of n x n points of it.
//
// Source:    Heckbert and Herf 1997, "Simulating soft shadows with graphics hardware"; Macedo 2018, 6.1 (uniform).
// Reads:     caster geometry, receiver depth and normals.    Writes: visibility.
// Strong at: right penumbrae of any width, of several casters too; rectangles as they are.
// Weak at:   price: every point takes a map, whatever of the picture is penumbra.
#include "algorithms/entries.hpp"

#include <algorithm>

#include "algorithms/area/area_maps.hpp"
#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "algorithms/shared/source_points.hpp"
#include "algorithms/shared/source_size.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "shaders/area_area_light_frag.h"
#include "shaders/area_area_light_part_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kSide };

constexpr std::uint32_t kMostSide = 17; // Macedo 2018, 6.3: 289 points

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of every point's map.", 64, 8192, 512, true},
    {"side", "Points of the light's surface: as many a row, in as many rows.", 2, kMostSide, 5},
};

constexpr VkFormat kSumFormat = VK_FORMAT_R16_SFLOAT; // every device blends it; whole numbers to 2048
constexpr std::uint32_t kMostTexels = 1u << 23;       // in maps at once: 32 MiB

/// Maps that there are at once.
std::uint32_t layersOf(std::uint32_t resolution, std::uint32_t points)
{
    return std::min({points, std::max(kMostTexels / (resolution * resolution), 1u), gpu::MAX_AREA_MAPS});
}

/// A row of points. One: the light has no surface.
std::uint32_t sideOf(const ShadowTask& task)
{
    return task.light->constants.sourceRadius > 0.0f ? static_cast<std::uint32_t>(task.settings[kSide]) : 1;
}

/// The maps of a task. Where all fit at once they are kept for as long as light and casters stand still, and cover all
/// casters; others cover what the view sees.
struct PointMaps {
    ImageId image;
    std::uint32_t layers = 0, resolution = 0, variant = 0;
    bool kept = false; ///< All of them stay, for all views.
    bool due = true;   ///< To be drawn in this frame.
};

PointMaps makeMaps(PassBuilder& passes, const ShadowTask& task)
{
    PointMaps maps;
    const std::uint32_t side = sideOf(task), points = side * side;
    maps.resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
    maps.layers = layersOf(maps.resolution, points);
    maps.kept = maps.layers == points;
    maps.variant = side << 14 | maps.resolution;
    const ImageInfo info{.name = "area_light.maps",
                         .scope = maps.kept ? Scope::light : Scope::task,
                         .format = kMapFormat,
                         .extent = {maps.resolution, maps.resolution},
                         .layers = maps.layers,
                         .variant = maps.variant};
    maps.image = maps.kept ? passes.persistent(info) : passes.transient(info);
    if (!maps.kept) return maps;
    const std::uint64_t stamp =
        Stamp().add(task.light->revision).add(task.casters->statics).add(task.casters->dynamics).value();
    maps.due = passes.stale(maps.image, stamp);
    if (!maps.due) passes.kept(points);
    return maps;
}

class AreaLight final : public ShadowAlgorithm {
public:
    explicit AreaLight(const AlgorithmServices& services)
        : casters_(makeDepthMapPipelines(services)),
          sum_(makePointLookups(services, "area_light.sum", k_area_area_light_part_frag, kSumFormat, false, true)),
          resolve_(makePointLookups(services, "area_light.resolve", k_area_area_light_frag, VK_FORMAT_R8_UNORM, true))
    {
    }
    void declare(PassBuilder& passes, const ShadowTask& task) override;
    const char* refuses(const ShadowTask& task) const override { return refusesDisc(*task.light); }

private:
    void addUp(PassBuilder& passes, const ShadowTask& task, const PointMaps& maps, ImageId sums, std::uint32_t first,
               const gpu::AreaConstants* constants) const;
    void finish(PassBuilder& passes, const ShadowTask& task, const PointMaps& maps, ImageId sums,
                const gpu::AreaConstants* constants) const;

    DepthMapPipelines casters_;
    PointLookups sum_, resolve_;
};

void AreaLight::addUp(PassBuilder& passes, const ShadowTask& task, const PointMaps& maps, ImageId sums,
                      std::uint32_t first, const gpu::AreaConstants* constants) const
{
    const LookupImages look(task, maps.image);
    const VkRect2D pixels = lightPixels(*task.light, *task.view);
    PassRef pass = passes.raster("area_light.sum", Scope::task, first);
    look.uses(pass);
    pass.writes(sums, {.clear = first == 0, .blend = true}).area(drawnArea(*task.view));
    pass.record([=, pipeline = sum_.of[look.hasNormals]](PassContext& gpu) {
        if (!gpu.clipTo(pixels)) return;
        gpu.bind(pipeline, {gpu.constants(0, *constants), gpu.sampled(2, look.depth), gpu.sampled(3, look.normals),
                            gpu.sampled(4, look.map, SamplerKind::nearestBorderFar)});
        gpu.drawFullscreen();
    });
}

void AreaLight::finish(PassBuilder& passes, const ShadowTask& task, const PointMaps& maps, ImageId sums,
                       const gpu::AreaConstants* constants) const
{
    const LookupImages look(task, maps.image);
    LookupPass pass(passes, task, "area_light.resolve", look);
    if (sums) pass.uses.samples(sums);
    const ImageId read = sums ? sums : task.depth; // constants->continues
    pass.record([=, pipeline = resolve_.of[look.hasNormals]](PassContext& gpu) {
        gpu.bind(pipeline, {gpu.constants(0, *constants), gpu.sampled(2, look.depth), gpu.sampled(3, look.normals),
                            gpu.sampled(4, look.map, SamplerKind::nearestBorderFar), gpu.sampled(5, read)});
    });
}

void AreaLight::declare(PassBuilder& passes, const ShadowTask& task)
{
    const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
    const gpu::MapConstants centre = centreConstants(task, resolution);
    FrameArena& arena = passes.arena();
    const PointMaps maps = makeMaps(passes, task);
    const std::uint32_t points = sideOf(task) * sideOf(task);
    const float nearest = nearestCaster(task);
    ImageId sums;
    if (maps.layers < points)
        sums = passes.transient(
            ImageInfo{.name = "area_light.sums", .format = kSumFormat, .extent = passes.extent(task.depth)});
    for (std::uint32_t first = 0; first < points; first += maps.layers) {
        auto* constants = arena.make(gpu::AreaConstants{});
        constants->base = centre;
        constants->count = std::min(maps.layers, points - first);
        constants->share = 1.0f / static_cast<float>(points);
        constants->continues = first > 0;
        for (std::uint32_t i = 0; i < constants->count; ++i) {
            ShadowTask point = task;
            const SourcePoint place = spreadOver(*task.light, first + i, sideOf(task));
            if (points > 1) point.light = arena.make(lightAt(*task.light, place, nearest));
            constants->points[i] = declarePointMap(passes, casters_, point,
                                                   {.name = "area_light.casters",
                                                    .image = maps.image,
                                                    .resolution = resolution,
                                                    .layer = i,
                                                    .scope = maps.kept ? Scope::light : Scope::task,
                                                    .variant = (first + i) << 19 | maps.variant,
                                                    .seen = !maps.kept,
                                                    .due = maps.due});
        }
        if (first + constants->count < points)
            addUp(passes, task, maps, sums, first, constants);
        else
            finish(passes, task, maps, sums, constants);
    }
}

VkDeviceSize memoryPerLight(std::span<const double> settings, VkExtent2D extent, GnLightType)
{
    const auto resolution = static_cast<std::uint32_t>(settings[kResolution]);
    const auto side = static_cast<std::uint32_t>(settings[kSide]);
    const std::uint32_t points = side * side, layers = layersOf(resolution, points);
    return VkDeviceSize{4} * resolution * resolution * layers + (layers < points ? storedImageSize(extent, 2) : 0);
}

} // namespace

constinit const AlgorithmEntry kAreaLight{
    .name = "area_light",
    .source = "Heckbert and Herf 1997; Macedo 2018, 6.1",
    .traits = kAreaTraits,
    .settings = kSettings,
    .memoryPerLight = memoryPerLight,
    .create = makeAlgorithm<AreaLight>,
    .typicalWrongPercent = kAreaWrongPercent,
};

} // namespace gnomon
