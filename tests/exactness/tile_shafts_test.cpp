// tile_shafts shows what ray_traced shows, wherever camera, lights and casters are.
#include <algorithm>
#include <cmath>
#include <random>

#include "demo/program/ambiguity.hpp"
#include "exactness/stage.hpp"
#include "exactness/testbed.hpp"
#include "shaders/hybrid/reasons.h"

namespace gnomon::exact {
namespace {

constexpr const char* kShafts = "tile_shafts";
constexpr VkExtent2D kSize{322, 183}; // no multiple of any tile

class Dice {
public:
    explicit Dice(unsigned seed) : random_(seed) {}
    double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    glm::dvec3 direction()
    {
        for (;;) {
            const glm::dvec3 v(between(-1, 1), between(-1, 1), between(-1, 1));
            const double length = glm::length(v);
            if (length > 0.1 && length < 1.0) return v / length;
        }
    }

private:
    std::mt19937 random_;
};

/// A scene whose camera and lights are thrown anew for every frame; instances move by their own time.
struct Thrown {
    Scene scene;
    std::vector<demo::Light> first;
    demo::Session session;

    explicit Thrown(Scene from)
        : scene(std::move(from)),
          session(test::device(), scene, {.scene = {}, .size = kSize, .contextFlags = GN_CONTEXT_NO_BACKGROUND_BIT})
    {
        REQUIRE(gnWarmUp(session.shadows.context()) >= 0);
        for (demo::Light& light : scene.lights) {
            light.isStatic = false;
            light.keys.clear();
            light.orbit = {};
        }
        first = scene.lights;
    }

    demo::CameraState camera(Dice& dice)
    {
        demo::CameraState state = session.camera(dice.between(0.0, 8.0));
        const double distance = glm::length(state.target - state.eye);
        state.eye += dice.direction() * distance * dice.between(0.0, 0.5);
        state.eye.y = std::max(state.eye.y, 0.05);
        state.target += dice.direction() * distance * 0.3;
        const glm::dvec3 ahead = glm::normalize(state.target - state.eye);
        state.up = glm::normalize(glm::cross(glm::cross(ahead, glm::normalize(dice.direction())), ahead));
        return state;
    }

    void throwLights(Dice& dice)
    {
        for (std::size_t i = 0; i < scene.lights.size(); ++i) {
            demo::Light& light = scene.lights[i];
            light.position = first[i].position + dice.direction() * dice.between(0.0, 2.0);
            light.direction = glm::normalize(first[i].direction + dice.direction() * dice.between(0.0, 0.9));
        }
    }

    Pictures draw(const char* method, const demo::CameraState& eye, double time)
    {
        for (uint32_t i = 0; i < scene.lights.size(); ++i)
            demo::expect(session.shadows.pin(i, method));
        session.renderer.draw({.time = time, .cameras = {&eye, 1}, .shadows = &session.shadows});
        return session.renderer.readVisibility();
    }

    std::uint64_t rays()
    {
        GnFrameStats stats{};
        REQUIRE(gnGetFrameStats(session.shadows.context(), &stats) == GN_SUCCESS);
        return stats.rays;
    }
};

struct Apart {
    std::size_t pixels = 0, clear = 0, dark = 0, all = 0;
};

/// Pixels that differ, and those among them that have one answer only.
void compareWith(Thrown& thrown, const Pictures& truth, const Pictures& shown, double time, Apart& apart)
{
    const demo::SceneState state = demo::stateAt(thrown.scene, time);
    REQUIRE(truth.size() == shown.size());
    REQUIRE(truth.size() == state.present.size());
    for (std::size_t layer = 0; layer < truth.size(); ++layer) {
        std::vector<uint8_t> differing(truth[layer].texels.size());
        std::size_t count = 0;
        for (std::size_t i = 0; i < differing.size(); ++i) {
            differing[i] = truth[layer].texels[i] != shown[layer].texels[i];
            count += differing[i];
            apart.dark += truth[layer].texels[i] == 0;
        }
        apart.all += differing.size();
        apart.pixels += count;
        if (count == 0) continue;
        const demo::FrameSurfaces surfaces{thrown.session.renderer.readDepth(), thrown.session.renderer.readNormals()};
        const uint32_t light = state.present[layer];
        const std::vector<uint8_t> ambiguous =
            demo::ambiguousPixels(thrown.scene, state, thrown.session.renderer.camera(), surfaces,
                                  thrown.scene.lights[light], state.lights[light], differing);
        for (std::size_t i = 0; i < differing.size(); ++i)
            apart.clear += differing[i] == 1 && ambiguous[i] == 0;
    }
}

void checkThrown(const Scene& scene, const std::string& name, unsigned seed)
{
    CAPTURE(name);
    Thrown thrown(scene);
    Dice dice(seed);
    Apart apart;
    for (int frame = 0; frame < 20; ++frame) {
        CAPTURE(frame);
        thrown.throwLights(dice);
        const demo::CameraState eye = thrown.camera(dice);
        const double time = dice.between(0.0, 8.0);
        const double tile = std::exp2(std::floor(dice.between(2.0, 6.99)));
        demo::expect(thrown.session.shadows.set(kShafts, "tile", tile));
        const Pictures truth = thrown.draw("ray_traced", eye, time);
        const Pictures shown = thrown.draw(kShafts, eye, time);
        compareWith(thrown, truth, shown, time, apart);
    }
    MESSAGE(name << ": " << apart.pixels << " of " << apart.all << " pixels differ, " << apart.clear
                 << " of them clear; " << apart.dark << " dark");
    CHECK(apart.clear == 0);
    CHECK(apart.pixels <= apart.all / 1000000);
    CHECK(apart.dark > 1000);
}

/// How many bytes of each value.
std::vector<std::size_t> histogram(const Pictures& pictures)
{
    std::vector<std::size_t> counts(256);
    for (const Image8& picture : pictures)
        for (const uint8_t texel : picture.texels)
            ++counts[texel];
    return counts;
}

} // namespace

TEST_CASE("tile_shafts equals ray_traced from 20 cameras under 20 throws of the lights of every shipped scene")
{
    const test::DeviceTest silence;
    unsigned seed = 1;
    for (const std::string& name : sceneNames())
        checkThrown(shippedScene(name), name, seed++);
}

TEST_CASE("it is so where casters are open, thin and behind the eye, with both depth conventions")
{
    const test::DeviceTest silence;
    for (const auto convention : {demo::DepthConvention::ReversedInfinite, demo::DepthConvention::Standard})
        checkThrown(testbed(convention), std::string(nameOf(convention)), 77);
}

TEST_CASE("tile_shafts proves a third of the pixels or more where triangles are large, and its reasons say which it traced")
{
    const test::DeviceTest silence;
    for (const std::string name : {"room", "colonnade", "torus_grid"}) {
        CAPTURE(name);
        Thrown thrown(shippedScene(name));
        const demo::CameraState eye = thrown.session.camera(0.0);
        const Pictures shown = thrown.draw(kShafts, eye, 0.0);
        demo::expect(thrown.session.shadows.set(kShafts, "reasons", 1.0));
        const Pictures reasons = thrown.draw(kShafts, eye, 0.0);
        std::size_t apart = 0;
        for (std::size_t layer = 0; layer < shown.size(); ++layer)
            for (std::size_t i = 0; i < shown[layer].texels.size(); ++i) {
                const uint8_t code = reasons[layer].texels[i];
                const bool lit =
                    code == gpu::REASON_OUTSIDE || code == gpu::REASON_TILE_LIT || code == gpu::REASON_RT_LIT;
                const bool dark =
                    code == gpu::REASON_BACKFACING || code == gpu::REASON_TILE_SHADOW || code == gpu::REASON_RT_SHADOW;
                apart += lit == dark || lit != (shown[layer].texels[i] == 255);
            }
        CHECK(apart == 0);
        const std::vector<std::size_t> counts = histogram(reasons);
        const std::size_t proven = counts[gpu::REASON_TILE_LIT] + counts[gpu::REASON_TILE_SHADOW];
        const std::size_t traced = counts[gpu::REASON_RT_LIT] + counts[gpu::REASON_RT_SHADOW];
        MESSAGE(name << ": proven lit " << counts[gpu::REASON_TILE_LIT] << ", dark "
                     << counts[gpu::REASON_TILE_SHADOW] << "; traced " << traced);
        CHECK(thrown.rays() == traced);
        // Triangles as small as pixels prove little: torus_grid at this size is mostly traced.
        if (name != "torus_grid") CHECK(traced < proven * 2);
        CHECK(counts[gpu::REASON_TILE_LIT] > 0);
        thrown.draw("ray_traced", eye, 0.0);
        CHECK(thrown.rays() == proven + traced);
    }
}

} // namespace gnomon::exact
