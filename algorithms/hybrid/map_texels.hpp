#pragma once
// The texels of a map around a receiver, on the CPU: what shaders/shared/planar_tap.glsl does on the device, for the
// few pixels that a copy of the map is asked about.
#include <array>
#include <cstdint>
#include <span>

#include <glm/vec2.hpp>

#include "algorithms/shared/receivers.hpp"
#include "shaders/shared/map_lookup.h"

namespace gnomon {

/// A map on the CPU: depth and the number of the nearest triangle, row by row, one span a layer.
struct HostMap {
    std::uint32_t side = 0;
    std::array<std::span<const float>, 6> depth;
    std::array<std::span<const std::uint32_t>, 6> triangle;
};

/// How many texels are asked around a receiver.
enum class TexelBlock { own, four, nine };

/// A receiver in the map. Four texels are those whose centres surround it, nine the own one and all its neighbours.
class MapTexels {
public:
    MapTexels() = default;
    MapTexels(const HostMap& map, const gpu::MapConstants& constants, bool cube, const Receiver& receiver);

    /// Whether all texels of the block say the same as `lit`. Outside the map everything is lit.
    /// Four: exactly when a bilinear filter of the comparisons would give 0 or 1 (Moderno, 3.4).
    bool agree(bool lit, TexelBlock block) const;

    /// Whether the four texels are farther than the receiver by more than rounding and snapping may move either
    /// (shaders/shared/agreement.glsl has the same for pcf_hybrid). Where contact shadows are thinner than that, texels
    /// agree on nothing worth believing.
    bool clearlyLit() const;

    /// Calls `visit(number)` for the triangles in the block, each once, the own texel's first, the nearest three next;
    /// no triangle is none. Stops when it returns true, and says so.
    template <typename Visit>
    bool anyTriangle(TexelBlock block, Visit&& visit) const
    {
        std::uint32_t seen[9], count = 0;
        for (int i = 0; i < sizeOf(block); ++i) {
            const std::uint32_t number = triangle(own_ + stepOf(i));
            bool again = number == kNone;
            for (std::uint32_t k = 0; k < count; ++k)
                again = again || seen[k] == number;
            if (again) continue;
            seen[count++] = number;
            if (visit(number)) return true;
        }
        return false;
    }
    /// Of the own texel.
    std::uint32_t ownTriangle() const { return triangle(own_); }

    /// Calls for the nine texels' memory. \param depths theirs too, else the triangles alone.
    void prefetch(bool depths) const;

    /// Something that is no triangle of ours is nearest in the own texel.
    bool foreign() const;

private:
    static constexpr std::uint32_t kNone = 0xffffffffu;
    static constexpr int sizeOf(TexelBlock block)
    {
        return block == TexelBlock::own ? 1 : block == TexelBlock::four ? 4 : 9;
    }
    /// Texels of all blocks in one order: own, the three towards the nearest corner, the five others.
    glm::ivec2 stepOf(int index) const
    {
        constexpr int steps[9][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {-1, 0}, {0, -1}, {-1, 1}, {1, -1}, {-1, -1}};
        return quadrant_ * glm::ivec2(steps[index][0], steps[index][1]);
    }
    bool holds(glm::ivec2 texel) const
    {
        return static_cast<std::uint32_t>(texel.x) < map_->side && static_cast<std::uint32_t>(texel.y) < map_->side &&
               !map_->depth[layer_].empty(); // a layer that no receiver was thought to lie in
    }
    std::size_t place(glm::ivec2 texel) const
    {
        return static_cast<std::size_t>(texel.y) * map_->side + static_cast<std::size_t>(texel.x);
    }
    std::uint32_t triangle(glm::ivec2 texel) const
    {
        return holds(texel) ? map_->triangle[layer_][place(texel)] : kNone;
    }
    /// By more than `room`, a receiver nearer to the light than `least` counting as at `least`.
    bool lit(glm::ivec2 texel, float least, float room = 0.0f) const;

    const HostMap* map_ = nullptr;
    std::uint32_t layer_ = 0;
    glm::vec2 at_{0.0f};
    glm::ivec2 own_{0};
    glm::ivec2 quadrant_{0};   ///< Towards the nearest corner of the own texel.
    gpu::PlanarDepth plane_{}; ///< Already nearer by `slack_`.
    float slack_ = 0.0f;
};

} // namespace gnomon
