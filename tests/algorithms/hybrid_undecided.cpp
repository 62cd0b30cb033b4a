// Pixels that wait for their rays: found in a picture, and told from the near plane.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "algorithms/hybrid/near_clip.hpp"
#include "algorithms/hybrid/undecided.hpp"
#include "shaders/hybrid/reasons.h"

using namespace gnomon;

namespace {

/// Pictures of which about one pixel in `one` is undecided, against a search byte by byte.
void check(std::uint32_t width, std::uint32_t height, std::uint32_t one, std::mt19937& random)
{
    constexpr std::uint32_t left = 300, top = 17;
    std::vector<std::uint8_t> bytes(std::size_t{width} * height);
    std::vector<std::uint32_t> wanted;
    for (std::uint32_t i = 0; i < bytes.size(); ++i) {
        const bool undecided = random() % one == 0;
        // Among the others those that differ in one bit, or are one more or less.
        constexpr std::uint8_t others[] = {0, 255, 72, 201, 199, 192, 204, 136, 1};
        bytes[i] = undecided ? std::uint8_t{gpu::UNDECIDED} : others[random() % std::size(others)];
        if (undecided) wanted.push_back(gpu::packPixel(left + i % width, top + i / width));
    }
    std::vector<std::uint32_t> found(wanted.size());
    REQUIRE(findUndecided(bytes, width, left, top, found) == wanted.size());
    const auto tileOf = [&](std::uint32_t pixel) {
        return (gpu::pixelY(pixel) - top) / 4 * 65536 + (gpu::pixelX(pixel) - left) / 4;
    };
    CHECK(std::is_sorted(found.begin(), found.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return tileOf(a) < tileOf(b); }));
    std::sort(found.begin(), found.end());
    std::sort(wanted.begin(), wanted.end());
    CHECK(found == wanted);
}

} // namespace

TEST_CASE("every undecided pixel is found once, tile by tile")
{
    std::mt19937 random(3);
    for (const std::uint32_t width : {1u, 4u, 7u, 8u, 15u, 37u, 64u})
        for (const std::uint32_t height : {1u, 3u, 4u, 21u})
            for (const std::uint32_t one : {1u, 2u, 9u, 200u})
                check(width, height, one, random);
}

TEST_CASE("a packed pixel keeps both coordinates up to 65535")
{
    for (const std::uint32_t x : {0u, 1u, 16384u, 65535u}) {
        for (const std::uint32_t y : {0u, 7u, 65535u}) {
            CHECK(gpu::pixelX(gpu::packPixel(x, y)) == x);
            CHECK(gpu::pixelY(gpu::packPixel(x, y)) == y);
        }
    }
}

namespace {

/// A near rectangle somewhere, and a box that may meet it.
struct NearScene {
    static constexpr std::int32_t kLeft = 40, kTop = 7;
    static constexpr std::uint32_t kWidth = 160, kHeight = 90;
    CameraView view;
    Caster box;

    explicit NearScene(std::mt19937& random)
    {
        const auto in = [&](float low, float high) { return std::uniform_real_distribution(low, high)(random); };
        const auto any = [&] { return glm::vec3(in(-1, 1), in(-1, 1), in(-1, 1)); };
        const glm::vec3 corner = 2.0f * any(), right = glm::normalize(any());
        const glm::vec3 down = glm::normalize(glm::cross(right, any())) * in(0.02f, 1.0f);
        view.area = {{kLeft, kTop}, {kWidth, kHeight}};
        view.nearCorners = {corner, corner + right, corner + right + down, corner + down};
        const glm::vec3 middle = corner + in(-0.3f, 1.3f) * right + in(-0.3f, 1.3f) * down + 0.4f * any();
        const glm::vec3 half(in(0.01f, 0.6f), in(0.01f, 0.6f), in(0.01f, 0.6f));
        box.bounds = {middle - half, middle + half};
        box.closed = true;
    }

    /// Where the view ray of a place in the picture starts.
    glm::dvec3 start(glm::dvec2 pixel) const
    {
        const glm::dvec3 corner(view.nearCorners[0]);
        return corner + (pixel.x - kLeft) / kWidth * (glm::dvec3(view.nearCorners[1]) - corner) +
               (pixel.y - kTop) / kHeight * (glm::dvec3(view.nearCorners[3]) - corner);
    }
    bool startsWithin(glm::dvec2 pixel) const
    {
        const glm::dvec3 p = start(pixel), lower(box.bounds.lower), upper(box.bounds.upper);
        return glm::all(glm::lessThanEqual(lower, p)) && glm::all(glm::lessThanEqual(p, upper));
    }
    VkRect2D pixels() const
    {
        const Caster* casters[] = {&box};
        return nearClip(view, casters).pixels;
    }
};

bool holds(const VkRect2D& rect, std::int32_t x, std::int32_t y)
{
    return x >= rect.offset.x && x < rect.offset.x + static_cast<std::int32_t>(rect.extent.width) &&
           y >= rect.offset.y && y < rect.offset.y + static_cast<std::int32_t>(rect.extent.height);
}

} // namespace

TEST_CASE("no view ray starts in a closed caster outside of the rectangle")
{
    std::mt19937 random(5);
    int cut = 0, apart = 0;
    for (int round = 0; round < 300; ++round) {
        CAPTURE(round);
        const NearScene scene(random);
        const VkRect2D rect = scene.pixels();
        for (std::int32_t y = NearScene::kTop; y < NearScene::kTop + static_cast<std::int32_t>(scene.kHeight); ++y) {
            for (std::int32_t x = NearScene::kLeft; x < NearScene::kLeft + static_cast<std::int32_t>(scene.kWidth);
                 ++x) {
                if (!scene.startsWithin({x + 0.5, y + 0.5})) continue;
                REQUIRE(holds(rect, x, y));
            }
        }
        (rect.extent.width == 0 ? apart : cut) += 1;
        CHECK(rect.offset.x >= (rect.extent.width == 0 ? 0 : NearScene::kLeft));
        CHECK(rect.offset.x + rect.extent.width <= NearScene::kLeft + NearScene::kWidth);
        CHECK(rect.offset.y + rect.extent.height <= NearScene::kTop + NearScene::kHeight);
    }
    CHECK(cut > 50);
    CHECK(apart > 50);
}

TEST_CASE("a slab across the near plane cuts the columns that it covers, and what is open or alpha-tested none")
{
    std::mt19937 random(6);
    NearScene scene(random);
    scene.view.nearCorners = {{{0, 1, -1}, {2, 1, -1}, {2, 0, -1}, {0, 0, -1}}};
    scene.box.bounds = {{0.5f, -9, -9}, {0.75f, 9, 9}};
    const VkRect2D rect = scene.pixels();
    // 160 pixels for two metres, half a pixel for the margin.
    CHECK(rect.offset.x == NearScene::kLeft + 39);
    CHECK(rect.extent.width == 22);
    CHECK(rect.offset.y == NearScene::kTop);
    CHECK(rect.extent.height == NearScene::kHeight);
    const Caster* casters[] = {&scene.box};
    const Aabb receivers = nearClip(scene.view, casters).receivers;
    CHECK(glm::all(glm::lessThan(receivers.lower, scene.box.bounds.lower)));
    CHECK(glm::all(glm::lessThan(scene.box.bounds.upper, receivers.upper)));
    CHECK(receivers.upper.x < 2.0f);

    scene.box.alphaTested = true;
    CHECK(scene.pixels().extent.width == 0);
    scene.box.alphaTested = false;
    scene.box.closed = false;
    CHECK(scene.pixels().extent.width == 0);
    scene.box.closed = true;
    scene.box.bounds = {{0.5f, -9, -9}, {0.75f, 9, -1.01f}};
    CHECK(scene.pixels().extent.width == 0);
}
