// projected_planar is right on the plane that most receivers lie on, whatever the light, and shows the rest lit.
#include <algorithm>
#include <cmath>

#include "demo/program/receivers.hpp"
#include "exactness/stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr const char* kPlanar = "projected_planar";
constexpr VkExtent2D kSize{1280, 720};

/// The counted pixels of a light that lie at this height, to a sixteenth of a pixel's footprint, or those that are off
/// it by more than a whole one.
std::vector<uint8_t> atHeight(const Stage& stage, size_t layer, double height, bool wanted)
{
    const demo::ImageF& depth = stage.surfaces.depth;
    const gpu::ViewConstants view = demo::viewConstants(stage.scene(), stage.camera, {depth.width, depth.height});
    std::vector<uint8_t> mask = stage.counted[layer];
    for (uint32_t y = 0; y < depth.height; ++y) {
        for (uint32_t x = 0; x < depth.width; ++x) {
            uint8_t& pixel = mask[size_t(y) * depth.width + x];
            if (pixel == 0) continue;
            const float w = gpu::linearDepth(view, *depth.at(x, y));
            const glm::vec3 ray = gpu::viewRayWs(view, glm::vec2(float(x) + 0.5f, float(y) + 0.5f));
            const double off = std::abs(stage.camera.eye.y + double(w) * double(ray.y) - height);
            const double footprint = double(w * view.pixelSize);
            if (wanted ? off > footprint / 16.0 : off < footprint) pixel = 0;
        }
    }
    return mask;
}

struct Planar {
    ErrorCount onPlane;
    uint64_t dark = 0;          ///< On the plane, by the truth.
    uint64_t darkElsewhere = 0; ///< Off it, as drawn.
};

Planar measurePlanar(Stage& stage, double height)
{
    Planar sum;
    const Pictures pictures = stage.draw(kPlanar);
    for (size_t layer = 0; layer < pictures.size(); ++layer) {
        const std::vector<uint8_t> on = atHeight(stage, layer, height, true);
        const std::vector<uint8_t> off = atHeight(stage, layer, height, false);
        sum.onPlane += demo::compare(pictures[layer], stage.truth[layer], on);
        for (size_t i = 0; i < on.size(); ++i) {
            sum.dark += on[i] == 1 && stage.truth[layer].texels[i] < 128;
            sum.darkElsewhere += off[i] == 1 && pictures[layer].texels[i] < 128;
        }
    }
    return sum;
}

void checkPlanar(const std::string& what, Stage& stage, double height = 0.0)
{
    CAPTURE(what);
    const Planar found = measurePlanar(stage, height);
    MESSAGE(what << ": on the plane wrong " << inWords(found.onPlane) << ", of which dark " << found.dark);
    CHECK(found.onPlane.counted > 20000);
    CHECK(found.dark > 500);
    CHECK(found.onPlane.percent(found.onPlane.wrong()) <= 0.02);
    CHECK(found.darkElsewhere == 0);
}

std::vector<demo::CameraKey> eyes()
{
    return {{.eye = {1.0, 4.2, 9.0}, .target = {0.0, 0.8, 0.0}},    // the testbed's own
            {.eye = {0.5, 14.0, 0.4}, .target = {0.0, 0.0, 0.0}},   // from above
            {.eye = {-7.0, 1.2, 6.0}, .target = {1.0, 0.0, -1.0}}}; // along the floor
}

} // namespace

TEST_CASE("projected_planar is wrong on at most 0.02 % of the pixels of its plane, and shows all others lit")
{
    const test::DeviceTest silence;
    for (const auto convention : {demo::DepthConvention::ReversedInfinite, demo::DepthConvention::Standard}) {
        int number = 0;
        for (const demo::CameraKey& eye : eyes()) {
            Scene scene = testbed(convention);
            scene.camera = {eye};
            Stage stage(scene, kSize);
            checkPlanar(std::string(nameOf(convention)) + " depth, eye " + std::to_string(number++), stage);
        }
    }
}

TEST_CASE("it is so for every kind of light where the caster hangs before the eye, and the floor is a caster itself")
{
    const test::DeviceTest silence;
    for (const KindOfLight& light : kKinds)
        for (const bool closed : {true, false}) {
            Stage stage(hangingCaster(light.kind, closed, demo::DepthConvention::ReversedInfinite), kSize);
            checkPlanar(std::string(nameOf(light.kind)) + (closed ? ", closed" : ", open"), stage);
        }
}

TEST_CASE("it is so where casters are no manifold surfaces, or pass through themselves")
{
    const test::DeviceTest silence;
    Stage stage(oddCasters(), kSize);
    checkPlanar("odd casters", stage);
}

TEST_CASE("it is so in the shipped scene whose receivers are mostly one floor")
{
    const test::DeviceTest silence;
    Stage stage(shippedScene("torus_grid"), kSize);
    checkPlanar("torus_grid", stage);
}

} // namespace gnomon::exact
