#pragma once
// A mesh's triangles in a tree of boxes that may be walked by whoever asks for more than rays: in mesh space, shared by
// all instances. Embree's own builder makes it; Embree's own trees cannot be looked into.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

struct RTCDeviceTy; // Embree's

namespace gnomon {

class TriangleTree {
public:
    static constexpr std::uint32_t kWidth = 4;    ///< Children a node; the floats of the narrowest vector register.
    static constexpr std::uint32_t kLeafSize = 4; ///< Triangles a leaf holds at most.
    static constexpr std::uint32_t kLeafBit = 1u << 31;

    /// Boxes of the children, and what they are: a node's index, or kLeafBit | first << 2 | count - 1, `first` into
    /// triangles(). The children in use come first.
    struct Node {
        float lower[3][kWidth], upper[3][kWidth];
        std::uint32_t child[kWidth];
        std::uint32_t count;
    };

    static bool isLeaf(std::uint32_t child) { return (child & kLeafBit) != 0; }
    /// The triangles of a leaf, as numbers of the mesh's triangles.
    std::span<const std::uint32_t> leaf(std::uint32_t child) const
    {
        return std::span(triangles_).subspan((child & ~kLeafBit) >> 2, (child & 3u) + 1);
    }
    /// Children stand behind their parents; the first is the root.
    std::span<const Node> nodes() const { return nodes_; }
    std::span<const std::uint32_t> triangles() const { return triangles_; }
    std::size_t memoryBytes() const noexcept;

    /// On this thread. Null where Embree has no memory or the mesh is larger than a leaf's reference can tell (2^29
    /// triangles).
    static std::shared_ptr<const TriangleTree> build(RTCDeviceTy* device, std::span<const glm::vec3> positions,
                                                     std::span<const std::uint32_t> indices);
    /// The same tree around other positions of the same triangles. Boxes of triangles that have parted overlap more;
    /// what is found in them is the same.
    std::shared_ptr<const TriangleTree> refitted(std::span<const glm::vec3> positions,
                                                 std::span<const std::uint32_t> indices) const;
    /// Its boxes have grown so much against the root's since it was built that building it again pays.
    bool worn() const noexcept { return spread_ > kWorn * spreadBuilt_; }

private:
    // Lauterbach, Yoon, Tuft and Manocha 2006 (RT-DEFORM) build again when boxes have worsened by 40 %.
    static constexpr double kWorn = 1.4;

    void fit(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices);

    std::vector<Node> nodes_;
    std::vector<std::uint32_t> triangles_;
    double spread_ = 0.0; ///< Area of all boxes below the root, in areas of the root: rays meet so many of them.
    double spreadBuilt_ = 0.0;
};

} // namespace gnomon
