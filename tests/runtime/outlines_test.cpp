// Outlines of shadows as rays tell them, against shadows whose outlines are known.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "runtime/ray_fixture.hpp"
#include "runtime/select/outlines.hpp"
#include "tests/runtime/view_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr float kPixel = 0.01f; // metres, at the wall

/// With depth: reversed, a near plane at 0.1 m, no far one.
CameraView depthCamera()
{
    CameraView view = camera();
    view.constants.depthScale = 0.1f;
    view.constants.depthMul = 1.0f;
    view.constants.offsetFactor = 1.0f;
    return view;
}

/// A wall across the view, ten metres away. @param left, right of the middle: MapCoverage::nearness
std::vector<TileSample::Tile> wall(float flatness, float left = 1.0f, float right = 1.0f)
{
    std::vector<TileSample::Tile> tiles;
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 40; ++x)
            tiles.push_back({.plane = {0.1f, 0.0f, 0.0f, flatness},
                             .place = 16.0f * glm::vec2(x, y),
                             .middle = {0.16f * (float(x) - 19.5f), 0.16f * (19.5f - float(y)), -10.0f},
                             .nearness = x < 20 ? left : right});
    return tiles;
}

LightView sun(float z)
{
    LightView light{};
    light.constants.directionWs = glm::vec4(0.0f, 0.0f, z, -2.0f);
    return light;
}

/// A disc across z, of 48 triangles.
void addDisc(std::vector<glm::vec3>& corners, glm::vec3 middle, float radius)
{
    constexpr int kPieces = 48;
    const auto at = [&](int i) {
        const float angle = 2.0f * std::numbers::pi_v<float> * float(i) / kPieces;
        return middle + radius * glm::vec3(std::cos(angle), std::sin(angle), 0.0f);
    };
    for (int i = 0; i < kPieces; ++i)
        corners.insert(corners.end(), {middle, at(i), at(i + 1)});
}

/// Discs in rows, and what they throw.
struct Discs {
    static constexpr float kRadius = 0.4f;
    RayScene rays;
    TracedMesh mesh;
    Caster caster;
    std::vector<const Caster*> all{&caster};

    explicit Discs(float z, bool left = false) : mesh(rays, corners(z, left)), caster(casterOf(mesh, 1))
    {
        REQUIRE(rays.update({&caster, 1}));
    }
    static std::vector<glm::vec3> corners(float z, bool left)
    {
        std::vector<glm::vec3> found;
        for (int y = 0; y < 5; ++y)
            for (int x = 0; x < (left ? 2 : 5); ++x)
                addDisc(found, {1.17f * float(x) - 2.34f, 1.17f * float(y) - 2.34f, z}, kRadius);
        return found;
    }
    /// Of so many discs' shadows, so many times as large, on 6.4 x 6.4 m of wall: pixels a pixel.
    static double density(int discs, double times)
    {
        return discs * times * 2.0 * std::numbers::pi * double{kRadius} / (6.4 * 6.4) * double{kPixel};
    }
};

} // namespace

TEST_CASE("rays find as much outline as there is, on planes and half as much elsewhere")
{
    Discs discs(-5.0f);
    const CameraView view = depthCamera();
    const auto flat = outlinesByRays(view, sun(-1.0f), wall(1.0f), discs.rays);
    REQUIRE(flat);
    CHECK(double{flat->density} == doctest::Approx(Discs::density(25, 1.0)).epsilon(0.1));
    CHECK(flat->nearness == doctest::Approx(1.0));
    const auto rough = outlinesByRays(view, sun(-1.0f), wall(0.0f), discs.rays);
    REQUIRE(rough);
    CHECK(double{rough->density} == doctest::Approx(0.5 * Discs::density(25, 1.0)).epsilon(0.25)); // fewer are met

    // A lamp where the eye is: shadows are twice as large, and some end beyond the picture.
    LightView lamp = sun(-1.0f);
    lamp.type = GN_LIGHT_TYPE_POINT;
    lamp.constants = {.positionWs = {0.0f, 0.0f, 0.0f, 1.0f}, .range = 100.0f, .type = gpu::LIGHT_POINT};
    lamp.constants.directionWs.w = -2.0f;
    const auto near = outlinesByRays(view, lamp, wall(1.0f), discs.rays);
    REQUIRE(near);
    CHECK(double{near->density} > 0.5 * Discs::density(9, 2.0));
    CHECK(double{near->density} < Discs::density(25, 2.0));
    lamp.constants.range = 9.0f; // ends before the wall
    CHECK(outlinesByRays(view, lamp, wall(1.0f), discs.rays)->density == 0.0f);
}

TEST_CASE("outlines are where the light falls, and as near as the receivers that they are on")
{
    Discs behind(-12.0f), left(-5.0f, true);
    const CameraView view = depthCamera();
    CHECK(outlinesByRays(view, sun(-1.0f), wall(1.0f), behind.rays)->density == 0.0f);
    CHECK(outlinesByRays(view, sun(1.0f), wall(1.0f), behind.rays)->density == 0.0f); // lit from behind
    const auto found = outlinesByRays(view, sun(-1.0f), wall(1.0f, 3.0f, 0.5f), left.rays);
    REQUIRE(found);
    CHECK(found->density > 0.0f);
    CHECK(found->nearness == doctest::Approx(3.0));
    LightView masked = sun(-1.0f);
    left.caster.mask = 2;
    REQUIRE(left.rays.update({&left.caster, 1}));
    masked.mask = 1;
    CHECK(outlinesByRays(view, masked, wall(1.0f), left.rays)->density == 0.0f);
}

TEST_CASE("where rays cannot tell, nothing is said")
{
    Discs discs(-5.0f);
    CameraView view = depthCamera();
    CHECK(!outlinesByRays(view, sun(-1.0f), {}, discs.rays));
    view.constants.rayDepthWs.w = -1.0f; // no perspective
    CHECK(!outlinesByRays(view, sun(-1.0f), wall(1.0f), discs.rays));
    std::vector<TileSample::Tile> sky = wall(0.0f);
    for (TileSample::Tile& tile : sky)
        tile.plane.inverse = 0.0f;
    CHECK(outlinesByRays(depthCamera(), sun(-1.0f), sky, discs.rays)->density == 0.0f);

    LightCasters casters;
    CHECK(raysTellOutlines(casters)); // there are none
    casters.all = discs.all;
    CHECK(raysTellOutlines(casters));
    discs.caster.alphaTested = true;
    CHECK(raysTellOutlines(casters)); // rays stop at all of the mesh
    discs.caster.opacity = [](std::uint32_t, float, float, void*) { return 1.0f; };
    CHECK(!raysTellOutlines(casters)); // the host would be asked
    discs.caster.alphaTested = false;
    discs.caster.mesh = nullptr; // the host draws it
    CHECK(!raysTellOutlines(casters));
}
