#include "algorithms/hybrid/tile_search.hpp"

#include <algorithm>
#include <bit>
#include <optional>

namespace gnomon {

using namespace lanes;

namespace {

// Nodes that a tile keeps before it stops descending and lets its quarters go on.
constexpr std::size_t kItemBudget = 16;
// Volumes that a tile may make, and triangles it may look at for them. Sixteen pixels against one volume take about 30
// cycles, making it about 100, sixteen rays took 1 300 to 2 500 (Zen 4) when larger limits left fewer rays and took
// longer; since rays go in packets, half and a quarter of these could not be told apart.
constexpr std::size_t kVolumes = 32;
constexpr std::size_t kTriangles = 64;
// Blocks of the smallest tile that is asked for its triangles: what is too many for 32x32 pixels is mostly too many for
// its quarters. Asking those leaves a third to four fifths of the rays, and the search takes 2 to 20 % longer than with
// tracing them all (six shipped scenes, tile_shafts.md).
constexpr std::uint32_t kSmallest = 64;
// Lists on top of each other, one a size of tile, of at most the budget or what the root started with.
constexpr std::size_t kItemMemory = 4096;
// At most this many volumes are asked by pixels at once rather than by tiles first: making a hull costs as much.
constexpr std::size_t kFew = 3;
constexpr std::uint32_t kLoose = UINT32_MAX; // an item's node: the caster has no tree

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
    std::uint32_t bits = 0;
    for (std::uint32_t i = 0; i < node.count; ++i)
        bits |= TriangleTree::isLeaf(node.child[i]) ? 0u : 1u << i;
    return bits;
}

/// Which triangles visitTriangles() passes on.
struct Touching {
    static std::uint32_t boxes(const MeshShaft& /*shaft*/, const TriangleTree::Node& /*node*/) { return ~0u; }
    static bool triangle(const MeshShaft& /*shaft*/, glm::vec3 /*a*/, glm::vec3 /*b*/, glm::vec3 /*c*/) { return true; }
};

struct Spanning {
    static std::uint32_t boxes(const MeshShaft& shaft, const TriangleTree::Node& node) { return shaft.spannedBy(node); }
    static bool triangle(const MeshShaft& shaft, glm::vec3 a, glm::vec3 b, glm::vec3 c)
    {
        return shaft.spannedBy(a, b, c);
    }
};

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
      planes_(arena.array<ShadowPlanes>(kVolumes)), lists_(arena.array<const ShadowPlanes*>(8 * kVolumes))
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
        for (std::uint32_t bits = world.touches(four); bits != 0; bits &= bits - 1) {
            const std::uint32_t caster = four.child[std::countr_zero(bits)];
            const TriangleTree* tree = scene_.casters[caster].tree;
            push({.caster = caster, .node = tree ? 0 : kLoose, .mask = tree ? (1u << tree->nodes()[0].count) - 1u : 0});
        }
    }
    return items_.subspan(first, itemCount_ - first);
}

/// Goes down from an item until leaves are reached or the list is long.
void TileSearch::walk(const ShaftCaster& caster, const MeshShaft& shaft, Item item, std::size_t limit)
{
    const std::span<const TriangleTree::Node> nodes = caster.tree->nodes();
    Item open[64];
    std::size_t count = 0;
    open[count++] = item;
    while (count > 0) {
        Item next = open[--count];
        const TriangleTree::Node& node = nodes[next.node];
        next.mask &= shaft.touches(node);
        const std::uint32_t inner = next.mask & innerBits(node);
        if (inner != 0 && itemCount_ + count < limit && count + 4 <= std::size(open)) {
            for (std::uint32_t bits = inner; bits != 0; bits &= bits - 1) {
                const std::uint32_t child = node.child[std::countr_zero(bits)];
                open[count++] = {.caster = next.caster, .node = child, .mask = (1u << nodes[child].count) - 1u};
            }
            next.mask &= ~inner;
        }
        if (next.mask != 0 && !push(next)) return;
    }
}

/// What of the items touches the shaft. @param leaves set where nothing is left but leaves
std::span<const TileSearch::Item> TileSearch::narrowed(std::span<const Item> items, const Shaft& shaft, bool& leaves)
{
    const std::size_t first = itemCount_;
    for (std::size_t i = 0; i < items.size();) {
        const std::uint32_t index = items[i].caster;
        const ShaftCaster& caster = scene_.casters[index];
        const MeshShaft here = meshShaft(shaft, caster);
        for (; i < items.size() && items[i].caster == index; ++i) {
            if (items[i].node == kLoose)
                push(items[i]);
            else
                walk(caster, here, items[i], first + kItemBudget);
        }
    }
    const std::span<const Item> left = items_.subspan(first, itemCount_ - first);
    leaves = std::all_of(left.begin(), left.end(), [&](const Item& item) {
        if (item.node == kLoose) return false;
        return (innerBits(scene_.casters[item.caster].tree->nodes()[item.node]) & item.mask) == 0;
    });
    return left;
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

/// Calls visit(maker, a, b, c) for the triangles in the items' leaves that are `Wanted` and touch the shaft, until it
/// returns false. Children that are nodes are passed over.
template <typename Wanted, typename Visit>
void TileSearch::visitTriangles(std::span<const Item> items, const Hull& hull, const Shaft& shaft, Visit visit) const
{
    for (std::size_t i = 0; i < items.size();) {
        const std::uint32_t index = items[i].caster;
        const ShaftCaster& caster = scene_.casters[index];
        const MeshShaft here = meshShaft(shaft, caster);
        std::optional<ShadowMaker> made;
        for (; i < items.size() && items[i].caster == index; ++i) {
            if (items[i].node == kLoose) continue;
            const TriangleTree::Node& node = caster.tree->nodes()[items[i].node];
            const std::uint32_t leaves = items[i].mask & ~innerBits(node) & Wanted::boxes(here, node);
            if (leaves == 0) continue;
            const ShadowMaker& maker = made ? *made : made.emplace(scene_.light, hull, caster);
            for (std::uint32_t bits = leaves; bits != 0; bits &= bits - 1) {
                for (const std::uint32_t triangle : caster.tree->leaf(node.child[std::countr_zero(bits)])) {
                    const std::uint32_t* corner = caster.mesh->indices.data() + 3 * std::size_t(triangle);
                    const glm::vec3* at = caster.mesh->positions.data();
                    const glm::vec3 a = at[corner[0]], b = at[corner[1]], c = at[corner[2]];
                    if (Wanted::triangle(here, a, b, c) && here.touches(a, b, c) && !visit(maker, a, b, c)) return;
                }
            }
        }
    }
}

/// Shadow volumes of what the leaves hold, as far as they meet the hull.
TileSearch::Found TileSearch::volumesOf(std::span<const Item> items, const Hull& hull, const Shaft& shaft,
                                        Volumes& volumes)
{
    volumes.centre = hull.centre;
    std::size_t made = 0;
    Found found = Found::volumes;
    ShadowPlanes spare;
    visitTriangles<Touching>(items, hull, shaft, [&](const ShadowMaker& maker, glm::vec3 a, glm::vec3 b, glm::vec3 c) {
        const Shadowing shadowing = maker.make(a, b, c, made < kVolumes ? planes_[made] : spare);
        if (shadowing == Shadowing::all) found = Found::covered;
        if (shadowing == Shadowing::some && ++made > kVolumes) found = Found::tooMany;
        return found == Found::volumes;
    });
    listCount_ = 0;
    for (std::size_t i = 0; i < std::min(made, kVolumes); ++i)
        lists_[listCount_++] = &planes_[i];
    volumes.list = lists_.first(listCount_);
    return found;
}

/// Whether one of the triangles that were reached already hides the light from the whole hull: a wall, among much else.
bool TileSearch::coveredByOne(std::span<const Item> items, const Hull& hull, const Shaft& shaft) const
{
    std::size_t left = kTriangles;
    bool covered = false;
    ShadowPlanes scratch;
    visitTriangles<Spanning>(items, hull, shaft, [&](const ShadowMaker& maker, glm::vec3 a, glm::vec3 b, glm::vec3 c) {
        covered = maker.make(a, b, c, scratch) == Shadowing::all;
        return !covered && --left > 0;
    });
    return covered;
}

bool TileSearch::hullAround(Tile tile, Hull& hull) const
{
    if (answers_->knownHull(tile.first, tile.count, hull)) return true;
    answers_->wanted(tile.first, tile.count);
    return hullOf(*scene_.kernels, &blocks_[tile.first], tile.count, scene_.row, hull);
}

void TileSearch::traceAll(Tile tile)
{
    answers_->wanted(tile.first, tile.count);
    std::uint32_t state[kLanes];
    std::fill_n(state, kLanes, kUnsure);
    for (std::uint32_t i = tile.first; i < tile.first + tile.count; ++i)
        if (blocks_[i].rays != 0) answers_->lanes(i, state);
}

void TileSearch::searchBlock(std::uint32_t block, const Volumes& volumes)
{
    if (volumes.list.empty()) return;
    answers_->wanted(block, 1);
    if (blocks_[block].rays == 0) return;
    const glm::vec3 rounded(volumes.centre);
    const float centre[3] = {rounded.x, rounded.y, rounded.z};
    std::uint32_t state[kLanes];
    scene_.kernels->classify(blocks_[block], centre, volumes.list.data(),
                             static_cast<std::uint32_t>(volumes.list.size()), state);
    answers_->lanes(block, state);
}

void TileSearch::searchVolumes(Tile tile, const Volumes& above)
{
    if (tile.count == 1 || above.list.size() <= kFew) {
        for (std::uint32_t i = tile.first; i < tile.first + tile.count; ++i)
            searchBlock(i, above);
        return;
    }
    Hull hull;
    if (!hullAround(tile, hull)) return; // nobody asks
    const FlatHull flat(hull, above.centre);
    const std::size_t first = listCount_;
    for (const ShadowPlanes* volume : above.list) {
        const Shadowing shadowing = flat.under(*volume);
        if (shadowing == Shadowing::all) {
            answers_->dark(tile.first, tile.count);
            listCount_ = first;
            return;
        }
        if (shadowing == Shadowing::some) lists_[listCount_++] = volume;
    }
    const Volumes here{.centre = above.centre, .list = lists_.subspan(first, listCount_ - first)};
    if (!here.list.empty()) {
        const std::uint32_t quarter = tile.count / 4;
        for (std::uint32_t i = 0; i < 4; ++i)
            searchVolumes({.first = tile.first + i * quarter, .count = quarter}, here);
    }
    listCount_ = first;
}

void TileSearch::search(Tile tile, std::span<const Item> items)
{
    const bool root = tile.count == blocks_.size();
    Hull hull;
    if (!hullAround(tile, hull)) {
        traceAll(tile); // some start nowhere; or nobody asks
        return;
    }
    const std::size_t saved = itemCount_;
    const Shaft shaft = shaftOf(scene_.light, hull);
    if (root) items = roots(shaft);
    bool leaves = false;
    const std::span<const Item> left = narrowed(items, shaft, leaves);
    if (overflow_) {
        overflow_ = false;
        traceAll(tile);
    } else if (!left.empty()) {
        Volumes volumes;
        const Found found =
            leaves && trianglesIn(left) <= kTriangles ? volumesOf(left, hull, shaft, volumes) : Found::tooMany;
        if (found == Found::covered || (found == Found::tooMany && coveredByOne(left, hull, shaft)))
            answers_->dark(tile.first, tile.count);
        else if (found == Found::volumes)
            searchVolumes(tile, volumes);
        else if (tile.count <= kSmallest)
            traceAll(tile);
        else
            for (std::uint32_t i = 0; i < 4; ++i)
                search({.first = tile.first + i * (tile.count / 4), .count = tile.count / 4}, left);
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
