#include "algorithms/volumes/volume_tree.hpp"

#include <algorithm>
#include <numeric>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace gnomon {

namespace {

constexpr std::uint32_t kLeafSize = 8; // boxes; testing one costs about what testing a node does
constexpr int kMostLevels = 12;        // a cell is then 1/4096 of the whole: boxes at one place stay together

std::uint32_t octant(glm::vec3 point, glm::vec3 middle)
{
    return (point.x >= middle.x ? 1u : 0u) | (point.y >= middle.y ? 2u : 0u) | (point.z >= middle.z ? 4u : 0u);
}

Aabb childCell(const Aabb& cell, std::uint32_t which)
{
    const glm::vec3 middle = cell.center();
    Aabb child = cell;
    for (int axis = 0; axis < 3; ++axis)
        ((which >> axis) & 1u ? child.lower : child.upper)[axis] = middle[axis];
    return child;
}

} // namespace

float VolumeTree::distanceSquared(const Aabb& box, glm::vec3 point)
{
    const glm::vec3 outside = glm::max(glm::max(box.lower - point, point - box.upper), glm::vec3(0.0f));
    return glm::dot(outside, outside);
}

void VolumeTree::build(std::span<const Aabb> boxes)
{
    boxes_.assign(boxes.begin(), boxes.end());
    items_.resize(boxes.size());
    std::iota(items_.begin(), items_.end(), 0u);
    nodes_.clear();
    if (boxes.empty()) return;
    const Aabb whole = std::accumulate(boxes.begin(), boxes.end(), boxes.front(), unionOf);
    buildNode(0, static_cast<std::uint32_t>(boxes.size()), whole, 0);
}

std::int32_t VolumeTree::buildNode(std::uint32_t first, std::uint32_t count, const Aabb& cell, int depth)
{
    const auto index = static_cast<std::int32_t>(nodes_.size());
    Node node{.bounds = boxes_[items_[first]], .children = {}, .first = first, .count = count};
    node.children.fill(-1);
    for (std::uint32_t i = first; i < first + count; ++i)
        node.bounds = unionOf(node.bounds, boxes_[items_[i]]);
    node.leaf = count <= kLeafSize || depth == kMostLevels;
    nodes_.push_back(node);
    if (node.leaf) return index;

    const glm::vec3 middle = cell.center();
    const auto begin = items_.begin() + first;
    std::stable_sort(begin, begin + count, [&](std::uint32_t a, std::uint32_t b) {
        return octant(boxes_[a].center(), middle) < octant(boxes_[b].center(), middle);
    });
    for (std::uint32_t from = first; from < first + count;) {
        const std::uint32_t which = octant(boxes_[items_[from]].center(), middle);
        std::uint32_t to = from;
        while (to < first + count && octant(boxes_[items_[to]].center(), middle) == which)
            ++to;
        const std::int32_t child = buildNode(from, to - from, childCell(cell, which), depth + 1);
        nodes_[static_cast<std::size_t>(index)].children[which] = child;
        from = to;
    }
    return index;
}

} // namespace gnomon
