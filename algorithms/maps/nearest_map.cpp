#include "algorithms/maps/nearest_map.hpp"

#include "algorithms/shared/depth_map.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "shaders/maps_nearest_map_frag.h"

namespace gnomon {

namespace {

constexpr SettingSpec kSettings[] = {{"resolution", "Texels per side of the map.", 64, 8192, 1024}};

class NearestMap final : public ShadowAlgorithm {
public:
    explicit NearestMap(const AlgorithmServices& services)
        : casters_(makeDepthMapPipelines(services)),
          resolve_(services, {.name = "nearest_map.resolve", .fragment = k_maps_nearest_map_frag, .filters = false})
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const auto resolution = static_cast<std::uint32_t>(task.settings[0]);
        const DepthMap map = declareDepthMap(passes, casters_, task, resolution);
        gpu::MapConstants constants = mapConstants(task, resolution, 1);
        addProjection(constants, *map.fit, task);
        resolve_.declare(passes, task, map.image, constants);
        map_ = {.image = map.image, .clipFromWorld = {map.fit->clipFromWorld}};
    }

    const Map* lightMap() const override { return &map_; }

private:
    DepthMapPipelines casters_;
    MapResolve resolve_;
    Map map_;
};

} // namespace

constinit const AlgorithmEntry kNearestMap{
    .name = "nearest_map",
    .source = "Williams 1978",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_HARD_BIT,
    .roundTrips = 0,
    .maxRounds = 0,
    .settings = kSettings,
    .memoryPerLight = [](std::span<const double> settings, VkExtent2D,
                         GnLightType) { return depthMapMemory(static_cast<std::uint32_t>(settings[0])); },
    .missing = nullptr,
    .create = [](const AlgorithmServices& services) -> std::unique_ptr<ShadowAlgorithm> {
        return std::make_unique<NearestMap>(services);
    },
    .typicalWrongPercent = 0.54f, // nearest_map.md
};

} // namespace gnomon
