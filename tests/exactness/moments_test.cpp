// Filtered moments on real maps: against maps whose comparisons are filtered, and what leaks where there is no light.
#include <algorithm>
#include <cstdlib>
#include <string>

#include "demo/scene/scene_file.hpp"
#include "exactness/stage.hpp"

namespace gnomon::exact {
namespace {

struct Kind {
    std::string name;
    double number;
};
const Kind kVsm{"VSM", 0.0}, kEsm{"ESM", 1.0}, kEvsm2{"EVSM2", 2.0}, kEvsm4{"EVSM4", 3.0}, kMsm{"MSM", 4.0};
const Kind kKindsOfMoments[] = {kVsm, kEsm, kEvsm2, kEvsm4, kMsm};

constexpr double kSide = 256.0;

Pictures moments(Stage& stage, const Kind& kind, double filter, double bits = 32.0, double bleeding = 0.0,
                 double side = kSide)
{
    return stage.draw(
        "moments",
        {{"resolution", side}, {"kind", kind.number}, {"filter", filter}, {"bits", bits}, {"bleeding", bleeding}});
}

/// Comparisons averaged over a box of texels, for a light of any kind.
Pictures comparisons(Stage& stage, double filter)
{
    Pictures pictures = stage.draw("shadow_map", {{"resolution", kSide}, {"filter", filter}});
    Pictures cubes = stage.draw("cube_map", {{"resolution", kSide}, {"filter", filter}});
    for (size_t layer = 0; layer < pictures.size(); ++layer)
        if (cubes[layer].width > 0) pictures[layer] = std::move(cubes[layer]);
    return pictures;
}

/// A box over a thin floor, both at right angles to a light that falls straight down: two depths, the receiver on one.
Scene twoLayers()
{
    const char* text = R"(
name: two_layers
size: [160, 120]
meshes:
  floor: {box: {size: [6, 0.0002, 6]}}
  box: {box: {size: [1.5, 0.02, 1.1]}}
instances:
  - {name: floor, mesh: floor, at: [0, -0.0001, 0]}
  - {name: box, mesh: box, at: [0.1, 1.5, 0.2], rotate: {axis: [0, 1, 0], degrees: 20}}
lights:
  - {name: sun, kind: directional, direction: [0, -1, 0]}
camera:
  - {eye: [0, 3, 3.5], target: [0, 0, 0], fov: 45}
)";
    return demo::valueOf(demo::parseScene(text, "two_layers.yaml"));
}

} // namespace

// Chebyshev's and Hamburger's bounds are exact for two depths with the receiver on the farther one, and a box between
// texels is the mix of the boxes at texels. Bounds: the floor's far side, which is in the map, is 0.2 mm of 1.5 m
// behind the receiver, and channels of 16 bits are off by 2^-17 times what the solution multiplies that with.
TEST_CASE("of two layers at right angles to the light moments make the picture that averaged comparisons do")
{
    const test::DeviceTest silence;
    Stage stage(twoLayers(), {160, 120});
    for (const double filter : {3.0, 5.0, 7.0}) {
        const Pictures wanted = comparisons(stage, filter);
        for (const Kind& kind : kKindsOfMoments) {
            for (const double bits : {32.0, 16.0}) {
                CAPTURE(filter);
                CAPTURE(kind.name);
                CAPTURE(bits);
                const Pictures got = moments(stage, kind, filter, bits);
                int worst = 0, between = 0;
                for (size_t i = 0; i < wanted[0].texels.size(); ++i) {
                    if (stage.counted[0][i] != 1) continue;
                    worst = std::max(worst, std::abs(int(wanted[0].texels[i]) - int(got[0].texels[i])));
                    between += wanted[0].texels[i] > 0 && wanted[0].texels[i] < 255;
                }
                MESSAGE("filter " << filter << ", " << kind.name << ", " << bits << " bits: largest difference "
                                  << worst << " of 255, " << between << " pixels between");
                CHECK(between > 300);
                CHECK(worst <= (kind.number == kEsm.number || kind.number == kEvsm2.number ? 9 : 2));
            }
        }
    }
}

TEST_CASE("where all comparisons around a pixel agree, moments say the same, but for what VSM and two moments leak")
{
    const test::DeviceTest silence;
    Stage stage(shippedScene("room"), {320, 180});
    const Pictures wanted = comparisons(stage, 7.0);
    for (const Kind& kind : kKindsOfMoments) {
        CAPTURE(kind.name);
        const Pictures got = moments(stage, kind, 5.0, 32.0, 0.1);
        uint64_t lit = 0, dark = 0, darkened = 0, leaked = 0;
        for (size_t layer = 0; layer < wanted.size(); ++layer) {
            REQUIRE(got[layer].width > 0);
            for (size_t i = 0; i < wanted[layer].texels.size(); ++i) {
                if (stage.counted[layer][i] != 1) continue;
                const int before = wanted[layer].texels[i], now = got[layer].texels[i];
                lit += before == 255;
                dark += before == 0;
                darkened += before == 255 && now < 128;
                leaked += before == 0 && now >= 128;
            }
        }
        const double darkenedPercent = 100.0 * double(darkened) / double(lit);
        const double leakedPercent = 100.0 * double(leaked) / double(dark);
        MESSAGE(kind.name << ": of " << lit << " lit pixels " << darkenedPercent << " % are dark, of " << dark
                          << " dark ones " << leakedPercent << " % lit");
        CHECK(lit > 20000);
        CHECK(dark > 5000);
        CHECK(darkenedPercent <= 0.1);
        CHECK(leakedPercent <= (kind.number == kMsm.number || kind.number == kEvsm4.number ? 2.0 : 12.0));
    }
}

TEST_CASE("under three layers VSM leaks most, EVSM less, and MSM no more than that")
{
    const test::DeviceTest silence;
    Stage stage(shippedScene("views/layers"), {320, 180});
    const Pictures compared = comparisons(stage, 7.0);
    const auto leak = [&](const Kind& kind, double bleeding) {
        const Pictures pictures = moments(stage, kind, 7.0, 32.0, bleeding);
        double sum = 0.0;
        uint64_t pixels = 0;
        for (size_t layer = 0; layer < pictures.size(); ++layer) {
            for (size_t i = 0; i < pictures[layer].texels.size(); ++i) {
                // No light, and no texel within the box says otherwise.
                if (stage.counted[layer][i] != 1 || stage.truth[layer].texels[i] != 0) continue;
                if (compared[layer].texels[i] != 0) continue;
                sum += pictures[layer].texels[i] / 255.0;
                ++pixels;
            }
        }
        CHECK(pixels > 5000);
        MESSAGE(kind.name << ", bleeding " << bleeding << ": mean visibility of " << pixels << " pixels in full shadow "
                          << sum / double(pixels));
        return sum / double(pixels);
    };
    // Methods that average answers of texels, not depths, leak nothing where all of these are dark: 15 x 15 texels
    // around, with one more for ramps, and two more for distances, which end on the screen.
    const Pictures wide = stage.draw("shadow_map", {{"resolution", kSide}, {"filter", 15.0}, {"kernel", 1.0}});
    const Pictures ramps = stage.draw("rpcf", {{"resolution", kSide}, {"filter", 7.0}});
    const Pictures distances = stage.draw("edt", {{"resolution", kSide}, {"penumbra", 0.02}});
    uint64_t deep = 0, light = 0;
    for (size_t layer = 0; layer < wide.size(); ++layer) {
        if (wide[layer].width == 0) continue;
        const size_t width = wide[layer].width;
        for (size_t i = 2 * width + 2; i + 2 * width + 2 < wide[layer].texels.size(); ++i) {
            bool dark = stage.counted[layer][i] == 1;
            for (size_t row = i - 2 * width; dark && row <= i + 2 * width; row += width)
                for (size_t at = row - 2; at <= row + 2; ++at)
                    dark = dark && stage.truth[layer].texels[at] == 0 && compared[layer].texels[at] == 0 &&
                           stage.counted[layer][at] == 1;
            if (!dark || wide[layer].texels[i] != 0) continue;
            ++deep;
            light += ramps[layer].texels[i] != 0 || distances[layer].texels[i] != 0;
        }
    }
    MESSAGE("rpcf and edt have light in " << light << " of " << deep << " pixels of the umbra");
    CHECK(deep > 1500);
    CHECK(light == 0);
    const double vsm = leak(kVsm, 0.0), evsm = leak(kEvsm4, 0.0), msm = leak(kMsm, 0.0);
    CHECK(leak(kEvsm2, 0.0) < vsm);
    CHECK(evsm < vsm);
    CHECK(msm <= evsm);
    CHECK(msm > 0.0); // a bound of four moments is not exact
    CHECK(leak(kVsm, 0.3) < 0.7 * vsm);
}

// The box of 63 texels covers all that a map of 64 covers: there is next to no shadow left, and no wrong one.
TEST_CASE("a filter wider than what the map covers leaves light, and one that is not leaves shadows")
{
    const test::DeviceTest silence;
    Stage stage(shippedScene("views/layers"), {160, 90});
    const auto meanOf = [&](const Pictures& pictures, size_t layer) {
        uint64_t counted = 0;
        double sum = 0.0;
        for (size_t i = 0; i < pictures[layer].texels.size(); ++i) {
            if (stage.counted[layer][i] != 1) continue;
            sum += pictures[layer].texels[i] / 255.0;
            ++counted;
        }
        return sum / double(counted);
    };
    for (const Kind& kind : kKindsOfMoments) {
        for (const double bits : {16.0, 32.0}) {
            CAPTURE(kind.name);
            CAPTURE(bits);
            const Pictures wide = moments(stage, kind, 63.0, bits, 0.0, 64.0);
            const Pictures narrow = moments(stage, kind, 5.0, bits, 0.0, 64.0);
            for (size_t layer = 0; layer < wide.size(); ++layer) {
                const double truth = meanOf(stage.truth, layer);
                MESSAGE(kind.name << ", " << bits << " bits, " << stage.scene().lights[layer].name
                                  << ": mean visibility " << meanOf(wide, layer) << ", " << meanOf(narrow, layer)
                                  << ", truth " << truth);
                CHECK(meanOf(wide, layer) > 0.8);
                // Where a box reaches past a caster, exponentials of what is far outweigh all else.
                const bool outweighed = kind.number == kEsm.number || kind.number == kEvsm2.number;
                CHECK(std::abs(meanOf(narrow, layer) - truth) < (outweighed ? 0.25 : 0.06));
            }
        }
    }
}

} // namespace gnomon::exact
