// Soft shadows by a few rays a pixel on the device, against 256 rays of the brute force: how far they are off at first
// and after a while, at depth gaps, behind what moves, and beside a camera that moves. On devices without ray queries
// there is nothing to compare.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include "demo/io/png.hpp"
#include "demo/scene/primitives.hpp"
#include "exactness/soft_reference.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr const char* kSoft = "ray_soft";
constexpr VkExtent2D kSize{160, 120};

bool canTrace(const Stage& stage)
{
    return std::ranges::any_of(stage.methods(),
                               [](const GnMethodInfo& method) { return std::string_view(method.pName) == kSoft; });
}

struct Rmse {
    double squares = 0.0;
    uint64_t count = 0;
    void add(double off) { squares += off * off, ++count; }
    double value() const { return count ? std::sqrt(squares / double(count)) : 0.0; }
};

double offAt(const Image8& picture, const SoftTruth& truth, size_t i)
{
    return std::abs(picture.texels[i] / 255.0 - truth.visibility[i]);
}

/// Over pixels that the light reaches and that some of it may be hidden from.
double rmseOf(const Image8& picture, const SoftTruth& truth)
{
    Rmse error;
    for (size_t i = 0; i < truth.visibility.size(); ++i)
        if (truth.asked[i] && truth.visibility[i] > 0.0 && truth.visibility[i] < 1.0)
            error.add(offAt(picture, truth, i));
    CHECK(error.count > 300);
    return error.value();
}

/// For a look at what a bound found; where $GNOMON_TEST_PICTURES names a folder.
void dump(const std::string& name, const Image8& picture)
{
    const char* folder = std::getenv("GNOMON_TEST_PICTURES");
    if (folder) REQUIRE(demo::writePng(std::string(folder) + "/" + name + ".png", picture));
}

/// As when the light is first seen.
Image8 first(Stage& stage, double rays)
{
    return stage.draw(kSoft, {{"rays", rays}, {"frames", 1.0}})[0];
}

/// After so many frames in which nothing moves. @param ms of the last of them
Image8 settled(Stage& stage, double rays, int frames, double& ms)
{
    (void)first(stage, rays);
    Image8 picture;
    for (int i = 1; i < frames; ++i) {
        const auto start = std::chrono::steady_clock::now();
        picture = stage.draw(kSoft, {{"rays", rays}})[0];
        ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    }
    return picture;
}

struct Bounds {
    double atFirst[3], atLast[3]; ///< Of 1, 2 and 4 rays: RMSE.
};

void check(const std::string& what, Scene scene, const Bounds& bounds)
{
    CAPTURE(what);
    Stage stage(std::move(scene), kSize);
    if (!canTrace(stage)) return;
    const SoftTruth truth = softTruths(stage)[0];
    const double hard = rmseOf(stage.truth[0], truth);
    for (int i = 0; i < 3; ++i) {
        const double rays = 1 << i;
        const Image8 begun = first(stage, rays);
        double ms = 0.0;
        const Image8 done = settled(stage, rays, 64, ms);
        const double before = rmseOf(begun, truth), after = rmseOf(done, truth);
        MESSAGE(what << ", " << rays << " rays: RMSE " << before << " in the first frame, " << after << " after 64, "
                     << ms << " ms; hard " << hard << "; " << inWords(compareSoft(done, truth)));
        dump(what + ", " + std::to_string(int(rays)) + ", first", begun);
        dump(what + ", " + std::to_string(int(rays)) + ", last", done);
        CHECK(before <= bounds.atFirst[i]);
        CHECK(after <= bounds.atLast[i]);
        const SoftError error = compareSoft(done, truth);
        CHECK(error.wrong == 0);
        CHECK(error.notAskedOff <= 2);
    }
}

} // namespace

TEST_CASE("penumbrae are near the truth at once, and nearer after 64 frames")
{
    const test::DeviceTest silence;
    // A sixth above what was measured. Of the error after 64 frames 0.008 is the truth's own, and 0.001 that of bytes.
    constexpr Bounds kBounds{{0.11, 0.08, 0.056}, {0.019, 0.0155, 0.012}};
    constexpr Bounds kNarrow{{0.17, 0.102, 0.068}, {0.0195, 0.0155, 0.012}}; // five pixels: few to average
    check("box, spot", softScene(Caster::box, LightKind::Spot, 0.9, 0.3f), kBounds);
    check("torus, point", softScene(Caster::torus, LightKind::Point, 1.6, 0.3f), kBounds);
    check("sphere, sun", softScene(Caster::sphere, LightKind::Directional, 1.6, 0.1f), kNarrow);
    Scene standard = softScene(Caster::cylinder, LightKind::Spot, 1.6, 0.6f);
    standard.depth.convention = demo::DepthConvention::Standard;
    check("cylinder, wide spot, standard depth", std::move(standard), kBounds);
}

TEST_CASE("lights without a radius have ray_query's picture bit by bit")
{
    const test::DeviceTest silence;
    Stage stage(testbed(demo::DepthConvention::ReversedInfinite), kSize);
    if (!canTrace(stage)) return;
    const Pictures soft = stage.draw(kSoft), hard = stage.draw("ray_query");
    for (size_t layer = 0; layer < hard.size(); ++layer)
        CHECK(test::differences(soft[layer], hard[layer]) == 0);
}

namespace {

/// Pixels beside one that is nearer or farther away by a tenth.
std::vector<uint8_t> gapsOf(const Stage& stage)
{
    const auto farAway = [&stage](uint32_t x, uint32_t y) {
        return 1.0 / std::max(*stage.surfaces.depth.at(x, y), 1e-6f);
    };
    std::vector<uint8_t> gaps(size_t{kSize.width} * kSize.height);
    for (uint32_t y = 2; y + 2 < kSize.height; ++y)
        for (uint32_t x = 2; x + 2 < kSize.width; ++x)
            for (const auto& [dx, dy] : {std::pair(-2, 0), {2, 0}, {0, -2}, {0, 2}}) {
                const double ratio = farAway(x, y) / farAway(uint32_t(int(x) + dx), uint32_t(int(y) + dy));
                gaps[y * kSize.width + x] |= ratio > 1.1 || ratio < 1.0 / 1.1;
            }
    return gaps;
}

/// A post before the eye, in the light, and behind it the shadow of a slab.
Scene postBeforeShadow()
{
    Scene scene = softScene(Caster::box, LightKind::Spot, 1.6, 0.4f);
    scene.instances[1].pose.scale = glm::dvec3(1.6, 0.2, 1.6);
    place(scene, "post", demo::makeCylinder({.radius = 0.06f, .topRadius = 0.06f, .height = 2.0f, .segments = 16}),
          {0.7, 0.6, 1.4});
    return scene;
}

} // namespace

TEST_CASE("what is seen beside a depth gap takes nothing over from behind it")
{
    const test::DeviceTest silence;
    Stage stage(postBeforeShadow(), kSize);
    if (!canTrace(stage)) return;
    const SoftTruth truth = softTruths(stage)[0];
    const std::vector<uint8_t> gaps = gapsOf(stage);
    double ms = 0.0;
    for (const int frames : {2, 32}) {
        const Image8 picture = settled(stage, 2, frames, ms);
        dump("gap after " + std::to_string(frames), picture);
        Rmse error;
        double worst = 0.0;
        for (size_t i = 0; i < gaps.size(); ++i) {
            if (!gaps[i] || !truth.asked[i] || (truth.visibility[i] > 0.0 && truth.visibility[i] < 1.0)) continue;
            error.add(offAt(picture, truth, i));
            worst = std::max(worst, offAt(picture, truth, i));
        }
        MESSAGE("beside gaps, lit or dark: RMSE " << error.value() << " over " << error.count << ", worst " << worst);
        CHECK(error.count > 100);
        CHECK(error.value() <= 0.02);
        CHECK(worst <= 0.2);
    }
}

TEST_CASE("behind a caster that moves no shadow stays")
{
    const test::DeviceTest silence;
    Scene scene = softScene(Caster::box, LightKind::Spot, 1.2, 0.3f);
    demo::Instance& box = scene.instances[1];
    box.keys = {{.time = 0.0, .pose = box.pose}, {.time = 1.0, .pose = box.pose}};
    box.keys[0].pose.position.x = -1.5;
    box.keys[1].pose.position.x = 1.5;
    Stage stage(std::move(scene), kSize);
    if (!canTrace(stage)) return;
    constexpr double kFrame = 1.0 / 60.0;
    std::vector<SoftTruth> before;
    for (int frame = 20; frame < 40; ++frame) {
        stage.goTo(frame * kFrame);
        before.push_back(softTruths(stage)[0]);
        const Image8 picture = stage.draw(kSoft, {{"rays", 1.0}})[0];
        if (frame < 35) continue;
        const SoftTruth& now = before.back();
        Rmse left, penumbra;
        for (size_t i = 0; i < now.visibility.size(); ++i) {
            if (!now.asked[i]) continue;
            const bool wasDark =
                std::ranges::any_of(before, [i](const SoftTruth& past) { return past.visibility[i] < 0.1; });
            if (now.visibility[i] == 1.0 && wasDark) left.add(offAt(picture, now, i));
            if (now.visibility[i] > 0.0 && now.visibility[i] < 1.0) penumbra.add(offAt(picture, now, i));
        }
        dump("moving " + std::to_string(frame), picture);
        MESSAGE("where the shadow was: RMSE " << left.value() << " over " << left.count << "; penumbra "
                                              << penumbra.value() << " over " << penumbra.count);
        CHECK(left.count > 100);
        CHECK(left.value() <= 0.02);
        CHECK(penumbra.value() <= 0.12);
    }
}

TEST_CASE("a camera that moves keeps what it has seen of the same places")
{
    const test::DeviceTest silence;
    Scene scene = softScene(Caster::torus, LightKind::Spot, 1.2, 0.4f);
    scene.camera.push_back(scene.camera[0]);
    scene.camera[1].time = 1.0;
    scene.camera[1].eye += glm::dvec3(1.5, 0.2, -0.5);
    Stage stage(std::move(scene), kSize);
    if (!canTrace(stage)) return;
    for (int frame = 0; frame < 40; ++frame) {
        stage.goTo(frame / 60.0);
        const Image8 picture = stage.draw(kSoft, {{"rays", 1.0}})[0];
        if (frame != 39) continue;
        const SoftTruth truth = softTruths(stage)[0];
        const double kept = rmseOf(picture, truth), alone = rmseOf(first(stage, 1.0), truth);
        dump("camera", picture);
        MESSAGE("with a past: RMSE " << kept << ", without " << alone);
        CHECK(kept <= 0.75 * alone);
    }
}

} // namespace gnomon::exact
