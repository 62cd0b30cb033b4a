// What pages by the pixel are worth beside cascades of the same memory, in the shipped scenes that reach far.
#include "exactness/stage.hpp"

namespace gnomon::exact {
namespace {

/// The scene under its sun or moon alone.
Scene underSun(const std::string& name)
{
    Scene scene = shippedScene(name);
    std::erase_if(scene.lights, [](const demo::Light& light) { return light.kind != LightKind::Directional; });
    REQUIRE(!scene.lights.empty());
    scene.lights.resize(1);
    return scene;
}

} // namespace

TEST_CASE("where casters reach farther than 100 m, pages are wrong on no more pixels than cascades of the same memory")
{
    const test::DeviceTest silence;
    for (const char* name : {"city_night", "forest_walk"}) {
        CAPTURE(name);
        for (const double time : {0.0, 4.0}) {
            Stage stage(underSun(name), {480, 270}, time);
            for (const double side : {256.0, 512.0}) {
                const ErrorCount four =
                    pooled(stage, stage.draw("cascades", {{"resolution", side}, {"cascades", 4.0}, {"filter", 1.0}}));
                const ErrorCount pages = pooled(stage, stage.draw("virtual_map", {{"resolution", 2.0 * side}}));
                MESSAGE(name << " at " << time << " s, " << side << " texels: cascades " << inWords(four)
                             << ", virtual_map " << inWords(pages) << ", ratio "
                             << double(pages.wrong()) / double(four.wrong()));
                CHECK(pages.counted == four.counted);
                CHECK(pages.counted > 10'000);
                CHECK(pages.wrong() <= four.wrong());
            }
        }
    }
}

TEST_CASE("filtered pages are no farther from the truth than a filtered map of the same memory")
{
    const test::DeviceTest silence;
    Stage stage(underSun("colonnade"), {320, 180});
    const double map =
        pooled(stage, stage.draw("shadow_map", {{"resolution", 1024.0}, {"filter", 3.0}})).meanAbsolute();
    const double pages =
        pooled(stage, stage.draw("virtual_map", {{"resolution", 1024.0}, {"filter", 3.0}})).meanAbsolute();
    MESSAGE("mean difference from the truth: one map of 1024 texels " << map << ", pages of as many " << pages);
    CHECK(pages <= map);
}

} // namespace gnomon::exact
