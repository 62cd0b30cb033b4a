// Which cells of a layer a box may be drawn into, and which rectangles of texels bring cells up to date.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "algorithms/shared/box_cells.hpp"
#include "algorithms/shared/map_cells.hpp"
#include "algorithms/shared/map_lookup.hpp"
#include "maps_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr int kLayerCells = 64;

bool holds(const VkRect2D& rect, std::uint32_t x, std::uint32_t y)
{
    const auto left = static_cast<std::uint32_t>(rect.offset.x), top = static_cast<std::uint32_t>(rect.offset.y);
    return x >= left && x < left + rect.extent.width && y >= top && y < top + rect.extent.height;
}

Cells randomCells(Random& random)
{
    Cells cells = kAllCells;
    for (int i = random.engine() % 4; i >= 0; --i) // full, halves, few
        cells &= Cells{random.engine()} << 32 | random.engine();
    return random.engine() % 8 ? cells : cells * 0xff; // rows alike
}

struct Projected {
    LightView light;
    LightFit fit;
};

/// A light and a map of it, somewhere `far` metres from the origin.
Projected randomProjection(Random& random, float far)
{
    Projected result;
    LightView& light = result.light;
    const glm::vec3 middle = far * random.unit();
    light.constants.positionWs = glm::vec4(middle + random.vec(-6.0f, 6.0f), 1.0f);
    light.constants.directionWs = glm::vec4(random.unit(), 0.0f);
    light.constants.range = 30.0f;
    const Aabb scene{middle - glm::vec3(8.0f), middle + glm::vec3(8.0f)};
    switch (random.engine() % 3) {
    case 0:
        light.type = GN_LIGHT_TYPE_DIRECTIONAL;
        result.fit = fitDirectional(light, scene);
        break;
    case 1:
        light.type = GN_LIGHT_TYPE_SPOT;
        light.coneAngle = random.in(0.2f, 1.2f);
        result.fit = fitSpot(light, scene, 1024, 4.0f);
        break;
    default:
        light.type = GN_LIGHT_TYPE_POINT;
        result.fit = fitCubeFace(light, scene, static_cast<std::uint32_t>(random.engine() % 6), 1024, 4.0f);
    }
    return result;
}

} // namespace

TEST_CASE("rectangles hold the texels of their cells and, where the side is a multiple of 8, no others")
{
    Random random;
    for (int i = 0; i < 300; ++i) {
        const std::uint32_t side = std::array{64u, 96u, 100u, 71u}[random.engine() % 4];
        const Cells cells = i < 2 ? (i == 0 ? kAllCells : 0xaa55aa55aa55aa55u) : randomCells(random);
        std::array<VkRect2D, 32> room;
        const std::span<const VkRect2D> rects = cellRegions(cells, side, room);
        CHECK(rects.size() <= (cells == kAllCells ? 1 : 32));
        bool exact = true, whole = true;
        for (std::uint32_t y = 0; y < side; ++y)
            for (std::uint32_t x = 0; x < side; ++x) {
                const bool wanted = cells >> (8 * (y * 8 / side) + x * 8 / side) & 1;
                int held = 0;
                for (const VkRect2D& rect : rects)
                    held += holds(rect, x, y);
                whole &= !wanted || held > 0;
                exact &= held == wanted;
            }
        CHECK(whole);
        if (side % 8 == 0) CHECK(exact);
        const VkRect2D bounds = cellBounds(cells, side);
        std::uint32_t left = side, top = side, right = 0, bottom = 0;
        for (const VkRect2D& rect : rects) {
            const auto x = static_cast<std::uint32_t>(rect.offset.x), y = static_cast<std::uint32_t>(rect.offset.y);
            left = std::min(left, x), right = std::max(right, x + rect.extent.width);
            top = std::min(top, y), bottom = std::max(bottom, y + rect.extent.height);
            CHECK(x + rect.extent.width <= side);
            CHECK(y + rect.extent.height <= side);
        }
        if (cells == 0) continue;
        CHECK(bounds.offset.x == static_cast<std::int32_t>(left));
        CHECK(bounds.offset.y == static_cast<std::int32_t>(top));
        CHECK(bounds.extent.width == right - left);
        CHECK(bounds.extent.height == bottom - top);
    }
    CHECK(cellBounds(0, 64).extent.width == 0);
}

TEST_CASE("of layers over one ground what either covers differs, of others everything")
{
    CHECK(changedCells({7, 0x0f}, {7, 0x3c}) == 0x3f);
    CHECK(changedCells({7, 0x0f}, {7, 0}) == 0x0f);
    CHECK(changedCells({6, 0x0f}, {7, 0x3c}) == kAllCells);
    CHECK(changedCells({}, {7, 0x3c}) == kAllCells);
    CHECK(changedCells({}, {}) == kAllCells); // nothing is known of either
}

TEST_CASE("neighbours of cells are those beside them in the layer")
{
    CHECK(withNeighbours(0) == 0);
    CHECK(withNeighbours(1) == 0x0303);
    CHECK(withNeighbours(0x80) == 0xc0c0);
    CHECK(withNeighbours(Cells{1} << 63) == 0xc0c0000000000000u);
    CHECK(withNeighbours(Cells{1} << 27) == 0x1c1c1c0000u);
    CHECK(withNeighbours(Cells{0x81} << 24) == 0xc3c3c30000u);
    CHECK(withNeighbours(kAllCells) == kAllCells);
}

TEST_CASE("whatever of a box is drawn into a map lies in its cells, wherever light and box are")
{
    Random random;
    int drawn = 0, few = 0, boxes = 0;
    for (int i = 0; i < 4000; ++i) {
        const float far = std::array{0.0f, 100.0f, 20000.0f}[random.engine() % 3];
        const auto [light, fit] = randomProjection(random, far);
        const MapProjection projection = mapProjection(fit, light);
        const glm::vec3 middle = light.position() + random.vec(-9.0f, 9.0f);
        const glm::vec3 half = random.vec(0.0f, std::exp2(random.in(-5.0f, 2.0f)));
        const Aabb box{middle - half, middle + half};
        const Cells cells = boxCells(box, projection.clipFromZero, projection.zeroWs);
        bool inside = true;
        for (int k = 0; k < 40; ++k) {
            const glm::vec3 p = glm::clamp(middle + half * random.vec(-1.4f, 1.4f), box.lower, box.upper); // faces too
            const glm::dvec4 clip =
                glm::dmat4(projection.clipFromZero) * glm::dvec4(glm::dvec3(p) - glm::dvec3(projection.zeroWs), 1.0);
            if (clip.w <= 0.0) continue;
            const glm::dvec2 at = glm::dvec2(clip) / clip.w * 0.5 + 0.5;
            if (at.x < 0.0 || at.x >= 1.0 || at.y < 0.0 || at.y >= 1.0) continue;
            ++drawn;
            inside &= (cells >> (8 * static_cast<int>(at.y * 8.0) + static_cast<int>(at.x * 8.0)) & 1) != 0;
        }
        CHECK(inside);
        const glm::vec4 clip = projection.clipFromZero * glm::vec4(middle - projection.zeroWs, 1.0f);
        if (glm::length(half) > 0.1f || clip.w < 1.0f || std::max(std::abs(clip.x), std::abs(clip.y)) > clip.w)
            continue;
        ++boxes;
        few += std::popcount(cells) <= 4;
    }
    CHECK(drawn > 20000);
    CHECK(boxes > 100);
    CHECK(few == boxes); // small ones in the map
}

TEST_CASE("a box that reaches the plane of the light may be drawn anywhere, one beside the map nowhere")
{
    LightView light;
    light.type = GN_LIGHT_TYPE_SPOT;
    light.coneAngle = 0.5f;
    light.constants.positionWs = {1.0f, 2.0f, 3.0f, 1.0f};
    light.constants.directionWs = {0.0f, -1.0f, 0.0f, 0.0f};
    light.constants.range = 30.0f;
    const LightFit fit = fitSpot(light, {{-8.0f, -8.0f, -8.0f}, {8.0f, 8.0f, 8.0f}});
    const MapProjection projection = mapProjection(fit, light);
    const auto cells = [&](glm::vec3 middle, float half) {
        return std::popcount(boxCells({middle - half, middle + half}, projection.clipFromZero, projection.zeroWs));
    };
    CHECK(cells({1.0f, 2.0f, 3.0f}, 0.1f) == kLayerCells);
    CHECK(cells({1.3f, 1.95f, 3.0f}, 0.1f) == kLayerCells);
    CHECK(cells({1.0f, 5.0f, 3.0f}, 0.1f) == kLayerCells); // behind
    CHECK(cells({1.0f, -3.0f, 3.0f}, 0.01f) == 4);         // where four meet
    CHECK(cells({6.0f, -3.0f, 3.0f}, 0.5f) == 0);
    // A needle that points at the light from close by, and one from a little farther away.
    const auto needle = [&](float top) {
        const Aabb box{{1.0f, -8.0f, 3.0f}, {1.0f, top, 3.0f}};
        return std::popcount(boxCells(box, projection.clipFromZero, projection.zeroWs));
    };
    CHECK(needle(1.995f) == kLayerCells);
    CHECK(needle(1.9f) == 4);
}
