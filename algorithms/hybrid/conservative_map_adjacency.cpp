#include "algorithms/hybrid/conservative_map_adjacency.hpp"

#include "algorithms/hybrid/conservative_sheets.hpp"
#include "algorithms/maps/depth_map.hpp"

namespace gnomon {

namespace {

enum Setting { kResolution, kMode, kReasons, kLambda };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map, or of each of a point light's six.", 64, 8192, 1024},
    {"mode", "0: sheets between silhouettes, guaranteed; 1: as in the thesis, triangles with kept edges.", 0, 1, 0},
    kReasonsSetting,
    kLambdaSetting,
};

constexpr RayListNames kNames = {.list = "conservative_map_adjacency.uncertain",
                                 .clear = "conservative_map_adjacency.clear",
                                 .trace = "conservative_map_adjacency.trace",
                                 .umbra = "conservative_map_adjacency.umbra"};

class ConservativeMapAdjacency final : public ShadowAlgorithm {
public:
    explicit ConservativeMapAdjacency(const AlgorithmServices& services)
        : vk_(*services.vk), maps_(services), sheets_(services),
          classify_(services, "conservative_map_adjacency.classify"), lists_(services, kNames)
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const bool thesis = task.settings[kMode] != 0.0;
        const ConservativeMapView view = conservativeView(
            task, static_cast<std::uint32_t>(task.settings[kResolution]),
            static_cast<ThesisOffset>(static_cast<std::uint32_t>(task.settings[kLambda])), passes.arena());
        const ConservativeImages images{.nearest = maps_.declareNearest(passes, task, view, thesis),
                                        .covered = thesis ? sheets_.declareThesis(passes, task, view, maps_)
                                                          : sheets_.declareCovered(passes, task, view, maps_)};
        const RayList list = lists_.open(passes, task, task.settings[kReasons] != 0.0);
        classify_.declare(passes, task, view, images, list, thesis);
        lists_.close(passes, task, list);
    }

    const char* refuses(const ShadowTask& task) const override { return refusesConservative(vk_, task); }

private:
    const DeviceTable& vk_;
    ConservativeMaps maps_;
    ConservativeSheets sheets_;
    ConservativeClassify classify_;
    RayLists lists_;
};

} // namespace

constinit const AlgorithmEntry kConservativeMapAdjacency{
    .name = "conservative_map_adjacency",
    .source = "Morais 2015, 4",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT |
              GN_TRAIT_EXACT_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_RAYS_BIT | GN_TRAIT_TOPOLOGY_BIT,
    .roundTrips = 1,
    .maxRounds = 0,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D extent) {
            // Two layers, each as many images as a point light may need.
            const auto resolution = static_cast<std::uint32_t>(settings[kResolution]);
            return 2 * depthMapMemory(resolution, 6) + ConservativeSheets::memory(resolution) +
                   RayLists::memory(extent);
        },
    .missing = [](const DeviceTable& vk) -> const char* {
        return vk.enabled.fragmentStoresAndAtomics ? nullptr : "needs fragmentStoresAndAtomics";
    },
    .create = [](const AlgorithmServices& services) -> std::unique_ptr<ShadowAlgorithm> {
        return std::make_unique<ConservativeMapAdjacency>(services);
    },
};

} // namespace gnomon
