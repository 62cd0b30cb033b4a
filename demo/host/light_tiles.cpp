#include "demo/host/light_tiles.hpp"

#include <array>

#include <glm/geometric.hpp>

namespace gnomon::demo {
namespace {

// Directions and distances are single precision: a sphere is taken to be a little larger.
constexpr float kMargin = 1.001f;

/// Planes through the eye along the edges of the tiles' columns (or rows). Unit normals, towards the higher pixels.
using Edges = std::array<glm::vec3, gpu::LIGHT_TILES + 1>;

/// \param across the view ray's change from one column to the next pixel, \param along the edges.
Edges edges(const glm::vec3& corner, const glm::vec3& across, const glm::vec3& along, uint32_t tileSize)
{
    Edges out;
    for (uint32_t i = 0; i < out.size(); ++i) {
        const glm::vec3 normal = glm::normalize(glm::cross(along, corner + across * float(i * tileSize)));
        out[i] = glm::dot(normal, across) < 0.0f ? -normal : normal;
    }
    return out;
}

/// Bit i: the sphere may reach column (or row) i.
uint32_t reached(const Edges& edges, const glm::vec3& center, float radius)
{
    uint32_t bits = 0;
    for (uint32_t i = 0; i < gpu::LIGHT_TILES; ++i)
        if (glm::dot(center, edges[i]) > -radius && glm::dot(center, edges[i + 1]) < radius) bits |= 1u << i;
    return bits;
}

} // namespace

VkExtent2D lightTileSize(VkExtent2D extent)
{
    return {(extent.width + gpu::LIGHT_TILES - 1) / gpu::LIGHT_TILES,
            (extent.height + gpu::LIGHT_TILES - 1) / gpu::LIGHT_TILES};
}

void markLightTiles(const CameraMatrices& camera, VkExtent2D extent, std::span<const gpu::DemoLight> lights,
                    std::span<uint32_t> masks)
{
    const VkExtent2D tile = lightTileSize(extent);
    const Edges columns = edges(camera.rayCorner, camera.rayDx, camera.rayDy, tile.width);
    const Edges rows = edges(camera.rayCorner, camera.rayDy, camera.rayDx, tile.height);
    const glm::vec3 forward(-camera.viewFromWorld[0][2], -camera.viewFromWorld[1][2], -camera.viewFromWorld[2][2]);
    for (uint32_t light = 0; light < lights.size(); ++light) {
        uint32_t inColumns = ~0u, inRows = ~0u;
        if (lights[light].type != gpu::LIGHT_DIRECTIONAL) {
            const glm::vec3 center(lights[light].positionEye);
            const float radius = lights[light].colour.w * kMargin;
            if (glm::dot(center, forward) < -radius) continue;
            inColumns = reached(columns, center, radius);
            inRows = reached(rows, center, radius);
        }
        for (uint32_t row = 0; row < gpu::LIGHT_TILES; ++row)
            for (uint32_t column = 0; column < gpu::LIGHT_TILES; ++column)
                if ((inRows >> row & inColumns >> column & 1u) != 0)
                    masks[(row * gpu::LIGHT_TILES + column) * gpu::LIGHT_TILE_WORDS + light / 32] |= 1u << light % 32;
    }
}

} // namespace gnomon::demo
