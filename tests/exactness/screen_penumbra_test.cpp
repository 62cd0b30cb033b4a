// Penumbrae that are blurred on the screen: their width, what gets into the umbra, and what crosses the silhouettes of
// what stands before them.
#include <algorithm>
#include <cmath>

#include <glm/gtc/quaternion.hpp>

#include "demo/scene/primitives.hpp"
#include "exactness/soft_measures.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr const char* kMethods[] = {"screen_soft", "ssrbssm"};
constexpr VkExtent2D kSize{160, 120};
constexpr LightKind kLights[] = {LightKind::Spot, LightKind::Point, LightKind::Directional};

float radiusOf(LightKind kind, float metres)
{
    return kind == LightKind::Directional ? metres / 3.0f : metres;
}

/// Heights over the floor of what pixels show.
class Places {
public:
    explicit Places(const Stage& stage)
    {
        const brute::View view = bruteView(stage);
        const brute::Light light = bruteLight(stage, 0);
        const brute::Scene casters(bruteTriangles(stage));
        width_ = view.width;
        for (int y = 0; y < view.height; ++y) {
            for (int x = 0; x < view.width; ++x) {
                const auto ux = static_cast<uint32_t>(x), uy = static_cast<uint32_t>(y);
                const float depth = *stage.surfaces.depth.at(ux, uy);
                heights_.push_back(
                    brute::answerAt(view, light, casters, x, y, depth, drawnNormal(stage, ux, uy)).receiver.y);
            }
        }
    }
    double height(int x, int y) const { return heights_[static_cast<size_t>(y * width_ + x)]; }
    /// Within three pixels of something half a metre higher or lower.
    bool atGap(int x, int y) const
    {
        bool gap = false;
        for (int dy = -3; dy <= 3; ++dy)
            for (int dx = -3; dx <= 3; ++dx) {
                const auto at = static_cast<size_t>((y + dy) * width_ + x + dx);
                gap = gap || (at < heights_.size() && std::abs(heights_[at] - height(x, y)) > 0.5);
            }
        return gap;
    }

private:
    int width_ = 0;
    std::vector<double> heights_;
};

} // namespace

TEST_CASE("penumbrae on the screen grow in proportion to the gap, and are as wide as traced ones")
{
    const test::DeviceTest silence;
    for (const LightKind kind : kLights)
        checkLinear(kMethods, kind, kind == LightKind::Directional ? 0.1f : 0.25f,
                    0.9); // lower ones are as narrow as pixels
}

TEST_CASE("the blur takes no light into the umbra, and darkens nothing that sees the whole light")
{
    const test::DeviceTest silence;
    for (const LightKind kind : kLights) {
        Stage stage(umbraScene(kind, radiusOf(kind, 0.25f)), kSize);
        const std::vector<SoftTruth> truths = tracedSoftTruths(stage);
        for (const char* method : kMethods) {
            const UmbraCount count = countUmbra(stage.draw(method, {{"resolution", 1024.0}})[0], truths[0]);
            MESSAGE(std::string(method) << " " << std::string(demo::nameOf(kind)) << ": " << inWords(count));
            CHECK(count.umbra > 200);
            CHECK(count.light > 2000);
            CHECK(count.leaks == 0);
            CHECK(count.specks * 200 <= count.light);
        }
    }
}

TEST_CASE("no shadow crosses the silhouette of what stands before it, and no light the other way")
{
    const test::DeviceTest silence;
    for (const LightKind kind : kLights) {
        // The far edge of a lit table cuts through the penumbra of the sheet behind it.
        Scene scene = halfPlane(kind, 1.4, radiusOf(kind, 0.5f));
        place(scene, "table", demo::makeBox({.size = glm::vec3(0.5f, 0.05f, 0.6f)}), {1.45, 0.775, 0.4});
        Stage stage(std::move(scene), kSize);
        const std::vector<SoftTruth> truths = tracedSoftTruths(stage);
        const Places places(stage);
        for (const char* method : kMethods) {
            const Image8 picture = stage.draw(method, {{"resolution", 1024.0}})[0];
            uint64_t gaps = 0;
            int darkened = 0, lightened = 0;
            for (int y = 1; y + 1 < int(kSize.height); ++y) {
                for (int x = 1; x + 1 < int(kSize.width); ++x) {
                    const auto at = static_cast<size_t>(y * int(kSize.width) + x);
                    const double truth = truths[0].visibility[at];
                    if (truths[0].asked[at] == 0 || !places.atGap(x, y)) continue;
                    ++gaps;
                    if (places.height(x, y) > 0.7 && truth == 1.0)
                        darkened = std::max(darkened, 255 - int(picture.texels[at]));
                    if (places.height(x, y) < 0.1 && truth == 0.0)
                        lightened = std::max(lightened, int(picture.texels[at]));
                }
            }
            MESSAGE(std::string(method) << " " << std::string(demo::nameOf(kind)) << ": " << gaps
                                        << " pixels, darkened by " << darkened << ", lightened by " << lightened
                                        << " of 255");
            CHECK(gaps > 60);
            CHECK(darkened <= 2);
            CHECK(lightened <= 2);
        }
    }
}

TEST_CASE("the error of penumbrae on the screen is less than half of a hard shadow's, and revectorized edges lessen it")
{
    const test::DeviceTest silence;
    for (const Caster caster : {Caster::box, Caster::torus}) {
        for (const LightKind kind : kLights) {
            Stage stage(softScene(caster, kind, 1.2, kind == LightKind::Directional ? 0.08f : 0.3f), kSize);
            const std::vector<SoftTruth> truths = tracedSoftTruths(stage, 256);
            const SoftError hard = compareSoft(stage.truth, truths);
            const SoftError pcss = compareSoft(stage.draw("pcss", {{"resolution", 1024.0}}), truths);
            const double finest = kind == LightKind::Directional ? 2048.0 : 1024.0; // a sun's covers the whole floor
            for (const double side : {finest, 0.25 * finest}) {
                const SoftError soft = compareSoft(stage.draw("screen_soft", {{"resolution", side}}), truths);
                const SoftError lines = compareSoft(stage.draw("ssrbssm", {{"resolution", side}}), truths);
                MESSAGE(std::string(demo::nameOf(kind))
                        << " " << side << ": hard " << hard.penumbra.rmse() << ", pcss of 1024 " << pcss.penumbra.rmse()
                        << ", screen_soft " << soft.penumbra.rmse() << ", ssrbssm " << lines.penumbra.rmse() << "; "
                        << inWords(soft));
                CHECK(soft.penumbra.pixels > 300);
                CHECK(2.0 * soft.penumbra.rmse() <= hard.penumbra.rmse());
                CHECK(lines.penumbra.rmse() <= soft.penumbra.rmse());
                CHECK(1000 * lines.wrong <= lines.outside.pixels);
            }
        }
    }
}

TEST_CASE("without a radius the blur leaves the picture of the hard method")
{
    const test::DeviceTest silence;
    for (const LightKind kind : kLights) {
        Stage stage(softScene(Caster::torus, kind, 1.2, 0.0f), kSize);
        const char* hard = kind == LightKind::Point ? "cube_map" : "shadow_map";
        CHECK(test::differences(stage.draw("screen_soft", {{"resolution", 512.0}})[0],
                                stage.draw(hard, {{"resolution", 512.0}})[0]) == 0);
        CHECK(test::differences(stage.draw("ssrbssm", {{"resolution", 512.0}})[0],
                                stage.draw("rbsm", {{"resolution", 512.0}})[0]) == 0);
    }
}

TEST_CASE("the blur of a lamp larger than its distance, inside of a blocker, leaves every pixel defined")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Spot, LightKind::Point}) {
        Scene scene = softScene(Caster::box, kind, 1.2, 6.0f);
        place(scene, "lamp shade", demo::makeBox({.size = glm::vec3(0.3f)}), scene.lights[0].position);
        Stage stage(std::move(scene), kSize);
        for (const char* method : kMethods) {
            const Image8 first = stage.draw(method, {{"resolution", 256.0}})[0];
            CHECK(test::differences(first, stage.draw(method, {{"resolution", 256.0}})[0]) == 0);
            CHECK(std::count(first.texels.begin(), first.texels.end(), uint8_t(255)) > 0); // the sky
        }
    }
}

} // namespace gnomon::exact
