#include "algorithms/hybrid/tile_search.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

namespace gnomon {

using namespace simd;

namespace {

// Nodes that a tile keeps before it stops descending, and triangles that it makes volumes of, sixteen at once. Half and
// twice as much could not be told apart in four scenes.
constexpr std::size_t kItemBudget = 256;
constexpr std::size_t kTriangles = 1024;
// Where few pixels of a tile ask, their rays cost less than so many volumes for each.
constexpr std::size_t kTrianglesARay = 2;
// Blocks of volumes that a tile may have; casters do not share one.
constexpr std::size_t kVolumes = 128;
// Nodes whose triangles are asked whether one of them hides the light.
constexpr std::size_t kSpanning = 64;
// Blocks of the smallest tile that is asked for its triangles: what is too much for 32x32 pixels is mostly too much for
// its quarters. Asking those leaves half of the rays, and the search takes 2 to 23 % longer in three of four scenes
// (demo/theses/measurements/2026-11-rays.md).
constexpr std::uint32_t kSmallest = 64;
// Lists on top of each other, one a size of tile, of at most the budget or what the root started with.
constexpr std::size_t kItemMemory = 4096;
// Blocks of the smallest square whose hull tells sooner than its pixels what may be shadowed in it.
constexpr std::uint32_t kKnownHulls = 16;
constexpr std::uint32_t kLoose = UINT32_MAX; // an item's node: the caster has no tree
constexpr std::uint32_t kBeside = 1u << 31;  // in the mask of a caster: its bounds do not reach across the shaft

/// What the ray tracer may be wrong by where the shaft meets the caster: errors of distances are smaller for what is
/// closer, but for planes that meet boxes anywhere this is all there is.
glm::dvec3 roundingOf(const Shaft& shaft, const CasterReach& caster)
{
    return 2.0 * caster.rounding(caster.reach + shaft.largest);
}

MeshShaft meshShaft(const Shaft& shaft, const ShaftCaster& caster)
{
    return MeshShaft(shaft, &caster, roundingOf(shaft, caster), caster.meshReach);
}

/// Bits of children that are nodes.
std::uint32_t innerBits(const TriangleTree::Node& node)
{
    Int4 children;
    static_assert(sizeof children == sizeof node.child && TriangleTree::kLeafBit == 1u << 31);
    std::memcpy(&children, node.child, sizeof children);
    return ~bitsOf(children) & ((1u << node.count) - 1u); // signs
}

FrameBounds together(const FrameBounds& a, const FrameBounds& b)
{
    FrameBounds both;
    for (int k = 0; k < 3; ++k) {
        both.lower[k] = std::min(a.lower[k], b.lower[k]);
        both.upper[k] = std::max(a.upper[k], b.upper[k]);
    }
    return both;
}

} // namespace

ShaftScene::ShaftScene(const Kernels& width, const LightView& view, std::span<const Caster* const> all,
                       glm::vec3 rowDirection, FrameArena& arena)
    : light(view), kernels(&width), row(rowDirection)
{
    const std::span<ShaftCaster> list = arena.array<ShaftCaster>(all.size());
    const std::span<TriangleTree::Node> nodes = arena.array<TriangleTree::Node>(all.size() / 4 + 1);
    std::uint32_t count = 0;
    for (const Caster* caster : all) {
        if (!castsRays(*caster)) continue; // left out as rays leave it out
        const ShaftCaster& here = *new (&list[count]) ShaftCaster(*caster);
        for (int i = 0; i < 3; ++i)
            largest.spread[i] = glm::max(largest.spread[i], here.spread[i]);
        largest.reach = glm::max(largest.reach, here.reach);
        largest.translation = glm::max(largest.translation, glm::abs(here.translation));
        TriangleTree::Node& node = nodes[count / 4];
        if (count % 4 == 0) node = {};
        for (int axis = 0; axis < 3; ++axis) {
            node.lower[axis][count % 4] = caster->bounds.lower[axis];
            node.upper[axis][count % 4] = caster->bounds.upper[axis];
        }
        node.child[count % 4] = count;
        node.count = count % 4 + 1;
        ++count;
    }
    casters = list.first(count);
    boxes = nodes.first((count + 3) / 4);
}

TileSearch::TileSearch(const ShaftScene& scene, FrameArena& arena)
    : scene_(scene), items_(arena.array<Item>(std::max(kItemMemory, 6 * scene.casters.size()))),
      volumes_(arena.array<ShadowVolumes>(kVolumes)), lists_(arena.array<VolumeBits>(6 * kVolumes)),
      bounds_(arena.array<FrameBounds>(std::size(bounded_) * 64))
{
}

bool TileSearch::push(const Item& item)
{
    if (itemCount_ == items_.size()) {
        overflow_ = true;
        return false;
    }
    items_[itemCount_++] = item;
    return true;
}

/// The casters whose bounds the shaft touches.
std::span<const TileSearch::Item> TileSearch::roots(const Shaft& shaft)
{
    const std::size_t first = itemCount_;
    const MeshShaft world(shaft, nullptr, roundingOf(shaft, scene_.largest),
                          glm::vec3(scene_.largest.reach) * (1.0f + 1e-6f));
    for (const TriangleTree::Node& four : scene_.boxes) {
        std::uint32_t bits = world.touches(four);
        const std::uint32_t across = bits == 0 ? 0 : world.spannedBy(four);
        for (; bits != 0; bits &= bits - 1) {
            const int box = std::countr_zero(bits);
            const std::uint32_t caster = four.child[box];
            const TriangleTree* tree = scene_.casters[caster].tree;
            const std::uint32_t all = tree ? (1u << tree->nodes()[0].count) - 1u : 0;
            push({.caster = caster, .node = tree ? 0 : kLoose, .mask = all | ((across >> box & 1) != 0 ? 0 : kBeside)});
        }
    }
    return items_.subspan(first, itemCount_ - first);
}

/// Goes down from an item until leaves are reached or the list is long; with `Across`, to what reaches across the
/// shaft.
/// @return whether nothing is left but leaves
template <bool Across>
bool TileSearch::walk(const ShaftCaster& caster, const MeshShaft& shaft, Item item, std::size_t limit)
{
    const std::span<const TriangleTree::Node> nodes = caster.tree->nodes();
    Item open[64];
    std::size_t count = 0;
    bool leaves = true;
    open[count++] = item;
    while (count > 0) {
        Item next = open[--count];
        const TriangleTree::Node& node = nodes[next.node];
        next.mask &= shaft.touches(node);
        if (Across && next.mask != 0) next.mask &= shaft.spannedBy(node);
        const std::uint32_t inner = next.mask & innerBits(node);
        if (inner != 0 && itemCount_ + count < limit && count + 4 <= std::size(open)) {
            for (std::uint32_t bits = inner; bits != 0; bits &= bits - 1) {
                const std::uint32_t child = node.child[std::countr_zero(bits)];
                open[count++] = {.caster = next.caster, .node = child, .mask = (1u << nodes[child].count) - 1u};
            }
            next.mask &= ~inner;
        } else {
            leaves = leaves && inner == 0;
        }
        if (next.mask != 0 && !push(next)) return false;
    }
    return leaves;
}

/// What of the items touches the shaft. @param leaves set where nothing is left but leaves
std::span<const TileSearch::Item> TileSearch::narrowed(std::span<const Item> items, const Shaft& shaft, bool& leaves)
{
    const std::size_t first = itemCount_;
    leaves = true;
    for (std::size_t i = 0; i < items.size();) {
        const std::uint32_t index = items[i].caster;
        const ShaftCaster& caster = scene_.casters[index];
        const MeshShaft here = meshShaft(shaft, caster);
        for (; i < items.size() && items[i].caster == index; ++i) {
            if (items[i].node == kLoose) {
                push(items[i]);
                leaves = false;
            } else if (!walk<false>(caster, here, items[i], first + kItemBudget)) {
                leaves = false;
            }
        }
    }
    return items_.subspan(first, itemCount_ - first);
}

std::size_t TileSearch::trianglesIn(std::span<const Item> leaves) const
{
    std::size_t count = 0;
    for (const Item& item : leaves) {
        const TriangleTree& tree = *scene_.casters[item.caster].tree;
        for (std::uint32_t bits = item.mask; bits != 0; bits &= bits - 1)
            count += tree.leaf(tree.nodes()[item.node].child[std::countr_zero(bits)]).size();
    }
    return count;
}

/// Calls take(look, corners, lanes) for the triangles in the items' leaves, up to sixteen of one caster at a time,
/// until it returns false. Children that are nodes are passed over.
template <typename Take>
void TileSearch::inSixteens(std::span<const Item> items, const Hull& hull, Take take) const
{
    Corners corners{};
    for (std::size_t i = 0; i < items.size();) {
        const std::uint32_t index = items[i].caster;
        const ShaftCaster& caster = scene_.casters[index];
        const TriangleLookup look = lookOf(scene_.light, hull, frame_, caster);
        std::uint32_t filled = 0;
        for (; i < items.size() && items[i].caster == index; ++i) {
            if (items[i].node == kLoose) continue;
            const TriangleTree::Node& node = caster.tree->nodes()[items[i].node];
            for (std::uint32_t leaves = items[i].mask & ~innerBits(node); leaves != 0; leaves &= leaves - 1) {
                for (const std::uint32_t triangle : caster.tree->leaf(node.child[std::countr_zero(leaves)])) {
                    const std::uint32_t* corner = caster.mesh->indices.data() + 3 * std::size_t(triangle);
                    const glm::vec3* at = caster.mesh->positions.data();
                    for (int k = 0; k < 3; ++k)
                        for (int axis = 0; axis < 3; ++axis)
                            corners.at[k][axis][filled] = at[corner[k]][axis];
                    if (++filled < kLanes) continue;
                    filled = 0;
                    if (!take(look, corners, (1u << kLanes) - 1u)) return;
                }
            }
        }
        if (filled != 0 && !take(look, corners, (1u << filled) - 1u)) return;
    }
}

/// Makes the volumes of what the leaves hold, as far as they meet the hull, and lists them.
TileSearch::Found TileSearch::volumesOf(std::span<const Item> items, const Hull& hull)
{
    Found found = Found::volumes;
    listCount_ = 0;
    inSixteens(items, hull, [&](const TriangleLookup& look, const Corners& corners, std::uint32_t lanes) {
        if (listCount_ == kVolumes) {
            found = Found::tooMany;
            return false;
        }
        std::uint32_t covering = 0;
        const std::uint32_t bits = scene_.kernels->volumes(look, corners, lanes, volumes_[listCount_], covering);
        if (covering != 0) found = Found::covered;
        if (bits != 0) {
            lists_[listCount_] = {static_cast<std::uint16_t>(listCount_), static_cast<std::uint16_t>(bits)};
            ++listCount_;
        }
        return found == Found::volumes;
    });
    return found;
}

/// Whether one triangle hides the light from the whole hull: a wall. Only boxes that reach across the shaft can hold
/// it.
bool TileSearch::hiddenByOne(std::span<const Item> items, const Hull& hull, const Shaft& shaft)
{
    const std::size_t first = itemCount_;
    for (std::size_t i = 0; i < items.size();) {
        const std::uint32_t index = items[i].caster;
        const ShaftCaster& caster = scene_.casters[index];
        if (items[i].node == kLoose || (items[i].mask & kBeside) != 0) {
            ++i;
            continue;
        }
        const MeshShaft here = meshShaft(shaft, caster);
        for (; i < items.size() && items[i].caster == index; ++i)
            walk<true>(caster, here, items[i], first + kSpanning);
    }
    std::uint32_t covering = 0;
    ShadowVolumes scratch;
    inSixteens(items_.subspan(first, itemCount_ - first), hull,
               [&](const TriangleLookup& look, const Corners& corners, std::uint32_t lanes) {
                   scene_.kernels->volumes(look, corners, lanes, scratch, covering);
                   return covering == 0;
               });
    itemCount_ = first;
    overflow_ = false; // a wall may have been missed, that is all
    return covering != 0;
}

bool TileSearch::hullAround(Tile tile, Hull& hull, std::size_t& rays) const
{
    rays = std::size_t(tile.count) * kLanes;
    if (answers_->knownHull(tile.first, tile.count, hull)) return true;
    answers_->wanted(tile.first, tile.count);
    rays = 0;
    for (std::uint32_t i = tile.first; i < tile.first + tile.count; ++i)
        rays += blocks_[i].rays;
    return hullOf(*scene_.kernels, &blocks_[tile.first], tile.count, scene_.row, hull);
}

void TileSearch::traceAll(Tile tile)
{
    answers_->wanted(tile.first, tile.count);
    for (std::uint32_t i = tile.first; i < tile.first + tile.count; ++i)
        if (blocks_[i].rays != 0) answers_->lanes(i, {.inside = 0, .unsure = (1u << kLanes) - 1u});
}

/// Where the rays of a part of the tile start, as the light sees it; nowhere, where none asks.
FrameBounds TileSearch::boundsOf(Tile part)
{
    Hull hull;
    if (part.count >= kKnownHulls && answers_->knownHull(part.first, part.count, hull)) return boundsIn(frame_, hull);
    constexpr float infinity = std::numeric_limits<float>::infinity();
    FrameBounds all{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    answers_->wanted(part.first, part.count);
    for (std::uint32_t i = part.first; i < part.first + part.count; ++i) {
        if (blocks_[i].rays == 0) continue;
        if ((bounded_[i / 64] >> i % 64 & 1) == 0) {
            bounded_[i / 64] |= std::uint64_t{1} << i % 64;
            scene_.kernels->spanned(frame_, blocks_[i], bounds_[i]);
        }
        all = together(all, bounds_[i]);
    }
    return all;
}

void TileSearch::searchVolumes(Tile tile, VolumeList above)
{
    const std::uint32_t quarter = tile.count / 4;
    for (std::uint32_t i = 0; i < 4; ++i) {
        const Tile part{.first = tile.first + i * quarter, .count = quarter};
        VolumeBits* const here = &lists_[listCount_];
        const std::uint32_t count = scene_.kernels->meeting(
            volumes_.data(), above.data(), static_cast<std::uint32_t>(above.size()), boundsOf(part), here);
        if (count == 0) continue;
        if (quarter == 1) {
            answers_->lanes(part.first,
                            scene_.kernels->classify(frame_, blocks_[part.first], volumes_.data(), here, count));
            continue;
        }
        listCount_ += count;
        searchVolumes(part, {here, count});
        listCount_ -= count;
    }
}

/// What the volumes of triangles that were reached say, or else rays; or else the tile's quarters.
void TileSearch::decide(Tile tile, std::size_t rays, const Hull& hull, std::span<const Item> items, bool leaves)
{
    const bool few = leaves && trianglesIn(items) <= std::min(kTriangles, kTrianglesARay * rays);
    const Found found = few ? volumesOf(items, hull) : Found::tooMany;
    if (found == Found::covered) {
        answers_->dark(tile.first, tile.count);
    } else if (found == Found::tooMany) {
        if (tile.count <= kSmallest)
            traceAll(tile);
        else
            for (std::uint32_t i = 0; i < 4; ++i)
                search({.first = tile.first + i * (tile.count / 4), .count = tile.count / 4}, items);
    } else if (listCount_ != 0) {
        std::fill(std::begin(bounded_), std::end(bounded_), 0);
        const VolumeList list = lists_.first(listCount_);
        if (tile.count > 1)
            searchVolumes(tile, list);
        else
            answers_->lanes(tile.first, scene_.kernels->classify(frame_, blocks_[tile.first], volumes_.data(),
                                                                 list.data(), static_cast<std::uint32_t>(list.size())));
    }
}

void TileSearch::search(Tile tile, std::span<const Item> items)
{
    const bool root = tile.count == blocks_.size();
    Hull hull;
    std::size_t rays = 0;
    if (!hullAround(tile, hull, rays) || !frameOf(scene_.light, hull, frame_)) {
        traceAll(tile); // some start nowhere, or nobody asks, or the light is among them
        return;
    }
    const std::size_t saved = itemCount_;
    const Shaft shaft = shaftOf(scene_.light, hull);
    if (root) items = roots(shaft);
    if (!overflow_ && hiddenByOne(items, hull, shaft)) {
        answers_->dark(tile.first, tile.count);
        itemCount_ = saved;
        return;
    }
    bool leaves = false;
    const std::span<const Item> left = narrowed(items, shaft, leaves);
    if (overflow_) {
        overflow_ = false;
        traceAll(tile);
    } else if (!left.empty()) {
        decide(tile, rays, hull, left, leaves);
    }
    itemCount_ = saved;
}

void TileSearch::run(std::span<const Block> blocks, TileAnswers& answers)
{
    blocks_ = blocks;
    answers_ = &answers;
    itemCount_ = 0;
    search({.first = 0, .count = static_cast<std::uint32_t>(blocks.size())}, {});
}

} // namespace gnomon
