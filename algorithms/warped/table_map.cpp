#include "algorithms/warped/table_map.hpp"

#include <algorithm>

#include <glm/matrix.hpp>

#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/shared/cube_faces.hpp"
#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/face_light.hpp"
#include "runtime/scene/bias.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "runtime/scene/mesh_chunks.hpp"
#include "shaders/shared_map_resolve_vert.h"
#include "shaders/warped/triangle.h"

namespace gnomon {

namespace {

constexpr std::uint32_t kPixelsPerGroup = 8 * 4; // a side, of importance.comp

constexpr BindingInfo kTables{.binding = 5, .kind = BindingKind::storageBuffer};
constexpr BindingInfo kPlaces{.binding = 6,
                              .kind = BindingKind::sampledImage,
                              .format = VK_FORMAT_R32G32_SFLOAT,
                              .array = true,
                              .powerOfTwo = true};

PipelineId importancePipeline(const AlgorithmServices& services, const TableMapInfo& info, bool normals, bool cube)
{
    const auto look = lookupBindings(false);
    const BindingInfo bindings[] = {look[0], {.binding = 1, .kind = BindingKind::storageBuffer}, look[1], look[2]};
    return services.pipelines->compute(
        {.name = info.importance,
         .compute = {.code = info.importanceCode, .specializationCount = 2, .specialization = {normals, cube}},
         .bindings = bindings});
}

PipelineId castersPipeline(const AlgorithmServices& services, const TableMapInfo& info)
{
    const BindingInfo bindings[] = {{.binding = 1, .kind = BindingKind::storageBuffer},
                                    {.binding = 2, .kind = BindingKind::storageBuffer},
                                    kTables,
                                    kPlaces};
    GraphicsPipelineInfo pipeline;
    pipeline.name = info.casters;
    pipeline.vertex.code = info.vertexCode;
    pipeline.fragment.code = info.fragmentCode;
    pipeline.bindings = std::span(bindings).first(info.places ? 4 : 3);
    pipeline.pushBytes = sizeof(gpu::WarpCaster);
    pipeline.depthTest = pipeline.depthWrite = true;
    pipeline.depthCompare = VK_COMPARE_OP_LESS;
    pipeline.depthFormat = kMapFormat;
    return services.pipelines->graphics(pipeline);
}

PipelineId resolvePipeline(const AlgorithmServices& services, const TableMapInfo& info, bool normals, bool cube)
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
    pipeline.fragment = {.code = info.resolveCode, .specializationCount = 2, .specialization = {normals, cube}};
    pipeline.bindings = std::span(bindings).first(info.places ? 6 : 5);
    pipeline.colorFormat = VK_FORMAT_R8_UNORM;
    return services.pipelines->graphics(pipeline);
}

gpu::WarpCaster warpCaster(const WarpTask& warp, std::uint32_t face, const LightView& light, const Caster& caster,
                           const glm::vec3& away)
{
    const MapProjection map = mapProjection(warp.fits[face], light);
    const double side = warp.resolution;
    glm::dmat4 rows = glm::transpose(glm::dmat4(map.clipFromZero));
    rows[0] = 0.5 * side * (rows[0] + rows[3]);
    rows[1] = 0.5 * side * (rows[1] + rows[3]);
    glm::dmat4 zeroFromObject(glm::dmat3(caster.basis));
    zeroFromObject[3] = glm::dvec4(glm::dvec3(caster.translation + away) - glm::dvec3(map.zeroWs), 1.0);
    const CasterRaster raster = casterRaster(caster);
    gpu::WarpCaster push{};
    push.texelFromObject = glm::mat4(glm::transpose(rows) * zeroFromObject);
    push.side = static_cast<float>(side);
    push.depthConstant = map.depthConstant;
    push.depthScale = map.depthScale;
    push.flags = (light.type != GN_LIGHT_TYPE_DIRECTIONAL ? gpu::WARP_CASTER_PERSPECTIVE : 0u) |
                 (raster.cullMode == VK_CULL_MODE_FRONT_BIT ? gpu::WARP_CASTER_BACK_ONLY : 0u) |
                 (caster.mirrored ? gpu::WARP_CASTER_MIRRORED : 0u) |
                 (raster.slopeBias > 0.0f ? gpu::WARP_CASTER_BIASED : 0u) | face << gpu::WARP_CASTER_MAP_SHIFT;
    return push;
}

struct CastersDraw {
    PipelineId pipeline;
    const WarpTask* warp;
    std::uint32_t map;
    const LightView* light;
    std::span<const Caster* const> casters;
    Warp made;

    void operator()(PassContext& gpu) const
    {
        drawInParts(*light, casters, [&](std::span<const Caster* const> run, const DrawnPart& part) {
            for (const Caster* caster : run)
                draw(gpu, *caster, part);
        });
    }

    void draw(PassContext& gpu, const Caster& caster, const DrawnPart& part) const
    {
        const Bound bindings[] = {gpu.storage(1, caster.mesh->vertexBuffer), gpu.storage(2, caster.mesh->indexBuffer),
                                  gpu.storage(5, made.tables), gpu.sampled(6, made.places)};
        gpu.bind(pipeline, std::span(bindings).first(made.places ? 4 : 3));
        gpu.push(warpCaster(*warp, map, *light, caster, part.away));
        const std::uint32_t end = part.firstFace + std::min(part.faceCount, UINT32_MAX - part.firstFace);
        forFacesIn(warp->fits[map].volume, caster, {part.firstFace, end}, [&](const FaceRange& faces) {
            gpu.vk->vkCmdDraw(gpu.cmd, 3 * (faces.end - faces.first), 1, 3 * faces.first, 0);
        });
    }
};

} // namespace

TableMap::TableMap(const AlgorithmServices& services, const TableMapInfo& info)
    : info_(info), casters_(castersPipeline(services, info))
{
    for (const bool normals : {false, true}) {
        for (const bool cube : {false, true}) {
            importance_[normals][cube] = importancePipeline(services, info, normals, cube);
            resolve_[normals][cube] = resolvePipeline(services, info, normals, cube);
        }
    }
}

WarpTask* TableMap::fit(PassBuilder& passes, const ShadowTask& task, std::uint32_t resolution)
{
    WarpTask* warp = passes.arena().make<WarpTask>();
    warp->resolution = resolution;
    // Depths before the near end are written as 0, whether the device can clamp or not.
    const bool cube = task.light->type == GN_LIGHT_TYPE_POINT;
    if (cube)
        warp->fits = fitCubeFaces(Clamped::all, task, resolution, passes.arena());
    else
        warp->fits = {fitDepthMap(Clamped::all, task, resolution, passes.arena()), 1};
    warp->constants.maps = cube ? neededCubeFaces(task) : 1u;
    warp->constants.base = mapConstants(task, resolution, 1);
    addLightProjection(warp->constants.base, warp->fits, task);
    const VkRect2D pixels = lightPixels(*task.light, *task.view);
    warp->constants.pixels = {static_cast<std::uint32_t>(pixels.offset.x), static_cast<std::uint32_t>(pixels.offset.y),
                              pixels.extent.width, pixels.extent.height};
    return warp;
}

BufferId TableMap::declareImportance(PassBuilder& passes, const ShadowTask& task, const WarpTask& warp,
                                     VkDeviceSize bytes) const
{
    const BufferId importance =
        passes.transient(BufferInfo{.name = info_.importanceBuffer, .size = bytes * warp.maps()});
    passes.transfer(info_.clear).writes(importance).record([=](PassContext& gpu) {
        gpu.vk->vkCmdFillBuffer(gpu.cmd, gpu.buffer(importance), 0, VK_WHOLE_SIZE, 0);
    });
    const LookupImages look(task, task.depth);
    PassRef count = passes.compute(info_.importance);
    count.samples(look.depth).updates(importance);
    if (look.hasNormals) count.samples(look.normals);
    count.record([=, pipeline = importance_[look.hasNormals][warp.maps() > 1], shared = &warp](PassContext& gpu) {
        const auto groups = [](std::uint32_t pixels) { return (pixels + kPixelsPerGroup - 1) / kPixelsPerGroup; };
        const std::uint32_t columns = groups(shared->constants.pixels.z), rows = groups(shared->constants.pixels.w);
        if (columns == 0 || rows == 0) return;
        gpu.bind(pipeline, {gpu.constants(0, shared->constants), gpu.storage(1, importance), gpu.sampled(2, look.depth),
                            gpu.sampled(3, look.normals)});
        gpu.vk->vkCmdDispatch(gpu.cmd, columns, rows, 1);
    });
    return importance;
}

void TableMap::declare(PassBuilder& passes, const ShadowTask& task, const WarpTask& warp, const Warp& made) const
{
    const ImageId image = passes.transient(ImageInfo{
        .name = info_.map, .format = kMapFormat, .extent = {warp.resolution, warp.resolution}, .layers = warp.maps()});
    for (std::uint32_t map = 0; map < warp.maps(); ++map) {
        if (!warp.drawn(map)) continue;
        PassRef draw = passes.raster(info_.casters, Scope::task, map);
        draw.depthWrite(image, {.layer = map, .clear = true, .value = {.depthStencil = {1.0f, 0}}}).reads(made.tables);
        if (made.places) draw.samples(made.places);
        draw.record(CastersDraw{.pipeline = casters_,
                                .warp = &warp,
                                .map = map,
                                .light = task.light,
                                .casters = meshesIn(task.casters->all, warp.fits[map].volume, passes.arena()),
                                .made = made});
    }

    const LookupImages look(task, image);
    LookupPass resolve(passes, task, info_.resolve, look);
    resolve.uses.reads(made.tables);
    if (made.places) resolve.uses.samples(made.places);
    resolve.record([=, pipeline = resolve_[look.hasNormals][warp.maps() > 1], shared = &warp](PassContext& gpu) {
        const Bound bindings[] = {gpu.constants(0, shared->constants), gpu.sampled(2, look.depth),
                                  gpu.sampled(3, look.normals),        gpu.sampled(4, look.map),
                                  gpu.storage(5, made.tables),         gpu.sampled(6, made.places)};
        gpu.bind(pipeline, std::span(bindings).first(made.places ? 6 : 5));
    });
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
