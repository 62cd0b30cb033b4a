#pragma once
// Tables of warps as the device makes them from importance that a test hands it, and what they say of places.
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "device/dispatch.hpp"
#include "shaders/warped/warp.h"

namespace gnomon::test {

/// What a warp is made with: gpu::WarpConstants.
struct WarpMade {
    uint32_t map = 0; ///< Of a light's, the one that has receivers.
    float side = 512.0f, blur = 0.0f, even = 0.1f, power = 1.0f;
    uint32_t mostWeight = 0;
};

/// Along rows if `counts[row][place]`; along columns likewise.
using Grid = std::vector<std::vector<double>>;

struct NonorthogonalTables {
    gpu::WarpTable is; ///< Of a single map.
    std::vector<float> tables;
    std::vector<glm::vec4> answers; ///< To the places asked, two each: tests/device/shaders/warp_probe.comp.

    std::span<const float> function(uint32_t kind, uint32_t f) const
    {
        return std::span(tables).subspan((kind * is.cells + f) * is.edges, is.edges);
    }
    Grid functions(uint32_t kind) const;
};
/// @param counts of cells, row by row
NonorthogonalTables nonorthogonalOf(const WarpMade& made, const std::vector<uint32_t>& counts,
                                    const std::vector<glm::vec2>& asked);

struct RectilinearTables {
    std::vector<float> table;       ///< Of a single map.
    std::vector<glm::vec4> answers; ///< One to a place.
};
/// @param importance of columns, then of rows, gpu::WARP_BINS each
RectilinearTables rectilinearOf(const WarpMade& made, const std::vector<uint32_t>& importance,
                                const std::vector<glm::vec2>& asked);

} // namespace gnomon::test
