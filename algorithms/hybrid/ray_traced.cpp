// One ray a pixel on the CPU, or many to a light with a radius: the truth that every other method is held against.
// Source:    A. Appel, "Some techniques for shading machine renderings of solids", AFIPS 1968; Morais 2015, 2.3.
// Reads:     receiver depth and normals (read back), caster triangles.     Writes: visibility.
// Strong at: exact for every kind of light and caster with triangles; alpha-tested casters by the host's opacity.
// Weak at:   cost follows the pixels that face the light, one GPU-CPU-GPU round trip; no host-drawn casters.
#include "algorithms/entries.hpp"

#include "algorithms/hybrid/light_disc.hpp"
#include "algorithms/hybrid/sampled_pixels.hpp"
#include "algorithms/hybrid/undecided.hpp"
#include "algorithms/shared/host_visibility.hpp"

namespace gnomon {

namespace {

enum Setting { kReasons, kSamples, kSeed };

bool isSampled(std::span<const double> settings)
{
    return settings[kSamples] > 1.0 && settings[kReasons] == 0.0;
}

constexpr SettingSpec kSettings[] = {
    kReasonsSetting,
    kSamplesSetting,
    kSeedSetting,
};

/// Whether the light's surface is sampled; else its centre is asked, and reason codes say of that ray.
bool isSampled(const ShadowTask& task)
{
    return isSampled(task.settings) && task.light->constants.sourceRadius > 0.0f;
}

class RayTraced final : public ShadowAlgorithm {
public:
    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        constexpr TracedNames names{"ray_traced.visibility", "ray_traced.trace", "ray_traced.copy"};
        if (isSampled(task))
            declareSampledPixels(passes, task, names,
                                 {.count = static_cast<std::uint32_t>(task.settings[kSamples]),
                                  .seed = static_cast<std::uint32_t>(task.settings[kSeed])});
        else
            declareTracedPixels(passes, task, names, task.settings[kReasons] != 0.0);
    }

    const char* refuses(const ShadowTask& task) const override
    {
        return isSampled(task) ? refusesDisc(*task.light) : nullptr;
    }
};

} // namespace

constinit const AlgorithmEntry kRayTraced{
    .name = "ray_traced",
    .source = "Appel 1968; Morais 2015, 2.3",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_EXACT_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_RAYS_BIT |
              GN_TRAIT_FLAT_SOURCE_BIT,
    .roundTrips = 1,
    .settings = kSettings,
    .memoryPerLight = [](std::span<const double>, VkExtent2D extent,
                         GnLightType) { return hostVisibilityMemory(extent); },
    .create = makeAlgorithm<RayTraced>,
    .approximates = isSampled, // lights with a radius
    .softens = isSampled,
};

} // namespace gnomon
