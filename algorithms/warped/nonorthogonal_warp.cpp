// Shadow map in which every row of texels, and then every column, is spread by the receivers that lie in it, so that
// each texel holds about as many.
// Source:    J. Navratil, "High-quality shadow rendering from complex light sources", 2015, 4.2.
// Reads:     casters' triangles; receiver depth and normals.     Writes: visibility.
// Strong at: receivers in several places of the map, with little between them.
// Weak at:   texels are sheared; the map is drawn in every frame, more slowly than a plain one.
#include "algorithms/entries.hpp"

#include "algorithms/warped/table_map.hpp"
#include "shaders/warped_bounds_comp.h"
#include "shaders/warped_casters_frag.h"
#include "shaders/warped_casters_vert.h"
#include "shaders/warped_functions_columns_comp.h"
#include "shaders/warped_functions_comp.h"
#include "shaders/warped_importance_comp.h"
#include "shaders/warped_places_comp.h"
#include "shaders/warped_recount_comp.h"
#include "shaders/warped_resolve_frag.h"
#include "shaders/warped_smooth_columns_comp.h"
#include "shaders/warped_smooth_comp.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kSmoothing, kEven, kPower, kParaboloids, kContact };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map.", 64, 4096, 1024, true},
    {"smoothing", "Share of the map to each side that rows, and columns, are averaged over.", 0, 0.25, 0.1},
    {"even", "Share of texels that is spread evenly, over all others.", 0.05, 10, 0.1},
    {"power", "Of the number of receivers in a cell: 1 gives every texel as many; 2/3 the fewest wrong pixels.", 0.1, 1,
     0.67},
    kParaboloidsSetting,
    kContactSetting,
};

constexpr std::uint32_t kRowsGroup = 16, kEdgesGroup = 64, kPlacesGroup = 64;

/// Bytes for each map.
struct Sizes {
    VkDeviceSize counts, functions;
    WarpTables tables;
};

Sizes sizesOf(std::uint32_t resolution)
{
    const gpu::WarpTable table = gpu::warpTable(0, static_cast<float>(resolution));
    return {sizeof(float) * table.cells * table.cells,
            sizeof(float) * gpu::warpFunctions(table.cells),
            {.floats = table.size, .places = table.places, .functions = table.cells}};
}

/// What the passes that make a table read and write.
struct Plan {
    const WarpTask* warp = nullptr;
    BufferId counts, functions, warpedCounts;
};

class NonorthogonalWarp final : public ShadowAlgorithm {
public:
    explicit NonorthogonalWarp(const AlgorithmServices& services)
        : vk_(*services.vk), map_(services, {.importance = "nonorthogonal_warp.importance",
                                             .clear = "nonorthogonal_warp.clear",
                                             .casters = "nonorthogonal_warp.casters",
                                             .resolve = "nonorthogonal_warp.resolve",
                                             .importanceBuffer = "nonorthogonal_warp.counts",
                                             .tables = "nonorthogonal_warp.tables",
                                             .places = "nonorthogonal_warp.copy_places",
                                             .map = "nonorthogonal_warp.depth",
                                             .importanceCode = k_warped_importance_comp,
                                             .vertexCode = k_warped_casters_vert,
                                             .fragmentCode = k_warped_casters_frag,
                                             .resolveCode = k_warped_resolve_frag})
    {
        makePipelines(*services.pipelines);
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const std::span<const double> settings = task.settings;
        const auto resolution = static_cast<std::uint32_t>(settings[kResolution]);
        WarpTask* warp = TableMap::fit(passes, task,
                                       {.resolution = resolution,
                                        .paraboloids = settings[kParaboloids],
                                        .blur = settings[kSmoothing] * gpu::warpCells(static_cast<float>(resolution)),
                                        .even = settings[kEven],
                                        .power = settings[kPower]});
        const Sizes sizes = sizesOf(warp->resolution);
        const WarpDue due = map_.due(passes, task, *warp, sizes.tables);
        if (due == WarpDue::all) {
            Plan* plan = passes.arena().make<Plan>();
            plan->warp = warp;
            plan->counts = map_.declareImportance(passes, task, *warp, sizes.counts);
            const auto buffer = [&](const char* name, VkDeviceSize bytes) {
                return passes.transient(BufferInfo{.name = name, .size = warp->maps * bytes});
            };
            plan->functions = buffer("nonorthogonal_warp.functions", sizes.functions);
            plan->warpedCounts = buffer("nonorthogonal_warp.recount", sizes.counts);
            declareTables(passes, *plan);
        }
        map_.declareCasters(passes, task, *warp, sizes.tables, due);
        map_.declareLookup(passes, task, *warp, task.settings[kContact]);
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
        places_ = make("nonorthogonal_warp.places", k_warped_places_comp, bounds);
    }

    void declareTables(PassBuilder& passes, const Plan& plan) const
    {
        const Plan* shared = &plan;
        const BufferId tables = plan.warp->tables;
        const gpu::WarpTable table = gpu::warpTable(0, plan.warp->constants.base.map.side);
        const auto dispatch = [=](PipelineId pipeline, BufferId from, BufferId to, std::uint32_t x, std::uint32_t y) {
            return [=](PassContext& gpu) {
                gpu.bind(pipeline, {gpu.constants(0, shared->warp->constants), gpu.storage(1, from), gpu.storage(2, to),
                                    gpu.storage(5, tables)});
                gpu.vk->vkCmdDispatch(gpu.cmd, x, y, shared->warp->maps);
            };
        };
        const std::uint32_t rowGroups = table.cells / kRowsGroup;
        const std::uint32_t edgeGroups = (table.edges + kEdgesGroup - 1) / kEdgesGroup;
        passes.compute("nonorthogonal_warp.rows")
            .reads(plan.counts)
            .writes(plan.functions)
            .record(dispatch(rows_, plan.counts, plan.functions, rowGroups, 1));
        passes.compute("nonorthogonal_warp.smooth_rows")
            .reads(plan.functions)
            .writes(tables)
            .record(dispatch(smoothRows_, plan.functions, tables, edgeGroups, table.cells));
        passes.compute("nonorthogonal_warp.recount")
            .reads(plan.counts)
            .reads(tables)
            .writes(plan.warpedCounts)
            .record(dispatch(recount_, plan.counts, plan.warpedCounts, rowGroups, 1));
        passes.compute("nonorthogonal_warp.columns")
            .reads(plan.warpedCounts)
            .writes(plan.functions)
            .record(dispatch(columns_, plan.warpedCounts, plan.functions, rowGroups, 1));
        passes.compute("nonorthogonal_warp.smooth_columns")
            .reads(plan.functions)
            .updates(tables)
            .record(dispatch(smoothColumns_, plan.functions, tables, edgeGroups, table.cells));
        passes.compute("nonorthogonal_warp.bounds")
            .updates(tables)
            .record(dispatch(bounds_, tables, tables, edgeGroups, 2 * table.blocks));
        passes.compute("nonorthogonal_warp.places")
            .updates(tables)
            .record(
                dispatch(places_, tables, tables, (table.cells * table.texels + kPlacesGroup - 1) / kPlacesGroup, 2));
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
              GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_GPU_POSITIONS_BIT,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D, GnLightType type) {
            const auto side = static_cast<std::uint32_t>(settings[kResolution]);
            const VkDeviceSize maps = warpMaps(type, settings[kParaboloids]);
            const Sizes sizes = sizesOf(side);
            return maps * side * side * 4 + 2 * pooledSize(maps * sizes.counts) + pooledSize(maps * sizes.functions) +
                   pooledSize(maps * sizes.tables.bytes()) + maps * sizes.tables.placesBytes(side);
        },
    .create = makeAlgorithm<NonorthogonalWarp>,
    .typicalWrongPercent = 0.3f, // nonorthogonal_warp.md
    .followsView = true,
};

} // namespace gnomon
