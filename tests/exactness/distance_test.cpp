// Penumbrae by distances on the screen: the distance transform against brute force, how wide ramps are, and what they
// do to other surfaces and in the umbra.
#include <algorithm>
#include <random>

#include <glm/gtc/quaternion.hpp>

#include "demo/scene/primitives.hpp"
#include "exactness/soft_measures.hpp"
#include "exactness/testbed.hpp"
#include "shaders/revectorized/distance.h"

namespace gnomon::exact {
namespace {

constexpr const char *kFixed = "edt", *kSoft = "edt_soft";

/// A floor seen from above, and over it crates in random places: their shadows are a random mask.
Scene crates(uint32_t count, LightKind kind)
{
    Scene scene;
    scene.name = "crates";
    place(scene, "floor", demo::makeBox({.size = glm::vec3(12.0f, 0.2f, 12.0f)}), {0.0, -0.1, 0.0});
    std::mt19937 random(7 + count);
    const auto within = [&](double low, double high) { return low + (high - low) * double(random()) / 0x1p32; };
    for (uint32_t i = 0; i < count; ++i) {
        const auto size = static_cast<float>(within(0.05, 0.25));
        const double x = within(-1.2, 1.2), y = within(0.05, 0.6), z = within(-1.5, 1.5);
        place(scene, "crate", demo::makeBox({.size = glm::vec3(size)}), {x, y, z}).pose.rotation =
            glm::angleAxis(within(0.0, 3.0), glm::normalize(glm::dvec3(1.0, 2.0, 0.5)));
    }
    scene.lights = {softScene(Caster::box, kind, 1.0, 0.0f).lights[0]};
    scene.camera = {{.eye = {0.0, 5.0, 2.0}, .target = {0.0, 0.0, 0.0}}};
    return scene;
}

struct Place {
    int x, y;
};

int squaredDistance(Place a, Place b)
{
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

/// Checks each pixel's site against all seeds. @return their number
size_t checkSites(Stage& stage)
{
    const auto shown = [&](uint32_t what) {
        return stage.draw(kFixed, {{"resolution", 512.0}, {"show", double(what)}})[0];
    };
    const Image8 seeds = shown(gpu::SHOW_SEEDS), columns = shown(gpu::SHOW_COLUMNS), rows = shown(gpu::SHOW_ROWS);
    std::vector<Place> places;
    const auto width = static_cast<int>(seeds.width), height = static_cast<int>(seeds.height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (seeds.texels[size_t(y * width + x)] == 255) places.push_back({x, y});
    size_t wrong = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto at = size_t(y * width + x);
            const Place site{columns.texels[at] - 1, rows.texels[at] - 1};
            if (places.empty()) {
                wrong += site.x >= 0 || site.y >= 0;
                continue;
            }
            int least = INT32_MAX;
            for (const Place& seed : places)
                least = std::min(least, squaredDistance({x, y}, seed));
            const bool isSeed = site.x >= 0 && site.y >= 0 && seeds.texels[size_t(site.y * width + site.x)] == 255;
            wrong += !isSeed || squaredDistance({x, y}, site) != least;
        }
    }
    CHECK(wrong == 0);
    return places.size();
}

/// Its camera moved away from the middle of the picture, or closer.
Scene seenFrom(Scene scene, double distance)
{
    demo::CameraKey& key = scene.camera[0];
    key.eye = key.target + distance * glm::normalize(key.eye - key.target);
    return scene;
}

} // namespace

TEST_CASE("the site of every pixel is as near as brute force finds, for masks of no, few and many edges")
{
    const test::DeviceTest silence;
    struct Mask {
        uint32_t crates;
        VkExtent2D size;
    };
    for (const Mask& mask : {Mask{0, {160, 120}}, Mask{1, {97, 131}}, Mask{30, {160, 120}}, Mask{300, {97, 131}}}) {
        Stage stage(crates(mask.crates, LightKind::Directional), mask.size);
        const size_t seeds = checkSites(stage);
        MESSAGE(mask.crates << " crates, " << mask.size.width << "x" << mask.size.height << ": " << seeds << " seeds");
        CHECK((seeds > 0) == (mask.crates > 0));
    }
    Stage lamp(crates(30, LightKind::Point), {160, 120});
    CHECK(checkSites(lamp) > 300);
}

TEST_CASE("a ramp's width is the setting's, from near and from four times as far")
{
    const test::DeviceTest silence;
    constexpr double kWidth = 0.4;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Directional}) {
        for (const double distance : {2.0, 8.0}) {
            Stage stage(seenFrom(halfPlane(kind, 1.0, 0.0f), distance), {200, 150});
            const double width =
                widthOnFloor(stage, stage.draw(kFixed, {{"resolution", 2048.0}, {"penumbra", kWidth}})[0]);
            MESSAGE(std::string(demo::nameOf(kind))
                    << " from " << distance << " m: penumbra " << kWidth << " m, 10 to 90 % in " << width << " m");
            CHECK(std::abs(width - 0.8 * kWidth) <= 0.08 * kWidth);
        }
    }
}

namespace {

/// A floor, and over it a bar whose shadow is narrower than half the ramp.
Scene barScene()
{
    Scene scene = halfPlane(LightKind::Directional, 1.0, 0.0f);
    scene.instances.pop_back();
    place(scene, "bar", demo::makeBox({.size = glm::vec3(6.0f, 0.02f, 0.12f)}), {0.0, 0.6, 0.0});
    scene.lights[0].direction = {0.0, -1.0, 0.0};
    scene.camera = {{.eye = {0.0, 2.5, 2.2}, .target = {0.0, 0.0, 0.0}}}; // the bar hides what lies beyond the ramp
    return scene;
}

/// Largest second difference, a step being a pixel, across the middle of the bar's shadow: of 4 pixels to each side.
double sharpestCrease(const Image8& picture)
{
    int most = 0;
    for (uint32_t y = picture.height / 2 - 4; y < picture.height / 2 + 4; ++y)
        for (uint32_t x = picture.width / 4; x < picture.width * 3 / 4; ++x)
            most = std::max(most, std::abs(*picture.at(x, y - 1) - 2 * *picture.at(x, y) + *picture.at(x, y + 1)));
    return most;
}

} // namespace

TEST_CASE("the mean takes two thirds of the crease away along a narrow shadow's middle, and keeps a ramp's width")
{
    const test::DeviceTest silence;
    Stage bar(barScene(), {160, 120});
    const auto draw = [&](double mean) {
        return bar.draw(kFixed, {{"resolution", 2048.0}, {"penumbra", 0.5}, {"mean", mean}})[0];
    };
    const double plain = sharpestCrease(draw(0.0)), smooth = sharpestCrease(draw(1.0));
    MESSAGE("largest second difference " << plain << ", of the mean " << smooth);
    CHECK(plain >= 12);
    CHECK(3.0 * smooth <= plain);

    constexpr double kWidth = 0.4;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point}) {
        Stage stage(seenFrom(halfPlane(kind, 1.0, 0.0f), 2.0), {200, 150});
        const Settings settings = {{"resolution", 2048.0}, {"penumbra", kWidth}, {"mean", 0.5}};
        const double width = widthOnFloor(stage, stage.draw(kFixed, settings)[0]);
        MESSAGE(std::string(demo::nameOf(kind)) << ": 10 to 90 % in " << width << " m of " << kWidth);
        CHECK(std::abs(width - 0.8 * kWidth) <= 0.08 * kWidth);
    }
}

TEST_CASE("penumbrae of edt_soft grow in proportion to the gap, and are as wide as traced ones")
{
    const test::DeviceTest silence;
    const char* const methods[] = {kSoft};
    checkLinear(methods, LightKind::Spot, 0.25f);
    checkLinear(methods, LightKind::Point, 0.25f);
    checkLinear(methods, LightKind::Directional, 0.1f);
}

TEST_CASE("edt_soft lets no light into the umbra, and darkens nothing that sees the whole light")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Directional}) {
        Stage stage(umbraScene(kind, kind == LightKind::Directional ? 0.08f : 0.25f), {160, 120});
        const UmbraCount count = countUmbra(stage.draw(kSoft, {{"resolution", 1024.0}})[0], tracedSoftTruths(stage)[0]);
        MESSAGE(std::string(demo::nameOf(kind)) << ": " << inWords(count));
        CHECK(count.umbra > 200);
        CHECK(count.light > 2000);
        CHECK(count.leaks == 0);
        CHECK(200 * count.specks <= count.light);
    }
}

TEST_CASE("without a penumbra both have the picture of rbsm")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Directional}) {
        Stage stage(softScene(Caster::torus, kind, 1.2, 0.0f), {160, 120});
        const Image8 hard = stage.draw("rbsm", {{"resolution", 512.0}})[0];
        CHECK(test::differences(stage.draw(kSoft, {{"resolution", 512.0}})[0], hard) == 0);
        CHECK(test::differences(stage.draw(kFixed, {{"resolution", 512.0}, {"penumbra", 0.0}})[0], hard) == 0);
        CHECK(test::differences(stage.draw(kFixed, {{"resolution", 512.0}, {"penumbra", 0.3}})[0], hard) > 200);
    }
}

// The card hangs beside the sheet's shadow, nearer to the eye than half the ramp is wide: by distance alone the edge on
// the floor would darken it.
TEST_CASE("a ramp on the floor, or the mean of it, does not darken what hangs before it in the light")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Directional}) {
        Scene scene = halfPlane(kind, 1.5, 0.0f);
        place(scene, "card", demo::makeBox({.size = glm::vec3(0.5f, 0.02f, 0.5f)}), {0.4, 0.25, 0.3});
        Stage stage(std::move(scene), {160, 120});
        const brute::View view = bruteView(stage);
        const brute::Light light = bruteLight(stage, 0);
        const brute::Scene casters(bruteTriangles(stage));
        const Image8 picture = stage.draw(kFixed, {{"resolution", 2048.0}, {"penumbra", 1.0}})[0];
        const Image8 smooth = stage.draw(kFixed, {{"resolution", 2048.0}, {"penumbra", 1.0}, {"mean", 0.5}})[0];
        uint64_t card = 0, dark = 0, ramp = 0;
        for (uint32_t y = 0; y < 120; ++y) {
            for (uint32_t x = 0; x < 160; ++x) {
                const brute::Answer answer = brute::answerAt(view, light, casters, int(x), int(y),
                                                             *stage.surfaces.depth.at(x, y), drawnNormal(stage, x, y));
                const uint8_t seen = *picture.at(x, y);
                ramp += seen > 0 && seen < 255;
                if (answer.state != brute::State::asked || std::abs(answer.receiver.y - 0.26) > 0.005) continue;
                ++card;
                dark += seen != 255 || *smooth.at(x, y) != 255;
            }
        }
        MESSAGE(std::string(demo::nameOf(kind)) << ": " << card << " pixels of the card, " << dark << " darkened");
        CHECK(card > 200);
        CHECK(ramp > 1000);
        CHECK(dark == 0);
    }
}

} // namespace gnomon::exact
