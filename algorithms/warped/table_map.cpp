#include "algorithms/warped/table_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <glm/matrix.hpp>

#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/shared/cube_faces.hpp"
#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/face_light.hpp"
#include "algorithms/shared/frusta.hpp"
#include "algorithms/shared/paraboloid_fit.hpp"
#include "runtime/scene/bias.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "runtime/scene/mesh_chunks.hpp"
#include "shaders/shared_map_resolve_vert.h"
#include "shaders/warped/triangle.h"

namespace gnomon {

namespace {

constexpr std::uint32_t kPixelsPerGroup = 8 * 4; // a side, of importance.comp

constexpr BindingInfo kTables{.binding = 5, .kind = BindingKind::storageBuffer};

constexpr std::size_t indexOf(WarpShape shape)
{
    return static_cast<std::size_t>(shape);
}

/// What shaders that look at receivers are made for.
ShaderInfo lookCode(std::span<const std::uint32_t> code, bool normals, WarpShape shape)
{
    return {.code = code,
            .specializationCount = 3,
            .specialization = {normals, shape == WarpShape::cube, shape == WarpShape::discs}};
}

constexpr VkFormat kPlacesFormat = VK_FORMAT_R32G32_SFLOAT;
constexpr BindingInfo kPlaces{.binding = 6, .kind = BindingKind::sampledImage, .format = kPlacesFormat, .array = true};

PipelineId importancePipeline(const AlgorithmServices& services, const TableMapInfo& info, bool normals,
                              WarpShape shape)
{
    const auto look = lookupBindings(false);
    const BindingInfo bindings[] = {look[0], {.binding = 1, .kind = BindingKind::storageBuffer}, look[1], look[2]};
    return services.pipelines->compute(
        {.name = info.importance, .compute = lookCode(info.importanceCode, normals, shape), .bindings = bindings});
}

PipelineId castersPipeline(const AlgorithmServices& services, const TableMapInfo& info, bool discs, bool open)
{
    const BindingInfo bindings[] = {{.binding = 1, .kind = BindingKind::storageBuffer},
                                    {.binding = 2, .kind = BindingKind::storageBuffer},
                                    kTables,
                                    kPlaces};
    GraphicsPipelineInfo pipeline;
    pipeline.name = info.casters;
    pipeline.vertex = {.code = info.vertexCode, .specializationCount = 1, .specialization = {discs}};
    pipeline.fragment = {.code = info.fragmentCode, .specializationCount = 2, .specialization = {discs, open}};
    pipeline.bindings = bindings;
    pipeline.pushBytes = sizeof(gpu::WarpCaster);
    pipeline.depthTest = pipeline.depthWrite = true;
    pipeline.depthCompare = VK_COMPARE_OP_LESS;
    pipeline.depthFormat = kMapFormat;
    return services.pipelines->graphics(pipeline);
}

PipelineId resolvePipeline(const AlgorithmServices& services, const TableMapInfo& info, bool normals, WarpShape shape)
{
    const auto look = lookupBindings(true);
    BindingInfo bindings[6];
    std::ranges::copy(look, bindings);
    bindings[3].sampler = SamplerKind::nearest;
    bindings[4] = kTables;
    bindings[5] = kPlaces;
    GraphicsPipelineInfo pipeline;
    pipeline.name = info.resolve;
    pipeline.vertex.code = k_shared_map_resolve_vert;
    pipeline.fragment = lookCode(info.resolveCode, normals, shape);
    pipeline.bindings = bindings;
    pipeline.colorFormat = VK_FORMAT_R8_UNORM;
    return services.pipelines->graphics(pipeline);
}

/// Half the diagonal, at most, of a texel of a light with a position, radians: functions are nowhere less steep than
/// the share that is spread evenly makes them. With a texel for rounding.
float widestTexel(const WarpTask& warp)
{
    const float even = std::fmax(warp.constants.evenShare, 1e-3f);
    // Units of the disc are radians at its rim, and twice as many in its middle.
    const float wide =
        warp.shape == WarpShape::discs ? 4.0f / warp.constants.discs[0].axisWs.w : warp.fits.front().texelAtOne;
    return wide / static_cast<float>(warp.resolution) * (0.75f * (1.0f + 1.0f / even) + 1.0f);
}

/// Sine of the angle past a right one at which texels lie that receivers before it may be compared with. A map's
/// corners lie at 1/3.
float pastRim(const WarpTask& warp)
{
    return std::fmin(widestTexel(warp), 1.0f / 3.0f);
}

/// From object space to source texels, times w.
glm::mat4 texelFromObject(const LightFit& fit, const LightView& light, double side, const Caster& caster,
                          const glm::dvec3& at)
{
    const MapProjection map = mapProjection(fit, light);
    glm::dmat4 rows = glm::transpose(glm::dmat4(map.clipFromZero));
    rows[0] = 0.5 * side * (rows[0] + rows[3]);
    rows[1] = 0.5 * side * (rows[1] + rows[3]);
    glm::dmat4 zeroFromObject(glm::dmat3(caster.basis));
    zeroFromObject[3] = glm::dvec4(at - glm::dvec3(map.zeroWs), 1.0);
    return glm::mat4(glm::transpose(rows) * zeroFromObject);
}

/// From object space to the axes of a paraboloid.
glm::mat4 axesFromObject(const gpu::Paraboloid& disc, const LightView& light, const Caster& caster,
                         const glm::dvec3& at)
{
    const glm::dmat3 axesFromWorld =
        glm::transpose(glm::dmat3(glm::dvec3(disc.rightWs), glm::dvec3(disc.downWs), glm::dvec3(disc.axisWs)));
    glm::dmat4 matrix(axesFromWorld * glm::dmat3(caster.basis));
    matrix[3] = glm::dvec4(axesFromWorld * (at - glm::dvec3(light.position())), 1.0);
    return glm::mat4(matrix);
}

gpu::WarpCaster warpCaster(const WarpTask& warp, std::uint32_t map, const LightView& light, const Caster& caster,
                           const glm::vec3& away)
{
    const glm::dvec3 at(caster.translation + away);
    const CasterRaster raster = casterRaster(caster);
    gpu::WarpCaster push{};
    push.side = static_cast<float>(warp.resolution);
    push.flags = (light.type != GN_LIGHT_TYPE_DIRECTIONAL ? gpu::WARP_CASTER_PERSPECTIVE : 0u) |
                 (raster.cullMode == VK_CULL_MODE_FRONT_BIT ? gpu::WARP_CASTER_BACK_ONLY : 0u) |
                 (caster.mirrored ? gpu::WARP_CASTER_MIRRORED : 0u) | map << gpu::WARP_CASTER_MAP_SHIFT;
    if (warp.shape == WarpShape::discs) {
        const gpu::Paraboloid& disc = warp.constants.discs[map];
        push.texelFromObject = axesFromObject(disc, light, caster, at);
        push.depthScale = warp.constants.base.map.farWs;
        push.disc = {disc.rightWs.w, disc.downWs.w, 0.5f * push.side * disc.axisWs.w, pastRim(warp)};
        return push;
    }
    const MapProjection projection = mapProjection(warp.fits[map], light);
    push.texelFromObject = texelFromObject(warp.fits[map], light, double{push.side}, caster, at);
    push.depthConstant = projection.depthConstant;
    push.depthScale = projection.depthScale;
    return push;
}

struct CastersDraw {
    PipelineId pipelines[2]; ///< [open]
    const WarpTask* warp;
    std::uint32_t map;
    const LightView* light;
    std::uint32_t flags; ///< gpu::WarpCaster

    void operator()(PassContext& gpu) const
    {
        const Caster* last = nullptr;
        drawInParts(*light, warp->casters[map], [&](std::span<const Caster* const> run, const DrawnPart& part) {
            for (const Caster* caster : run) {
                if (!last || caster->mesh != last->mesh || caster->closed != last->closed) bind(gpu, *caster);
                last = caster;
                draw(gpu, *caster, part);
            }
        });
    }

    void bind(PassContext& gpu, const Caster& caster) const
    {
        gpu.bind(pipelines[casterRaster(caster).slopeBias > 0.0f],
                 {gpu.storage(1, caster.mesh->vertexBuffer), gpu.storage(2, caster.mesh->indexBuffer),
                  gpu.storage(5, warp->tables), gpu.sampled(6, warp->places)});
    }

    void draw(PassContext& gpu, const Caster& caster, const DrawnPart& part) const
    {
        gpu::WarpCaster push = warpCaster(*warp, map, *light, caster, part.away);
        push.flags |= flags;
        gpu.push(push);
        const std::uint32_t end = part.firstFace + std::min(part.faceCount, UINT32_MAX - part.firstFace);
        forFacesIn(warp->volumes[map], caster, {part.firstFace, end}, [&](const FaceRange& faces) {
            gpu.vk->vkCmdDraw(gpu.cmd, 3 * (faces.end - faces.first), 1, 3 * faces.first, 0);
        });
    }
};

/// Of everything that a map and its tables follow from, but for where the view's receivers lie.
std::uint64_t stampOf(const WarpTask& warp, const LightView& light)
{
    static_assert(sizeof(gpu::WarpConstants) % sizeof(std::uint32_t) == 0);
    std::array<std::uint32_t, sizeof(gpu::WarpConstants) / sizeof(std::uint32_t)> words;
    std::memcpy(words.data(), &warp.constants, sizeof(words));
    Stamp stamp;
    for (const std::uint32_t word : words)
        stamp.add(std::uint64_t{word});
    stamp.add(light.revision);
    for (const LightFit& fit : warp.fits)
        stamp.add(fit.nearWs).add(fit.farWs);
    for (const std::span<const Caster* const> casters : warp.casters)
        stamp.add(casters);
    return stamp.value();
}

/// What a receiver that the view sees may be compared with.
std::span<const Caster* const> castersOf(PassBuilder& passes, const ShadowTask& task, const WarpTask& warp,
                                         std::uint32_t map)
{
    const std::span<const Caster* const> inside = meshesIn(task.casters->all, warp.volumes[map], passes.arena());
    if (task.light->type == GN_LIGHT_TYPE_DIRECTIONAL) return inside;
    return castersSeen(MapCulling::shadows, frustumOf(*task.view, *task.light), task.light->position(),
                       widestTexel(warp), inside, passes.arena());
}

/// The maps of a light that has matrices.
void fitMatrices(PassBuilder& passes, const ShadowTask& task, WarpTask& warp)
{
    // Depths before the near end are written as 0, whether the device can clamp or not.
    if (warp.shape == WarpShape::cube)
        warp.fits = fitCubeFaces(Clamped::all, task, warp.resolution, passes.arena());
    else
        warp.fits = {fitDepthMap(Clamped::all, task, warp.resolution, passes.arena()), 1};
    warp.constants.maps = warp.shape == WarpShape::cube ? neededCubeFaces(task) : 1u;
    addLightProjection(warp.constants.base, warp.fits, task);
    for (std::uint32_t map = 0; map < warp.maps; ++map)
        warp.volumes[map] = warp.fits[map].volume;
}

void fitDiscs(PassBuilder& passes, const ShadowTask& task, WarpTask& warp)
{
    const float reach = casterReach(*task.light, sceneBounds(*task.casters));
    const ParaboloidSet set = lowerAndUpper(task, warp.resolution, reach, MapCulling::parts);
    gpu::WarpConstants& constants = warp.constants;
    constants.maps = set.needed;
    constants.base.map.farWs = reach;
    constants.firstWs = glm::vec4(set.firstWs, 0.0f);
    std::ranges::copy(set.parts, constants.discs);
    const std::span<Plane> planes = passes.arena().array<Plane>(warp.maps);
    for (std::uint32_t map = 0; map < warp.maps; ++map) {
        planes[map] = planeThrough(task.light->position(), glm::vec3(set.parts[map].poleWs), pastRim(warp), reach);
        warp.volumes[map] = planes.subspan(map, 1);
    }
}

void copyPlaces(PassContext& gpu, const WarpTask& warp, const WarpTables& tables)
{
    std::array<VkBufferImageCopy2, gpu::WARP_MAPS> regions{};
    std::uint32_t count = 0;
    for (std::uint32_t map = 0; map < warp.maps; ++map) {
        if (!warp.drawn(map)) continue;
        regions[count++] = {.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
                            .bufferOffset = tables.bytes() * map + sizeof(float) * VkDeviceSize{tables.places},
                            .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 2 * map, 2},
                            .imageExtent = {tables.functions, warp.resolution, 1}};
    }
    if (count == 0) return;
    const VkCopyBufferToImageInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_BUFFER_TO_IMAGE_INFO_2,
                                        .srcBuffer = gpu.buffer(warp.tables),
                                        .dstImage = gpu.image(warp.places),
                                        .dstImageLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                        .regionCount = count,
                                        .pRegions = regions.data()};
    gpu.vk->vkCmdCopyBufferToImage2(gpu.cmd, &copy);
}

} // namespace

TableMap::TableMap(const AlgorithmServices& services, const TableMapInfo& info) : info_(info), contact_(services)
{
    for (const bool discs : {false, true})
        for (const bool open : {false, true})
            casters_[discs][open] = castersPipeline(services, info, discs, open);
    for (const bool normals : {false, true}) {
        for (const WarpShape shape : {WarpShape::plain, WarpShape::cube, WarpShape::discs}) {
            importance_[normals][indexOf(shape)] = importancePipeline(services, info, normals, shape);
            resolve_[normals][indexOf(shape)] = resolvePipeline(services, info, normals, shape);
        }
    }
}

std::uint32_t warpMaps(GnLightType type, double paraboloids)
{
    return type == GN_LIGHT_TYPE_POINT && paraboloids != 0.0 ? 2 : mapLayers(type);
}

WarpTask* TableMap::fit(PassBuilder& passes, const ShadowTask& task, const TableSettings& settings)
{
    WarpTask* warp = passes.arena().make<WarpTask>();
    warp->resolution = settings.resolution;
    warp->maps = warpMaps(task.light->type, settings.paraboloids);
    warp->shape = warp->maps == 1 ? WarpShape::plain : warp->maps == 2 ? WarpShape::discs : WarpShape::cube;
    gpu::WarpConstants& constants = warp->constants;
    constants.base = mapConstants(task, settings.resolution, 1);
    constants.blur = static_cast<float>(settings.blur);
    constants.evenShare = static_cast<float>(settings.even);
    constants.power = static_cast<float>(settings.power);
    const VkRect2D pixels = lightPixels(*task.light, *task.view);
    constants.pixels = {static_cast<std::uint32_t>(pixels.offset.x), static_cast<std::uint32_t>(pixels.offset.y),
                        pixels.extent.width, pixels.extent.height};
    if (warp->shape == WarpShape::discs)
        fitDiscs(passes, task, *warp);
    else
        fitMatrices(passes, task, *warp);
    return warp;
}

WarpDue TableMap::due(PassBuilder& passes, const ShadowTask& task, WarpTask& warp, const WarpTables& tables) const
{
    const std::uint32_t variant = warp.maps << 16 | warp.resolution;
    warp.map = passes.persistent(ImageInfo{.name = info_.map,
                                           .format = kMapFormat,
                                           .extent = {warp.resolution, warp.resolution},
                                           .layers = warp.maps,
                                           .variant = variant});
    warp.places = passes.persistent(ImageInfo{.name = info_.places,
                                              .format = kPlacesFormat,
                                              .extent = {tables.functions, warp.resolution},
                                              .layers = 2 * warp.maps,
                                              .variant = variant});
    warp.tables =
        passes.persistent(BufferInfo{.name = info_.tables, .size = tables.bytes() * warp.maps, .variant = variant});
    for (std::uint32_t map = 0; map < warp.maps; ++map)
        if (warp.drawn(map)) warp.casters[map] = castersOf(passes, task, warp, map);
    Stamp stamp;
    stamp.add(stampOf(warp, *task.light)).add(passes.serial(warp.map)).add(passes.serial(warp.places));
    if (passes.stale(warp.tables, stamp.value())) {
        passes.stale(warp.map, stamp.add(passes.frame()).value()); // not all of it is there
        return WarpDue::all;
    }
    if (passes.stale(warp.map, stamp.value())) return WarpDue::unseen;
    passes.kept(warp.maps);
    return WarpDue::nothing;
}

BufferId TableMap::declareImportance(PassBuilder& passes, const ShadowTask& task, const WarpTask& warp,
                                     VkDeviceSize bytes) const
{
    const BufferId importance = passes.transient(BufferInfo{.name = info_.importanceBuffer, .size = bytes * warp.maps});
    passes.transfer(info_.clear).writes(importance).record([=](PassContext& gpu) {
        gpu.vk->vkCmdFillBuffer(gpu.cmd, gpu.buffer(importance), 0, VK_WHOLE_SIZE, 0);
    });
    const LookupImages look(task, task.depth);
    PassRef count = passes.compute(info_.importance);
    count.samples(look.depth).updates(importance);
    if (look.hasNormals) count.samples(look.normals);
    count.record([=, pipeline = importance_[look.hasNormals][indexOf(warp.shape)], shared = &warp](PassContext& gpu) {
        const auto groups = [](std::uint32_t pixels) { return (pixels + kPixelsPerGroup - 1) / kPixelsPerGroup; };
        const std::uint32_t columns = groups(shared->constants.pixels.z), rows = groups(shared->constants.pixels.w);
        if (columns == 0 || rows == 0) return;
        gpu.bind(pipeline, {gpu.constants(0, shared->constants), gpu.storage(1, importance), gpu.sampled(2, look.depth),
                            gpu.sampled(3, look.normals)});
        gpu.vk->vkCmdDispatch(gpu.cmd, columns, rows, 1);
    });
    return importance;
}

void TableMap::declareCasters(PassBuilder& passes, const ShadowTask& task, const WarpTask& warp,
                              const WarpTables& tables, WarpDue due) const
{
    if (due == WarpDue::nothing) return;
    const bool all = due == WarpDue::all;
    if (all)
        passes.transfer(info_.places)
            .reads(warp.tables)
            .writes(warp.places, kAllLayers)
            .record([shared = &warp, tables](PassContext& gpu) { copyPlaces(gpu, *shared, tables); });
    const PipelineId* pipelines = casters_[warp.shape == WarpShape::discs];
    for (std::uint32_t map = 0; map < warp.maps; ++map) {
        if (!warp.drawn(map)) continue;
        passes.raster(info_.casters, Scope::task, map)
            .depthWrite(warp.map, {.layer = map, .clear = all, .value = {.depthStencil = {1.0f, 0}}})
            .reads(warp.tables)
            .samples(warp.places)
            .record(CastersDraw{.pipelines = {pipelines[0], pipelines[1]},
                                .warp = &warp,
                                .map = map,
                                .light = task.light,
                                .flags = all ? 0u : gpu::WARP_CASTER_UNSEEN});
    }
}

void TableMap::declareLookup(PassBuilder& passes, const ShadowTask& task, const WarpTask& warp, double contact) const
{
    const LookupImages look(task, warp.map);
    LookupPass resolve(passes, task, info_.resolve, look);
    resolve.uses.reads(warp.tables).samples(warp.places);
    resolve.record([=, pipeline = resolve_[look.hasNormals][indexOf(warp.shape)], shared = &warp](PassContext& gpu) {
        gpu.bind(pipeline,
                 {gpu.constants(0, shared->constants), gpu.sampled(2, look.depth), gpu.sampled(3, look.normals),
                  gpu.sampled(4, look.map), gpu.storage(5, shared->tables), gpu.sampled(6, shared->places)});
    });
    contact_.declare(passes, task, contact);
}

const char* warpRefuses(const DeviceTable& vk, const ShadowTask& task)
{
    const VkDeviceSize most = vk.properties.limits.maxStorageBufferRange;
    for (const Caster* caster : task.casters->all) {
        if (!caster->mesh) continue;
        const VkDeviceSize positions = VkDeviceSize{caster->mesh->positionCount()} * sizeof(glm::vec3);
        const VkDeviceSize indices = VkDeviceSize{caster->mesh->triangleCount()} * 3 * sizeof(std::uint32_t);
        if (std::max(positions, indices) > most) return "a caster's mesh is larger than a storage buffer";
    }
    return nullptr;
}

} // namespace gnomon
