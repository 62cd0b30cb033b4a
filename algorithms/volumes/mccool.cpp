// Shadow volumes rebuilt from depth maps: polygons where depth jumps, one bit of stencil a map that they toggle.
// Source:    M. McCool, "Shadow volume reconstruction from depth maps", ACM TOG 19(1), 2000; Rautenbach 2008, 3.3.1.
// Reads:     casters, host-drawn ones included, as a depth map; receiver depth and normals.     Writes: visibility.
// Strong at: volumes of whatever can be drawn, without its triangles; they and the map are kept while nothing moves.
// Weak at:   as coarse as the map, and costlier than looking it up.
#include "algorithms/entries.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/shared/light_map.hpp"
#include "algorithms/volumes/depth_surface.hpp"
#include "algorithms/volumes/shadow_reach.hpp"
#include "algorithms/volumes/stencil_resolve.hpp"

#include "shaders/volumes_mccool_cap_frag.h"
#include "shaders/volumes_mccool_cap_vert.h"
#include "shaders/volumes_mccool_edges_comp.h"
#include "shaders/volumes_mccool_polygons_comp.h"
#include "shaders/volumes_mccool_vert.h"

namespace gnomon {

namespace {

/// Maps of a point light.
constexpr std::uint32_t kMaps = 6;
/// Room for the indices of a cell in the mean: where two of its sides jump it has six triangles, at borders to nothing
/// fewer; four or five are measured.
constexpr std::uint32_t kCellIndices = 18;

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map, or of each of a point light's six.", 64, 8192, 1024, true},
    {"darkening", "Shadows are 0: black; 1: `shade`, surfaces that face away too (ambient); 2: `shade` (composite).", 0,
     2, 0},
    {"shade", "What is left of the light in shadows that are not black.", 0, 1, 0.3},
    {"edges", "Cells with edges that a map may have, per texel of its side; beyond, the map is looked up.", 1, 256, 64},
};
enum Setting : std::size_t { kResolution, kDarkening, kShade, kEdges };

struct Pipelines {
    DepthMapPipelines casters;
    ViewStencilPipelines view;
    PipelineId edges, list;
    PipelineId caps[kMaps];
    PipelineId polygons[2][kMaps]; ///< [reversed]
    ResolvePipelines resolve;
};

/// One map: its polygons, and how they and their cap are drawn.
struct Layer {
    std::uint32_t index = 0;
    gpu::DepthSurface surface;
    gpu::MapConstants look;
    NearTexels near;
    BufferId cells, polygons;
};

/// Block of mccool.vert, std140.
struct VertexConstants {
    gpu::VolumeConstants volume;
    gpu::DepthSurface surface;
};

/// What the passes of one task share; in the frame's arena.
struct Plan {
    StencilResolve resolve;
    ImageId map;
    BufferId receiverBounds;
    float nearWs = 0.0f;    ///< Linear depth of the near plane.
    bool receivers = false; ///< Receivers are asked; no polygon is drawn (mayCrossUnseen()).
    std::uint32_t layerCount = 0;
    Layer layers[kMaps];
};

using Templates = std::array<std::uint32_t, gpu::TEMPLATES * gpu::TEMPLATE_TRIANGLES>;

template <typename Block>
void copyTemplates(Block& block, const Templates& templates)
{
    static_assert(sizeof(block.templates) == sizeof(templates));
    std::memcpy(block.templates, templates.data(), sizeof(templates));
}

// --- pipelines ---

constexpr BindingInfo surfaceAt(std::uint32_t binding)
{
    return mapAt(binding, kMapFormat, SamplerKind::nearestBorderFar);
}

/// Draws into the stencil of the view's copy: turns the bit of one map wherever the depth test passes.
GraphicsPipelineInfo toggling(std::uint32_t map, const char* name)
{
    return {.name = name,
            .stencil = stencilTest(VK_COMPARE_OP_ALWAYS, 0, VK_STENCIL_OP_INVERT, 1u << map),
            .colorMask = 0,
            .colorFormat = VK_FORMAT_R8_UNORM,
            .depthFormat = kStencilFormat};
}

PipelineId capPipeline(const AlgorithmServices& services, std::uint32_t map)
{
    const BindingInfo bindings[] = {constantsAt(0), sampledAt(1, VK_FORMAT_D32_SFLOAT), surfaceAt(3), bufferAt(4)};
    GraphicsPipelineInfo info = toggling(map, "mccool.cap");
    info.vertex.code = k_volumes_mccool_cap_vert;
    info.fragment.code = k_volumes_mccool_cap_frag;
    info.bindings = bindings;
    return services.pipelines->graphics(info);
}

PipelineId polygonPipeline(const AlgorithmServices& services, std::uint32_t map, bool reversed)
{
    const BindingInfo bindings[] = {constantsAt(0), surfaceAt(1), bufferAt(2)};
    GraphicsPipelineInfo info = toggling(map, reversed ? "mccool.polygons_reversed" : "mccool.polygons");
    info.vertex.code = k_volumes_mccool_vert;
    info.bindings = bindings;
    info.depthTest = true;
    info.depthCompare = reversed ? VK_COMPARE_OP_GREATER : VK_COMPARE_OP_LESS;
    return services.pipelines->graphics(info);
}

// --- polygons: of the light ---

VkDeviceSize polygonBytes(std::uint32_t cells)
{
    return sizeof(std::uint32_t) * (gpu::POLYGON_HEADER + VkDeviceSize{kCellIndices} * cells);
}

VkDeviceSize cellBytes(std::uint32_t cells)
{
    return sizeof(std::uint32_t) * (VkDeviceSize{1} + cells);
}

/// Before the indices of a map's list.
struct PolygonHead {
    VkDrawIndexedIndirectCommand command;
    std::uint32_t asked;
};
static_assert(sizeof(PolygonHead) <= sizeof(std::uint32_t) * gpu::POLYGON_HEADER);

void recordClear(const PassContext& gpu, const Layer& layer)
{
    // The first index stands in the command, not in the binding: Mesa 22.3 ignores its offset in indirect draws.
    const PolygonHead empty{.command = {.indexCount = 0,
                                        .instanceCount = 1,
                                        .firstIndex = gpu::POLYGON_HEADER,
                                        .vertexOffset = 0,
                                        .firstInstance = 0},
                            .asked = 0};
    const std::uint32_t none = 0;
    gpu.vk->vkCmdUpdateBuffer(gpu.cmd, gpu.buffer(layer.polygons), 0, sizeof(empty), &empty);
    gpu.vk->vkCmdUpdateBuffer(gpu.cmd, gpu.buffer(layer.cells), 0, sizeof(none), &none);
}

void recordEdges(PassContext& gpu, ImageId map, const Layer& layer, PipelineId pipeline)
{
    gpu.bind(pipeline, {gpu.constants(0, layer.surface),
                        gpu.sampled(1, map, SamplerKind::nearestBorderFar, layer.index), gpu.storage(2, layer.cells)});
    const std::uint32_t cells = layer.surface.side + 1; // a row, and as many rows
    gpu.vk->vkCmdDispatch(gpu.cmd, (cells + gpu::EDGE_COLUMNS - 1) / gpu::EDGE_COLUMNS,
                          (cells + gpu::EDGE_ROWS - 1) / gpu::EDGE_ROWS, 1);
}

void recordList(PassContext& gpu, ImageId map, const Layer& layer, const Templates& templates, PipelineId pipeline)
{
    gpu::PolygonConstants block{};
    block.surface = layer.surface;
    copyTemplates(block, templates);
    gpu.bind(pipeline, {gpu.constants(0, block), gpu.sampled(1, map, SamplerKind::nearestBorderFar, layer.index),
                        gpu.storage(2, layer.cells), gpu.storage(3, layer.polygons)});
    gpu.vk->vkCmdDispatch(gpu.cmd, gpu::POLYGON_GROUPS, 1, 1);
}

// --- stencil: of the task ---

void recordCap(PassContext& gpu, const Plan& plan, const Layer& layer, const Templates& templates, PipelineId pipeline)
{
    gpu::CapConstants block{};
    block.base = layer.look;
    block.surface = layer.surface;
    block.nearTexels = layer.near.texels;
    block.nearDepth = layer.near.depth;
    block.nearWs = plan.nearWs;
    block.always = layer.near.always ? 1.0f : 0.0f;
    block.receivers = plan.receivers ? 1.0f : 0.0f;
    copyTemplates(block, templates);
    gpu.bind(pipeline,
             {gpu.constants(0, block), gpu.sampled(1, plan.resolve.depth, SamplerKind::nearest, 0),
              gpu.sampled(3, plan.map, SamplerKind::nearestBorderFar, layer.index), gpu.storage(4, layer.polygons)});
    gpu.drawFullscreen();
}

void recordPolygons(PassContext& gpu, const Plan& plan, const Layer& layer, PipelineId pipeline)
{
    const VertexConstants block{.volume = volumeConstants(*plan.resolve.view, *plan.resolve.light, true),
                                .surface = layer.surface};
    gpu.bind(pipeline, {gpu.constants(0, block), gpu.sampled(1, plan.map, SamplerKind::nearestBorderFar, layer.index),
                        gpu.storage(2, plan.receiverBounds)});
    const VkBuffer buffer = gpu.buffer(layer.polygons);
    gpu.vk->vkCmdBindIndexBuffer(gpu.cmd, buffer, 0, VK_INDEX_TYPE_UINT32);
    gpu.vk->vkCmdDrawIndexedIndirect(gpu.cmd, buffer, 0, 1, sizeof(VkDrawIndexedIndirectCommand));
}

/// Whether rays from the eye may cross the surface where no polygon stands for it. Polygons are left out along faces,
/// which end a ray: not where the picture lacks such a face (VolumeSource::mayBeUnseen(), here of a whole caster), nor
/// where the eye or the near rectangle may lie in a closed caster, whose lit sides are not in the map.
bool mayCrossUnseen(const ShadowTask& task)
{
    const Aabb box = eyeBounds(*task.view);
    return std::ranges::any_of(task.casters->all, [&](const Caster* caster) {
        if (caster->closed) return overlap(caster->bounds, box);
        return caster->singleSided || (caster->mesh && caster->mesh->insideOut);
    });
}

Darkness darknessOf(const ShadowTask& task)
{
    const auto mode = static_cast<int>(task.settings[kDarkening]);
    const auto shade = static_cast<float>(task.settings[kShade]);
    return {.shadow = mode == 0 ? 0.0f : shade, .turnedAway = mode == 1 ? shade : 0.0f};
}

// --- the method ---

class McCool final : public ShadowAlgorithm {
public:
    explicit McCool(const AlgorithmServices& services) : vk_(*services.vk), templates_(cellTemplates())
    {
        pipelines_.casters = makeDepthMapPipelines(services);
        pipelines_.view = makeViewStencilPipelines(services);
        pipelines_.edges = services.pipelines->compute("mccool.edges", {k_volumes_mccool_edges_comp},
                                                       {constantsAt(0), surfaceAt(1), bufferAt(2)});
        pipelines_.list = services.pipelines->compute("mccool.list", {k_volumes_mccool_polygons_comp},
                                                      {constantsAt(0), surfaceAt(1), bufferAt(2), bufferAt(3)});
        for (std::uint32_t map = 0; map < kMaps; ++map) {
            pipelines_.caps[map] = capPipeline(services, map);
            for (const bool reversed : {false, true})
                pipelines_.polygons[reversed][map] = polygonPipeline(services, map, reversed);
        }
        pipelines_.resolve = makeResolvePipelines(services, "mccool.resolve");
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        Plan& plan = *passes.arena().make<Plan>();
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        gpu::MapConstants constants = mapConstants(task, resolution, 1);
        const LightMap map = declareLightMap(passes, pipelines_.casters, task, resolution, constants);
        const ViewStencil stencil = declareViewStencil(passes, pipelines_.view, task);
        const gpu::ViewConstants& view = task.view->constants;
        plan.map = map.image;
        plan.receiverBounds = stencil.receiverBounds;
        plan.nearWs = gpu::linearDepth(view, task.view->reversed() ? 1.0f : 0.0f);
        plan.receivers = task.view->oblique || mayCrossUnseen(task);
        for (std::uint32_t index = 0; index < map.fits.size(); ++index)
            if ((map.needed >> index) & 1u) declareLayer(passes, task, plan, map, index);
        declareStencil(passes, task, plan, stencil);
    }

    const char* refuses(const ShadowTask& task) const override
    {
        if (const char* reason = refusesView(vk_, *task.view)) return reason;
        const auto side = static_cast<std::uint32_t>(task.settings[kResolution]);
        const std::uint32_t last = gpu::vertexIndex(side, static_cast<int>(side) - 1, static_cast<int>(side) - 1, 2);
        if (last > vk_.properties.limits.maxDrawIndexedIndexValue)
            return "the map has more vertices than the device's index range";
        const VkDeviceSize polygons = polygonBytes(side * static_cast<std::uint32_t>(task.settings[kEdges]));
        return fitsBinding(vk_, polygons) ? nullptr : "`edges` asks for more polygons than a storage buffer holds";
    }

private:
    /// Adds the layer to the plan, and declares its polygons where they are out of date.
    void declareLayer(PassBuilder& passes, const ShadowTask& task, Plan& plan, const LightMap& map,
                      std::uint32_t index) const
    {
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const auto edges = static_cast<std::uint32_t>(task.settings[kEdges]);
        const std::uint32_t capacity = resolution * edges;
        const std::uint32_t variant = (edges * kMaps + index) << 16 | resolution;
        Layer& layer = plan.layers[plan.layerCount++];
        layer.index = index;
        layer.surface = depthSurface(map.fits[index], *task.light, task.view->eye, resolution);
        layer.surface.cellCapacity = capacity;
        layer.surface.indexCapacity = kCellIndices * capacity;
        layer.look = mapConstants(task, resolution, 1);
        addProjection(layer.look, map.fits[index], task);
        layer.near = nearTexels(map.fits[index], task.view->nearCorners, resolution);
        layer.polygons = passes.persistent(BufferInfo{
            .name = "mccool.polygons", .scope = Scope::light, .size = polygonBytes(capacity), .variant = variant});
        if (passes.stale(layer.polygons, Stamp().add(map.stamps[index]).add(std::uint64_t{capacity}).value()))
            declarePolygons(passes, map.image, layer, variant);
        else
            passes.kept();
    }

    void declarePolygons(PassBuilder& passes, ImageId map, Layer& layer, std::uint32_t variant) const
    {
        layer.cells = passes.transient(BufferInfo{.name = "mccool.cells",
                                                  .scope = Scope::light,
                                                  .size = cellBytes(layer.surface.cellCapacity),
                                                  .variant = variant});
        const Layer* shared = &layer;
        const McCool* self = this;
        passes.transfer("mccool.clear", Scope::light, variant)
            .writes(layer.cells)
            .writes(layer.polygons)
            .record([=](PassContext& gpu) { recordClear(gpu, *shared); });
        passes.compute("mccool.edges", Scope::light, variant)
            .samples(map, {.layer = layer.index})
            .updates(layer.cells)
            .record([=](PassContext& gpu) { recordEdges(gpu, map, *shared, self->pipelines_.edges); });
        passes.compute("mccool.list", Scope::light, variant)
            .samples(map, {.layer = layer.index})
            .reads(layer.cells)
            .updates(layer.polygons)
            .record([=](PassContext& gpu) { recordList(gpu, map, *shared, self->templates_, self->pipelines_.list); });
    }

    void declareStencil(PassBuilder& passes, const ShadowTask& task, Plan& plan, const ViewStencil& stencil) const
    {
        PassRef pass = declareStencilPass(passes, task, "mccool.toggle", stencil, plan.resolve);
        plan.resolve.darkness = darknessOf(task);
        pass.samples(plan.map).reads(plan.receiverBounds);
        for (std::uint32_t i = 0; i < plan.layerCount; ++i) {
            const BufferId polygons = plan.layers[i].polygons;
            pass.reads(polygons).indices(polygons).indirect(polygons);
        }
        const Plan* shared = &plan;
        const McCool* self = this;
        pass.record([=](PassContext& gpu) {
            recordStencilPass(gpu, shared->resolve, self->pipelines_.resolve,
                              [&](PassContext& within) { self->recordLayers(within, *shared); });
        });
    }

    void recordLayers(PassContext& gpu, const Plan& plan) const
    {
        const std::size_t reversed = plan.resolve.view->reversed() ? 1 : 0;
        for (std::uint32_t i = 0; i < plan.layerCount; ++i) {
            const Layer& layer = plan.layers[i];
            recordCap(gpu, plan, layer, templates_, pipelines_.caps[layer.index]);
            if (!plan.receivers) recordPolygons(gpu, plan, layer, pipelines_.polygons[reversed][layer.index]);
        }
    }

    const DeviceTable& vk_;
    Templates templates_;
    Pipelines pipelines_;
};

} // namespace

const AlgorithmEntry kMccool{
    .name = "mccool",
    .source = "McCool 2000; Rautenbach 2008, 3.3.1",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D extent, GnLightType type) {
            const auto side = static_cast<std::uint32_t>(settings[kResolution]);
            const auto edges = static_cast<std::uint32_t>(settings[kEdges]);
            const std::uint32_t maps = mapLayers(type);
            return depthMapMemory(side, maps) +
                   maps * (pooledSize(polygonBytes(side * edges)) + pooledSize(cellBytes(side * edges))) +
                   viewStencilMemory(extent);
        },
    .missing = missingForStencil,
    .create = makeAlgorithm<McCool>,
    .typicalWrongPercent = 0.5f, // mccool.md, colonnade
};

} // namespace gnomon
