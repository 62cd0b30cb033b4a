// Shadow map whose columns and rows are as wide as what the view sees in them is near.
// Source:    P. Rosen, "Rectilinear texture warping for fast adaptive shadow mapping", I3D 2012; J. Navratil,
//            "High-quality shadow rendering from complex light sources", 2015, 3.2.3 and 4.2.2.
// Reads:     casters' triangles; receiver depth and normals.     Writes: visibility.
// Strong at: receivers that fill a part of the light's reach; near ones beside far ones.
// Weak at:   one near receiver widens its whole column and row; the map is drawn in every frame.
#include "algorithms/entries.hpp"

#include <algorithm>

#include "algorithms/warped/table_map.hpp"
#include "shaders/warped_casters_rectilinear_frag.h"
#include "shaders/warped_casters_rectilinear_vert.h"
#include "shaders/warped_importance_rectilinear_comp.h"
#include "shaders/warped_rectilinear_edges_comp.h"
#include "shaders/warped_rectilinear_places_comp.h"
#include "shaders/warped_resolve_rectilinear_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kBlur, kEven, kPower, kGreatest, kParaboloids, kContact };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map.", 64, 4096, 1024, true},
    {"blur", "Columns, of 512, to each side of one that its importance is spread over.", 0, gpu::MAX_BLUR_BINS, 4},
    {"even", "Share of texels that is spread evenly, over all others.", 0.001, 10, 0.05},
    {"power", "Of a column's importance: 0.5 the fewest wrong pixels; 0 whatever is seen is as important.", 0, 1, 0.5},
    {"greatest", "1: a column is as important as its nearest receiver is near; 0: as all receivers together.", 0, 1, 0},
    kParaboloidsSetting,
    kContactSetting,
};

constexpr std::uint32_t kPlacesGroup = 64;
constexpr VkDeviceSize kImportanceBytes = sizeof(std::uint32_t) * 2 * gpu::WARP_BINS;

WarpTables tablesOf(std::uint32_t resolution)
{
    return {.floats = gpu::rectilinearTable(static_cast<float>(resolution)),
            .places = gpu::RECTILINEAR_PLACES,
            .functions = 1};
}

// However many receivers lie in a column, their sum stays below 2^32.
std::uint32_t mostWeight(const glm::uvec4& pixels)
{
    const std::uint64_t count = std::max<std::uint64_t>(std::uint64_t{pixels.z} * pixels.w, 1);
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(UINT32_MAX / count, 1, 1u << 20));
}

class RectilinearWarp final : public ShadowAlgorithm {
public:
    explicit RectilinearWarp(const AlgorithmServices& services)
        : vk_(*services.vk), map_(services, {.importance = "rectilinear_warp.importance",
                                             .clear = "rectilinear_warp.clear",
                                             .casters = "rectilinear_warp.casters",
                                             .resolve = "rectilinear_warp.resolve",
                                             .importanceBuffer = "rectilinear_warp.importance",
                                             .tables = "rectilinear_warp.tables",
                                             .places = "rectilinear_warp.copy_places",
                                             .map = "rectilinear_warp.depth",
                                             .importanceCode = k_warped_importance_rectilinear_comp,
                                             .vertexCode = k_warped_casters_rectilinear_vert,
                                             .fragmentCode = k_warped_casters_rectilinear_frag,
                                             .resolveCode = k_warped_resolve_rectilinear_frag})
    {
        constexpr BindingInfo edges[] = {{.binding = 0, .kind = BindingKind::constants},
                                         {.binding = 1, .kind = BindingKind::storageBuffer},
                                         {.binding = 2, .kind = BindingKind::storageBuffer}};
        constexpr BindingInfo places[] = {edges[0], edges[2]};
        edges_ = services.pipelines->compute({.name = "rectilinear_warp.edges",
                                              .compute = {.code = k_warped_rectilinear_edges_comp},
                                              .bindings = edges});
        places_ = services.pipelines->compute({.name = "rectilinear_warp.places",
                                               .compute = {.code = k_warped_rectilinear_places_comp},
                                               .bindings = places});
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const std::span<const double> settings = task.settings;
        WarpTask* warp = TableMap::fit(passes, task,
                                       {.resolution = resolution,
                                        .paraboloids = settings[kParaboloids],
                                        .blur = settings[kBlur],
                                        .even = settings[kEven],
                                        .power = settings[kPower]});
        if (settings[kGreatest] == 0.0) warp->constants.mostWeight = mostWeight(warp->constants.pixels);
        const WarpTables tables = tablesOf(resolution);
        const WarpDue due = map_.due(passes, task, *warp, tables);
        if (due == WarpDue::all)
            declareTables(passes, *warp, map_.declareImportance(passes, task, *warp, kImportanceBytes));
        map_.declareCasters(passes, task, *warp, tables, due);
        map_.declareLookup(passes, task, *warp, task.settings[kContact]);
    }

    const char* refuses(const ShadowTask& task) const override { return warpRefuses(vk_, task); }

private:
    void declareTables(PassBuilder& passes, const WarpTask& warp, BufferId importance) const
    {
        const BufferId tables = warp.tables;
        passes.compute("rectilinear_warp.edges")
            .reads(importance)
            .writes(tables)
            .record([=, pipeline = edges_, shared = &warp](PassContext& gpu) {
                gpu.bind(pipeline,
                         {gpu.constants(0, shared->constants), gpu.storage(1, importance), gpu.storage(2, tables)});
                gpu.vk->vkCmdDispatch(gpu.cmd, 2, 1, shared->maps);
            });
        passes.compute("rectilinear_warp.places")
            .updates(tables)
            .record([=, pipeline = places_, shared = &warp](PassContext& gpu) {
                gpu.bind(pipeline, {gpu.constants(0, shared->constants), gpu.storage(2, tables)});
                gpu.vk->vkCmdDispatch(gpu.cmd, (2 * shared->resolution + kPlacesGroup - 1) / kPlacesGroup, 1,
                                      shared->maps);
            });
    }

    const DeviceTable& vk_;
    TableMap map_;
    PipelineId edges_, places_;
};

} // namespace

constinit const AlgorithmEntry kRectilinearWarp{
    .name = "rectilinear_warp",
    .source = "Rosen 2012; Navratil 2015, 3.2.3",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT |
              GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_GPU_POSITIONS_BIT,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D, GnLightType type) {
            const auto side = static_cast<std::uint32_t>(settings[kResolution]);
            const VkDeviceSize maps = warpMaps(type, settings[kParaboloids]);
            return maps * side * side * 4 + pooledSize(maps * tablesOf(side).bytes()) +
                   maps * tablesOf(side).placesBytes(side) + pooledSize(maps * kImportanceBytes);
        },
    .create = makeAlgorithm<RectilinearWarp>,
    .typicalWrongPercent = 0.4f, // rectilinear_warp.md
    .followsView = true,
};

} // namespace gnomon
