// A light's map in pages of several resolutions, of which those that the view asks for are kept.
// Source:    ours; clipmaps (C. Tanner, C. Migdal and M. Jones, SIGGRAPH 1998) and adaptive shadow maps (R. Fernando,
// S. Fernandez, K. Bala and D. Greenberg, SIGGRAPH 2001), in pages.
// Reads:     casters through the rasteriser, receiver depth, geometric normals.     Writes: visibility.
// Strong at: wide scenes: texels are about as wide as pixels near and far, and what stands still is drawn once.
// Weak at:   a camera that turns or jumps draws many small pages; one pool per light and view.
#include "algorithms/entries.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <unordered_map>

#include <glm/common.hpp>

#include "algorithms/maps/page_requests.hpp"
#include "algorithms/maps/page_slots.hpp"
#include "algorithms/shared/contact.hpp"
#include "algorithms/shared/depth_casters.hpp"
#include "algorithms/shared/light_map.hpp"
#include "algorithms/shared/map_resolve.hpp"
#include "shaders/maps_virtual_map_frag.h"

namespace gnomon {

namespace {

enum Setting { kResolution, kFilter, kDensity, kContact };

constexpr SettingSpec kSettings[] = {
    {"resolution", "Texels per side of all pages together, laid out as a square.", 64, 8192, 2048, true},
    {"filter", "Texels per side of the box that is averaged: 1 (nearest), 3, 5 or 7.", 1, gpu::MAX_FILTER_SIDE, 1},
    {"density", "Texels to a pixel along its sides, where there is room for so many.", 1, 4, 2},
    kContactSetting,
};

constexpr std::uint32_t kPagesPerSide = 16;  ///< Of the square: 256 layers, which every device has.
constexpr std::uint32_t kLeastPageSide = 32; ///< Texels; fewer pages below.
/// Of a map whose depths tell as much apart as pages are to: the largest that follows screen coverage.
constexpr std::uint32_t kPlainSide = 4096;
constexpr std::uint32_t kBorderTexels = 4; ///< That filters reach beside a receiver: half of 7 and the fraction.

/// Pages of the pool of one light in one view.
struct Pool {
    std::uint32_t side;     ///< Of a page with its border, texels.
    std::uint32_t capacity; ///< Pages.
    std::uint32_t border;

    static Pool of(std::span<const double> settings, GnLightType type)
    {
        const auto resolution = static_cast<std::uint32_t>(settings[kResolution]);
        const std::uint32_t side = std::max(resolution / kPagesPerSide, kLeastPageSide);
        const std::uint32_t perSide = std::max(resolution / side, 2u);
        return {side, std::max(perSide * perSide, mapLayers(type)),
                filterSide(settings[kFilter]) > 1 ? kBorderTexels : 0};
    }
};

/// Device bytes of a table, at least: that of a turning camera does not grow.
constexpr VkDeviceSize kTableMemory = 16 << 10;
/// And of its versions and what carries the pages' stamps.
constexpr VkDeviceSize kBooksMemory = 512 << 10;

// A page that takes another one's place is drawn by a pass of its own name, so that evictions are counted.
constexpr LayerNames kPageNames{"virtual_map.page", "virtual_map.statics", "virtual_map.copy_statics"};
constexpr LayerNames kEvictingNames{"virtual_map.page_evicting", "virtual_map.statics", "virtual_map.copy_statics"};

/// Casters with where they lie in the light's map.
class PlacedCasters {
public:
    PlacedCasters(std::span<const Caster* const> casters, const PageGrid& grid, FrameArena& arena)
        : casters_(casters), rects_(arena.array<PlaneRect>(casters.size())),
          found_(arena.array<const Caster*>(casters.size()))
    {
        for (std::size_t i = 0; i < casters.size(); ++i)
            rects_[i] = grid.rectOf(casters[i]->bounds);
    }

    /// Those that touch a rectangle; memory from the arena.
    std::span<const Caster* const> in(const PlaneRect& rect, FrameArena& arena) const
    {
        std::size_t count = 0;
        for (std::size_t i = 0; i < casters_.size(); ++i)
            if (rects_[i].overlaps(rect)) found_[count++] = casters_[i];
        const std::span<const Caster*> kept = arena.array<const Caster*>(count);
        std::copy_n(found_.begin(), count, kept.begin());
        return kept;
    }

private:
    std::span<const Caster* const> casters_;
    std::span<PlaneRect> rects_;
    std::span<const Caster*> found_;
};

/// A light's map as a whole, and the grids of its parts that receivers in view may lie in. In the frame's memory.
struct Grids {
    std::span<const LightFit> fits; ///< Of a point light six.
    std::span<const PageGrid> seen;

    bool cube() const { return fits.size() > 1; }
};

/// The page table of a frame, and how receivers are found in it.
struct PageTable {
    std::span<std::uint32_t> entries;
    std::uint64_t stamp = 0;
};

constexpr BindingInfo kTableBinding[] = {bufferAt(5)};

std::uint32_t windowOf(const Page& page, int finest)
{
    return page.face * gpu::MAX_PAGE_LEVELS + static_cast<std::uint32_t>(page.level - finest);
}

/// Adds how receivers are found in the base: of a point light, whose faces differ in their axes alone, a map about the
/// axis of each. @return the place of its first texel
glm::dvec2 addBase(const Page& finest, const Grids& grids, const ShadowTask& task, std::uint32_t side,
                   gpu::MapConstants& base)
{
    if (grids.cube()) {
        addLightProjection(base, grids.fits, task);
        const double half = 0.5 * std::ldexp(static_cast<double>(side), finest.level);
        base.map.slope = static_cast<float>(half);
        return glm::dvec2(-half);
    }
    const PageGrid& grid = grids.seen.front();
    addProjection(base, grid.fitAt(finest, side), task);
    return grid.cornerOf(finest);
}

/// Windows of the levels, and of the pages in them the layers. @param base place of the base's first texel
PageTable tableOf(std::span<const PlacedPage> pages, const PageRequests& requests, const Grids& grids, glm::dvec2 base,
                  gpu::VirtualMapConstants& constants, FrameArena& arena)
{
    const int finest = pageOf(pages.front().key).level;
    constants.levels = static_cast<std::uint32_t>(requests.coarsest() - finest + 1);
    PageRect windows[gpu::MAX_PAGE_WINDOWS];
    for (const PlacedPage& placed : pages) {
        const Page page = pageOf(placed.key);
        PageRect& window = windows[windowOf(page, finest)];
        const glm::ivec2 at(page.x, page.y);
        const bool first = window.width() <= 0;
        window = {first ? at : glm::min(window.low, at), first ? at : glm::max(window.high, at)};
    }
    std::uint32_t size = 0;
    for (const PageGrid& grid : grids.seen)
        for (int level = finest; level <= requests.coarsest(); ++level) {
            const std::uint32_t i = windowOf(grid.page(level, 0, 0), finest);
            const PageRect& window = windows[i];
            const auto width = static_cast<std::uint32_t>(window.width()),
                       height = static_cast<std::uint32_t>(window.height());
            constants.windows[i] = {size, width, height, 0};
            size += width * height;
            const glm::dvec2 moved = base - grid.cornerOf(grid.page(level, window.low.x, window.low.y));
            constants.parts[i] = glm::vec4(glm::vec2(static_cast<float>(std::ldexp(1.0, finest - level))),
                                           glm::vec2(moved * std::ldexp(1.0, -level)));
        }
    for (std::uint32_t i = 0; i < requests.slices(); ++i)
        constants.given[i].x = static_cast<std::uint32_t>(std::max(requests.levelOf(i) - finest, 0));
    constants.slices = requests.slices();

    PageTable table{.entries = arena.array<std::uint32_t>(size)};
    std::ranges::fill(table.entries, 0u);
    Stamp stamp;
    for (const PlacedPage& placed : pages) {
        const Page page = pageOf(placed.key);
        const gpu::uvec4& window = constants.windows[windowOf(page, finest)];
        const glm::ivec2 at = glm::ivec2(page.x, page.y) - windows[windowOf(page, finest)].low;
        const std::uint32_t entry =
            window.x + static_cast<std::uint32_t>(at.y) * window.y + static_cast<std::uint32_t>(at.x);
        table.entries[entry] = placed.slot + 1;
        stamp.add(std::uint64_t{entry} << 32 | placed.slot);
    }
    table.stamp = stamp.add(std::uint64_t{size}).value();
    return table;
}

class VirtualMap final : public ShadowAlgorithm {
public:
    explicit VirtualMap(const AlgorithmServices& services)
        : casters_(makeDepthMapPipelines(services)), resolve_(services, {.name = "virtual_map.resolve",
                                                                         .fragment = k_maps_virtual_map_frag,
                                                                         .cube = k_maps_virtual_map_frag,
                                                                         .layers = true,
                                                                         .more = kTableBinding}),
          contact_(services)
    {
    }

    void declare(PassBuilder& passes, const ShadowTask& task) override
    {
        FrameArena& arena = passes.arena();
        const Pool pool = Pool::of(task.settings, task.light->type);
        const Grids grids = gridsOf(task, pool, arena);
        Kept& kept = keptOf(task, pool, passes.frame());
        const std::uint64_t stamp = requestStamp(task, pool, grids);
        if (kept.asked != stamp)
            kept.requests.ask(task, sceneBounds(*task.casters), grids.seen, {pool.capacity, task.settings[kDensity]});
        kept.asked = stamp;
        const std::span<const PlacedPage> pages = kept.slots.place(kept.requests.pages(), passes.frame());
        passes.pages(static_cast<std::uint32_t>(std::ranges::count_if(pages, &PlacedPage::evicts)),
                     kept.requests.withoutRoom());
        const ImageId image = declarePages(passes, task, pool, grids, pages);

        gpu::VirtualMapConstants constants{};
        const Page finest = pageOf(pages.front().key);
        constants.base = mapConstants(task, pool.side, filterSide(task.settings[kFilter]));
        const glm::dvec2 base = addBase(finest, grids, task, pool.side, constants.base);
        constants.footprint =
            static_cast<float>(std::ldexp(static_cast<double>(task.view->constants.pixelSize) / task.settings[kDensity],
                                          -kept.requests.firstLevel()));
        constants.pageTexels = static_cast<float>(pool.side - 2 * pool.border);
        constants.border = static_cast<float>(pool.border);
        const PageTable table = tableOf(pages, kept.requests, grids, base, constants, arena);
        resolve_.declare(
            passes, task, image, constants,
            {.filtered = constants.base.map.filterSide > 1.0f, .more = {{{.buffer = declareTable(passes, table)}}}});
        contact_.declare(passes, task, task.settings[kContact]);
    }

private:
    /// Of one light in one view, from frame to frame.
    struct Kept {
        PageRequests requests;
        PageSlots slots;
        std::uint64_t asked = 0; ///< Of what the requests depend on.
        std::uint64_t used = 0;  ///< Frame.
    };

    Grids gridsOf(const ShadowTask& task, const Pool& pool, FrameArena& arena) const
    {
        const std::span<const LightFit> fits = fitLightMap(casters_.clamped, task, kPlainSide, arena);
        const std::uint32_t needed = std::max(neededLayers(task), 1u); // one, though nothing is looked up there
        const std::span<PageGrid> grids = arena.array<PageGrid>(static_cast<std::size_t>(std::popcount(needed)));
        auto next = grids.begin();
        for (std::uint32_t face = 0; face < fits.size(); ++face)
            if (needed >> face & 1)
                std::construct_at(&*next++, fits[face], *task.light, task.view->origin, pool.side - 2 * pool.border,
                                  pool.border, face);
        return {fits, grids};
    }

    static std::uint64_t requestStamp(const ShadowTask& task, const Pool& pool, const Grids& grids)
    {
        const CameraView& view = *task.view;
        Stamp stamp;
        stamp.add(task.light->revision).add(task.casters->staticStamp).add(task.casters->dynamicStamp);
        stamp.add(std::uint64_t{pool.side} << 32 | pool.capacity).add(std::uint64_t{pool.border});
        stamp.add(static_cast<float>(task.settings[kDensity]));
        for (const PageGrid& grid : grids.seen)
            stamp.add(std::uint64_t{grid.face()});
        for (const auto word : std::bit_cast<std::array<std::uint32_t, sizeof(view.constants) / 4>>(view.constants))
            stamp.add(std::uint64_t{word});
        stamp.add(std::uint64_t{view.area.extent.width} << 32 | view.area.extent.height);
        for (const std::int32_t start : {view.area.offset.x, view.area.offset.y})
            stamp.add(static_cast<std::uint64_t>(start));
        return stamp.value();
    }

    Kept& keptOf(const ShadowTask& task, const Pool& pool, std::uint64_t frame)
    {
        const std::uint64_t key = std::uint64_t{task.view->id} << 32 | task.light->id;
        auto found = kept_.find(key);
        if (found == kept_.end()) {
            constexpr std::uint64_t kForgottenAfter = 60; // frames, as the pool's resources
            std::erase_if(kept_, [&](const auto& entry) { return entry.second.used + kForgottenAfter < frame; });
            found = kept_.emplace(key, Kept{.requests = {}, .slots = PageSlots(pool.capacity)}).first;
        }
        Kept& kept = found->second;
        if (kept.slots.capacity() != pool.capacity) kept.slots = PageSlots(pool.capacity);
        kept.used = frame;
        return kept;
    }

    ImageId declarePages(PassBuilder& passes, const ShadowTask& task, const Pool& pool, const Grids& grids,
                         std::span<const PlacedPage> pages) const
    {
        KeptMap map(passes, {.name = "virtual_map.pages",
                             .staticsName = "virtual_map.statics",
                             .stampName = "virtual_map.stamp",
                             .format = kMapFormat,
                             .resolution = pool.side,
                             .layers = pool.capacity,
                             .form = pool.border,
                             .scope = Scope::task});
        for (const PageGrid& grid : grids.seen)
            drawFace(map, passes.arena(), task, pool, grid, pages);
        map.keepOthers();
        return map.image();
    }

    /// Those of the pages that are the grid's.
    void drawFace(KeptMap& map, FrameArena& arena, const ShadowTask& task, const Pool& pool, const PageGrid& grid,
                  std::span<const PlacedPage> pages) const
    {
        const PlacedCasters statics(task.casters->statics, grid, arena);
        const PlacedCasters dynamics(task.casters->dynamics, grid, arena);
        for (const PlacedPage& placed : pages) {
            const Page page = pageOf(placed.key);
            if (page.face != grid.face()) continue;
            const PlaneRect rect = grid.rectOf(page);
            const LightFit& fit = *arena.make(grid.fitOf(page));
            const LayerContent content = layerContent(*task.light, statics.in(rect, arena), dynamics.in(rect, arena),
                                                      Stamp().add(fit.clipFromWorld).value());
            map.update(placed.slot, placed.evicts ? kEvictingNames : kPageNames, content,
                       DepthCasters(casters_, fit, task, pool.side, arena));
        }
    }

    static BufferId declareTable(PassBuilder& passes, const PageTable& table)
    {
        const KeptList list = passes.keptList(
            {.name = "virtual_map.table", .size = std::max<VkDeviceSize>(table.entries.size_bytes(), kTableMemory)},
            table.stamp);
        if (list.due)
            passes.prepare("virtual_map.table")
                .writes(list.buffer)
                .run([buffer = list.buffer, entries = table.entries](HostContext& host) {
                    const std::span<std::uint32_t> to = host.write<std::uint32_t>(buffer);
                    std::copy_n(entries.begin(), std::min(entries.size(), to.size()), to.begin());
                });
        return list.buffer;
    }

    DepthMapPipelines casters_;
    MapResolve resolve_;
    ContactShadows contact_;
    std::unordered_map<std::uint64_t, Kept> kept_; ///< By view and light.
};

} // namespace

constinit const AlgorithmEntry kVirtualMap{
    .name = "virtual_map",
    .source = "ours; after Tanner, Migdal and Jones 1998",
    .traits = kAnyLight | GN_TRAIT_HARD_BIT | GN_TRAIT_FIXED_PENUMBRA_BIT | GN_TRAIT_GPU_TRANSFORMS_BIT,
    .settings = kSettings,
    .memoryPerLight =
        [](std::span<const double> settings, VkExtent2D, GnLightType type) {
            const Pool pool = Pool::of(settings, type);
            return depthMapMemory(pool.side, pool.capacity) + kBooksMemory;
        },
    .create = makeAlgorithm<VirtualMap>,
    .typicalWrongPercent = 0.54f, // 0.27 of 2048 texels a side in bunny (exactness_bounds_tests)
    .followsView = true,
};

} // namespace gnomon
