// Soft shadows against 256 rays a pixel, by the definitions' soft error.
#include "exactness/soft_reference.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr const char* kWedges = "penumbra_wedges";
constexpr VkExtent2D kSize{160, 120};

struct Setup {
    Caster caster = Caster::box;
    double height = 1.0; ///< Of the caster's centre over the floor, metres.
    float radius = 0.3f;
    LightKind kind = LightKind::Point;
    demo::DepthConvention convention = demo::DepthConvention::ReversedInfinite;
};

std::string inWords(const Setup& setup)
{
    const char* names[] = {"box", "sphere", "cylinder", "torus"};
    return std::string(names[size_t(setup.caster)]) + " " + std::to_string(setup.height) + " m high, " +
           demo::nameOf(setup.kind) + " light of radius " + std::to_string(setup.radius) + ", " +
           demo::nameOf(setup.convention) + " depth";
}

Scene sceneOf(const Setup& setup)
{
    Scene scene = softScene(setup.caster, setup.kind, setup.height, setup.radius);
    scene.depth.convention = setup.convention;
    return scene;
}

/// 0.06 is what is asked of the method; what it makes of a setup is a quarter of that or less where the source is small
/// before caster and distance.
void check(const Setup& setup, double bound)
{
    const std::string what = inWords(setup);
    CAPTURE(what);
    Stage stage(sceneOf(setup), kSize);
    const std::vector<SoftTruth> truths = softTruths(stage);
    const SoftError soft = compareSoft(stage.draw(kWedges), truths), hard = compareSoft(stage.truth, truths);
    MESSAGE(what << ": " << inWords(soft) << "; ray_traced " << inWords(hard));
    CHECK(soft.penumbra.pixels > 150);
    CHECK(soft.mean() <= bound);
    CHECK(5.0 * soft.mean() <= hard.mean());
    CHECK(soft.wrong == 0);
    CHECK(soft.outside.sum <= 0.001 * double(soft.outside.pixels));
    CHECK(soft.notAskedOff <= 2);
}

} // namespace

TEST_CASE("penumbrae of a box are off by at most 0.015 on average")
{
    const test::DeviceTest silence;
    check({.caster = Caster::box, .height = 1.6, .radius = 0.1f}, 0.015);
    check({.caster = Caster::box, .height = 0.9, .radius = 0.3f, .kind = LightKind::Spot}, 0.015);
    check({.caster = Caster::box, .height = 1.6, .radius = 0.6f, .convention = demo::DepthConvention::Standard}, 0.015);
    check({.caster = Caster::box, .height = 0.9, .radius = 0.6f}, 0.015);
}

TEST_CASE("penumbrae of round casters are off by at most 0.06 on average, 0.02 where the source is small")
{
    const test::DeviceTest silence;
    for (const Caster caster : {Caster::sphere, Caster::cylinder}) {
        check({.caster = caster, .height = 1.6, .radius = 0.25f, .kind = LightKind::Spot}, 0.02);
        check({.caster = caster, .height = 0.9, .radius = 0.6f}, 0.06);
        check({.caster = caster, .height = 1.6, .radius = 0.6f, .convention = demo::DepthConvention::Standard}, 0.06);
    }
}

TEST_CASE("penumbrae of a torus, whose outline goes round twice, are off by at most 0.03 on average")
{
    const test::DeviceTest silence;
    check({.caster = Caster::torus, .height = 1.6, .radius = 0.3f}, 0.03);
}

// The box covers only what the floor leaves of the disc. Taken for a share of all of it, what is outside of the
// penumbra is off by 0.066 on average.
TEST_CASE("a box that stands on a floor hides all that is above the floor of a lamp that the floor cuts")
{
    const test::DeviceTest silence;
    Scene scene = softScene(Caster::box, LightKind::Spot, 0.5, 0.6f);
    scene.lights[0].position = {-2.5, 0.4, 0.0};
    scene.lights[0].direction = {1.0, 0.0, 0.0};
    Stage stage(std::move(scene), kSize);
    const SoftError error = compareSoft(stage.draw(kWedges), tracedSoftTruths(stage, 256));
    MESSAGE(inWords(error));
    CHECK(error.penumbra.pixels > 5000);
    CHECK(error.outside.pixels > 500); // behind the box
    CHECK(error.mean() <= 0.03);
    CHECK(error.outside.mean() <= 0.01);
}

} // namespace gnomon::exact
