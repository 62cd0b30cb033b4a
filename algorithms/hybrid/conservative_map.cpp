#include "algorithms/hybrid/conservative_map.hpp"

#include "algorithms/hybrid/conservative_layers.hpp"
#include "algorithms/maps/depth_map.hpp"

namespace gnomon {

namespace {

enum Setting { kResolution, kMode, kReasons, kLambda };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of the map, or of each of a point light's six.", 64, 8192, 1024},
    {"mode", "0: guaranteed; 1: as in the thesis, back faces with the depth at the texel's centre.", 0, 1, 0},
    kReasonsSetting,
    kLambdaSetting,
};

constexpr RayListNames kNames = {.list = "conservative_map.uncertain",
                                 .clear = "conservative_map.clear",
                                 .trace = "conservative_map.trace",
                                 .umbra = "conservative_map.umbra"};

class ConservativeMap final : public ShadowAlgorithm {
public:
    explicit ConservativeMap(const AlgorithmServices& services)
        : vk_(*services.vk), maps_(services), classify_(services, "conservative_map.classify"), lists_(services, kNames)
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const bool thesis = task.settings[kMode] != 0.0;
        const ConservativeMapView view = conservativeView(
            task, static_cast<std::uint32_t>(task.settings[kResolution]),
            static_cast<ThesisOffset>(static_cast<std::uint32_t>(task.settings[kLambda])), passes.arena());
        const ConservativeImages images{.nearest = maps_.declareNearest(passes, task, view, thesis),
                                        .covered = maps_.declareCovered(passes, task, view, thesis)};
        const RayList list = lists_.open(passes, task, task.settings[kReasons] != 0.0);
        classify_.declare(passes, task, view, images, list, thesis);
        lists_.close(passes, task, list);
    }

    const char* refuses(const ShadowTask& task) const override { return refusesConservative(vk_, task); }

private:
    const DeviceTable& vk_;
    ConservativeMaps maps_;
    ConservativeClassify classify_;
    RayLists lists_;
};

} // namespace

constinit const AlgorithmEntry kConservativeMap{
    .name = "conservative_map",
    .source = "Hertel, Hormann and Westermann 2009; Morais 2015, 3.4.2",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT |
              GN_TRAIT_EXACT_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_RAYS_BIT,
    .roundTrips = 1,
    .maxRounds = 0,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D extent) {
            // Two layers, each as many images as a point light may need.
            return 2 * depthMapMemory(static_cast<std::uint32_t>(settings[kResolution]), 6) + RayLists::memory(extent);
        },
    .missing = [](const DeviceTable& vk) -> const char* {
        return vk.enabled.fragmentStoresAndAtomics ? nullptr : "needs fragmentStoresAndAtomics";
    },
    .create = [](const AlgorithmServices& services) -> std::unique_ptr<ShadowAlgorithm> {
        return std::make_unique<ConservativeMap>(services);
    },
};

} // namespace gnomon
