// Soft shadows from depth maps: how wide penumbrae are, that no light gets into the umbra, and what the pyramid of
// nearest and farthest depths saves.
#include <algorithm>
#include <cmath>

#include <glm/gtc/quaternion.hpp>

#include "demo/scene/primitives.hpp"
#include "exactness/soft_reference.hpp"
#include "exactness/testbed.hpp"
#include "shaders/filtered/pcss.h"

namespace gnomon::exact {
namespace {

constexpr const char* kPcss = "pcss";
constexpr VkExtent2D kSize{160, 120};

/// Metres along x on the floor from where a tenth of the lamp is seen to where nine tenths are, from all pixels of the
/// ramp: the slope of the line that fits them best.
double widthOnFloor(const Stage& stage, const Image8& picture)
{
    const brute::View view = bruteView(stage);
    const brute::Light light = bruteLight(stage, 0);
    const brute::Scene casters(bruteTriangles(stage));
    double n = 0.0, x = 0.0, v = 0.0, xv = 0.0, vv = 0.0;
    for (int py = 0; py < view.height; ++py) {
        for (int px = 0; px < view.width; ++px) {
            const auto ux = static_cast<uint32_t>(px), uy = static_cast<uint32_t>(py);
            const double seen = *picture.at(ux, uy) / 255.0;
            if (seen < 0.1 || seen > 0.9) continue;
            const brute::Answer answer = brute::answerAt(view, light, casters, px, py, *stage.surfaces.depth.at(ux, uy),
                                                         drawnNormal(stage, ux, uy));
            if (answer.state != brute::State::asked || std::abs(answer.receiver.y) > 0.01) continue;
            if (std::abs(answer.receiver.z - 0.3) > 0.5) continue; // under the lamp
            n += 1.0;
            x += answer.receiver.x;
            v += seen;
            xv += answer.receiver.x * seen;
            vv += seen * seen;
        }
    }
    REQUIRE(n > 20.0);
    return 0.8 * (n * xv - x * v) / (n * vv - v * v);
}

/// Square of the correlation of y with x.
double rSquared(const std::vector<double>& x, const std::vector<double>& y)
{
    double n = double(x.size()), sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0;
    for (size_t i = 0; i < x.size(); ++i) {
        sx += x[i];
        sy += y[i];
        sxx += x[i] * x[i];
        sxy += x[i] * y[i];
        syy += y[i] * y[i];
    }
    const double top = n * sxy - sx * sy;
    return top * top / ((n * sxx - sx * sx) * (n * syy - sy * sy));
}

void checkLinear(LightKind kind, float radius)
{
    std::vector<double> wanted, found, traced;
    for (const double height : {0.2, 0.5, 0.9, 1.4, 1.9}) {
        Stage stage(halfPlane(kind, height, radius), {240, 180});
        const double side = kind == LightKind::Directional ? 2048.0 : 1024.0;
        found.push_back(widthOnFloor(stage, stage.draw(kPcss, {{"resolution", side}})[0]));
        traced.push_back(widthOnFloor(stage, stage.draw("ray_traced", {{"samples", 256.0}})[0]));
        // Similar triangles; a sun's penumbra is as wide as its distance is large.
        wanted.push_back(kind == LightKind::Directional ? height : height / (4.0 - height));
        MESSAGE(std::string(demo::nameOf(kind))
                << ", sheet at " << height << " m: penumbra " << found.back() << " m wide, traced " << traced.back());
        CHECK(std::abs(found.back() - traced.back()) <= 0.12 * traced.back() + 0.01);
    }
    const double linear = rSquared(wanted, found);
    MESSAGE(std::string(demo::nameOf(kind)) << ": R^2 " << linear);
    CHECK(linear >= 0.95);
    CHECK(found.back() > 4.0 * found.front());
}

/// A ball, a crate and a low wall under lights of all kinds, and a lid that keeps all light from a part of the floor.
Scene umbraScene(LightKind kind, float radius)
{
    Scene scene = softScene(Caster::box, kind, 0.9, radius);
    place(scene, "lid", demo::makeBox({.size = glm::vec3(2.4f, 0.1f, 2.4f)}), {1.2, 0.6, -1.2});
    return scene;
}

} // namespace

TEST_CASE("penumbrae grow in proportion to the gap between caster and receiver, and are as wide as traced ones")
{
    const test::DeviceTest silence;
    checkLinear(LightKind::Spot, 0.25f);
    checkLinear(LightKind::Point, 0.25f);
    checkLinear(LightKind::Directional, 0.1f);
}

TEST_CASE("no light gets into the umbra, and nothing darkens what sees the whole light")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Directional}) {
        Stage stage(umbraScene(kind, kind == LightKind::Directional ? 0.08f : 0.25f), kSize);
        const std::vector<SoftTruth> truths = tracedSoftTruths(stage);
        const Image8 picture = stage.draw(kPcss, {{"resolution", 1024.0}})[0];
        // Pixels of the umbra, and of the light, with nothing else within two pixels.
        uint64_t umbra = 0, leaks = 0, light = 0, specks = 0;
        const auto width = static_cast<int>(kSize.width), height = static_cast<int>(kSize.height);
        for (int y = 2; y + 2 < height; ++y) {
            for (int x = 2; x + 2 < width; ++x) {
                double least = 1.0, most = 0.0;
                bool asked = true;
                for (int dy = -2; dy <= 2; ++dy) {
                    for (int dx = -2; dx <= 2; ++dx) {
                        const auto at = static_cast<size_t>((y + dy) * width + x + dx);
                        least = std::min(least, truths[0].visibility[at]);
                        most = std::max(most, truths[0].visibility[at]);
                        asked = asked && truths[0].asked[at] != 0;
                    }
                }
                if (!asked) continue;
                const uint8_t seen = picture.texels[static_cast<size_t>(y * width + x)];
                if (most == 0.0) {
                    ++umbra;
                    leaks += seen > 0;
                } else if (least == 1.0) {
                    ++light;
                    specks += seen < 250;
                }
            }
        }
        MESSAGE(std::string(demo::nameOf(kind))
                << ": umbra " << umbra << " pixels, leaks " << leaks << "; light " << light << ", specks " << specks);
        CHECK(umbra > 200);
        CHECK(light > 2000);
        CHECK(leaks == 0);
        CHECK(specks * 200 <= light);
    }
}

TEST_CASE("the error in the penumbra is a third of a hard shadow's at most")
{
    const test::DeviceTest silence;
    for (const Caster caster : {Caster::box, Caster::torus}) {
        for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Directional}) {
            Stage stage(softScene(caster, kind, 1.2, kind == LightKind::Directional ? 0.08f : 0.3f), kSize);
            const std::vector<SoftTruth> truths = tracedSoftTruths(stage);
            const SoftError hard = compareSoft(stage.truth, truths);
            const SoftError soft = compareSoft(stage.draw(kPcss, {{"resolution", 1024.0}}), truths);
            MESSAGE(std::string(demo::nameOf(kind))
                    << ": RMSE " << soft.penumbra.rmse() << ", hard " << hard.penumbra.rmse() << "; " << inWords(soft));
            CHECK(soft.penumbra.pixels > 300);
            CHECK(3.0 * soft.penumbra.rmse() <= hard.penumbra.rmse());
            CHECK(soft.wrong == 0);
        }
    }
}

TEST_CASE("the pyramid saves half of the searches at least, and no pixel changes by more than a 255th")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Directional}) {
        Stage stage(umbraScene(kind, kind == LightKind::Directional ? 0.08f : 0.25f), kSize);
        for (const double side : {1024.0, 999.0}) { // and one that is no power of two
            const Image8 with = stage.draw(kPcss, {{"resolution", side}})[0];
            const Image8 without = stage.draw(kPcss, {{"resolution", side}, {"early", 0.0}})[0];
            const Image8 why = stage.draw(kPcss, {{"resolution", side}, {"reasons", 1.0}})[0];
            int most = 0;
            for (size_t i = 0; i < with.texels.size(); ++i)
                most = std::max(most, std::abs(int(with.texels[i]) - int(without.texels[i])));
            const auto count = [&](uint32_t code) { return std::count(why.texels.begin(), why.texels.end(), code); };
            const auto lit = count(gpu::SOFT_LIT), dark = count(gpu::SOFT_DARK);
            const auto searched = count(gpu::SOFT_EMPTY) + count(gpu::SOFT_FILTERED);
            MESSAGE(std::string(demo::nameOf(kind))
                    << " " << side << ": " << lit << " lit and " << dark << " dark by the pyramid, " << searched
                    << " searched, of which " << count(gpu::SOFT_EMPTY) << " without a blocker");
            CHECK(most <= 1);
            CHECK(lit + dark >= searched);
            CHECK(dark > 0);
            CHECK(searched > 300);
        }
    }
}

TEST_CASE("lights without a radius have the picture of the hard map")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Directional}) {
        Stage stage(softScene(Caster::torus, kind, 1.2, 0.0f), kSize);
        const char* hard = kind == LightKind::Point ? "cube_map" : "shadow_map";
        CHECK(test::differences(stage.draw(kPcss, {{"resolution", 512.0}})[0],
                                stage.draw(hard, {{"resolution", 512.0}})[0]) == 0);
    }
}

TEST_CASE("radii larger than the distance to the receiver, and a light inside a blocker, leave every pixel defined")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point}) {
        Scene scene = softScene(Caster::box, kind, 1.2, 6.0f);
        place(scene, "lamp shade", demo::makeBox({.size = glm::vec3(0.3f)}), scene.lights[0].position);
        Stage stage(std::move(scene), kSize);
        const Image8 first = stage.draw(kPcss, {{"resolution", 256.0}})[0];
        CHECK(test::differences(first, stage.draw(kPcss, {{"resolution", 256.0}})[0]) == 0);
        CHECK(std::count(first.texels.begin(), first.texels.end(), uint8_t(255)) > 0); // the sky
    }
}

} // namespace gnomon::exact
