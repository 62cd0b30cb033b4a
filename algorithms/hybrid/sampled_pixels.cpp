#include "algorithms/hybrid/sampled_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "algorithms/hybrid/light_disc.hpp"
#include "algorithms/shared/host_visibility.hpp"
#include "runtime/base/hash.hpp"

namespace gnomon {

namespace {

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

} // namespace

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

} // namespace gnomon
