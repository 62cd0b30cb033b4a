#include "algorithms/warped/nonorthogonal_warp.hpp"

#include "algorithms/warped/table_map.hpp"
#include "shaders/shared_fullscreen_vert.h"
#include "shaders/warped_bounds_comp.h"
#include "shaders/warped_casters_frag.h"
#include "shaders/warped_casters_vert.h"
#include "shaders/warped_functions_columns_comp.h"
#include "shaders/warped_functions_comp.h"
#include "shaders/warped_importance_comp.h"
#include "shaders/warped_places_frag.h"
#include "shaders/warped_recount_comp.h"
#include "shaders/warped_resolve_frag.h"
#include "shaders/warped_smooth_columns_comp.h"
#include "shaders/warped_smooth_comp.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kSmoothing, kEven, kPower };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map.", 64, 4096, 1024, true},
    {"smoothing", "Share of the map to each side that rows, and columns, are averaged over.", 0, 0.25, 0.1},
    {"even", "Share of texels that is spread evenly, over all others.", 0.05, 10, 0.1},
    {"power", "Of the number of receivers in a cell: 1 gives every texel as many; 2/3 the fewest wrong pixels.", 0.1, 1,
     0.67},
};

constexpr VkDeviceSize kCountBytes = sizeof(float) * gpu::WARP_CELLS * gpu::WARP_CELLS;
constexpr VkDeviceSize kFunctionBytes = sizeof(float) * gpu::WARP_FUNCTIONS_OF_MAP;
constexpr VkDeviceSize kTableBytes = sizeof(float) * gpu::WARP_TABLE;
constexpr VkFormat kPlaceFormat = VK_FORMAT_R32G32_SFLOAT;
constexpr std::uint32_t kFunctionGroups = gpu::WARP_CELLS / 16;
constexpr std::uint32_t kEdgeGroups = (gpu::WARP_CELL_EDGES + 63) / 64;

/// What the passes that make a table read and write.
struct Plan {
    const WarpTask* warp = nullptr;
    BufferId counts, functions, warpedCounts, tables;
};

class NonorthogonalWarp final : public ShadowAlgorithm {
public:
    explicit NonorthogonalWarp(const AlgorithmServices& services)
        : vk_(*services.vk), map_(services, {.importance = "nonorthogonal_warp.importance",
                                             .clear = "nonorthogonal_warp.clear",
                                             .casters = "nonorthogonal_warp.casters",
                                             .resolve = "nonorthogonal_warp.resolve",
                                             .importanceBuffer = "nonorthogonal_warp.counts",
                                             .map = "nonorthogonal_warp.depth",
                                             .importanceCode = k_warped_importance_comp,
                                             .vertexCode = k_warped_casters_vert,
                                             .fragmentCode = k_warped_casters_frag,
                                             .resolveCode = k_warped_resolve_frag,
                                             .places = true})
    {
        makePipelines(*services.pipelines);
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        WarpTask* warp = TableMap::fit(passes, task, static_cast<std::uint32_t>(task.settings[kResolution]));
        warp->constants.blur = static_cast<float>(task.settings[kSmoothing] * gpu::WARP_CELLS);
        warp->constants.evenShare = static_cast<float>(task.settings[kEven]);
        warp->constants.power = static_cast<float>(task.settings[kPower]);
        Plan* plan = passes.arena().make<Plan>();
        plan->warp = warp;
        plan->counts = map_.declareImportance(passes, task, *warp, kCountBytes);
        const auto buffer = [&](const char* name, VkDeviceSize bytes) {
            return passes.transient(BufferInfo{.name = name, .size = warp->maps() * bytes});
        };
        plan->functions = buffer("nonorthogonal_warp.functions", kFunctionBytes);
        plan->warpedCounts = buffer("nonorthogonal_warp.recount", kCountBytes);
        plan->tables = buffer("nonorthogonal_warp.tables", kTableBytes);
        declareTables(passes, *plan);
        map_.declare(passes, task, *warp, {.tables = plan->tables, .places = declarePlaces(passes, *plan)});
    }

    const char* refuses(const ShadowTask& task) const override { return warpRefuses(vk_, task); }

private:
    void makePipelines(PipelineLibrary& pipelines)
    {
        constexpr BindingInfo all[] = {{.binding = 0, .kind = BindingKind::constants},
                                       {.binding = 1, .kind = BindingKind::storageBuffer},
                                       {.binding = 2, .kind = BindingKind::storageBuffer},
                                       {.binding = 5, .kind = BindingKind::storageBuffer}};
        const auto make = [&](const char* name, std::span<const std::uint32_t> code,
                              std::span<const BindingInfo> bindings) {
            return pipelines.compute({.name = name, .compute = {.code = code}, .bindings = bindings});
        };
        const std::span<const BindingInfo> three = std::span(all).first(3);
        rows_ = make("nonorthogonal_warp.rows", k_warped_functions_comp, three);
        smoothRows_ = make("nonorthogonal_warp.smooth_rows", k_warped_smooth_comp, three);
        recount_ = make("nonorthogonal_warp.recount", k_warped_recount_comp, all);
        columns_ = make("nonorthogonal_warp.columns", k_warped_functions_columns_comp, three);
        smoothColumns_ = make("nonorthogonal_warp.smooth_columns", k_warped_smooth_columns_comp, three);
        const BindingInfo bounds[] = {all[0], all[2]};
        bounds_ = make("nonorthogonal_warp.bounds", k_warped_bounds_comp, bounds);
        const BindingInfo places[] = {all[0], all[3]};
        places_ = pipelines.graphics({.name = "nonorthogonal_warp.places",
                                      .vertex = {.code = k_shared_fullscreen_vert},
                                      .fragment = {.code = k_warped_places_frag},
                                      .bindings = places,
                                      .pushBytes = sizeof(std::uint32_t),
                                      .colorFormat = kPlaceFormat});
    }

    void declareTables(PassBuilder& passes, const Plan& plan) const
    {
        const Plan* shared = &plan;
        const auto dispatch = [=](PipelineId pipeline, BufferId from, BufferId to, std::uint32_t x, std::uint32_t y) {
            return [=](PassContext& gpu) {
                gpu.bind(pipeline, {gpu.constants(0, shared->warp->constants), gpu.storage(1, from), gpu.storage(2, to),
                                    gpu.storage(5, shared->tables)});
                gpu.vk->vkCmdDispatch(gpu.cmd, x, y, shared->warp->maps());
            };
        };
        passes.compute("nonorthogonal_warp.rows")
            .reads(plan.counts)
            .writes(plan.functions)
            .record(dispatch(rows_, plan.counts, plan.functions, kFunctionGroups, 1));
        passes.compute("nonorthogonal_warp.smooth_rows")
            .reads(plan.functions)
            .writes(plan.tables)
            .record(dispatch(smoothRows_, plan.functions, plan.tables, kEdgeGroups, gpu::WARP_CELLS));
        passes.compute("nonorthogonal_warp.recount")
            .reads(plan.counts)
            .reads(plan.tables)
            .writes(plan.warpedCounts)
            .record(dispatch(recount_, plan.counts, plan.warpedCounts, kFunctionGroups, 1));
        passes.compute("nonorthogonal_warp.columns")
            .reads(plan.warpedCounts)
            .writes(plan.functions)
            .record(dispatch(columns_, plan.warpedCounts, plan.functions, kFunctionGroups, 1));
        passes.compute("nonorthogonal_warp.smooth_columns")
            .reads(plan.functions)
            .updates(plan.tables)
            .record(dispatch(smoothColumns_, plan.functions, plan.tables, kEdgeGroups, gpu::WARP_CELLS));
        passes.compute("nonorthogonal_warp.bounds")
            .updates(plan.tables)
            .record(dispatch(bounds_, plan.tables, plan.tables, kEdgeGroups, 2 * gpu::WARP_BLOCKS));
    }

    ImageId declarePlaces(PassBuilder& passes, const Plan& plan) const
    {
        const std::uint32_t side = plan.warp->resolution;
        const ImageId places = passes.transient(ImageInfo{.name = "nonorthogonal_warp.places",
                                                          .format = kPlaceFormat,
                                                          .extent = {side, side},
                                                          .layers = plan.warp->maps()});
        for (std::uint32_t map = 0; map < plan.warp->maps(); ++map) {
            if (!plan.warp->drawn(map)) continue;
            passes.raster("nonorthogonal_warp.places", Scope::task, map)
                .reads(plan.tables)
                .writes(places, {.layer = map})
                .record([=, pipeline = places_, shared = &plan](PassContext& gpu) {
                    gpu.bind(pipeline, {gpu.constants(0, shared->warp->constants), gpu.storage(5, shared->tables)});
                    gpu.push(map);
                    gpu.drawFullscreen();
                });
        }
        return places;
    }

    const DeviceTable& vk_;
    TableMap map_;
    PipelineId rows_, smoothRows_, recount_, columns_, smoothColumns_, bounds_, places_;
};

} // namespace

constinit const AlgorithmEntry kNonorthogonalWarp{
    .name = "nonorthogonal_warp",
    .source = "Navratil 2015, 4.2",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT |
              GN_TRAIT_CPU_GEOMETRY_BIT,
    .roundTrips = 0,
    .maxRounds = 0,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D, GnLightType type) {
            const auto side = static_cast<VkDeviceSize>(settings[kResolution]);
            const VkDeviceSize maps = mapLayers(type);
            return maps * side * side * (4 + 8) + 2 * pooledSize(maps * kCountBytes) +
                   pooledSize(maps * kFunctionBytes) + pooledSize(maps * kTableBytes);
        },
    .missing = nullptr,
    .create = makeAlgorithm<NonorthogonalWarp>,
    .typicalWrongPercent = 0.3f, // nonorthogonal_warp.md
    .followsView = true,
};

} // namespace gnomon
