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

/// The first light of a kind alone: several with such maps do not fit the memory of a small device.
Scene onlyFirst(Scene scene, LightKind kind)
{
    const auto first = std::find_if(scene.lights.begin(), scene.lights.end(),
                                    [&](const demo::Light& light) { return light.kind == kind; });
    if (first == scene.lights.end())
        scene.lights.clear();
    else
        scene.lights = {*first};
    return scene;
}

ErrorCount errorOf(const Scene& scene, double side)
{
    if (scene.lights.empty()) return {};
    Stage stage(scene, {1280, 720}); // with all the memory
    return pooled(stage, stage.draw("mccool", {{"resolution", side}}));
}

// An edge of a box is right or wrong along its whole length, some 50 pixels here: of fewer wrong pixels than four such
// edges the fall from one map to the next is chance, and only that over all maps is held.
constexpr uint64_t kFewWrong = 200;

/// \return by how much the error falls.
double checkFalls(const std::string& name, const ErrorCount& coarse, const ErrorCount& fine)
{
    const double before = coarse.percent(coarse.wrong()), now = fine.percent(fine.wrong());
    MESSAGE(name << ": wrong " << inWords(coarse) << ", with twice the texels " << inWords(fine) << ": falls "
                 << before / now << " times");
    CHECK(fine.wrong() > 20);
    if (fine.wrong() >= kFewWrong) {
        CHECK(before >= 1.4 * now);
        CHECK(before <= 2.6 * now);
    }
    return before / now;
}

/// Pooled over the first light of each kind. Six maps of 4096 texels, and as many of the static casters, are more than
/// a device of 2 GiB lends, so the last doubling is without point lights.
void checkScene(const std::string& name)
{
    CAPTURE(name);
    ErrorCount all[3], last[2]; // 512, 1024, 2048; 2048, 4096
    for (const KindOfLight& light : kKinds) {
        const Scene scene = onlyFirst(shippedScene(name), light.kind);
        for (size_t i = 0; i < 3; ++i) {
            const ErrorCount error = errorOf(scene, double(512 << i));
            all[i] += error;
            if (i == 2 && light.kind != LightKind::Point) last[0] += error;
        }
        if (light.kind != LightKind::Point) last[1] += errorOf(scene, 4096.0);
    }
    const double doubling = std::cbrt(checkFalls(name, all[0], all[1]) * checkFalls(name, all[1], all[2]) *
                                      checkFalls(name, last[0], last[1]));
    CHECK(doubling >= 1.4);
    CHECK(doubling <= 2.6);
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
