// Soft shadows of lights with a surface by rays: 64 cells of the light a pixel, of which about a tenth is traced,
// because a pixel's picture of the light is nearly its neighbour's.
// Source:    M. Agrawala, R. Ramamoorthi, A. Heirich, L. Moll, "Efficient image-based methods for rendering soft
//            shadows", SIGGRAPH 2000, section 4.
// Reads:     receiver depth and normals (read back), caster triangles.     Writes: visibility.
// Strong at: penumbrae as 64 rays find them, whatever overlaps whatever; all kinds of light; hard where there is no
//            radius, exactly.
// Weak at:   several rays a pixel even where nothing casts; one GPU-CPU-GPU round trip; no host-drawn casters.
#include "algorithms/entries.hpp"

#include <algorithm>
#include <cstring>
#include <new>
#include <type_traits>

#include "algorithms/hybrid/coherence_tile.hpp"
#include "algorithms/hybrid/traced_pixels.hpp"
#include "algorithms/shared/host_visibility.hpp"

namespace gnomon {

namespace {

enum Setting { kCells };

constexpr SettingSpec kSettings[] = {
    {"cells", "Cells of the light a side: a pixel's visibility has cells^2 steps.", 2, CellGrid::kMaxSide, 8},
};

constexpr TracedNames kNames{"coherence_sampling.visibility", "coherence_sampling.trace", "coherence_sampling.copy"};

/// Everything the host pass needs; copied into the frame.
struct SampleJob {
    const CameraView* view;
    const LightView* light;
    HostVisibility buffers;
    std::uint32_t cells; ///< A side.
};

void sampleTileRow(const SampleJob& job, const Receivers& receivers, CoherenceTile& tile, std::uint32_t top,
                   std::uint32_t height, std::span<std::uint8_t> rows)
{
    const VkRect2D& area = job.view->area;
    for (std::uint32_t left = 0; left < area.extent.width; left += CoherenceTile::kSide)
        tile.answer(receivers, static_cast<std::uint32_t>(area.offset.x) + left,
                    static_cast<std::uint32_t>(area.offset.y) + top,
                    std::min(CoherenceTile::kSide, area.extent.width - left), height, rows.subspan(left),
                    area.extent.width);
}

void sample(const SampleJob& job, const HostContext& host)
{
    const VkExtent2D extent = job.view->area.extent;
    const Receivers receivers = receiversOf(*job.view, *job.light, job.buffers, host);
    const CellLight light{.grid = CellGrid(job.cells),
                          .radius = discRadius(*job.light),
                          .pixelSize = job.view->constants.pixelSize,
                          .mask = job.light->mask};
    const std::span<std::uint8_t> visibility = host.write<std::uint8_t>(job.buffers.rows);
    constexpr std::uint32_t side = CoherenceTile::kSide;
    const std::span<CoherenceTile*> tiles = host.arena->array<CoherenceTile*>(host.jobs->threadCount());
    std::fill(tiles.begin(), tiles.end(), nullptr);
    static_assert(std::is_trivially_destructible_v<CoherenceTile>);
    // Tiles know nothing of each other: the picture is the same for any number of threads.
    const auto rowOf = [&](std::uint32_t top, CoherenceTile& tile) {
        const std::uint32_t height = std::min(side, extent.height - top);
        // Upload memory may be write-combined: whole rows at a time.
        const std::span<std::uint8_t> rows = host.arena->array<std::uint8_t>(std::size_t(height) * extent.width);
        sampleTileRow(job, receivers, tile, top, height, rows);
        std::memcpy(&visibility[std::size_t(top) * extent.width], rows.data(), rows.size());
    };
    host.jobs->parallelFor(
        (extent.height + side - 1) / side, 1, [&](std::size_t begin, std::size_t end, std::uint32_t thread) {
            if (!tiles[thread])
                tiles[thread] = new (host.arena->allocate(sizeof(CoherenceTile), alignof(CoherenceTile)))
                    CoherenceTile(light, host);
            for (std::size_t row = begin; row < end; ++row)
                rowOf(static_cast<std::uint32_t>(row) * side, *tiles[thread]);
        });
}

class CoherenceSampling final : public ShadowAlgorithm {
public:
    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        if (task.light->constants.sourceRadius <= 0.0f) { // no penumbra: ray_traced
            declareTracedPixels(passes, task, kNames);
            return;
        }
        const SampleJob job{.view = task.view,
                            .light = task.light,
                            .buffers = declareHostVisibility(passes, task, kNames.visibility),
                            .cells = static_cast<std::uint32_t>(task.settings[kCells])};
        PassRef host = passes.host(kNames.trace);
        useHostVisibility(host, job.buffers);
        host.run([job](HostContext& context) { sample(job, context); });
        declareVisibilityCopy(passes, task, job.buffers, kNames.copy);
    }

    const char* refuses(const ShadowTask& task) const override { return refusesDisc(*task.light); }
};

} // namespace

constinit const AlgorithmEntry kCoherenceSampling{
    .name = "coherence_sampling",
    .source = "Agrawala, Ramamoorthi, Heirich and Moll 2000",
    .traits =
        kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT | GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_RAYS_BIT,
    .roundTrips = 1,
    .settings = kSettings,
    .memoryPerLight = [](std::span<const double>, VkExtent2D extent,
                         GnLightType) { return hostVisibilityMemory(extent); },
    .create = makeAlgorithm<CoherenceSampling>,
    .typicalWrongPercent = 0.0f, // ray_traced's: lights of shipped scenes have no radius
};

} // namespace gnomon
