#include "runtime/rays/triangle_tree.hpp"

#include <algorithm>
#include <limits>

#include <glm/common.hpp>

#include "runtime/rays/embree.hpp"

namespace gnomon {
namespace {

struct Box {
    glm::vec3 lower{std::numeric_limits<float>::infinity()}, upper{-std::numeric_limits<float>::infinity()};

    void add(glm::vec3 point)
    {
        lower = glm::min(lower, point);
        upper = glm::max(upper, point);
    }
    /// Half the surface.
    double area() const
    {
        const glm::dvec3 size = glm::dvec3(upper) - glm::dvec3(lower);
        return size.x * size.y + size.y * size.z + size.z * size.x;
    }
};

/// What the builder makes, in memory of its own, until flatten() has put it into arrays.
struct Made {
    Made* children[TriangleTree::kWidth] = {}; ///< None: a leaf.
    unsigned childCount = 0;
    unsigned triangleCount = 0;
    std::uint32_t triangles[TriangleTree::kLeafSize] = {};
};

void* makeNode(RTCThreadLocalAllocator allocator, unsigned, void*)
{
    return new (rtcThreadLocalAlloc(allocator, sizeof(Made), alignof(Made))) Made;
}

void* makeLeaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t count, void*)
{
    Made* leaf = new (rtcThreadLocalAlloc(allocator, sizeof(Made), alignof(Made))) Made;
    leaf->triangleCount = static_cast<unsigned>(count);
    for (std::size_t i = 0; i < count && i < TriangleTree::kLeafSize; ++i)
        leaf->triangles[i] = primitives[i].primID;
    return leaf;
}

void setChildren(void* node, void** children, unsigned count, void*)
{
    Made& made = *static_cast<Made*>(node);
    made.childCount = count;
    for (unsigned i = 0; i < count; ++i)
        made.children[i] = static_cast<Made*>(children[i]);
}

void ignoreBounds(void*, const RTCBounds**, unsigned, void*) {} // fit() makes them

std::vector<RTCBuildPrimitive> primitivesOf(std::span<const glm::vec3> positions,
                                            std::span<const std::uint32_t> indices)
{
    std::vector<RTCBuildPrimitive> primitives(indices.size() / 3);
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        Box box;
        for (std::size_t corner = 0; corner < 3; ++corner)
            box.add(positions[indices[3 * i + corner]]);
        primitives[i] = {.lower_x = box.lower.x,
                         .lower_y = box.lower.y,
                         .lower_z = box.lower.z,
                         .geomID = 0,
                         .upper_x = box.upper.x,
                         .upper_y = box.upper.y,
                         .upper_z = box.upper.z,
                         .primID = static_cast<unsigned>(i)};
    }
    return primitives;
}

/// The tree under `made` behind what is there. Returns how its parent calls it.
std::uint32_t flatten(const Made& made, std::vector<TriangleTree::Node>& nodes, std::vector<std::uint32_t>& triangles)
{
    if (made.childCount == 0) {
        const auto first = static_cast<std::uint32_t>(triangles.size());
        triangles.insert(triangles.end(), made.triangles, made.triangles + made.triangleCount);
        return TriangleTree::kLeafBit | first << 2 | (made.triangleCount - 1);
    }
    const std::size_t index = nodes.size();
    nodes.emplace_back();
    nodes[index].count = made.childCount;
    for (unsigned i = 0; i < made.childCount; ++i) {
        const std::uint32_t child = flatten(*made.children[i], nodes, triangles);
        nodes[index].child[i] = child;
    }
    return static_cast<std::uint32_t>(index);
}

bool leavesFit(const Made& made)
{
    if (made.childCount == 0) return made.triangleCount >= 1 && made.triangleCount <= TriangleTree::kLeafSize;
    return std::all_of(made.children, made.children + made.childCount,
                       [](const Made* child) { return leavesFit(*child); });
}

RTCBuildArguments argumentsFor(std::vector<RTCBuildPrimitive>& primitives, RTCBVH bvh)
{
    RTCBuildArguments arguments = rtcDefaultBuildArguments();
    arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
    arguments.maxBranchingFactor = TriangleTree::kWidth;
    arguments.maxLeafSize = TriangleTree::kLeafSize;
    arguments.bvh = bvh;
    arguments.primitives = primitives.data();
    arguments.primitiveCount = arguments.primitiveArrayCapacity = primitives.size();
    arguments.createNode = makeNode;
    arguments.setNodeChildren = setChildren;
    arguments.setNodeBounds = ignoreBounds;
    arguments.createLeaf = makeLeaf;
    return arguments;
}

} // namespace

std::shared_ptr<const TriangleTree> TriangleTree::build(RTCDeviceTy* device, std::span<const glm::vec3> positions,
                                                        std::span<const std::uint32_t> indices)
{
    if (!device || indices.empty() || indices.size() / 3 > (kLeafBit >> 2)) return nullptr;
    const EmbreeFloatMode mode;
    std::vector<RTCBuildPrimitive> primitives = primitivesOf(positions, indices);
    struct Release {
        void operator()(RTCBVH bvh) const { rtcReleaseBVH(bvh); }
    };
    const std::unique_ptr<std::remove_pointer_t<RTCBVH>, Release> bvh(rtcNewBVH(device));
    const RTCBuildArguments arguments = argumentsFor(primitives, bvh.get());
    const Made* made = nullptr;
    buildHere([&] { made = static_cast<const Made*>(rtcBuildBVH(&arguments)); });
    if (!made || !leavesFit(*made)) return nullptr;

    auto tree = std::make_shared<TriangleTree>();
    tree->triangles_.reserve(primitives.size());
    const std::uint32_t root = flatten(*made, tree->nodes_, tree->triangles_);
    if (isLeaf(root)) {
        tree->nodes_.push_back({});
        tree->nodes_[0].count = 1;
        tree->nodes_[0].child[0] = root;
    }
    tree->nodes_.shrink_to_fit();
    tree->fit(positions, indices);
    tree->spreadBuilt_ = tree->spread_;
    return tree;
}

std::shared_ptr<const TriangleTree> TriangleTree::refitted(std::span<const glm::vec3> positions,
                                                           std::span<const std::uint32_t> indices) const
{
    auto tree = std::make_shared<TriangleTree>(*this);
    tree->fit(positions, indices);
    return tree;
}

void TriangleTree::fit(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices)
{
    double area = 0.0, rootArea = 0.0;
    for (std::size_t index = nodes_.size(); index-- > 0;) {
        Node& node = nodes_[index];
        Box all;
        for (std::uint32_t i = 0; i < kWidth; ++i) {
            Box box;
            if (i >= node.count) {
                node.child[i] = kLeafBit;
            } else if (isLeaf(node.child[i])) {
                for (const std::uint32_t triangle : leaf(node.child[i]))
                    for (std::size_t corner = 0; corner < 3; ++corner)
                        box.add(positions[indices[3 * std::size_t(triangle) + corner]]);
            } else {
                const Node& below = nodes_[node.child[i]];
                for (std::uint32_t k = 0; k < below.count; ++k) {
                    box.add({below.lower[0][k], below.lower[1][k], below.lower[2][k]});
                    box.add({below.upper[0][k], below.upper[1][k], below.upper[2][k]});
                }
            }
            for (int axis = 0; axis < 3; ++axis) {
                node.lower[axis][i] = i < node.count ? box.lower[axis] : 0.0f;
                node.upper[axis][i] = i < node.count ? box.upper[axis] : 0.0f;
            }
            if (i >= node.count) continue;
            area += box.area();
            all.add(box.lower);
            all.add(box.upper);
        }
        rootArea = all.area(); // the root comes last
    }
    spread_ = rootArea > 0.0 ? area / rootArea : 0.0;
}

std::size_t TriangleTree::memoryBytes() const noexcept
{
    return nodes_.capacity() * sizeof(Node) + triangles_.capacity() * sizeof(std::uint32_t);
}

} // namespace gnomon
