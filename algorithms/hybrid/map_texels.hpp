#pragma once
// The texels of a map around a receiver, on the CPU: what shaders/maps/planar_tap.glsl does on the device, for the few
// pixels that a copy of the map is asked about.
#include <array>
#include <cstdint>
#include <span>

#include <glm/vec2.hpp>

#include "algorithms/hybrid/receivers.hpp"
#include "shaders/maps/map_look.h"

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
    MapTexels(const HostMap& map, const gpu::MapConstants& constants, bool cube, const Receiver& receiver);

    /// Whether all texels of the block say the same as `lit`. Outside the map everything is lit.
    /// Four: exactly when a bilinear filter of the comparisons would give 0 or 1 (Moderno, 3.4).
    bool agree(bool lit, TexelBlock block) const;

    /// Numbers of the triangles in the block, each once, the own texel's first; no triangle is none. @return how many.
    std::uint32_t triangles(TexelBlock block, std::uint32_t (&numbers)[9]) const;

    /// Something that is no triangle of ours is nearest in the own texel.
    bool foreign() const;

private:
    glm::ivec2 stepOf(int index) const;
    bool holds(glm::ivec2 texel) const;
    std::size_t place(glm::ivec2 texel) const;
    bool lit(glm::ivec2 texel) const;

    const HostMap& map_;
    std::uint32_t layer_ = 0;
    glm::vec2 at_{0.0f};
    glm::ivec2 own_{0};
    glm::ivec2 quadrant_{0}; ///< Towards the nearest corner of the own texel.
    gpu::PlanarDepth plane_{};
};

} // namespace gnomon
