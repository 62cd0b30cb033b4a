// One ray a pixel on the CPU, or many to a light with a radius: the truth that every other method is held against.
// Source:    A. Appel, "Some techniques for shading machine renderings of solids", AFIPS 1968; Morais 2015, 2.3.
// Reads:     receiver depth and normals (read back), caster triangles.     Writes: visibility.
// Strong at: exact for every kind of light and caster with triangles; alpha-tested casters by the host's opacity.
// Weak at:   cost follows the pixels that face the light, one GPU-CPU-GPU round trip; no host-drawn casters.
#include "algorithms/entries.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "algorithms/hybrid/light_disc.hpp"
#include "algorithms/hybrid/sample_settings.hpp"
#include "algorithms/hybrid/traced_pixels.hpp"
#include "algorithms/hybrid/undecided.hpp"
#include "algorithms/shared/host_visibility.hpp"
#include "runtime/base/hash.hpp"

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

// --- many rays a pixel to points of the light's source; ray_query takes the same points (ray_samples.frag) ---

/// The points of a light's disc that a pixel asks. The disc is cut into `count` parts of equal area, and one point is
/// taken somewhere in each: where, differs from pixel to pixel, and is the same in every frame.
struct SourceSamples {
    std::uint32_t count = 1; ///< 1 to kMaxSourceSamples.
    std::uint32_t seed = 0;  ///< Another one gives other points.
};

// Taking one of a few sets costs less than new points for every pixel.
constexpr std::uint64_t kSets = gpu::SAMPLE_SETS;
// Rays asked at once: all of a pixel's, or those of several pixels.
constexpr std::size_t kBatch = kMaxSourceSamples;

/// In [0, 1).
float unit(std::uint64_t hash)
{
    return static_cast<float>(hash >> 40) * 0x1p-24f;
}

/// One point in each of as many parts, of equal area, of the square from -1 to 1 or of the unit disc: rows as high as
/// the points that they hold.
void spread(std::span<glm::vec2> points, bool square, std::uint64_t key)
{
    const std::size_t count = points.size();
    const std::size_t rows = sampleRows(count);
    for (std::size_t row = 0; row < rows; ++row) {
        const std::size_t first = count * row / rows, end = count * (row + 1) / rows;
        const auto inRow = static_cast<float>(end - first);
        for (std::size_t i = first; i < end; ++i) {
            const float u = (static_cast<float>(i - first) + unit(mixed(key, 2 * i))) / inRow;
            const float v =
                (static_cast<float>(first) + inRow * unit(mixed(key, 2 * i + 1))) / static_cast<float>(count);
            const glm::vec2 place = 2.0f * glm::vec2(u, v) - 1.0f;
            points[i] = square ? place : discOfSquare(place);
        }
    }
}

/// What points are spread over, seen from a receiver, in a place of the pixel's own: a disc is turned, a rectangle has
/// its sides swapped.
LightDisc sourceOf(const LightView& light, const ShadowRay& centre, std::uint64_t key)
{
    LightDisc source;
    if (light.rectangular()) { // key % kSets names the points
        source.x = key & kSets ? -light.sourceX : light.sourceX;
        source.y = key & (2 * kSets) ? -light.sourceY : light.sourceY;
        return source;
    }
    const float angle = 2.0f * std::numbers::pi_v<float> * unit(key);
    LightDisc disc(centre.direction, axisAcross(centre.direction), discRadius(light));
    if (light.flat()) disc.x = light.sourceX, disc.y = light.sourceY;
    source.x = std::cos(angle) * disc.x + std::sin(angle) * disc.y;
    source.y = std::cos(angle) * disc.y - std::sin(angle) * disc.x;
    return source;
}

/// Everything the host pass needs; copied into the frame.
struct SampleJob {
    const CameraView* view;
    const LightView* light;
    HostVisibility buffers;
    SourceSamples samples;
};

/// The pixels of a row; @param seen as many, for their counts
void sampleRow(const SampleJob& job, const HostContext& host, const Receivers& receivers,
               std::span<const glm::vec2> points, std::uint32_t row, RayBatch<kBatch>& batch,
               std::span<std::uint16_t> seen, std::span<std::uint8_t> bytes)
{
    const VkRect2D& area = job.view->area;
    const std::uint32_t count = job.samples.count;
    const auto answer = [&](std::uint32_t x, bool occluded) {
        seen[x] = static_cast<std::uint16_t>(seen[x] - occluded);
    };
    for (std::uint32_t x = 0; x < area.extent.width; ++x) {
        ShadowRay centre;
        const Asked asked = receivers.at(static_cast<std::uint32_t>(area.offset.x) + x,
                                         static_cast<std::uint32_t>(area.offset.y) + row, centre);
        seen[x] = static_cast<std::uint16_t>(asked == Asked::dark ? 0 : count);
        if (asked != Asked::ray) continue;
        if (batch.count + count > kBatch) batch.flush(host, job.light->mask, answer);
        const std::uint64_t key = mixed(mixed(job.samples.seed, row), x);
        const LightDisc source = sourceOf(*job.light, centre, key);
        for (const glm::vec2 point : points.subspan((key % kSets) * count, count)) {
            batch.rays[batch.count] = source.ray(centre, point);
            batch.tags[batch.count++] = x;
        }
    }
    batch.flush(host, job.light->mask, answer);
    for (std::uint32_t x = 0; x < area.extent.width; ++x)
        bytes[x] = static_cast<std::uint8_t>((510u * seen[x] + count) / (2u * count)); // nearest of 255
}

void sample(const SampleJob& job, const HostContext& host)
{
    const VkExtent2D extent = job.view->area.extent;
    const Receivers receivers = receiversOf(*job.view, *job.light, job.buffers, host);
    const std::span<glm::vec2> points = host.arena->array<glm::vec2>(kSets * job.samples.count);
    for (std::uint64_t set = 0; set < kSets; ++set)
        spread(points.subspan(set * job.samples.count, job.samples.count), job.light->rectangular(),
               mixed(set, job.samples.seed));
    const std::span<std::uint8_t> visibility = host.write<std::uint8_t>(job.buffers.rows);
    host.jobs->parallelFor(extent.height, 4, [&](std::size_t begin, std::size_t end, std::uint32_t) {
        RayBatch<kBatch> batch;
        const std::span<std::uint16_t> seen = host.arena->array<std::uint16_t>(extent.width);
        // Upload memory may be write-combined: a row at a time.
        const std::span<std::uint8_t> bytes = host.arena->array<std::uint8_t>(extent.width);
        for (std::size_t row = begin; row < end; ++row) {
            sampleRow(job, host, receivers, points, static_cast<std::uint32_t>(row), batch, seen, bytes);
            std::copy(bytes.begin(), bytes.end(), visibility.begin() + std::ptrdiff_t(row) * extent.width);
        }
    });
}

/// Declares the passes that write the share of the points that each pixel sees.
void declareSampledPixels(PassBuilder& passes, const ShadowTask& task, const TracedNames& names,
                          const SourceSamples& samples)
{
    const SampleJob job{.view = task.view,
                        .light = task.light,
                        .buffers = declareHostVisibility(passes, task, names.visibility),
                        .samples = samples};
    PassRef host = passes.host(names.trace);
    useHostVisibility(host, job.buffers);
    host.run([job](HostContext& context) { sample(job, context); });
    declareVisibilityCopy(passes, task, job.buffers, names.copy);
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
