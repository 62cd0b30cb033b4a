// Soft shadows of lights with a surface from eight points of it: a depth map from each, and rays to all eight where the
// maps do not agree.
// Source:    S. Beister, M. Ernst, M. Stamminger, "A Hybrid GPU-CPU Renderer", Vision, Modeling and Visualization 2005.
// Reads:     caster triangles, receiver depth and normals (read back).     Writes: visibility, in eighths.
// Strong at: lit and dark pixels without rays; maps of what stands still are kept.
// Weak at:   nine shades; what is hidden between the points; eight maps whenever a caster moves; no point lights.
#include "algorithms/entries.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "algorithms/hybrid/light_disc.hpp"
#include "algorithms/hybrid/traced_pixels.hpp"
#include "algorithms/hybrid/undecided.hpp"
#include "algorithms/shared/depth_casters.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "algorithms/shared/receivers.hpp"
#include "shaders/hybrid/eight_point.h"
#include "shaders/hybrid_eight_point_hybrid_frag.h"

namespace gnomon {

namespace {

constexpr std::uint32_t kLightPoints = gpu::LIGHT_POINTS;

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

constexpr LayerNames kMapNames{"point_maps.casters", "point_maps.statics", "point_maps.copy_statics"}; // of all points

/// The points in the unit disc: the centre, and seven around it. They stand for an eighth of the area each: the ring's
/// radius, 2/3 (1 - 8^-3/2) / (1 - 1/8), is the mean distance from the centre of what lies outside of its eighth. Half
/// planes over the disc are then off by 0.048 on average; 0.65 gives 0.053, 0.80 0.052.
std::array<glm::vec2, kLightPoints> lightPoints()
{
    constexpr float ring = 0.7283f;
    std::array<glm::vec2, kLightPoints> points{};
    for (std::uint32_t i = 1; i < kLightPoints; ++i) {
        const float angle =
            2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(kLightPoints - 1);
        points[i] = ring * glm::vec2(std::cos(angle), std::sin(angle));
    }
    return points;
}

/// The disc of a light seen along its axis; for receivers off it the same points of the disc turned to them.
struct PointDisc {
    glm::vec3 across; ///< Of LightDisc, for all receivers.
    float radius;     ///< discRadius().

    explicit PointDisc(const LightView& light) : across(axisAcross(light.direction())), radius(discRadius(light)) {}
};

/// The light as a point of its disc has it, the disc seen along the axis. A spot light's cone is wider by 1/8 of the
/// distance, so that farther away than eight radii the cone of the light lies inside the cone of every point.
LightView lightFrom(const LightView& light, glm::vec2 point)
{
    const PointDisc own(light);
    const LightDisc disc(-light.direction(), own.across, own.radius);
    const glm::vec3 moved = point.x * disc.x + point.y * disc.y;
    LightView result = light;
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) {
        const glm::vec3 direction = glm::normalize(light.direction() - moved);
        result.constants.directionWs = glm::vec4(direction, light.constants.directionWs.w);
        return result;
    }
    result.constants.positionWs += glm::vec4(moved, 0.0f);
    result.coneAngle = std::atan(std::tan(light.coneAngle) + 1.0f / 8.0f);
    if (!light.unlimited()) result.constants.range += own.radius;
    return result;
}

/// Depth maps from the points, one layer each, kept for as long as light and casters stand still: declares what is
/// missing of them, and adds to `looks` how the view's receivers are found in each. The light is directional or spot.
ImageId declarePointMaps(PassBuilder& passes, const DepthMapPipelines& pipelines, const ShadowTask& task,
                         std::uint32_t resolution, std::span<gpu::MapLookup, kLightPoints> looks)
{
    FrameArena& arena = passes.arena();
    KeptMap map(passes, {.name = "point_maps.depth",
                         .staticsName = "point_maps.statics",
                         .stampName = "point_maps.stamp",
                         .format = kMapFormat,
                         .resolution = resolution,
                         .layers = kLightPoints});
    const std::array points = lightPoints();
    for (std::uint32_t i = 0; i < kLightPoints; ++i) {
        ShadowTask from = task;
        from.light = arena.make(lightFrom(*task.light, points[i])); // casters are drawn by it later in the frame
        const LightFit& fit = *fitDepthMap(pipelines.clamped, from, resolution, arena);
        const LayerContent content =
            layerContent(*task.light, castersIn(task.casters->statics, fit.volume, arena),
                         castersIn(task.casters->dynamics, fit.volume, arena), Stamp().add(fit.clipFromWorld).value());
        map.update(i, kMapNames, content, DepthCasters(pipelines, fit, from, resolution, arena));
        gpu::MapConstants constants = mapConstants(from, resolution, 1);
        addProjection(constants, fit, from);
        looks[i] = constants.map;
    }
    return map.image();
}

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
