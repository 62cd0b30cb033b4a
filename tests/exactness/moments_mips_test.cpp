// Smaller maps of moments against pictures of `ray_traced` that are averaged over the pixels' areas.
#include <algorithm>
#include <array>
#include <cmath>

#include "demo/scene/primitives.hpp"
#include "exactness/stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{160, 90};
constexpr uint32_t kParts = 4; ///< A pixel's area is kParts x kParts rays.

/// Posts and boards along a way of 160 m, seen from a height of four metres.
Scene longWay(LightKind kind)
{
    Scene scene;
    scene.name = "long_way";
    place(scene, "ground", demo::makeBox({.size = {60.0f, 1.0f, 200.0f}}), {0.0, -0.5, -60.0});
    for (int i = 0; i < 40; ++i)
        for (const double side : {-1.0, 1.0})
            place(scene, "post", demo::makeBox({.size = {0.4f, 2.5f, 0.4f}}),
                  {side * (2.5 + 2.3 * (i % 3)), 1.25, 3.0 - 2.5 * i});
    for (int i = 0; i < 24; ++i)
        place(scene, "board", demo::makeBox({.size = {1.7f, 0.1f, 0.8f}}), {0.5 * (i % 4), 5.5, 1.0 - 4.5 * i});
    demo::Light& light = scene.lights.emplace_back();
    light.name = "light";
    light.kind = kind;
    light.direction = glm::normalize(glm::dvec3(0.8, -0.6, -0.1));
    if (kind == LightKind::Spot) {
        light.position = glm::dvec3(0.0, 0.0, -30.0) - 70.0 * light.direction;
        light.outerAngle = 0.8f;
        light.innerAngle = 0.75f;
        light.range = 300.0f;
    }
    if (kind == LightKind::Point) {
        light.position = {-6.0, 15.0, -30.0};
        light.range = 60.0f;
    }
    scene.camera = {{.eye = {0.0, 4.0, 4.0}, .target = {0.0, 2.2, -10.0}}};
    return scene;
}

/// A box over a thin floor, both at right angles to a light that falls straight down: two depths, for which every kind
/// is exact.
Scene twoDepths()
{
    Scene scene;
    scene.name = "two_depths";
    place(scene, "floor", demo::makeBox({.size = {6.0f, 0.0002f, 6.0f}}), {0.0, -0.0001, 0.0});
    place(scene, "box", demo::makeBox({.size = {1.5f, 0.02f, 1.1f}}), {0.1, 1.5, 0.2});
    demo::Light& light = scene.lights.emplace_back();
    light.name = "light";
    light.kind = LightKind::Directional;
    light.direction = {0.0, -1.0, 0.0};
    scene.camera = {{.eye = {0.0, 3.0, 3.5}, .target = {0.0, 0.0, 0.0}}};
    return scene;
}

/// Mean squares of what pictures are off by, by distance from the eye.
struct Squares {
    double sum = 0.0;
    uint64_t pixels = 0;
    void add(double off)
    {
        sum += off * off;
        ++pixels;
    }
    double rmse() const { return std::sqrt(sum / double(std::max<uint64_t>(pixels, 1))); }
};
constexpr std::array kEnds = {10.0, 20.0, 40.0, 60.0}; ///< Metres.
using ByDistance = std::array<Squares, kEnds.size()>;

double distanceAt(const Stage& stage, uint32_t x, uint32_t y)
{
    return double(stage.camera.depthScale) / double(*stage.surfaces.depth.at(x, y) + stage.camera.depthAdd);
}

bool onGround(const Stage& stage, uint32_t x, uint32_t y)
{
    return stage.counted[0][size_t(y) * stage.surfaces.depth.width + x] == 1 &&
           stage.surfaces.normals.at(x, y)[1] > 0.9f && distanceAt(stage, x, y) < kEnds.back();
}

/// Of pixels that show nothing but what looks up.
ByDistance errorsOf(const Stage& coarse, const Stage& fine, const Image8& picture)
{
    ByDistance errors;
    for (uint32_t y = 0; y < picture.height; ++y) {
        for (uint32_t x = 0; x < picture.width; ++x) {
            double lit = 0.0;
            bool counted = onGround(coarse, x, y);
            for (uint32_t part = 0; counted && part < kParts * kParts; ++part) {
                const uint32_t px = x * kParts + part % kParts, py = y * kParts + part / kParts;
                counted = onGround(fine, px, py);
                lit += *fine.truth[0].at(px, py) / (255.0 * kParts * kParts);
            }
            if (!counted) continue;
            const auto band = std::ranges::find_if(kEnds, [&](double end) { return distanceAt(coarse, x, y) < end; });
            errors[size_t(band - kEnds.begin())].add(*picture.at(x, y) / 255.0 - lit);
        }
    }
    return errors;
}

struct Format {
    double kind, bits;
};

} // namespace

// The third picture is of kept maps.
TEST_CASE("smaller maps of moments bring wide pixels nearer to the mean over their areas and leave near ones alone")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Directional, LightKind::Point}) {
        const std::string lamp = nameOf(kind);
        CAPTURE(lamp);
        const Scene scene = longWay(kind);
        Stage coarse(scene, kSize);
        const Stage fine(scene, {kSize.width * kParts, kSize.height * kParts});
        for (const double number : {3.0, 4.0}) {
            if (kind == LightKind::Point && number == 4.0) continue;
            const auto draw = [&](double mips) {
                return coarse.draw("moments", {{"resolution", 1024.0}, {"kind", number}, {"mips", mips}});
            };
            const Pictures plain = draw(0.0), mipped = draw(1.0);
            CHECK(draw(1.0)[0].texels == mipped[0].texels);
            const ByDistance without = errorsOf(coarse, fine, plain[0]), with = errorsOf(coarse, fine, mipped[0]);
            for (size_t band = 0; band < kEnds.size(); ++band)
                MESSAGE(lamp << ", kind " << number << ", to " << kEnds[band] << " m, " << with[band].pixels
                             << " pixels: RMSE " << without[band].rmse() << ", with mips " << with[band].rmse());
            CHECK(with[0].pixels > 1000);
            CHECK(with[0].sum == without[0].sum);
            CHECK(with[3].pixels > 100);
            CHECK(with[3].rmse() <= 0.9 * without[3].rmse());
        }
    }
}

TEST_CASE("smaller maps of every kind and format have the mean over the pixels' areas")
{
    const test::DeviceTest silence;
    const VkExtent2D size{40, 30};
    Stage coarse(twoDepths(), size);
    const Stage fine(twoDepths(), {size.width * kParts, size.height * kParts});
    constexpr Format kFormats[] = {{0.0, 16.0}, {0.0, 32.0}, {1.0, 32.0}, {3.0, 16.0}, {3.0, 32.0}, {4.0, 16.0}};
    for (const Format& format : kFormats) {
        const double kind = format.kind, bits = format.bits;
        const auto errors = [&](double mips) {
            const Pictures pictures = coarse.draw(
                "moments", {{"resolution", 1024.0}, {"kind", kind}, {"bits", bits}, {"bleeding", 0.0}, {"mips", mips}});
            return errorsOf(coarse, fine, pictures[0])[0];
        };
        const Squares without = errors(0.0), with = errors(1.0);
        MESSAGE("kind " << kind << ", " << bits << " bits, " << with.pixels << " pixels: RMSE " << without.rmse()
                        << ", with mips " << with.rmse());
        CHECK(with.pixels > 300);
        CHECK(with.rmse() <= 0.6 * without.rmse());
    }
}

} // namespace gnomon::exact
