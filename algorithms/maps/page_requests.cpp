#include "algorithms/maps/page_requests.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "algorithms/maps/view_solid.hpp"
#include "algorithms/shared/depth_map.hpp"

namespace gnomon {

namespace {

/// The coarsest level there is, the last that a key holds: 2^63 m a texel. A mesh may be as large as the library's
/// numbers and its transform as well; what lies beyond a page of this level is lit.
constexpr int kCoarsestLevel = 63;
/// Share of the pages that the coarsest level takes at most.
constexpr std::uint32_t kCoarsestShare = 8;
constexpr std::uint32_t kLeastPages = 4; ///< That a rectangle may touch, however wide pages are.
/// What contains the eye is mostly hollow there, as in cascade_fit.cpp: nothing of it is expected nearer, metres.
constexpr double kNearestWithin = 1.0;
/// Distances at which pixels are as wide as texels are rounded differently by shaders: slices overlap by this share.
constexpr double kOverlap = 1.0 / 1024.0;
/// Chunks of a mesh that are looked at one by one; meshes of more are one box.
constexpr std::size_t kMostChunks = 512;
constexpr int kRows = 64; ///< Of a slice's pages, and columns.

int levelOfWidth(double metres)
{
    return static_cast<int>(std::floor(std::log2(std::max(1e-30, std::min(1e30, metres)))));
}

std::uint64_t columns(int first, int last)
{
    first = std::max(first, 0);
    last = std::min(last, kRows - 1);
    if (first > last) return 0;
    return (~std::uint64_t{0} >> (kRows - 1 - last)) & (~std::uint64_t{0} << first);
}

/// Row or column of a place; one beside all of them where it lies beside.
int rowOf(double place)
{
    return static_cast<int>(std::max(-1.0, std::min(double{kRows}, std::floor(place)))); // also of what is no number
}

/// Columns of each row that a convex shape covers, from the edges of its surface.
struct RowRanges {
    std::array<double, kRows> low, high;
    int first = kRows, last = -1;

    RowRanges()
    {
        low.fill(kRows);
        high.fill(-1.0);
    }

    void addEdge(glm::dvec2 a, glm::dvec2 b)
    {
        if (a.y > b.y) std::swap(a, b);
        const int from = std::max(rowOf(a.y), 0), to = std::min(rowOf(b.y), kRows - 1);
        const double slope = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0.0;
        for (int row = from; row <= to; ++row) {
            double x0 = a.x + slope * (std::max(a.y, double(row)) - a.y);
            double x1 = b.y > a.y ? a.x + slope * (std::min(b.y, row + 1.0) - a.y) : b.x;
            if (x0 > x1) std::swap(x0, x1);
            low[std::size_t(row)] = std::min(low[std::size_t(row)], x0);
            high[std::size_t(row)] = std::max(high[std::size_t(row)], x1);
            first = std::min(first, row);
            last = std::max(last, row);
        }
    }
};

/// Calls visit(from, to) with the edges, in the light's map, of what the view sees of a box between two planes.
template <typename Visit>
void forPlaces(const ViewSolid& view, const PageGrid& grid, const Aabb& box, double nearest,
               const std::array<glm::dvec4, 2>& ends, const Visit& visit)
{
    const glm::dvec4 before(0.0, 0.0, 0.0, 1.0);
    const std::array edges = grid.edges();
    const std::array planes{view.distance() - nearest * before,
                            grid.depth() - grid.nearest() * before,
                            ends[0],
                            ends[1],
                            edges[0],
                            edges[1],
                            edges[2],
                            edges[3]};
    view.forSurface(box, planes, [&](const Polygon& polygon) {
        const std::span<const glm::dvec3> corners = polygon.corners();
        for (std::size_t i = 0; i < corners.size(); ++i)
            visit(grid.placeOf(corners[i]), grid.placeOf(corners[(i + 1) % corners.size()]));
    });
}

} // namespace

void PageRequests::addBox(const Aabb& bounds, const CameraView& camera, const ViewSolid& view, const PageGrid& grid)
{
    if (!touches(bounds, camera.frustum)) return;
    const Measured distance = measured(view.distance(), bounds), depth = measured(grid.depth(), bounds);
    const bool aboutEye = overlap(bounds, {camera.eye, camera.eye});
    const double nearest =
        std::max(distance.least, aboutEye ? std::max(kNearestWithin, view.nearest()) : view.nearest());
    if (!(nearest <= distance.greatest) || !(depth.greatest > grid.nearest())) return;
    for (const glm::dvec4& edge : grid.edges())
        if (measured(edge, bounds).greatest < 0.0) return;
    const double scale = glm::length(glm::dvec3(view.pixel())) / glm::length(glm::dvec3(view.distance()));
    const double fixed = view.pixel().w; // without a perspective, where scale is 0
    const auto pixelAt = [&](double metres) { return scale > 0.0 ? scale * metres : fixed; };
    boxes_.push_back({bounds, nearest, pixelAt(nearest) / depth.greatest,
                      pixelAt(distance.greatest) / std::max(depth.least, grid.nearest()), &grid});
}

void PageRequests::collectBoxes(const ShadowTask& task, const ViewSolid& view, const PageGrid& grid)
{
    for (const Caster* caster : task.casters->all) {
        const bool parts = caster->mesh && !caster->gpuPlaced && !caster->hostDrawn &&
                           caster->mesh->chunks.size() > 1 && caster->mesh->chunks.size() <= kMostChunks;
        if (!parts) {
            addBox(caster->bounds, *task.view, view, grid);
        } else if (touches(caster->bounds, task.view->frustum)) {
            for (const Aabb& chunk : caster->mesh->chunks)
                addBox(transformed(chunk, caster->basis, caster->translation), *task.view, view, grid);
        }
    }
}

/// @param most pages of a grid
void PageRequests::askCoarsest(std::span<const PageGrid> grids, std::uint32_t most)
{
    const auto fits = [&](const PageGrid& grid) {
        const PageRect rect = grid.pagesIn(grid.all(), coarsest_);
        const int limit = static_cast<int>(most);
        return rect.width() <= limit && rect.height() <= limit && rect.width() * rect.height() <= limit;
    };
    for (coarsest_ = grids.front().finestLevel(); coarsest_ < kCoarsestLevel; ++coarsest_)
        if (std::ranges::all_of(grids, fits)) break;
    for (const PageGrid& grid : grids) {
        const glm::dvec2 middle = 0.5 * (grid.all().low + grid.all().high);
        const PageRect rect = grid.pagesIn(fits(grid) ? grid.all() : PlaneRect{middle, middle}, coarsest_);
        for (int y = rect.low.y; y <= rect.high.y; ++y)
            for (int x = rect.low.x; x <= rect.high.x; ++x)
                pages_.push_back(keyOf(grid.page(coarsest_, x, y)));
    }
}

std::array<glm::dvec4, 2> PageRequests::Slice::ends(const ViewSolid& view, const PageGrid& grid) const
{
    return {view.pixel() - narrowest * grid.depth(), widest * grid.depth() - view.pixel()};
}

void PageRequests::cutSlices(const ViewSolid& view, const Aabb& casters, std::span<const PageGrid> grids)
{
    double narrowest = INFINITY, widest = 0.0;
    for (const Box& box : boxes_) {
        narrowest = std::min(narrowest, box.narrowest);
        widest = std::max(widest, box.widest);
    }
    constexpr int kMost = static_cast<int>(gpu::MAX_PAGE_LEVELS) - 1;
    const int nearest = boxes_.empty() ? coarsest_ : levelOfWidth(narrowest);
    first_ = std::clamp(nearest, std::max(grids.front().finestLevel(), coarsest_ - kMost), coarsest_);
    const int last =
        boxes_.empty() ? first_ : std::clamp(levelOfWidth(widest), first_, std::max(first_, coarsest_ - 1));
    used_ = static_cast<std::uint32_t>(last - first_ + 1);
    for (Slice& slice : used()) {
        slice.level = first_ + static_cast<int>(&slice - slices_.data());
        slice.pages.clear();
        slice.finer.clear();
        const double texel = std::ldexp(1.0, slice.level);
        slice.narrowest = slice.level == first_ ? 0.0 : texel * (1.0 - kOverlap);
        slice.widest = (slice.level == last ? widest : 2.0 * texel) * (1.0 + kOverlap);
        for (const PageGrid& grid : grids) {
            PlaneRect seen{glm::dvec2(INFINITY), glm::dvec2(-INFINITY)};
            forPlaces(view, grid, casters, view.nearest(), slice.ends(view, grid), [&](glm::dvec2 from, glm::dvec2) {
                seen = {glm::min(seen.low, from), glm::max(seen.high, from)};
            });
            // Or nothing.
            slice.seen[grid.face()] = seen.low.x <= seen.high.x ? seen.meet(grid.all()) : PlaneRect{};
        }
    }
}

void PageRequests::raiseSlices(std::span<const PageGrid> grids)
{
    const auto fits = [&](const Slice& slice, int raised) {
        return slice.level + raised >= coarsest_ || std::ranges::all_of(grids, [&](const PageGrid& grid) {
                   const PageRect rect = grid.pagesIn(slice.seen[grid.face()], slice.level + raised);
                   return std::max(rect.width(), rect.height()) <= kRows;
               });
    };
    int raised = 0;
    for (const Slice& slice : used())
        while (raised < static_cast<int>(gpu::MAX_PAGE_LEVELS) && !fits(slice, raised))
            ++raised;
    for (Slice& slice : used())
        slice.level += raised;
}

/// The pages of a face that its boxes ask for.
void PageRequests::markFace(const ViewSolid& view, const PageGrid& grid)
{
    for (Slice& slice : used()) {
        const PlaneRect& seen = slice.seen[grid.face()];
        const glm::dvec2 middle = 0.5 * (seen.low + seen.high);
        slice.corner = grid.pagesIn({middle, middle}, slice.level).low - kRows / 2;
        slice.rows.fill(0);
    }
    for (const Box& box : boxes_)
        if (box.grid == &grid) mark(box, view);
    for (Slice& slice : used())
        for (int row = 0; row < kRows; ++row)
            for (std::uint64_t bits = slice.rows[std::size_t(row)]; bits != 0; bits &= bits - 1)
                slice.pages.push_back(
                    keyOf(grid.page(slice.level, slice.corner.x + std::countr_zero(bits), slice.corner.y + row)));
}

void PageRequests::mark(const Box& box, const ViewSolid& view)
{
    const PageGrid& grid = *box.grid;
    const PlaneRect rect = grid.rectOf(box.bounds).meet(grid.all());
    if (!(rect.low.x <= rect.high.x && rect.low.y <= rect.high.y)) return;
    for (Slice& slice : used()) {
        if (slice.level >= coarsest_ || box.widest < slice.narrowest || box.narrowest > slice.widest) continue;
        const PageRect pages = grid.pagesIn(rect, slice.level);
        const glm::ivec2 low = pages.low - slice.corner, high = pages.high - slice.corner;
        if (pages.width() <= 2 && pages.height() <= 2) { // not worth a closer look
            for (int row = std::max(low.y, 0); row <= std::min(high.y, kRows - 1); ++row)
                slice.rows[std::size_t(row)] |= columns(low.x, high.x);
            continue;
        }
        RowRanges ranges;
        const glm::dvec2 zero = grid.cornerOf({slice.level, slice.corner.x, slice.corner.y});
        const double scale = 1.0 / grid.width(slice.level);
        forPlaces(view, grid, box.bounds, box.nearest, slice.ends(view, grid),
                  [&](glm::dvec2 from, glm::dvec2 to) { ranges.addEdge(scale * (from - zero), scale * (to - zero)); });
        const double texel = 1.0 / grid.texels(); // of slack for what was rounded
        for (int row = ranges.first; row <= ranges.last; ++row) {
            const double first = ranges.low[std::size_t(row)], last = ranges.high[std::size_t(row)];
            if (first <= last)
                slice.rows[std::size_t(row)] |=
                    columns(std::max(rowOf(first - texel), low.x), std::min(rowOf(last + texel), high.x));
        }
    }
}

void PageRequests::coarsen(Slice& slice) const
{
    ++slice.level;
    std::swap(slice.finer, slice.pages);
    slice.pages.clear();
    if (slice.level >= coarsest_) return;
    for (const PageKey key : slice.finer)
        slice.pages.push_back(keyOf(pageOf(key).parent()));
    std::sort(slice.pages.begin(), slice.pages.end());
    slice.pages.erase(std::unique(slice.pages.begin(), slice.pages.end()), slice.pages.end());
}

std::size_t PageRequests::askedAt(int level)
{
    if (level >= coarsest_) return 0;
    merged_.clear();
    for (const Slice& slice : used())
        if (slice.level == level) merged_.insert(merged_.end(), slice.pages.begin(), slice.pages.end());
    std::sort(merged_.begin(), merged_.end());
    return static_cast<std::size_t>(std::unique(merged_.begin(), merged_.end()) - merged_.begin());
}

/// Adds the pages of all slices.
void PageRequests::addTo(std::vector<PageKey>& pages)
{
    for (const Slice& slice : used())
        pages.insert(pages.end(), slice.pages.begin(), slice.pages.end());
    std::sort(pages.begin(), pages.end());
    pages.erase(std::unique(pages.begin(), pages.end()), pages.end());
}

void PageRequests::makeRoom(std::uint32_t capacity)
{
    std::size_t asked = wanted_.size();
    for (std::uint32_t step = 0; asked > capacity && step < gpu::MAX_PAGE_LEVELS; ++step) {
        for (std::uint32_t i = used_; i-- > 0 && asked > capacity;) {
            Slice& slice = slices_[i];
            if (slice.level >= coarsest_) continue;
            asked -= askedAt(slice.level) + askedAt(slice.level + 1);
            coarsen(slice);
            asked += askedAt(slice.level - 1) + askedAt(slice.level);
        }
    }
    for (Slice& slice : used()) { // what is left is for some of the finer pages; the coarser ones stay under them
        const std::size_t more = std::min(capacity - std::min<std::size_t>(asked, capacity), slice.finer.size());
        if (more == 0) continue;
        slice.pages.insert(slice.pages.end(), slice.finer.begin(), slice.finer.begin() + std::ptrdiff_t(more));
        --slice.level;
        asked += more;
    }
}

void PageRequests::ask(const ShadowTask& task, const Aabb& casters, std::span<const PageGrid> grids,
                       const Wanted& wanted)
{
    pages_.clear();
    boxes_.clear();
    // Of a point light each face has its share, seen or not, and counts its pages from a corner: a turn of the view
    // leaves their level.
    const bool cube = task.light->type == GN_LIGHT_TYPE_POINT;
    askCoarsest(grids, cube ? std::max(wanted.capacity / kCoarsestShare / mapLayers(task.light->type), 1u)
                            : std::max(wanted.capacity / kCoarsestShare, kLeastPages));
    const ViewSolid view(*task.view, wanted.density);
    for (const PageGrid& grid : grids)
        collectBoxes(task, view, grid);
    cutSlices(view, casters, grids);
    raiseSlices(grids);
    for (const PageGrid& grid : grids)
        markFace(view, grid);
    wanted_ = pages_;
    addTo(wanted_);
    makeRoom(wanted.capacity);
    addTo(pages_);
    withoutRoom_ = static_cast<std::uint32_t>(std::ranges::count_if(
        wanted_, [&](PageKey key) { return !std::binary_search(pages_.begin(), pages_.end(), key); }));
}

} // namespace gnomon
