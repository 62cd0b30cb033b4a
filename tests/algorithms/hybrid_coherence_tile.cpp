// Coherence-based sampling on tiles against all cells of all their pixels.
#include <doctest/doctest.h>

#include <memory>

#include "algorithms/host_frame.hpp"
#include "algorithms/hybrid/coherence_tile.hpp"
#include "algorithms/hybrid_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr std::uint32_t kSide = CoherenceTile::kSide;

struct Tile {
    std::uint32_t left, top, width, height;
};

/// Nothing but ground there, between light and umbra.
constexpr Tile kPenumbra{60, 72, kSide, kSide};

/// Level ground and a box that hangs above it, as a camera sees them.
struct Yard {
    RayScene rays;
    TracedMesh mesh;
    Seen seen;

    Yard() : mesh(make(rays))
    {
        const std::vector<Caster> casters{casterOf(mesh, 0)};
        rays.update(casters);
        seen = look({}, brute::trianglesOf(casters));
    }

private:
    static TracedMesh make(RayScene& rays)
    {
        std::vector<glm::vec3> corners{{-40, 0, -40}, {-40, 0, 40}, {40, 0, 40}, {40, 0, -40}};
        std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};
        const glm::mat4 place = glm::rotate(glm::translate(glm::mat4(1.0f), {-1, 3, 2}), 0.5f, {1, 2, 0.5f});
        addBox(corners, indices, glm::scale(place, {4.0f, 0.3f, 3.0f}));
        return TracedMesh(rays, std::move(corners), std::move(indices));
    }
};

/// The light as the tile takes it, and receivers for it.
struct Lamp {
    LightView view;
    CellLight cells;
    Receivers receivers;

    Lamp(const Yard& yard, const LightView& light, std::uint32_t side = 8)
        : view(light), cells{CellGrid(side), discRadius(view), yard.seen.view.constants.pixelSize, view.mask},
          receivers(yard.seen.view, view, yard.seen.depth, yard.seen.normalBytes())
    {
    }
};

LightView withRadius(LightPair light, float radius)
{
    light.view.constants.sourceRadius = radius;
    return light.view;
}

LightView sun()
{
    return withRadius(makeLight(GN_LIGHT_TYPE_DIRECTIONAL, {}, {0.4, -1.0, -0.15}, 0.0, 0.0), 0.3f);
}

/// Of one pixel.
struct Truth {
    std::uint8_t share = 0; ///< As a byte.
    Asked asked = Asked::lit;
};

/// All cells of all pixels; the disc's axes are those of the tile's first pixel that asks.
std::vector<Truth> traceAll(const Yard& yard, const Lamp& lamp, const Tile& tile)
{
    std::vector<Truth> result;
    glm::vec3 across(0.0f);
    for (std::uint32_t y = tile.top; y < tile.top + tile.height; ++y) {
        for (std::uint32_t x = tile.left; x < tile.left + tile.width; ++x) {
            ShadowRay centre;
            Truth& truth = result.emplace_back();
            truth.asked = lamp.receivers.at(x, y, centre);
            truth.share = truth.asked == Asked::lit ? 255 : 0;
            if (truth.asked != Asked::ray) continue;
            if (across == glm::vec3(0.0f)) across = axisAcross(centre.direction);
            const LightDisc disc(centre.direction, across, lamp.cells.radius);
            std::vector<ShadowRay> rays;
            for (CellMask left = lamp.cells.grid.all(); left != 0; left &= left - 1)
                rays.push_back(
                    disc.ray(centre, lamp.cells.grid.at(static_cast<std::uint32_t>(std::countr_zero(left)))));
            std::vector<std::uint8_t> occluded(rays.size());
            yard.rays.occluded(rays, lamp.cells.mask, occluded);
            const auto seen = static_cast<double>(std::count(occluded.begin(), occluded.end(), 0));
            truth.share = static_cast<std::uint8_t>(std::lround(255.0 * seen / static_cast<double>(rays.size())));
        }
    }
    return result;
}

struct Answer {
    std::vector<std::uint8_t> bytes; ///< Row by row, `stride` apart.
    std::uint64_t rays = 0;
};
constexpr std::size_t kStride = 40;
constexpr std::uint8_t kUntouched = 77;

Answer answerOf(Yard& yard, const Lamp& lamp, const Tile& tile)
{
    Answer answer{std::vector<std::uint8_t>(kStride * kSide, kUntouched)};
    HostFrame frame(yard.rays);
    answer.rays = frame.run([&](const HostContext& host) {
        const auto memory = std::make_unique<CoherenceTile>(lamp.cells, host);
        memory->answer(lamp.receivers, tile.left, tile.top, tile.width, tile.height, answer.bytes, kStride);
    });
    return answer;
}

struct Tally {
    int asked = 0, penumbra = 0, wrong = 0;
    std::uint64_t rays = 0;
};

void compare(Yard& yard, const Lamp& lamp, const Tile& tile, Tally& tally)
{
    const std::vector<Truth> truth = traceAll(yard, lamp, tile);
    const Answer answer = answerOf(yard, lamp, tile);
    tally.rays += answer.rays;
    for (std::uint32_t y = 0; y < kSide; ++y) {
        for (std::uint32_t x = 0; x < kStride; ++x) {
            const std::uint8_t byte = answer.bytes[y * kStride + x];
            if (x >= tile.width || y >= tile.height) {
                tally.wrong += byte != kUntouched;
                continue;
            }
            const Truth& pixel = truth[y * tile.width + x];
            tally.wrong += byte != pixel.share;
            tally.asked += pixel.asked == Asked::ray;
            tally.penumbra += pixel.asked == Asked::ray && pixel.share != 0 && pixel.share != 255;
        }
    }
}

Tally wholePicture(Yard& yard, const Lamp& lamp)
{
    Tally tally;
    for (std::uint32_t top = 0; top < kHeight; top += kSide)
        for (std::uint32_t left = 0; left < kWidth; left += kSide)
            compare(yard, lamp, {left, top, std::min(kSide, kWidth - left), std::min(kSide, kHeight - top)}, tally);
    return tally;
}

} // namespace

TEST_CASE("behind one occluder the shares are those of all cells, for less than an eighth of the rays")
{
    Yard yard;
    const glm::dvec3 lamp(3, 9, 2);
    for (const LightView& light : {sun(), withRadius(makeLight(GN_LIGHT_TYPE_POINT, lamp, {0, -1, 0}, 0, 0), 1.5f),
                                   withRadius(makeLight(GN_LIGHT_TYPE_SPOT, lamp, {-0.2, -1, -0.1}, 14, 0.7), 1.5f)}) {
        for (const std::uint32_t side : {2u, 5u, 8u}) {
            CAPTURE(light.type);
            CAPTURE(side);
            const Tally tally = wholePicture(yard, Lamp(yard, light, side));
            CHECK(tally.wrong == 0);
            CHECK(tally.penumbra > 300);
            const auto all = static_cast<std::uint64_t>(tally.asked) * side * side;
            CHECK(tally.rays < all * 3 / 5); // two of four cells are a rim's
            if (side == 8) CHECK(tally.rays < all / 8);
        }
    }
}

TEST_CASE("a tile of any size, anywhere, answers its own pixels alone")
{
    Yard yard;
    const Lamp lamp(yard, sun());
    int penumbra = 0;
    for (const Tile& tile : {Tile{56, 75, 32, 1}, Tile{70, 66, 1, 32}, Tile{90, 72, 7, 5},
                             Tile{kWidth - 31, 40, 31, 32}, Tile{3, kHeight - 9, 32, 9}}) {
        CAPTURE(tile.left);
        Tally tally;
        compare(yard, lamp, tile, tally);
        CHECK(tally.wrong == 0);
        CHECK(tally.asked > 0);
        penumbra += tally.penumbra;
    }
    CHECK(penumbra > 30);
}

TEST_CASE("pixels that need no ray get their answer without one")
{
    Yard yard;
    const std::uint32_t sky = 16;
    for (std::size_t i = 0; i < yard.seen.depth.size(); ++i)
        if (i % kWidth < sky) yard.seen.depth[i] = yard.seen.view.constants.skyDepth;
    // From below: the ground faces away.
    const Lamp lamp(yard, withRadius(makeLight(GN_LIGHT_TYPE_DIRECTIONAL, {}, {0.4, 1.0, -0.15}, 0.0, 0.0), 0.3f));
    const Answer answer = answerOf(yard, lamp, {0, kHeight - kSide, kSide, kSide});
    CHECK(answer.rays == 0);
    int wrong = 0;
    for (std::uint32_t y = 0; y < kSide; ++y)
        for (std::uint32_t x = 0; x < kSide; ++x)
            wrong += answer.bytes[y * kStride + x] != (x < sky ? 255 : 0);
    CHECK(wrong == 0);
}

TEST_CASE("casters outside the light's mask do not block")
{
    Yard yard;
    LightView light = sun();
    Tally tally;
    compare(yard, Lamp(yard, light), kPenumbra, tally);
    REQUIRE(tally.penumbra > 200);
    light.mask = 0;
    const Answer answer = answerOf(yard, Lamp(yard, light), kPenumbra);
    CHECK(std::count(answer.bytes.begin(), answer.bytes.end(), 255) == kSide * kSide);
}

TEST_CASE("a pixel without a neighbour on its surface traces all cells")
{
    // Every other pixel is moved towards the eye, by a share of its depth, and its normal turned, by an angle.
    const auto raysPerPixel = [](float nearer, float turned) {
        Yard yard;
        for (std::size_t i = 0; i < yard.seen.depth.size(); ++i) {
            if ((i % kWidth + i / kWidth) % 2 == 0) continue;
            yard.seen.normals[i] = {0.0f, std::cos(turned), std::sin(turned), 0.0f};
            yard.seen.depth[i] /= 1.0f - nearer;
        }
        Tally tally;
        compare(yard, Lamp(yard, sun()), kPenumbra, tally);
        CHECK(tally.wrong == 0);
        CHECK(tally.asked == kSide * kSide);
        return static_cast<double>(tally.rays) / tally.asked;
    };
    Yard yard;
    CHECK(answerOf(yard, Lamp(yard, sun()), {75, 75, 1, 1}).rays == 64);
    CHECK(raysPerPixel(0.3f, 0.0f) == 64.0);
    CHECK(raysPerPixel(0.0f, 0.7f) == 64.0); // 40 degrees
    CHECK(raysPerPixel(0.0f, 0.0f) < 32.0);
    CHECK(raysPerPixel(0.0f, 0.6f) < 32.0);
    CHECK(raysPerPixel(yard.seen.view.constants.pixelSize, 0.0f) < 32.0);
}
