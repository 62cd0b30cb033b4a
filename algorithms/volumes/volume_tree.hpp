#pragma once
// An octree over the bounds of casters that stand still, visited from the eye outwards. Plain CPU code without Vulkan.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/scene/scene_view.hpp"

namespace gnomon {

class VolumeTree {
public:
    struct Node {
        Aabb bounds;                          ///< Of everything in it; not the cell.
        std::array<std::int32_t, 8> children; ///< Index of a node, or -1.
        std::uint32_t first = 0, count = 0;   ///< Into `items`, of this node and all below it.
        bool leaf = true;
    };

    void build(std::span<const Aabb> boxes);

    /// Calls emit(index of the box) front to back as seen from the eye, leaving out boxes and whole branches whose
    /// bounds `wanted(Aabb)` refuses. `wanted` must be true of a box if it is true of anything inside.
    template <typename Wanted, typename Emit>
    void visit(glm::vec3 eye, const Wanted& wanted, const Emit& emit) const
    {
        if (!nodes_.empty()) visitNode(0, eye, wanted, emit);
    }

    std::span<const Node> nodes() const { return nodes_; }
    std::span<const std::uint32_t> items() const { return items_; }

private:
    static float distanceSquared(const Aabb& box, glm::vec3 point);

    template <typename Wanted, typename Emit>
    void visitNode(std::uint32_t index, glm::vec3 eye, const Wanted& wanted, const Emit& emit) const;

    std::int32_t buildNode(std::uint32_t first, std::uint32_t count, const Aabb& cell, int depth);

    std::vector<Node> nodes_;
    std::vector<std::uint32_t> items_;
    std::vector<Aabb> boxes_;
};

template <typename Wanted, typename Emit>
void VolumeTree::visitNode(std::uint32_t index, glm::vec3 eye, const Wanted& wanted, const Emit& emit) const
{
    const Node& node = nodes_[index];
    if (!wanted(node.bounds)) return;
    struct Step {
        float distance;
        std::uint32_t target;
    };
    std::array<Step, 8> steps; // a leaf has at most as many items as a node has children
    std::uint32_t count = 0;
    if (node.leaf) {
        for (const std::uint32_t item : items().subspan(node.first, node.count))
            if (node.count == 1 || wanted(boxes_[item])) {
                if (count == steps.size()) { // identical boxes, more than a leaf's worth: in the order they have
                    emit(item);
                    continue;
                }
                steps[count++] = {distanceSquared(boxes_[item], eye), item};
            }
    } else {
        for (const std::int32_t child : node.children)
            if (child >= 0)
                steps[count++] = {distanceSquared(nodes_[static_cast<std::uint32_t>(child)].bounds, eye),
                                  static_cast<std::uint32_t>(child)};
    }
    for (std::uint32_t i = 1; i < count; ++i) // eight at most: by insertion, equal ones stay in order
        for (std::uint32_t j = i; j > 0 && steps[j].distance < steps[j - 1].distance; --j)
            std::swap(steps[j], steps[j - 1]);
    for (std::uint32_t i = 0; i < count; ++i) {
        if (node.leaf)
            emit(steps[i].target);
        else
            visitNode(steps[i].target, eye, wanted, emit);
    }
}

} // namespace gnomon
