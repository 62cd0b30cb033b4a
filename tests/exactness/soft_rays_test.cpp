// Soft shadows by rays against 256 rays a pixel, by the definitions' soft error; how many rays they take; and that they
// are ray_traced where a light has no radius.
#include "exactness/soft_reference.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr const char* kCoherence = "coherence_sampling";
constexpr const char* kEight = "eight_point_hybrid";
constexpr VkExtent2D kSize{100, 75};
constexpr double kCells = 64.0, kCoherenceBound = 0.03, kRayShare = 0.3, kEightBound = 0.08;

uint64_t raysOf(Stage& stage)
{
    return stage.session().shadows.stats().rays;
}

/// Of the lights that are served.
SoftError compareServed(const Pictures& pictures, const std::vector<SoftTruth>& truths)
{
    SoftError sum;
    for (size_t layer = 0; layer < pictures.size(); ++layer)
        if (pictures[layer].width > 0) sum += compareSoft(pictures[layer], truths[layer]);
    return sum;
}

void checkSoft(const std::string& what, const SoftError& error, double bound)
{
    MESSAGE(what << ": " << inWords(error));
    CHECK(error.mean() <= bound);
    CHECK(error.wrong == 0);
    CHECK(error.outside.sum <= 0.002 * double(error.outside.pixels));
    CHECK(error.notAskedOff <= 2);
}

/// Both methods on the lights of a scene that they serve, against the hard picture.
void check(const std::string& what, Scene scene, VkExtent2D size = kSize)
{
    CAPTURE(what);
    Stage stage(std::move(scene), size);
    stage.draw("ray_traced");
    const uint64_t asked = raysOf(stage);
    const std::vector<SoftTruth> truths = softTruths(stage);
    const SoftError hard = compareSoft(stage.truth, truths);
    MESSAGE(what << ", ray_traced: " << inWords(hard));
    CHECK(hard.penumbra.pixels > 150);
    CHECK(hard.mean() > 2.0 * kEightBound); // the bounds tell soft from hard
    const SoftError soft = compareSoft(stage.draw(kCoherence), truths);
    const double share = double(raysOf(stage)) / (kCells * double(asked));
    checkSoft(what + ", coherence_sampling with " + percentText(100.0 * share) + " of the rays", soft, kCoherenceBound);
    CHECK(share <= kRayShare);
    const SoftError eighths = compareServed(stage.draw(kEight), truths);
    if (eighths.outside.pixels > 0) checkSoft(what + ", eight_point_hybrid", eighths, kEightBound);
}

/// The first lights of a shipped scene, given a surface.
Scene softened(const std::string& name, float radius, uint32_t lights)
{
    Scene scene = shippedScene(name);
    if (scene.lights.size() > lights) scene.lights.resize(lights);
    for (demo::Light& light : scene.lights)
        light.radius = radius;
    return scene;
}

} // namespace

TEST_CASE(
    "penumbrae of single casters are off by 0.03 of the light at most, for 30 % of the rays; by 0.08 of eight points")
{
    const test::DeviceTest silence;
    check("box, spot", softScene(Caster::box, LightKind::Spot, 0.9, 0.3f));
    check("torus, point", softScene(Caster::torus, LightKind::Point, 1.6, 0.3f));
    check("sphere, sun", softScene(Caster::sphere, LightKind::Directional, 1.6, 0.1f));
    Scene standard = softScene(Caster::cylinder, LightKind::Spot, 1.6, 0.6f);
    standard.depth.convention = demo::DepthConvention::Standard;
    check("cylinder, wide spot, standard depth", std::move(standard));
}

TEST_CASE(
    "penumbrae of shipped scenes are off by 0.03 of the light at most, for 30 % of the rays; by 0.08 of eight points")
{
    const test::DeviceTest silence;
    check("torus_grid", softened("torus_grid", 0.6f, 1), {128, 72});
    check("room", softened("room", 0.3f, 2), {80, 45}); // a spot light and a point light
}

TEST_CASE("lights without a radius have ray_traced's picture bit by bit")
{
    const test::DeviceTest silence;
    Stage stage(testbed(demo::DepthConvention::ReversedInfinite), {160, 120});
    for (const char* method : {kCoherence, kEight}) {
        const Pictures pictures = stage.draw(method);
        for (size_t layer = 0; layer < pictures.size(); ++layer)
            if (pictures[layer].width > 0) CHECK(test::differences(pictures[layer], stage.truth[layer]) == 0);
    }
}

} // namespace gnomon::exact
