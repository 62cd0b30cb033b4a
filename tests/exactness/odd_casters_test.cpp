// Casters that are no simple solids, open, non-manifold, turned against themselves or passing through each other, under
// every method of algorithms/volumes: each is held to its own bounds. MESSAGE prints what is measured.
#include "exactness/soft_reference.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{1280, 720}, kSoftSize{240, 160};

ErrorCount errorOf(Stage& stage, const std::string& method, const Setting& setting)
{
    const ErrorCount error = pooled(stage, stage.draw(method, {setting}));
    MESSAGE(method << " " << setting.value << ": wrong " << inWords(error));
    return error;
}

double percentOf(const ErrorCount& error)
{
    return error.percent(error.wrong());
}

} // namespace

TEST_CASE("exact volumes show odd casters as rays do, whichever way volumes are counted")
{
    const test::DeviceTest silence;
    Stage stage(oddCasters(), kSize);
    for (const std::string method : {"stencil_volume", "octree_volume", "all_edges_volume"})
        for (const double zFail : {0.0, 1.0}) {
            CAPTURE(method);
            CAPTURE(zFail);
            const Pictures pictures = stage.draw(method, {{"z_fail", zFail}});
            const ErrorCount error = pooled(stage, pictures);
            uint64_t clear = 0;
            for (size_t layer = 0; layer < pictures.size(); ++layer)
                clear += clearlyWrong(stage.scene(), stage, pictures[layer], layer);
            MESSAGE(method << " z_fail " << zFail << ": wrong " << inWords(error) << ", clearly " << clear);
            CHECK(percentOf(error) <= 0.005);
            CHECK(clear <= 2);
        }
}

TEST_CASE("methods that sample show odd casters as well as their maps, rows and planes allow")
{
    const test::DeviceTest silence;
    Stage stage(oddCasters(), kSize);
    CHECK(percentOf(errorOf(stage, "chan_durand", {"resolution", 512.0})) <= 0.1);

    // Edges are the map's here.
    const GnTraits mapped = ~GnTraits(GN_TRAIT_POINT_BIT);
    const ErrorCount map = pooled(stage, stage.draw("shadow_map", {{"resolution", 1024.0}}), mapped);
    const ErrorCount toggled = pooled(stage, stage.draw("mccool", {{"resolution", 1024.0}}), mapped);
    MESSAGE("mccool: wrong " << inWords(toggled) << ", looked up " << inWords(map));
    CHECK(10 * toggled.wrong() <= 11 * map.wrong());

    const double coarse = percentOf(errorOf(stage, "angular_spans", {"rows", 75.0}));
    const double fine = percentOf(errorOf(stage, "angular_spans", {"rows", 600.0}));
    CHECK(coarse >= 1.4 * 1.4 * 1.4 * fine); // three doublings
    CHECK(coarse <= 2.6 * 2.6 * 2.6 * fine);
}

// Off its plane a planar method is wrong; on it, planar_test.cpp asks the same of odd casters as of others.

// Where a caster is open or there twice, every layer of its outline counts ("Artefacts" in penumbra_wedges.md): its
// penumbra is then no better than a hard edge, and no worse.
TEST_CASE("penumbrae of a caster that passes through itself are right, of other odd ones no worse than hard edges")
{
    const test::DeviceTest silence;
    const Scene all = oddCasters();
    for (size_t caster = 1; caster < all.instances.size(); ++caster) {
        Scene scene = all;
        scene.instances = {all.instances[0], all.instances[caster]};
        scene.lights = {all.lights[1]};
        scene.lights[0].radius = 0.3f;
        Stage stage(scene, kSoftSize);
        const std::vector<SoftTruth> truths = softTruths(stage);
        const SoftError soft = compareSoft(stage.draw("penumbra_wedges"), truths);
        const SoftError hard = compareSoft(stage.truth, truths);
        const std::string& name = scene.instances[1].name;
        CAPTURE(name);
        MESSAGE(name << ": " << inWords(soft) << "; ray_traced " << inWords(hard));
        CHECK(soft.penumbra.pixels > 150);
        CHECK(soft.mean() <= (name == "crossing" ? 0.06 : 1.05 * hard.mean()));
        // Two pixels in the corners between fins and ring, dark by the truth with lit ones all round.
        CHECK(soft.wrong <= (name == "finned" ? 2 : 0));
    }
}

} // namespace gnomon::exact
