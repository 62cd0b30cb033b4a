#include "algorithms/hybrid/id_map.hpp"

#include <algorithm>

#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/shared/depth_casters.hpp"
#include "algorithms/shared/light_map.hpp"
#include "algorithms/shared/map_lookup.hpp"
#include "shaders/hybrid_id_map_frag.h"
#include "shaders/hybrid_id_map_vert.h"

namespace gnomon {

namespace {

constexpr VkFormat kNumberFormat = VK_FORMAT_R32_UINT;

/// Where one layer's casters are drawn.
struct Target {
    ImageId depth, numbers;
    std::uint32_t layer = 0; ///< Of depth; numbers have one.
    bool clearsDepth = true, clearsNumbers = true;
};

/// One map, while it is declared.
struct Declaring {
    PassBuilder& passes;
    const IdMapPipelines& pipelines;
    const ShadowTask& task;
    std::uint32_t resolution;

    std::uint32_t variant(std::uint32_t layer) const { return resolution * 8 + layer; }
    BufferId layerBuffer(const char* name, std::uint32_t layer) const
    {
        return passes.persistent(BufferInfo{.name = name,
                                            .scope = Scope::light,
                                            .size = VkDeviceSize{4} * resolution * resolution,
                                            .place = BufferPlace::readback,
                                            .variant = variant(layer)});
    }
    BufferId carrier(const char* name, std::uint32_t layer) const
    {
        return passes.persistent(BufferInfo{.name = name, .scope = Scope::light, .size = 4, .variant = variant(layer)});
    }
    ImageInfo staticDepths(const IdMap& map) const
    {
        return {.name = "contour_chain.static_depth",
                .scope = Scope::light,
                .format = kMapFormat,
                .extent = {resolution, resolution},
                .layers = static_cast<std::uint32_t>(map.fits.size()),
                .variant = resolution};
    }
    ImageInfo staticNumbers(std::uint32_t layer) const
    {
        return {.name = "contour_chain.static_numbers",
                .scope = Scope::light,
                .format = kNumberFormat,
                .extent = {resolution, resolution},
                .variant = variant(layer)};
    }
    Cells due(const IdMap& map, std::uint32_t layer, std::uint64_t stamp, const KeptParts& parts) const;
    void drawDepthOnly(const IdMap& map, std::uint32_t layer, std::span<const Caster* const> casters) const;
    void draw(const char* name, const LightFit& fit, const Target& target, std::span<const Caster* const> casters,
              Cells cells, BufferId firsts) const;
    void copyStatics(const IdMap& map, std::uint32_t layer, std::span<const Caster* const> statics, std::uint64_t stamp,
                     Cells cells, ImageId numbers, BufferId firsts) const;
    void copyToHost(std::uint32_t layer, ImageId from, std::uint32_t fromLayer, BufferId to, VkImageAspectFlags aspect,
                    Cells cells, const char* name) const;
};

/// The casters that the host draws come last of the two lists, the first of which is returned.
std::size_t splitHostDrawn(std::span<const Caster* const> casters, std::span<const Caster*> sorted)
{
    std::size_t own = 0, last = casters.size();
    for (const Caster* caster : casters)
        (caster->hostDrawn ? sorted[--last] : sorted[own++]) = caster;
    return own;
}

/// First, so that a texel in which they are nearest keeps naming no triangle.
void Declaring::drawDepthOnly(const IdMap& map, std::uint32_t layer, std::span<const Caster* const> casters) const
{
    const DepthCasters draw(pipelines.depth, map.fits[layer], task, resolution, passes.arena());
    passes.raster("contour_chain.host_casters", Scope::light, variant(layer))
        .depthWrite(map.depth, {.layer = layer, .clear = true, .value = {.depthStencil = {1.0f, 0}}})
        .record([=](PassContext& gpu) { draw(gpu, casters, false); });
}

/// The cells of which image and copies do not all hold what they are to hold; they are taken to hold it from now on.
Cells Declaring::due(const IdMap& map, std::uint32_t layer, std::uint64_t stamp, const KeptParts& parts) const
{
    Cells changed = 0;
    const auto ask = [&](BufferId buffer, std::uint64_t whole, const KeptParts& now) {
        if (!passes.stale(buffer, whole)) return;
        changed |= changedCells(passes.partsBefore(buffer), now);
        passes.keepParts(buffer, now);
    };
    ask(map.depths[layer], stamp, parts);
    ask(map.numbers[layer], stamp, parts);
    // The image's are kept beside it, and are of this very image.
    const BufferId image = carrier("contour_chain.stamp", layer);
    const std::uint64_t serial = passes.serial(map.depth);
    const std::uint64_t base = parts.base != 0 ? Stamp().add(parts.base).add(serial).value() : 0;
    ask(image, Stamp().add(stamp).add(serial).value(), {base, parts.covered});
    return changed;
}

/// @param cells what is drawn again, and what lies between
void Declaring::draw(const char* name, const LightFit& fit, const Target& target,
                     std::span<const Caster* const> casters, Cells cells, BufferId firsts) const
{
    const MapProjection projection = mapProjection(fit, *task.light);
    const DepthCasters::Push push = casterPush(projection);
    const auto [at, extent] = cellBounds(cells, resolution);
    VkClearValue none{};
    none.color.uint32[0] = kNoTriangle;
    passes.raster(name, Scope::light, variant(target.layer))
        .depthWrite(target.depth,
                    {.layer = target.layer, .clear = target.clearsDepth, .value = {.depthStencil = {1.0f, 0}}})
        .writes(target.numbers, {.clear = target.clearsNumbers, .value = none})
        .reads(firsts)
        .area({at.x, at.y, extent.width, extent.height})
        .record([=, pipeline = pipelines.casters, light = task.light, volume = std::span<const Plane>(fit.volume),
                 side = static_cast<float>(resolution)](PassContext& gpu) {
            if (casters.empty()) return;
            const float first = DepthCasters::fromOne(push) ? 1.0f : 0.0f;
            const VkViewport whole{0.0f, 0.0f, side, side, first, 1.0f - first};
            gpu.vk->vkCmdSetViewport(gpu.cmd, 0, 1, &whole);
            const Bound bindings[] = {gpu.storage(0, firsts)};
            drawInParts(*light, casters, [&](std::span<const Caster* const> run, const DrawnPart& part) {
                const DepthCasters::Push from = DepthCasters::moved(push, part.away);
                gpu.drawCasters({.pipeline = pipeline,
                                 .casters = run,
                                 .volume = volume,
                                 .bindings = bindings,
                                 .push = &from,
                                 .pushSize = sizeof(from),
                                 .firstFace = part.firstFace,
                                 .faceCount = part.faceCount,
                                 .numbered = true});
            });
        });
}

/// Static casters are drawn once, by themselves, and copied under the moving ones.
/// @param stamp of what they draw
void Declaring::copyStatics(const IdMap& map, std::uint32_t layer, std::span<const Caster* const> statics,
                            std::uint64_t stamp, Cells cells, ImageId numbers, BufferId firsts) const
{
    const ImageId depths = passes.persistent(staticDepths(map)), apart = passes.persistent(staticNumbers(layer));
    const std::uint64_t drawn = Stamp().add(stamp).add(passes.serial(depths)).add(passes.serial(apart)).value();
    if (passes.stale(carrier("contour_chain.static_stamp", layer), drawn))
        draw("contour_chain.statics", map.fits[layer], {depths, apart, layer}, statics, kAllCells, firsts);
    else
        passes.kept();
    CellCopy copy{.name = "contour_chain.copy_static_depth",
                  .variant = variant(layer),
                  .from = depths,
                  .to = map.depth,
                  .fromLayer = layer,
                  .toLayer = layer,
                  .aspect = VK_IMAGE_ASPECT_DEPTH_BIT,
                  .side = resolution,
                  .cells = cells};
    declareCellCopy(passes, copy);
    copy.name = "contour_chain.copy_static_numbers";
    copy.from = apart;
    copy.to = numbers;
    copy.fromLayer = copy.toLayer = 0;
    copy.aspect = VK_IMAGE_ASPECT_COLOR_BIT;
    declareCellCopy(passes, copy);
}

void Declaring::copyToHost(std::uint32_t layer, ImageId from, std::uint32_t fromLayer, BufferId to,
                           VkImageAspectFlags aspect, Cells cells, const char* name) const
{
    declareLayerCopy(passes, {.name = name,
                              .from = from,
                              .layer = fromLayer,
                              .to = to,
                              .aspect = aspect,
                              .side = resolution,
                              .variant = variant(layer),
                              .cells = cells});
}

/// Numbers of first triangles by index of the caster, for the vertex shader.
BufferId declareFirsts(PassBuilder& passes, const NumberedTriangles& triangles)
{
    std::uint32_t count = 1;
    for (const NumberedTriangles::Entry& entry : triangles.entries())
        count = std::max(count, entry.caster->index + 1);
    const BufferId firsts = passes.transient(BufferInfo{.name = "contour_chain.firsts",
                                                        .scope = Scope::light,
                                                        .size = sizeof(std::uint32_t) * VkDeviceSize{count},
                                                        .place = BufferPlace::upload});
    passes.prepare("contour_chain.firsts", Scope::light)
        .writes(firsts)
        .run([firsts, entries = triangles.entries()](HostContext& host) {
            const std::span<std::uint32_t> out = host.write<std::uint32_t>(firsts);
            for (const NumberedTriangles::Entry& entry : entries)
                out[entry.caster->index] = entry.first;
        });
    return firsts;
}

/// What is drawn again is what lies in the cells that moving casters cover or covered.
void declareLayer(const Declaring& declaring, const IdMap& map, std::uint32_t layer, const NumberedTriangles& triangles)
{
    PassBuilder& passes = declaring.passes;
    const ShadowTask& task = declaring.task;
    const LightFit& fit = map.fits[layer];
    FrameArena& arena = passes.arena();
    const std::span<const Caster* const> statics = castersIn(task.casters->statics, fit.volume, arena);
    const std::span<const Caster* const> dynamics = castersIn(task.casters->dynamics, fit.volume, arena);
    const std::uint64_t projected = Stamp().add(task.light->revision).add(fit.clipFromWorld).value();
    KeptParts parts;
    const bool inParts = !anyHostDrawn(statics) && !anyHostDrawn(dynamics); // a host draws into whole layers
    if (inParts) {
        const DepthCasters depth(declaring.pipelines.depth, fit, task, declaring.resolution, arena);
        // All static casters, also those beside the layer: they are numbered before the others.
        parts = {Stamp().add(projected).add(task.casters->staticStamp).value(), depth.cells(dynamics)};
    }
    const std::uint64_t whole = Stamp().add(projected).add(triangles.stamp()).add(statics).add(dynamics).value();
    const Cells cells = declaring.due(map, layer, whole, parts);
    if (cells == 0) {
        passes.kept();
        return;
    }
    // One image for all layers, one after the other: six would take a third more memory.
    const ImageId numbers = passes.transient(ImageInfo{.name = "contour_chain.numbers",
                                                       .scope = Scope::light,
                                                       .format = kNumberFormat,
                                                       .extent = {declaring.resolution, declaring.resolution},
                                                       .variant = declaring.resolution});
    const BufferId firsts = declareFirsts(passes, triangles);
    const bool apart = inParts && task.light->isStatic && !statics.empty() && !dynamics.empty() &&
                       passes.hasRoomFor(passes.missing(declaring.staticDepths(map), map.depth) +
                                         passes.missing(declaring.staticNumbers(layer), numbers));
    if (apart) {
        declaring.copyStatics(map, layer, statics, parts.base, cells, numbers, firsts);
        declaring.draw("contour_chain.dynamics", fit, {map.depth, numbers, layer, false, false}, dynamics, cells,
                       firsts);
    } else {
        const std::span<const Caster* const> casters = castersIn(task.casters->all, fit.volume, arena);
        const std::span<const Caster*> sorted = arena.array<const Caster*>(casters.size());
        const std::size_t own = splitHostDrawn(casters, sorted);
        const bool over = own < sorted.size();
        if (over) declaring.drawDepthOnly(map, layer, sorted.subspan(own));
        declaring.draw("contour_chain.casters", fit, {map.depth, numbers, layer, !over}, sorted.first(own), cells,
                       firsts);
    }
    declaring.copyToHost(layer, map.depth, layer, map.depths[layer], VK_IMAGE_ASPECT_DEPTH_BIT, cells,
                         "contour_chain.copy_depth");
    declaring.copyToHost(layer, numbers, 0, map.numbers[layer], VK_IMAGE_ASPECT_COLOR_BIT, cells,
                         "contour_chain.copy_numbers");
}

} // namespace

IdMapPipelines makeIdMapPipelines(const AlgorithmServices& services)
{
    static constexpr BindingInfo kBindings[] = {bufferAt(0)};
    IdMapPipelines result{.casters = {}, .depth = makeDepthMapPipelines(services)};
    GraphicsPipelineInfo info;
    info.name = "contour_chain.casters";
    info.vertex.code = k_hybrid_id_map_vert;
    info.fragment.code = k_hybrid_id_map_frag;
    info.bindings = kBindings;
    info.pushBytes = sizeof(DepthCasters::Push) + sizeof(std::uint32_t); // CasterDraw::numbered
    info.vertexStride = sizeof(glm::vec3);
    info.casters = info.transforms = true;
    info.depthTest = info.depthWrite = true;
    info.depthCompare = VK_COMPARE_OP_LESS;
    info.depthFormat = kMapFormat;
    info.colorFormat = kNumberFormat;
    info.depthClamp = result.depth.clamped != Clamped::none;
    result.casters = services.pipelines->graphics(info);
    return result;
}

void IdMap::uses(PassRef& host) const
{
    for (std::size_t layer = 0; layer < fits.size(); ++layer)
        if (needed >> layer & 1) host.reads(depths[layer]).reads(numbers[layer]);
}

HostMap IdMap::onHost(const HostContext& context) const
{
    HostMap map{.side = side, .depth = {}, .triangle = {}};
    for (std::size_t layer = 0; layer < fits.size(); ++layer) {
        if ((needed >> layer & 1) == 0) continue;
        map.depth[layer] = context.read<float>(depths[layer]);
        map.triangle[layer] = context.read<std::uint32_t>(numbers[layer]);
    }
    return map;
}

HostMapCopy IdMap::depthOnHost() const
{
    HostMapCopy copy{.layers = static_cast<std::uint32_t>(fits.size()), .needed = needed, .depth = {}};
    std::copy_n(depths, copy.layers, copy.depth);
    return copy;
}

IdMap declareIdMap(PassBuilder& passes, const IdMapPipelines& pipelines, const ShadowTask& task,
                   std::uint32_t resolution, const NumberedTriangles& triangles)
{
    const Declaring declaring{passes, pipelines, task, resolution};
    const bool cube = task.light->type == GN_LIGHT_TYPE_POINT;
    IdMap map{.depth = passes.persistent(ImageInfo{.name = "contour_chain.depth",
                                                   .scope = Scope::light,
                                                   .format = kMapFormat,
                                                   .extent = {resolution, resolution},
                                                   .layers = cube ? 6u : 1u,
                                                   .variant = resolution}),
              .fits = fitLightMap(pipelines.depth.clamped, task, resolution, passes.arena()),
              .needed = neededLayers(task),
              .side = resolution,
              .depths = {},
              .numbers = {}};
    for (std::uint32_t layer = 0; layer < map.fits.size(); ++layer) {
        if ((map.needed >> layer & 1) == 0) continue;
        map.depths[layer] = declaring.layerBuffer("contour_chain.depths", layer);
        map.numbers[layer] = declaring.layerBuffer("contour_chain.numbers", layer);
        declareLayer(declaring, map, layer, triangles);
    }
    return map;
}

VkDeviceSize idMapMemory(std::uint32_t resolution, std::uint32_t layers)
{
    // Depth on the device, both on the CPU, both of the static casters; and one layer of numbers while they are drawn.
    const VkDeviceSize layer = VkDeviceSize{resolution} * resolution * 4;
    return layers * (3 * layer + 2 * pooledSize(layer)) + layer;
}

} // namespace gnomon
