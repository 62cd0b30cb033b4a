#pragma once
// A mesh that deforms from frame to frame.
#include <cmath>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace gnomon::test {

/// A wavy sheet of 2 x 2 m whose waves run.
inline std::vector<glm::vec3> waves(std::uint32_t side, float phase)
{
    std::vector<glm::vec3> corners;
    for (std::uint32_t y = 0; y <= side; ++y)
        for (std::uint32_t x = 0; x <= side; ++x) {
            const float u = 2.0f * float(x) / float(side) - 1.0f, v = 2.0f * float(y) / float(side) - 1.0f;
            corners.push_back({u, 0.3f * std::sin(4.0f * u + 3.0f * v + phase), v});
        }
    return corners;
}

inline std::vector<std::uint32_t> sheetTriangles(std::uint32_t side)
{
    std::vector<std::uint32_t> indices;
    for (std::uint32_t y = 0; y < side; ++y)
        for (std::uint32_t x = 0; x < side; ++x) {
            const std::uint32_t a = y * (side + 1) + x, b = a + side + 1;
            indices.insert(indices.end(), {a, b, a + 1, a + 1, b, b + 1});
        }
    return indices;
}

} // namespace gnomon::test
