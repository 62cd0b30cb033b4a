// Casters as spans of angle, row by row round the light; receivers look theirs up on the CPU. No map, no volume, and
// no ray but where an open mesh may shade itself. Source:    Thakur et al., in Rautenbach 2008, 3.3.3 and 4.3.5.
// Reads:     topology and positions of the casters, receiver depth and normals (read back). Writes: visibility.
// Strong at: standing lights and casters: tables are kept, a receiver costs a search; no GPU work but two copies.
// Weak at:   edges are stepped by the height of a row; large casters have large rows; one round trip.
#include "algorithms/entries.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "algorithms/shared/caster_lists.hpp"
#include "algorithms/shared/host_visibility.hpp"
#include "algorithms/shared/light_cache.hpp"
#include "algorithms/volumes/light_spans.hpp"

namespace gnomon {

namespace {

enum Setting { kRows };

constexpr std::uint32_t kMostRows = 4096; // of a caster
constexpr SettingSpec kSettings[] = {
    {"rows", "Rows of a caster's table, over what it covers of theta.", 16, kMostRows, 300},
};

// Rows of all tables of a light. Those of boxes take some 95 bytes each, and two cores make some three million a
// second (angular_spans.md): 100 MB, and a third of a second.
constexpr std::size_t kMostRowsOfLight = std::size_t{1} << 20;

constexpr std::uint32_t kTile =
    16; // pixels a side: a hundred casters are left out by their extents once per 256 pixels

/// Everything the two passes need; copied into the frame.
struct SpanJob {
    const CameraView* view;
    const LightView* light;
    LightSpans* spans;
    std::span<const Caster* const> casters;
    std::uint32_t rows;
    HostVisibility buffers;
};

/// The pixels of a tile that ask, as the light sees them.
struct Tile {
    std::uint32_t count = 0;
    ShadowRay rays[kTile * kTile];
    glm::vec3 local[kTile * kTile];
    SpanPoint at[kTile * kTile];
    std::uint32_t pixels[kTile * kTile];  ///< Into the rows of the tile.
    std::uint8_t mayBlock[kTile * kTile]; ///< An open mesh may: a ray has to say.

    float base = 0.0f;          ///< Theta of the pixel that was the first when they were bounded.
    SpanPoint lower{}, upper{}; ///< Theta relative to that, within half a turn.

    void bound(bool round);
    bool meets(const CasterSpans::Extent& extent, bool round) const;
};

/// The same direction within half a turn of 0.
float wrapped(float theta, bool round)
{
    constexpr float turn = 2.0f * std::numbers::pi_v<float>;
    return round ? theta - turn * std::nearbyint(theta / turn) : theta;
}

void Tile::bound(bool round)
{
    constexpr float infinity = std::numeric_limits<float>::infinity();
    lower = {infinity, infinity, infinity};
    upper = {-infinity, -infinity, -infinity};
    base = count > 0 ? at[0].theta : 0.0f;
    for (std::uint32_t i = 0; i < count; ++i) {
        const float theta = wrapped(at[i].theta - base, round);
        lower = {std::min(lower.theta, theta), std::min(lower.phi, at[i].phi), std::min(lower.r, at[i].r)};
        upper = {std::max(upper.theta, theta), std::max(upper.phi, at[i].phi), std::max(upper.r, at[i].r)};
    }
}

bool Tile::meets(const CasterSpans::Extent& extent, bool round) const
{
    if (extent.thetaWidth < 0.0f) return false;
    if (extent.phiLast < lower.phi || extent.phiFirst > upper.phi || extent.nearest > upper.r) return false;
    const float middle = base + 0.5f * (lower.theta + upper.theta);
    const float apart = std::abs(wrapped(extent.thetaFirst + 0.5f * extent.thetaWidth - middle, round));
    // A millionth of the numbers themselves for rounding.
    const float slack = 1e-6f * (std::abs(extent.thetaFirst) + extent.thetaWidth + std::abs(middle));
    return apart <= 0.5f * (extent.thetaWidth + upper.theta - lower.theta) + slack;
}

void collect(const Receivers& receivers, const SpanSpace& space, const VkRect2D& area, std::uint32_t top,
             std::uint32_t left, std::span<std::uint8_t> rows, Tile& tile)
{
    const std::uint32_t width = area.extent.width;
    const std::uint32_t right = std::min(left + kTile, width), bottom = std::min(top + kTile, area.extent.height);
    tile.count = 0;
    for (std::uint32_t y = top; y < bottom; ++y) {
        for (std::uint32_t x = left; x < right; ++x) {
            const std::uint32_t pixel = (y - top) * width + x, i = tile.count;
            const Asked asked = receivers.at(static_cast<std::uint32_t>(area.offset.x) + x,
                                             static_cast<std::uint32_t>(area.offset.y) + y, tile.rays[i]);
            rows[pixel] = asked == Asked::dark ? 0 : 255;
            if (asked != Asked::ray) continue;
            tile.local[i] = space.local(tile.rays[i].origin);
            tile.at[i] = space.at(tile.local[i]);
            tile.pixels[i] = pixel;
            tile.mayBlock[i] = 0;
            ++tile.count;
        }
    }
    tile.bound(space.round());
}

/// Looks the tile's pixels up in all tables that can matter; those found dark leave the tile.
void lookUp(const LightSpans& spans, std::span<std::uint8_t> rows, Tile& tile)
{
    for (const std::unique_ptr<LightSpans::Entry>& entry : spans.entries()) {
        if (tile.count == 0) return;
        if (!tile.meets(entry->spans.extent(), spans.space().round())) continue;
        CasterSpans::Cursor cursor;
        std::uint32_t left = 0;
        for (std::uint32_t i = 0; i < tile.count; ++i) {
            const SpanAnswer answer = entry->spans.ask(tile.local[i], tile.at[i], cursor);
            if (answer == SpanAnswer::dark) {
                rows[tile.pixels[i]] = 0;
                continue;
            }
            tile.rays[left] = tile.rays[i];
            tile.local[left] = tile.local[i];
            tile.at[left] = tile.at[i];
            tile.pixels[left] = tile.pixels[i];
            tile.mayBlock[left] = tile.mayBlock[i] | (answer == SpanAnswer::beyondOpen ? 1 : 0);
            ++left;
        }
        tile.count = left;
    }
}

void answerTileRow(const SpanJob& job, const HostContext& host, const Receivers& receivers, std::uint32_t top,
                   std::span<std::uint8_t> rows)
{
    const auto answer = [&](std::uint32_t pixel, bool occluded) { rows[pixel] = occluded ? 0 : 255; };
    Tile tile;
    RayBatch<256> batch;
    for (std::uint32_t left = 0; left < job.view->area.extent.width; left += kTile) {
        collect(receivers, job.spans->space(), job.view->area, top, left, rows, tile);
        lookUp(*job.spans, rows, tile);
        for (std::uint32_t i = 0; i < tile.count; ++i) {
            if (!tile.mayBlock[i]) continue;
            batch.rays[batch.count] = tile.rays[i];
            batch.tags[batch.count++] = tile.pixels[i];
            if (batch.full()) batch.flush(host, job.light->mask, answer);
        }
    }
    batch.flush(host, job.light->mask, answer);
}

void answer(const SpanJob& job, const HostContext& host)
{
    const VkExtent2D extent = job.view->area.extent;
    const Receivers receivers = receiversOf(*job.view, *job.light, job.buffers, host);
    const std::span<std::uint8_t> visibility = host.write<std::uint8_t>(job.buffers.rows);
    const std::uint32_t tileRows = (extent.height + kTile - 1) / kTile;
    host.jobs->parallelFor(tileRows, 1, [&](std::size_t begin, std::size_t end, std::uint32_t) {
        // Upload memory may be write-combined: whole rows at a time.
        const std::span<std::uint8_t> rows = host.arena->array<std::uint8_t>(std::size_t{kTile} * extent.width);
        for (std::size_t row = begin; row < end; ++row) {
            const auto top = static_cast<std::uint32_t>(row) * kTile;
            answerTileRow(job, host, receivers, top, rows);
            const std::size_t count = std::size_t{std::min(kTile, extent.height - top)} * extent.width;
            std::copy_n(rows.begin(), count, visibility.begin() + std::ptrdiff_t(top) * extent.width);
        }
    });
}

std::uint32_t nextInstance()
{
    static std::atomic<std::uint32_t> made{0};
    return made++;
}

class AngularSpans final : public ShadowAlgorithm {
public:
    void declare(PassBuilder& passes, const ShadowTask& task) override;
    const char* refuses(const ShadowTask& task) const override;

private:
    LightCache<LightSpans> kept_;                   ///< By rows.
    const std::uint32_t instance_ = nextInstance(); ///< Methods of equal rows have tables of their own.
};

void AngularSpans::declare(PassBuilder& passes, const ShadowTask& task)
{
    const auto rows = static_cast<std::uint32_t>(task.settings[kRows]);
    const SpanJob job{.view = task.view,
                      .light = task.light,
                      .spans = &kept_.find(task.light->id, rows),
                      .casters = task.casters->all,
                      .rows = rows,
                      .buffers = declareHostVisibility(passes, task, "angular_spans.visibility")};
    // The stamp is the tables' own, set when they are made: a frame that is dropped before makes none.
    if (job.spans->stamp() == LightSpans::stampOf(*task.light, job.casters, rows)) {
        passes.kept();
    } else {
        const std::uint32_t variant = instance_ * (kMostRows + 1) + rows;
        passes.prepare("angular_spans.table", Scope::light, variant).run([job](HostContext& host) {
            for (std::uint32_t i = job.spans->update(*job.light, job.casters, job.rows, *host.jobs, *host.arena); i > 0;
                 --i)
                host.countIndexList();
        });
    }
    PassRef look = passes.host("angular_spans.look_up");
    useHostVisibility(look, job.buffers);
    look.run([job](HostContext& host) { answer(job, host); });
    declareVisibilityCopy(passes, task, job.buffers, "angular_spans.copy");
}

const char* AngularSpans::refuses(const ShadowTask& task) const
{
    std::size_t tables = 0;
    for (const Caster* caster : task.casters->all) {
        if (caster->alphaTested && !caster->mayBeMissed) return "alpha-tested casters in range";
        if (caster->mesh && !caster->alphaTested && !caster->mesh->topology)
            return "topology of a caster is not built yet";
        tables += castsVolume(*caster);
    }
    if (tables * static_cast<std::size_t>(task.settings[kRows]) > kMostRowsOfLight)
        return "casters in range times rows are more than 1048576";
    return nullptr;
}

} // namespace

constinit const AlgorithmEntry kAngularSpans{
    .name = "angular_spans",
    .source = "Thakur et al., in Rautenbach 2008, 3.3.3 and 4.3.5",
    .traits = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT | GN_TRAIT_HARD_BIT |
              GN_TRAIT_CPU_GEOMETRY_BIT | GN_TRAIT_TOPOLOGY_BIT | GN_TRAIT_RAYS_BIT,
    .roundTrips = 1,
    .settings = kSettings,
    .memoryPerLight = [](std::span<const double>, VkExtent2D extent,
                         GnLightType) { return hostVisibilityMemory(extent); },
    .create = makeAlgorithm<AngularSpans>,
    .typicalWrongPercent = 0.162f, // angular_spans.md, bunny
};

} // namespace gnomon
