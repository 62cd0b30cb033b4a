// tile_shafts shows what ray_traced shows, wherever camera, lights and casters are.
#include <cmath>

#include "exactness/testbed.hpp"
#include "exactness/thrown.hpp"
#include "shaders/hybrid/reasons.h"

namespace gnomon::exact {
namespace {

constexpr const char* kShafts = "tile_shafts";
constexpr VkExtent2D kSize{322, 183}; // no multiple of any tile
constexpr VkExtent2D kLargeSize{1282, 723};

void checkThrown(const Scene& scene, const std::string& name, unsigned seed)
{
    CAPTURE(name);
    Thrown thrown(scene, kSize);
    Dice dice(seed);
    Apart apart;
    for (int number = 0; number < 20; ++number) {
        CAPTURE(number);
        const Throw frame = thrown.next(dice);
        const double tile = std::exp2(std::floor(dice.between(2.0, 6.99)));
        demo::expect(thrown.session().shadows.set(kShafts, "tile", tile));
        const Pictures truth = thrown.draw("ray_traced", frame);
        const Pictures shown = thrown.draw(kShafts, frame);
        compareWith(thrown, frame, truth, shown, apart);
    }
    MESSAGE(name << ": " << inWords(apart));
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

TEST_CASE(
    "tile_shafts proves a third of the pixels or more where triangles are large, and its reasons say which it traced")
{
    const test::DeviceTest silence;
    for (const std::string name : {"room", "colonnade", "torus_grid"}) {
        CAPTURE(name);
        // In a picture of kSize a tile holds so many triangles that five sixths of colonnade are traced.
        Thrown thrown(shippedScene(name), kLargeSize, Lights::asTheyAre);
        const Throw frame{.eye = thrown.session().camera(0.0), .time = 0.0, .lights = thrown.scene().lights};
        const Pictures shown = thrown.draw(kShafts, frame);
        demo::expect(thrown.session().shadows.set(kShafts, "reasons", 1.0));
        const Pictures reasons = thrown.draw(kShafts, frame);
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
        MESSAGE(name << ": proven lit " << counts[gpu::REASON_TILE_LIT] << ", dark " << counts[gpu::REASON_TILE_SHADOW]
                     << "; traced " << traced);
        CHECK(thrown.rays() == traced);
        // Triangles as small as pixels prove little: torus_grid is mostly traced.
        if (name != "torus_grid") CHECK(traced < proven * 2);
        CHECK(counts[gpu::REASON_TILE_LIT] > 0);
        thrown.draw("ray_traced", frame);
        CHECK(thrown.rays() == proven + traced);
    }
}

} // namespace gnomon::exact
