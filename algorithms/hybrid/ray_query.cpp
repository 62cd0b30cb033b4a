// One ray a pixel on the device, or many to a light with a radius: the answers of ray_traced without the CPU.
// Source:    A. Appel, "Some techniques for shading machine renderings of solids", AFIPS 1968; VK_KHR_ray_query.
// Reads:     receiver depth and normals, acceleration structures of the casters.     Writes: visibility.
// Strong at: exact for every kind of light, nothing waits for the CPU, so that it may be recorded.
// Weak at:   devices with ray queries only; no host-drawn casters and none that are alpha-tested by a function.
#include "algorithms/entries.hpp"

#include "algorithms/hybrid/device_trace.hpp"
#include "algorithms/hybrid/sample_settings.hpp"
#include "algorithms/shared/source_size.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "shaders/hybrid_ray_query_frag.h"
#include "shaders/hybrid_ray_samples_frag.h"

namespace gnomon {

namespace {

enum Setting { kSamples, kSeed };

constexpr SettingSpec kSettings[] = {kSamplesSetting, kSeedSetting};

bool isSampled(std::span<const double> settings)
{
    return settings[kSamples] > 1.0;
}

bool isSampled(const ShadowTask& task)
{
    return isSampled(task.settings) && task.light->constants.sourceRadius > 0.0f;
}

gpu::RaySamplesConstants samplesConstants(const ShadowTask& task)
{
    const auto count = static_cast<std::uint32_t>(task.settings[kSamples]);
    return {.base = rayConstants(task),
            .samples = {count, static_cast<std::uint32_t>(task.settings[kSeed]), task.light->rectangular() ? 1 : 0,
                        sampleRows(count)},
            .sourceX = glm::vec4(task.light->sourceX, 0.0f),
            .sourceY = glm::vec4(task.light->sourceY, discRadius(*task.light))};
}

class RayQuery final : public ShadowAlgorithm {
public:
    explicit RayQuery(const AlgorithmServices& services)
        : trace_(services, "ray_query.trace", k_hybrid_ray_query_frag, VK_FORMAT_R8_UNORM),
          sample_(services, "ray_query.sample", k_hybrid_ray_samples_frag, VK_FORMAT_R8_UNORM)
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        const Part layer = visibilityIn(*task.view, task.layer, lightPixels(*task.light, *task.view));
        if (isSampled(task))
            sample_.declare(passes, task, samplesConstants(task), task.visibility, layer);
        else
            trace_.declare(passes, task, rayConstants(task), task.visibility, layer);
    }

    const char* refuses(const ShadowTask& task) const override
    {
        const char* const device = refusesDeviceRays(task);
        return device || !isSampled(task) ? device : refusesDisc(*task.light);
    }

private:
    DeviceTrace trace_, sample_;
};

} // namespace

constinit const AlgorithmEntry kRayQuery{
    .name = "ray_query",
    .source = "Appel 1968; VK_KHR_ray_query",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_EXACT_BIT | GN_TRAIT_CPU_GEOMETRY_BIT |
              GN_TRAIT_DEVICE_RAYS_BIT | GN_TRAIT_FLAT_SOURCE_BIT,
    .settings = kSettings,
    .memoryPerLight = [](std::span<const double>, VkExtent2D, GnLightType) { return VkDeviceSize{0}; },
    .missing = [](const DeviceTable& vk) { return vk.rayQueryMissing; },
    .create = makeAlgorithm<RayQuery>,
    .approximates = isSampled, // lights with a radius
    .softens = isSampled,
};

} // namespace gnomon
