// Lines in place of a map's stairs where maps are awkward: across the faces of a cube and on slopes; and penumbrae of
// them against traced ones.
#include <algorithm>
#include <cmath>

#include <glm/gtc/quaternion.hpp>

#include "demo/scene/primitives.hpp"
#include "exactness/soft_reference.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{160, 120};
constexpr const char* kRbssm = "rbssm";

/// Of a light with a position in a box: the largest and the second largest axis of the way to a receiver, as the
/// tangent that the second one has in the first one's face.
double tangentInFace(const glm::dvec3& fromLight)
{
    const glm::dvec3 size = glm::abs(fromLight);
    const double most = std::max({size.x, size.y, size.z}), least = std::min({size.x, size.y, size.z});
    return (size.x + size.y + size.z - most - least) / most;
}

struct Wrong {
    uint64_t map = 0, lines = 0;
    double ratio() const { return double(map) / double(lines); }
};

/// Nothing of the light is seen within two pixels.
bool deepInUmbra(const SoftTruth& truth, size_t pixel)
{
    bool deep = true;
    for (size_t dy = 0; dy < 5; ++dy)
        for (size_t dx = 0; dx < 5; ++dx) {
            const size_t at = pixel + dy * kSize.width + dx - 2 * kSize.width - 2;
            deep = deep && truth.asked[at] != 0 && truth.visibility[at] == 0.0;
        }
    return deep;
}

/// Calls visit(i) for the pixels that count and have only such neighbours, of the same truth, within two.
template <typename Visit>
void forClear(const Stage& stage, const Visit& visit)
{
    const auto width = static_cast<int>(kSize.width), height = static_cast<int>(kSize.height);
    for (int y = 2; y + 2 < height; ++y) {
        for (int x = 2; x + 2 < width; ++x) {
            const auto own = static_cast<size_t>(y * width + x);
            bool clear = true;
            for (int dy = -2; dy <= 2; ++dy) {
                for (int dx = -2; dx <= 2; ++dx) {
                    const auto at = static_cast<size_t>((y + dy) * width + x + dx);
                    clear =
                        clear && stage.counted[0][at] == 1 && stage.truth[0].texels[at] == stage.truth[0].texels[own];
                }
            }
            if (clear) visit(own);
        }
    }
}

} // namespace

TEST_CASE("no line ends where a cube's face does: there they are worth as much as elsewhere")
{
    const test::DeviceTest silence;
    constexpr double kSide = 128.0;
    Wrong near, elsewhere;
    for (const double degrees : {2.5, 3.0, 3.5, 4.0, 4.5, 5.0}) {
        Scene scene = halfPlane(LightKind::Point, 0.6, 0.0f);
        demo::Instance& sheet = scene.instances.back();
        sheet.pose.rotation = glm::angleAxis(glm::radians(degrees), glm::dvec3(0.0, 1.0, 0.0));
        sheet.pose.position = sheet.pose.rotation * glm::dvec3(-10.0, 0.0, 0.0) + glm::dvec3(0.0, 0.6, 0.0);
        scene.lights[0].position = {0.1, 1.2, 0.1}; // the floor's part of the face below is 2.4 m wide
        scene.camera = {{.eye = {0.9, 1.0, 1.3}, .target = {0.1, 0.0, 1.3}}}; // where that face ends
        Stage stage(std::move(scene), {240, 180});
        const Image8 map = stage.draw("cube_map", {{"resolution", kSide}, {"filter", 1.0}})[0];
        const Image8 lines = stage.draw("rbsm", {{"resolution", kSide}})[0];
        const brute::View view = bruteView(stage);
        const brute::Light light = bruteLight(stage, 0);
        const brute::Scene casters(bruteTriangles(stage));
        for (int y = 0; y < view.height; ++y) {
            for (int x = 0; x < view.width; ++x) {
                const auto i = static_cast<size_t>(y * view.width + x);
                const bool ofMap = map.texels[i] != stage.truth[0].texels[i];
                const bool ofLines = lines.texels[i] != stage.truth[0].texels[i];
                if (stage.counted[0][i] != 1 || (!ofMap && !ofLines)) continue;
                const auto px = static_cast<uint32_t>(x), py = static_cast<uint32_t>(y);
                const brute::Answer answer = brute::answerAt(
                    view, light, casters, x, y, *stage.surfaces.depth.at(px, py), drawnNormal(stage, px, py));
                // A stair of these edges is 11 to 23 texels long.
                const bool close = (1.0 - tangentInFace(answer.receiver - light.position)) * 0.5 * kSide < 8.0;
                Wrong& wrong = close ? near : elsewhere;
                wrong.map += ofMap;
                wrong.lines += ofLines;
            }
        }
    }
    MESSAGE("wrong near borders: map " << near.map << ", lines " << near.lines << ", ratio " << near.ratio()
                                       << "; elsewhere " << elsewhere.map << ", " << elsewhere.lines << ", ratio "
                                       << elsewhere.ratio());
    CHECK(near.map > 100);
    CHECK(elsewhere.map > 200);
    CHECK(elsewhere.ratio() >= 2.0);
    CHECK(near.ratio() >= 0.9 * elsewhere.ratio()); // 0.68 where stairs end four texels past a face
}

TEST_CASE("on slopes no line makes a shadow of what is lit")
{
    const test::DeviceTest silence;
    for (const double degrees : {30.0, 60.0, 80.0}) {
        Scene scene = softScene(Caster::box, LightKind::Directional, 3.0, 0.0f);
        scene.lights[0].direction = glm::normalize(glm::dvec3(0.2, -1.0, 0.1));
        place(scene, "slope", demo::makeBox({.size = glm::vec3(2.4f, 0.1f, 2.4f)}), {0.9, 0.9, -0.6}).pose.rotation =
            glm::angleAxis(glm::radians(degrees), glm::normalize(glm::dvec3(1.0, 0.3, 0.4)));
        Stage stage(std::move(scene), kSize);
        for (const double mode : {0.0, 1.0}) {
            const Image8 picture = stage.draw("rbsm", {{"resolution", 1024.0}, {"mode", mode}})[0];
            uint64_t lit = 0, flipped = 0;
            forClear(stage, [&](size_t i) {
                lit += stage.truth[0].texels[i] != 0;
                flipped += stage.truth[0].texels[i] != 0 && picture.texels[i] == 0;
            });
            MESSAGE(degrees << " degrees, mode " << mode << ": " << flipped << " of " << lit << " lit pixels are dark");
            CHECK(lit > 3000);
            CHECK(1000 * flipped <= lit);
        }
    }
}

TEST_CASE("without a radius rbssm draws rbsm's picture, and no radius leaves a pixel undefined")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Directional}) {
        Stage stage(softScene(Caster::torus, kind, 1.2, 0.0f), kSize);
        CHECK(test::differences(stage.draw(kRbssm, {{"resolution", 512.0}})[0],
                                stage.draw("rbsm", {{"resolution", 512.0}})[0]) == 0);
    }
    for (const LightKind kind : {LightKind::Spot, LightKind::Point}) {
        Scene scene = softScene(Caster::box, kind, 1.2, 6.0f); // larger than the way to the floor
        place(scene, "lamp shade", demo::makeBox({.size = glm::vec3(0.3f)}), scene.lights[0].position);
        Stage stage(std::move(scene), kSize);
        const Image8 first = stage.draw(kRbssm, {{"resolution", 256.0}})[0];
        CHECK(test::differences(first, stage.draw(kRbssm, {{"resolution", 256.0}})[0]) == 0);
        CHECK(std::count(first.texels.begin(), first.texels.end(), uint8_t(255)) > 0); // the sky
    }
}

TEST_CASE(
    "penumbrae of rbssm are no worse than those of the other methods of one map, and no light gets into the umbra")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point, LightKind::Directional}) {
        SoftError lines, pcss, vssm, mssm;
        uint64_t umbra = 0, leaks = 0;
        for (const Caster caster : {Caster::box, Caster::torus}) {
            for (const float radius : {0.1f, 0.3f}) {
                Scene scene = softScene(caster, kind, 1.2, kind == LightKind::Directional ? 0.25f * radius : radius);
                place(scene, "lid", demo::makeBox({.size = glm::vec3(2.4f, 0.1f, 2.4f)}), {1.2, 0.6, -1.2});
                Stage stage(std::move(scene), kSize);
                const std::vector<SoftTruth> truths = tracedSoftTruths(stage, 256);
                const Pictures soft = stage.draw(kRbssm, {{"resolution", 1024.0}});
                lines += compareSoft(soft, truths);
                pcss += compareSoft(stage.draw("pcss", {{"resolution", 1024.0}}), truths);
                vssm += compareSoft(stage.draw("moments_soft", {{"resolution", 1024.0}, {"moments", 0.0}}), truths);
                mssm += compareSoft(stage.draw("moments_soft", {{"resolution", 1024.0}, {"moments", 1.0}}), truths);
                forClear(stage, [&](size_t i) {
                    const bool deep = deepInUmbra(truths[0], i);
                    umbra += deep;
                    leaks += deep && soft[0].texels[i] > 0;
                });
            }
        }
        MESSAGE(std::string(demo::nameOf(kind))
                << ": RMSE in the penumbra rbssm " << lines.penumbra.rmse() << ", pcss " << pcss.penumbra.rmse()
                << ", VSSM " << vssm.penumbra.rmse() << ", MSSM " << mssm.penumbra.rmse() << " of "
                << lines.penumbra.pixels << " pixels; " << leaks << " of " << umbra << " pixels of the umbra leak");
        CHECK(lines.penumbra.pixels > 1000);
        CHECK(lines.penumbra.rmse() <= 1.01 * pcss.penumbra.rmse()); // of points they share wide penumbrae
        CHECK(lines.penumbra.rmse() <= vssm.penumbra.rmse());
        CHECK(lines.penumbra.rmse() <= mssm.penumbra.rmse());
        CHECK(umbra > 1000);
        CHECK(leaks == 0);
    }
}

} // namespace gnomon::exact
