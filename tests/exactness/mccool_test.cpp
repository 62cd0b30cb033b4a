// What is mccool's own: shadows that are not black, and maps with more edges than their list holds.
#include <algorithm>
#include <cmath>

#include "exactness/stage.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{320, 180};

/// Values among the pixels that the truth calls dark and, apart, among those turned away from the light.
struct Values {
    std::map<int, uint64_t> inShadow, turnedAway, lit;
};

Values valuesOf(const Stage& stage, const Pictures& pictures)
{
    Values values;
    for (size_t layer = 0; layer < pictures.size(); ++layer) {
        for (size_t i = 0; i < pictures[layer].texels.size(); ++i) {
            const int value = pictures[layer].texels[i];
            if (stage.counted[layer][i] != 0)
                ++(stage.truth[layer].texels[i] < 128 ? values.inShadow : values.lit)[value];
            else if (stage.truth[layer].texels[i] == 0)
                ++values.turnedAway[value];
        }
    }
    return values;
}

double share(const std::map<int, uint64_t>& values, int value)
{
    uint64_t all = 0;
    for (const auto& [each, count] : values)
        all += count;
    REQUIRE(all > 200);
    const auto found = values.find(value);
    return found == values.end() ? 0.0 : double(found->second) / double(all);
}

/// The nth light of a kind alone: several with such maps do not fit the memory of a small device. Without lights: there
/// is none.
Scene onlyOne(Scene scene, LightKind kind, size_t nth)
{
    std::erase_if(scene.lights, [&](const demo::Light& light) { return light.kind != kind; });
    if (nth < scene.lights.size())
        scene.lights = {scene.lights[nth]};
    else
        scene.lights.clear();
    return scene;
}

/// Whether the light is there at time 0.
bool shines(const Scene& scene)
{
    return !demo::stateAt(scene, 0.0).present.empty();
}

ErrorCount errorOf(const Scene& scene, double side)
{
    Stage stage(scene, {1280, 720}); // with all the memory
    return pooled(stage, stage.draw("mccool", {{"resolution", side}}));
}

// With fewer wrong pixels than this the fall from one map to the next is chance: scenario's first lamp keeps 256 at
// 2048 texels and 85 at 4096.
constexpr uint64_t kEnoughWrong = 200;

void checkFalls(const std::string& name, const ErrorCount& coarse, const ErrorCount& fine)
{
    const double before = coarse.percent(coarse.wrong()), now = fine.percent(fine.wrong());
    MESSAGE(name << ": wrong " << inWords(coarse) << ", with twice the texels " << inWords(fine) << ": falls "
                 << before / now << " times");
    CHECK(fine.wrong() > 20);
    // Where lights run out before there are enough (the spot lights of `rooms`), the ratio of two counts is known to a
    // standard error of sqrt(1/a + 1/b): two of them are chance.
    const double chance = std::sqrt(1.0 / double(coarse.wrong()) + 1.0 / double(fine.wrong()));
    const double room = fine.wrong() < kEnoughWrong ? 1.0 + 2.0 * chance : 1.0;
    CHECK(before * room >= 1.4 * now);
    CHECK(before <= 2.6 * room * now);
}

/// Pooled over the first lights of each kind, as many as it takes for enough wrong pixels. Six maps of 4096 texels, and
/// as many of the static casters, are more than a device of 2 GiB lends, so the last doubling is without point lights.
void checkScene(const std::string& name)
{
    CAPTURE(name);
    ErrorCount all[3], last[2]; // 512, 1024, 2048; 2048, 4096
    for (const KindOfLight& light : kKinds) {
        const bool point = light.kind == LightKind::Point;
        uint64_t left = 0; // by the finest map
        for (size_t nth = 0; left < kEnoughWrong; ++nth) {
            const Scene scene = onlyOne(shippedScene(name), light.kind, nth);
            if (scene.lights.empty() || !shines(scene)) break;
            for (size_t i = 0; i < 3; ++i) {
                const ErrorCount error = errorOf(scene, double(512 << i));
                all[i] += error;
                if (i == 2 && !point) last[0] += error;
                if (i == 2 && point) left += error.wrong();
            }
            if (point) continue;
            const ErrorCount finest = errorOf(scene, 4096.0);
            last[1] += finest;
            left += finest.wrong();
        }
    }
    checkFalls(name, all[0], all[1]);
    checkFalls(name, all[1], all[2]);
    checkFalls(name, last[0], last[1]);
}

} // namespace

TEST_CASE("shadows are black, or keep a share of the light, surfaces that face away with them or not")
{
    const test::DeviceTest silence;
    Stage stage(shippedScene("colonnade"), kSize);
    const auto drawn = [&](double mode) {
        return valuesOf(stage, stage.draw("mccool", {{"darkening", mode}, {"shade", 0.4}}));
    };
    const int kept = 102; // 0.4 of 255
    const Values black = drawn(0.0), ambient = drawn(1.0), composite = drawn(2.0);
    for (const Values* each : {&black, &ambient, &composite})
        CHECK(share(each->lit, 255) > 0.97);
    CHECK(share(black.inShadow, 0) > 0.97);
    CHECK(share(ambient.inShadow, kept) > 0.97);
    CHECK(share(composite.inShadow, kept) > 0.97);
    CHECK(share(black.turnedAway, 0) == 1.0);
    CHECK(share(composite.turnedAway, 0) == 1.0);
    CHECK(share(ambient.turnedAway, kept) == 1.0);
}

TEST_CASE("a map with more edges than fit is looked up, and the picture stays")
{
    const test::DeviceTest silence;
    for (const std::string name : {"colonnade", "room"}) {
        CAPTURE(name);
        Stage stage(shippedScene(name), kSize);
        const ErrorCount fits = pooled(stage, stage.draw("mccool"));
        const ErrorCount looked = pooled(stage, stage.draw("mccool", {{"edges", 1.0}}));
        const ErrorCount again = pooled(stage, stage.draw("mccool"));
        MESSAGE(name << ": polygons wrong " << inWords(fits) << ", looked up " << inWords(looked));
        CHECK(fits.wrong() > 0);
        CHECK(looked.wrong() != fits.wrong()); // else nothing was looked up
        CHECK(double(looked.wrong()) <= 1.5 * double(fits.wrong()));
        CHECK(double(fits.wrong()) <= 1.5 * double(looked.wrong()));
        CHECK(again.wrong() == fits.wrong());
    }
}

TEST_CASE("the error of mccool falls by 1.4 to 2.6 with every doubling of its map from 512 to 4096")
{
    const test::DeviceTest silence;
    for (const std::string& name : sceneNames())
        checkScene(name);
}

} // namespace gnomon::exact
