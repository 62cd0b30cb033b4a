#include "algorithms/hybrid/ray_query.hpp"

#include "algorithms/hybrid/device_trace.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "shaders/hybrid_ray_query_frag.h"

namespace gnomon {

namespace {

class RayQuery final : public ShadowAlgorithm {
public:
    explicit RayQuery(const AlgorithmServices& services)
        : trace_(services, "ray_query.trace", k_hybrid_ray_query_frag, VK_FORMAT_R8_UNORM)
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        trace_.declare(passes, task, rayConstants(task), task.visibility,
                       visibilityIn(*task.view, task.layer, lightPixels(*task.light, *task.view)));
    }

    const char* refuses(const ShadowTask& task) const override { return refusesDeviceRays(task); }

private:
    DeviceTrace trace_;
};

} // namespace

constinit const AlgorithmEntry kRayQuery{
    .name = "ray_query",
    .source = "Appel 1968; VK_KHR_ray_query",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT |
              GN_TRAIT_EXACT_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_DEVICE_RAYS_BIT,
    .memoryPerLight = [](std::span<const double>, VkExtent2D, GnLightType) { return VkDeviceSize{0}; },
    .missing = [](const DeviceTable& vk) { return vk.rayQueryMissing; },
    .create = makeAlgorithm<RayQuery>,
};

} // namespace gnomon
