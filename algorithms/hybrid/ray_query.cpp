// One ray a pixel on the device: the answers of ray_traced without the CPU.
// Source:    A. Appel, "Some techniques for shading machine renderings of solids", AFIPS 1968; VK_KHR_ray_query.
// Reads:     receiver depth and normals, acceleration structures of the casters.     Writes: visibility.
// Strong at: exact for every kind of light, nothing waits for the CPU, so that it may be recorded.
// Weak at:   devices with ray queries only; no host-drawn casters and none that are alpha-tested by a function.
#include "algorithms/entries.hpp"

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
