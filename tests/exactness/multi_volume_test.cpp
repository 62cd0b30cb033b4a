// A light with a surface as the mean of shadow volumes of many lights without, against rays to its surface.
#include "exactness/soft_reference.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr const char* kMultiVolume = "multi_volume";
constexpr VkExtent2D kSize{96, 72};

Scene panelScene()
{
    Scene scene = softScene(Caster::torus, LightKind::Spot, 1.6, 0.0f);
    setRectangle(scene.lights[0], {0.5f, 0.15f});
    return scene;
}

} // namespace

TEST_CASE("volumes of 64 points are within an RMSE of 0.03 of 1 024 rays, those of 4 are farther off by half")
{
    const test::DeviceTest silence;
    for (const Scene& scene : {panelScene(), softScene(Caster::torus, LightKind::Spot, 1.6, 0.3f),
                               softScene(Caster::box, LightKind::Point, 0.9, 0.3f),
                               softScene(Caster::box, LightKind::Directional, 0.9, 0.1f)}) {
        const std::string name = scene.lights[0].rectangle.x > 0.0f ? "rectangle" : demo::nameOf(scene.lights[0].kind);
        CAPTURE(name);
        Stage stage(scene, kSize);
        const std::vector<SoftTruth> truths = tracedSoftTruths(stage);
        const SoftError many = compareSoft(stage.draw(kMultiVolume, {{"side", 8.0}}), truths),
                        few = compareSoft(stage.draw(kMultiVolume, {{"side", 2.0}}), truths);
        MESSAGE(name << ", 64 points: RMSE " << many.penumbra.rmse() << ", mean " << inWords(many)
                     << "; 4: " << inWords(few));
        CHECK(many.penumbra.pixels > 150);
        CHECK(many.penumbra.rmse() < 0.03);
        CHECK(1.5 * many.penumbra.rmse() < few.penumbra.rmse());
        CHECK(many.outside.rmse() < 0.01);
        CHECK(many.notAskedOff == 0);
    }
}

TEST_CASE("a light without a surface has the picture of all_edges_volume, bit for bit")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Directional}) {
        Stage stage(softScene(Caster::torus, kind, 1.6, 0.0f), kSize);
        const Pictures volumes = stage.draw("all_edges_volume");
        CHECK(test::differences(stage.draw(kMultiVolume)[0], volumes[0]) == 0);
    }
}

} // namespace gnomon::exact
