// Casters and receivers close to a lamp whose farthest caster is far away: the near end of its map must not swallow
// them.
#include "demo/scene/primitives.hpp"
#include "exactness/stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

double wrongPercent(Stage& stage, const std::string& method, Settings settings = {})
{
    settings.push_back({"resolution", 1024.0});
    const ErrorCount error = pooled(stage, stage.draw(method, settings));
    MESSAGE(stage.scene().lights[0].name << ": " << method << " wrong " << inWords(error));
    CHECK(error.counted > 5000);
    return error.percent(error.wrong());
}

/// A shade and a plate under it, both before the near end of the lamp's map, seen from close by.
Scene shadeOverPlate(LightKind kind)
{
    Scene scene = lampOverPlain(kind);
    const auto add = [&](const char* name, float side, const glm::dvec3& position) {
        demo::Mesh& mesh = scene.meshes.emplace_back(demo::makePlane({.width = side, .depth = side}));
        mesh.name = name;
        demo::Instance& instance = scene.instances.emplace_back();
        instance.name = name;
        instance.mesh = static_cast<uint32_t>(scene.meshes.size() - 1);
        instance.pose.position = scene.lights[0].position + position;
    };
    add("shade", 0.02f, {0.0, -0.03, 0.0});
    add("plate", 0.3f, {0.0, -0.1, 0.0});
    scene.camera = {{.eye = {0.0, 4.12, 0.3}, .target = {0.0, 3.9, 0.0}}};
    return scene;
}

} // namespace

TEST_CASE("what lies between a lamp and the near end of its map is traced, not called lit")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point}) {
        Stage stage(shadeOverPlate(kind), {320, 180});
        size_t dark = 0;
        for (size_t i = 0; i < stage.truth[0].texels.size(); ++i)
            dark += stage.counted[0][i] != 0 && stage.truth[0].texels[i] == 0;
        CHECK(dark > 500); // on the plate
        CHECK(wrongPercent(stage, "pcf_hybrid") < 0.05);
        for (const double mode : {0.0, 1.0, 2.0})
            CHECK(wrongPercent(stage, "contour_chain", {{"mode", mode}}) < 0.05);
    }
}

TEST_CASE("a card just under a lamp casts on a plain that reaches a hundred times as far")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point}) {
        Stage stage(lampOverPlain(kind), {320, 180});
        const bool spot = kind == LightKind::Spot;
        size_t dark = 0;
        for (size_t i = 0; i < stage.truth[0].texels.size(); ++i)
            dark += stage.counted[0][i] != 0 && stage.truth[0].texels[i] == 0;
        CHECK(dark > 2000); // card and crate
        CHECK(wrongPercent(stage, spot ? "shadow_map" : "cube_map") < 1.0);
        CHECK(wrongPercent(stage, "pcf_hybrid") < 0.05);
    }
}

TEST_CASE("nor does a ground that reaches a hundred kilometres take the shadows near a lamp of unlimited range")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point}) {
        Scene scene = lampOverPlain(kind);
        place(scene, "sea", demo::makePlane({.width = 2e5f, .depth = 2e5f, .columns = 100, .rows = 100}),
              {0.0, -1.0, 0.0});
        Stage stage(scene, {320, 180});
        const bool spot = kind == LightKind::Spot;
        for (const char* method : {spot ? "shadow_map" : "cube_map", "virtual_map"})
            CHECK(wrongPercent(stage, method) < 1.0);
    }
}

TEST_CASE("triangles that end a kilometre away do not shadow themselves under a lamp close to them")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point}) {
        Stage stage(lampsOverLargeTriangles(kind, 12), {320, 240});
        const bool spot = kind == LightKind::Spot;
        for (const std::string method : {spot ? "shadow_map" : "cube_map", "pcf_hybrid", "contour_chain"}) {
            const Pictures pictures = stage.draw(method, {{"resolution", 512.0}});
            const ErrorCount error = pooled(stage, pictures);
            MESSAGE(std::string(nameOf(kind)) << ", " << method << ": wrong " << inWords(error));
            CHECK(error.counted > 50'000);
            CHECK(error.percent(error.wrong()) < 0.5);
        }
    }
}

} // namespace gnomon::exact
