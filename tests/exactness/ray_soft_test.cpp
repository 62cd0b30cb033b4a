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

bool canTrace(Stage& stage)
{
    return test::tracesRays(stage.session().shadows.context());
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

namespace {

/// What a diffuse receiver gets of a rectangle, but for factors of its own: by elements of its surface, as a host's own
/// shading has it, and what of that is seen.
struct Irradiance {
    double whole = 0.0, seen = 0.0;
};

/// From 16 x 16 parts of the rectangle, at their centres, each as bright as the cosines at both ends and the distance
/// say. \param normal unit
Irradiance irradianceOf(const brute::Scene& casters, const glm::dvec3& from, const glm::dvec3& normal,
                        const demo::Light& light)
{
    constexpr int kSide = 16;
    const RectangleAxes axes = rectangleAxes(light);
    const glm::dvec3 facing = glm::normalize(light.direction);
    Irradiance sum;
    for (int i = 0; i < kSide * kSide; ++i) {
        const double u = (i % kSide + 0.5) * 2.0 / kSide - 1.0, v = (i / kSide + 0.5) * 2.0 / kSide - 1.0;
        const glm::dvec3 way = light.position + u * axes.x + v * axes.y - from;
        const double squared = glm::dot(way, way),
                     part = 4.0 * glm::length(axes.x) * glm::length(axes.y) / (kSide * kSide);
        const double shines =
            part * std::max(glm::dot(normal, way), 0.0) * -glm::dot(facing, way) / (squared * squared);
        sum.whole += shines;
        if (shines > 0.0 && !casters.blocked(from, way, 1.0)) sum.seen += shines;
    }
    return sum;
}

/// The same without casters in closed form: the polygon's part above the horizon, and Lambert's sum over its edges.
/// Source: E. Heitz, J. Dupuy, S. Hill and D. Neubelt, "Real-time polygonal-light shading with linearly transformed
/// cosines", ACM Transactions on Graphics 35(4), 2016, 4.
double lambertIrradiance(const glm::dvec3& from, const glm::dvec3& normal, const demo::Light& light)
{
    const RectangleAxes axes = rectangleAxes(light);
    std::vector<glm::dvec3> above;
    const glm::dvec3 centre = light.position - from;
    const glm::dvec3 corners[] = {centre - axes.x - axes.y, centre + axes.x - axes.y, centre + axes.x + axes.y,
                                  centre - axes.x + axes.y};
    for (int i = 0; i < 4; ++i) {
        const glm::dvec3 &a = corners[i], &b = corners[(i + 1) % 4];
        const double highA = glm::dot(normal, a), highB = glm::dot(normal, b);
        if (highA > 0.0) above.push_back(a);
        if ((highA > 0.0) != (highB > 0.0)) above.push_back(glm::mix(a, b, highA / (highA - highB)));
    }
    double sum = 0.0;
    for (size_t i = 0; i < above.size(); ++i) {
        const glm::dvec3 a = glm::normalize(above[i]), b = glm::normalize(above[(i + 1) % above.size()]);
        const glm::dvec3 across = glm::cross(a, b);
        const double sine = glm::length(across);
        if (sine > 0.0) sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(normal, across) / sine;
    }
    return 0.5 * std::abs(sum);
}

/// Visibility by what is seen of the irradiance, of the first light.
SoftTruth weightedTruth(const Stage& stage)
{
    const brute::Scene casters(bruteTriangles(stage));
    const brute::View view = bruteView(stage);
    const brute::Light light = bruteLight(stage, 0);
    SoftTruth truth;
    Rmse ofClosedForm;
    for (uint32_t y = 0; y < kSize.height; ++y) {
        for (uint32_t x = 0; x < kSize.width; ++x) {
            const glm::dvec3 normal = glm::normalize(drawnNormal(stage, x, y));
            const brute::Answer answer =
                brute::answerAt(view, light, casters, int(x), int(y), *stage.surfaces.depth.at(x, y), normal);
            const bool asked = answer.state == brute::State::asked && !answer.grazing;
            truth.asked.push_back(asked);
            truth.visibility.push_back(answer.lit);
            if (!asked) continue;
            const glm::dvec3 from = answer.receiver + normal * answer.offset;
            const Irradiance sum = irradianceOf(casters, from, normal, stage.scene().lights[0]);
            const double whole = lambertIrradiance(from, normal, stage.scene().lights[0]);
            ofClosedForm.add(sum.whole / whole - 1.0);
            truth.visibility.back() = sum.seen / sum.whole;
        }
    }
    CHECK(ofClosedForm.value() < 0.01);
    return truth;
}

} // namespace

// Against each truth after 64 frames of one ray. The truths are far apart where a part of the rectangle is below the
// horizon: by area it counts as hidden.
TEST_CASE("weighted rays see of a rectangle what multiplies its unshadowed light to what arrives")
{
    const test::DeviceTest silence;
    Stage stage(shippedScene("views/still_life"), kSize);
    if (!canTrace(stage)) return;
    const SoftTruth weighted = weightedTruth(stage), byArea = softTruths(stage)[0];
    for (const bool isWeighted : {false, true}) {
        const Settings settings = {{"rays", 1.0}, {"weighted", double(isWeighted)}};
        Image8 picture;
        for (int i = 0; i < 64; ++i)
            picture = stage.draw(kSoft, settings)[0];
        dump(isWeighted ? "still life, weighted" : "still life", picture);
        const SoftError own = compareSoft(picture, isWeighted ? weighted : byArea);
        const SoftError other = compareSoft(picture, isWeighted ? byArea : weighted);
        MESSAGE(std::string(isWeighted ? "weighted" : "by area")
                << ": RMSE in the penumbra " << own.penumbra.rmse() << " over " << own.penumbra.pixels << ", outside "
                << own.outside.rmse() << "; against the other truth " << other.penumbra.rmse() << ", "
                << other.outside.rmse());
        CHECK(own.penumbra.pixels > 300);
        CHECK(own.penumbra.rmse() < 0.02);
        CHECK(own.outside.rmse() < 0.02);
        CHECK(other.penumbra.rmse() > 1.5 * own.penumbra.rmse());
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

namespace {

/// The scene, and its camera on a way of a metre a second.
Scene panned(Scene scene)
{
    scene.camera.resize(1);
    scene.camera.push_back(scene.camera[0]);
    scene.camera[1].time = 1.0;
    scene.camera[1].eye += glm::dvec3(1.0, 0.1, -0.3);
    return scene;
}

/// RMSE in the penumbra of the next frame, and of hard shadows.
struct NextOff {
    double soft, hard;
};
NextOff drawNext(Stage& stage, double time)
{
    stage.goTo(time);
    const Pictures pictures = stage.draw(kSoft);
    const std::vector<SoftTruth> truths = tracedSoftTruths(stage);
    const SoftError soft = compareSoft(pictures, truths), hard = compareSoft(stage.truth, truths);
    CHECK(soft.penumbra.pixels > 300);
    return {soft.penumbra.rmse(), hard.penumbra.rmse()};
}

} // namespace

TEST_CASE("the second frame beside a camera that moves is no worse than the first")
{
    const test::DeviceTest silence;
    Stage stage(panned(softScene(Caster::torus, LightKind::Point, 1.6, 0.3f)), kSize);
    if (!canTrace(stage)) return;
    const double begun = drawNext(stage, 0.0).soft, next = drawNext(stage, 1.0 / 60.0).soft;
    MESSAGE("RMSE " << begun << ", then " << next);
    CHECK(next <= begun);
}

// Penumbrae of one to four pixels, of three lights.
TEST_CASE(
    "narrow penumbrae beside a camera and a caster that move are nearer to the truth than hard shadows, by a third")
{
    const test::DeviceTest silence;
    Stage stage(panned(shippedScene("views/soft_table")), {160, 90});
    if (!canTrace(stage)) return;
    for (int frame = 0; frame < 8; ++frame) {
        const NextOff off = drawNext(stage, frame / 60.0);
        MESSAGE("frame " << frame << ": RMSE " << off.soft << ", hard " << off.hard);
        CHECK(1.5 * off.soft <= off.hard);
    }
}

} // namespace gnomon::exact
