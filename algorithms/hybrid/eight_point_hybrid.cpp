// Soft shadows of lights with a surface from eight points of it: a depth map from each, and rays to all eight where the
// maps do not agree.
// Source:    S. Beister, M. Ernst, M. Stamminger, "A Hybrid GPU-CPU Renderer", Vision, Modeling and Visualization 2005.
// Reads:     caster triangles, receiver depth and normals (read back).     Writes: visibility, in eighths.
// Strong at: lit and dark pixels without rays; maps of what stands still are kept.
// Weak at:   nine shades; what is hidden between the points; eight maps whenever a caster moves; no point lights.
#include "algorithms/entries.hpp"

#include <algorithm>
#include <array>

#include "algorithms/hybrid/point_maps.hpp"
#include "algorithms/hybrid/traced_pixels.hpp"
#include "algorithms/hybrid/undecided.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "algorithms/shared/receivers.hpp"
#include "shaders/hybrid_eight_point_hybrid_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of each of the eight maps.", 64, 4096, 512, true},
};

constexpr UndecidedNames kNames = {.status = "eight_point_hybrid.status",
                                   .readback = "eight_point_hybrid.readback",
                                   .visibility = "eight_point_hybrid.visibility",
                                   .trace = "eight_point_hybrid.trace",
                                   .copy = "eight_point_hybrid.copy"};
constexpr TracedNames kHardNames{"eight_point_hybrid.visibility", "eight_point_hybrid.trace",
                                 "eight_point_hybrid.copy"};

/// What is seen of the eight points, in eighths.
void tracePoints(const UndecidedSource& source, std::span<const std::uint32_t> pixels, std::span<std::uint8_t> bytes)
{
    const LightView& light = source.light;
    const PointDisc own(light);
    const std::array points = lightPoints();
    RayBatch<256> batch; // 32 pixels
    const auto answer = [&](std::uint32_t i, bool occluded) {
        bytes[i] = static_cast<std::uint8_t>(bytes[i] - occluded); // counts points first
    };
    for (std::uint32_t i = 0; i < pixels.size(); ++i) {
        ShadowRay centre;
        const Asked asked = source.receivers.at(gpu::pixelX(pixels[i]), gpu::pixelY(pixels[i]), centre);
        bytes[i] = asked == Asked::dark ? 0 : kLightPoints; // CPU and GPU may round n.l to different sides of zero
        if (asked != Asked::ray) continue;
        const LightDisc disc(centre.direction, own.across, own.radius);
        for (const glm::vec2 point : points) {
            batch.rays[batch.count] = disc.ray(centre, point);
            batch.tags[batch.count++] = i;
        }
        if (batch.full()) batch.flush(source.host, light.mask, answer);
    }
    batch.flush(source.host, light.mask, answer);
    for (std::uint8_t& byte : bytes)
        byte = static_cast<std::uint8_t>((510u * byte + kLightPoints) / (2u * kLightPoints)); // nearest of 255
}

class EightPointHybrid final : public ShadowAlgorithm {
public:
    explicit EightPointHybrid(const AlgorithmServices& services)
        : casters_(makeDepthMapPipelines(services)), classify_(services, {.name = "eight_point_hybrid.classify",
                                                                          .fragment = k_hybrid_eight_point_hybrid_frag,
                                                                          .layers = true,
                                                                          .filters = false})
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        if (task.light->constants.sourceRadius <= 0.0f) { // eight times the same point: ray_traced
            declareTracedPixels(passes, task, kHardNames);
            return;
        }
        gpu::EightPointConstants constants{};
        const auto resolution = static_cast<std::uint32_t>(task.settings[kResolution]);
        const ImageId map = declarePointMaps(passes, casters_, task, resolution,
                                             std::span<gpu::MapLookup, kLightPoints>(constants.points));
        constants.hybrid.base = mapConstants(task, resolution, 1);
        constants.hybrid.base.map.axisWs = constants.points[0].axisWs;
        classify_.declare(passes, task, map, constants, {});
        declareUndecided(passes, task, kNames, tracePoints);
    }

    const char* refuses(const ShadowTask& task) const override { return refusesDisc(*task.light); }

private:
    DepthMapPipelines casters_;
    MapResolve classify_;
};

} // namespace

constinit const AlgorithmEntry kEightPointHybrid{
    .name = "eight_point_hybrid",
    .source = "Beister, Ernst and Stamminger 2005",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_HARD_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT |
              GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_RAYS_BIT,
    .roundTrips = 1,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D extent, GnLightType) {
            return depthMapMemory(static_cast<std::uint32_t>(settings[kResolution]), kLightPoints) +
                   undecidedMemory(extent);
        },
    .create = makeAlgorithm<EightPointHybrid>,
    .typicalWrongPercent = 0.0f, // ray_traced's: lights of shipped scenes have no radius
};

} // namespace gnomon
