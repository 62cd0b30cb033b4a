#include "demo/host/light_tiles.hpp"

#include <doctest/doctest.h>
#include <glm/geometric.hpp>

#include <bit>
#include <random>

using namespace gnomon;
using namespace gnomon::demo;

namespace {

constexpr VkExtent2D kExtent{333, 187}; // no multiple of the tiles

bool marked(const std::vector<uint32_t>& masks, glm::uvec2 pixel, uint32_t light)
{
    const VkExtent2D tile = lightTileSize(kExtent);
    const uint32_t at = pixel.y / tile.height * gpu::LIGHT_TILES + pixel.x / tile.width;
    return (masks.at(at * gpu::LIGHT_TILE_WORDS + light / 32) >> light % 32 & 1u) != 0;
}

} // namespace

TEST_CASE("a light is marked in the tile of every pixel that it can reach, and in few others")
{
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    Scene scene;
    const CameraState camera{.eye = {3.0, 2.0, 5.0}, .target = {9.0, 1.0, -4.0}, .verticalFov = 1.0f};
    const CameraMatrices matrices = cameraMatrices(scene, camera, kExtent);
    std::vector<gpu::DemoLight> lights(80);
    for (gpu::DemoLight& light : lights) {
        light.type = gpu::LIGHT_POINT;
        const glm::vec3 place(unit(random) - 0.5f, unit(random) - 0.5f, unit(random) - 0.5f);
        light.positionEye = glm::vec4(place * 120.0f, 0.0f);
        light.colour.w = 1.0f + 9.0f * unit(random);
    }
    lights.back().type = gpu::LIGHT_DIRECTIONAL;
    std::vector<uint32_t> masks(gpu::LIGHT_TILES * gpu::LIGHT_TILES * gpu::LIGHT_TILE_WORDS, 0u);
    markLightTiles(matrices, kExtent, lights, masks);

    uint32_t reached = 0;
    for (int sample = 0; sample < 20'000; ++sample) {
        const glm::uvec2 pixel(random() % kExtent.width, random() % kExtent.height);
        const glm::vec3 ray =
            matrices.rayCorner + matrices.rayDx * (float(pixel.x) + 0.5f) + matrices.rayDy * (float(pixel.y) + 0.5f);
        const glm::vec3 position = ray * (80.0f * unit(random));
        for (uint32_t light = 0; light + 1 < lights.size(); ++light)
            if (glm::length(position - glm::vec3(lights[light].positionEye)) < lights[light].colour.w) {
                ++reached;
                CHECK(marked(masks, pixel, light));
            }
        CHECK(marked(masks, pixel, uint32_t(lights.size()) - 1));
    }
    CHECK(reached > 100);
    uint32_t marks = 0;
    for (const uint32_t mask : masks)
        marks += static_cast<uint32_t>(std::popcount(mask));
    CHECK(marks < lights.size() * gpu::LIGHT_TILES * gpu::LIGHT_TILES / 8);
}

TEST_CASE("a light round the eye is marked everywhere, one behind it nowhere")
{
    Scene scene;
    const CameraState camera{.eye = {0.0, 0.0, 0.0}, .target = {0.0, 0.0, -1.0}, .verticalFov = 1.0f};
    const CameraMatrices matrices = cameraMatrices(scene, camera, kExtent);
    std::vector<gpu::DemoLight> lights(2);
    lights[0].type = lights[1].type = gpu::LIGHT_POINT;
    lights[0].positionEye = {0.2f, 0.1f, 0.3f, 0.0f};
    lights[0].colour.w = 2.0f;
    lights[1].positionEye = {0.0f, 0.0f, 5.0f, 0.0f};
    lights[1].colour.w = 4.0f;
    std::vector<uint32_t> masks(gpu::LIGHT_TILES * gpu::LIGHT_TILES * gpu::LIGHT_TILE_WORDS, 0u);
    markLightTiles(matrices, kExtent, lights, masks);
    for (uint32_t y = 0; y < kExtent.height; y += 7)
        for (uint32_t x = 0; x < kExtent.width; x += 7) {
            CHECK(marked(masks, {x, y}, 0));
            CHECK_FALSE(marked(masks, {x, y}, 1));
        }
}
