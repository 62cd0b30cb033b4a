// What pages by the pixel are worth beside cascades of the same memory, in the shipped scenes that reach far.
#include "exactness/stage.hpp"

namespace gnomon::exact {
namespace {

/// The scene under its first light of the kind alone.
Scene under(LightKind kind, const std::string& name)
{
    Scene scene = shippedScene(name);
    std::erase_if(scene.lights, [&](const demo::Light& light) { return light.kind != kind; });
    REQUIRE(!scene.lights.empty());
    scene.lights.resize(1);
    return scene;
}

} // namespace

TEST_CASE("where casters reach farther than 100 m, pages are wrong on no more pixels than cascades of the same memory")
{
    const test::DeviceTest silence;
    for (const char* name : {"city_night", "forest_walk"}) {
        CAPTURE(std::string(name));
        for (const double time : {0.0, 4.0}) {
            Stage stage(under(LightKind::Directional, name), {480, 270}, time);
            for (const double side : {256.0, 512.0}) {
                const ErrorCount four =
                    pooled(stage, stage.draw("cascades", {{"resolution", side}, {"cascades", 4.0}, {"filter", 1.0}}));
                const ErrorCount pages = pooled(stage, stage.draw("virtual_map", {{"resolution", 2.0 * side}}));
                MESSAGE(std::string(name)
                        << " at " << time << " s, " << side << " texels: cascades " << inWords(four) << ", virtual_map "
                        << inWords(pages) << ", ratio " << double(pages.wrong()) / double(four.wrong()));
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
    Stage stage(under(LightKind::Directional, "colonnade"), {320, 180});
    const double map =
        pooled(stage, stage.draw("shadow_map", {{"resolution", 1024.0}, {"filter", 3.0}})).meanAbsolute();
    const double pages =
        pooled(stage, stage.draw("virtual_map", {{"resolution", 1024.0}, {"filter", 3.0}})).meanAbsolute();
    MESSAGE("mean difference from the truth: one map of 1024 texels " << map << ", pages of as many " << pages);
    CHECK(pages <= map);
}

TEST_CASE(
    "in a room, where pages have nothing to gain, a spot light is little worse than with a map of the same memory")
{
    const test::DeviceTest silence;
    Stage stage(under(LightKind::Spot, "room"), {480, 270});
    for (const double side : {512.0, 1024.0}) {
        const ErrorCount map = pooled(stage, stage.draw("shadow_map", {{"resolution", side}}));
        const ErrorCount pages = pooled(stage, stage.draw("virtual_map", {{"resolution", side}}));
        MESSAGE(side << " texels: shadow_map " << inWords(map) << ", virtual_map " << inWords(pages));
        CHECK(pages.counted == map.counted);
        CHECK(map.wrong() > 50);
        // Its levels are a factor of two apart: all but half of the texels may be where none are needed.
        CHECK(double(pages.wrong()) <= 1.5 * double(map.wrong()));
    }
}

} // namespace gnomon::exact
