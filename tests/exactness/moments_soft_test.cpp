// Summed-area tables of moments against 256 rays a pixel (`ray_traced`), and as plain maps where lights have no radius.
#include <string>

#include "exactness/soft_reference.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr double kSide = 512.0;
constexpr uint32_t kSamples = 256;

Pictures soft(Stage& stage, double moments)
{
    return stage.draw("moments_soft", {{"resolution", kSide}, {"moments", moments}});
}

} // namespace

TEST_CASE("without a radius moments_soft draws what plain maps draw, pixel by pixel")
{
    const test::DeviceTest silence;
    Stage stage(shippedScene("room"), {320, 180});
    const Pictures plain = stage.draw("shadow_map", {{"resolution", kSide}, {"filter", 1.0}});
    const Pictures cubes = stage.draw("cube_map", {{"resolution", kSide}, {"filter", 1.0}});
    const Pictures got = soft(stage, 1.0);
    for (size_t layer = 0; layer < got.size(); ++layer)
        CHECK(got[layer].texels == (plain[layer].width > 0 ? plain : cubes)[layer].texels);
}

// The sun's penumbrae are two to three texels wide, and the filter between texels one.
TEST_CASE("penumbrae of moments_soft are nearer to the truth than hard edges, for lights of every kind")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Directional, LightKind::Spot, LightKind::Point}) {
        for (const Caster caster : {Caster::box, Caster::sphere}) {
            const bool sun = kind == LightKind::Directional;
            Stage stage(softScene(caster, kind, 1.0, sun ? 0.05f : 0.2f), {160, 120});
            const std::vector<SoftTruth> truths = tracedSoftTruths(stage, kSamples);
            const SoftError hard = compareSoft(stage.truth, truths);
            for (const double moments : {0.0, 1.0}) {
                const Pictures pictures = soft(stage, moments);
                const SoftError error = compareSoft(pictures, truths);
                const std::string what =
                    std::string(demo::nameOf(kind)) + (caster == Caster::box ? ", box" : ", sphere");
                MESSAGE(what << (moments == 0.0 ? ", VSSM: " : ", MSSM: ") << inWords(error) << ", RMSE "
                             << error.penumbra.rmse() << "; hard " << inWords(hard) << ", RMSE "
                             << hard.penumbra.rmse());
                CHECK(error.penumbra.pixels > 100);
                const double bound = sun ? 0.95 : moments == 0.0 ? 0.6 : 0.5;
                CHECK(error.mean() <= bound * hard.mean());
                CHECK(error.penumbra.rmse() <= bound * hard.penumbra.rmse());
            }
        }
    }
}

// The disc's centre is 0.4 radii above the floor: a quarter of the disc is below, its circle's segment.
TEST_CASE("what of a disc is below the receiver's own plane does not shine, in maps, distances and wedges")
{
    const test::DeviceTest silence;
    Scene scene = softScene(Caster::box, LightKind::Spot, 5.0, 0.25f);
    scene.lights[0].position = {-2.0, 0.1, 0.0};
    scene.lights[0].direction = {1.0, 0.0, 0.0};
    Stage stage(std::move(scene), {80, 60});
    const std::vector<SoftTruth> truths = tracedSoftTruths(stage, kSamples);
    const auto check = [&](const std::string& method, const Settings& settings) {
        const SoftError error = compareSoft(stage.draw(method, settings), truths);
        MESSAGE(method << ": " << inWords(error));
        CHECK(error.penumbra.pixels > 500);
        CHECK(error.mean() <= 0.05);
    };
    for (const double moments : {0.0, 1.0})
        check("moments_soft", {{"resolution", kSide}, {"moments", moments}});
    for (const double mean : {0.0, 1.0})
        check("edt_soft", {{"resolution", kSide}, {"mean", mean}});
    for (const char* method : {"pcss", "rbssm", "ssrbssm", "penumbra_wedges"})
        check(method, {});
}

// Deep in the umbra: within three pixels there is nothing else.
TEST_CASE("under three layers four moments leak less than two")
{
    const test::DeviceTest silence;
    constexpr int kWidth = 240, kHeight = 135, kMargin = 3;
    Scene scene = shippedScene("views/layers");
    std::erase_if(scene.lights, [](const demo::Light& light) { return light.kind != LightKind::Spot; });
    scene.lights[0].radius = 0.25f;
    Stage stage(std::move(scene), {kWidth, kHeight});
    const SoftTruth truth = std::move(tracedSoftTruths(stage, kSamples)[0]);
    const auto isUmbra = [&](int x, int y) {
        const size_t i = size_t(y) * kWidth + size_t(x);
        return truth.asked[i] == 1 && truth.visibility[i] == 0.0;
    };
    const auto leak = [&](double moments) {
        const Pictures pictures = soft(stage, moments);
        double sum = 0.0;
        uint64_t pixels = 0;
        for (int y = kMargin; y < kHeight - kMargin; ++y) {
            for (int x = kMargin; x < kWidth - kMargin; ++x) {
                bool deep = true;
                for (int j = -kMargin; j <= kMargin; ++j)
                    for (int i = -kMargin; i <= kMargin; ++i)
                        deep = deep && isUmbra(x + i, y + j);
                if (!deep) continue;
                sum += *pictures[0].at(uint32_t(x), uint32_t(y)) / 255.0;
                ++pixels;
            }
        }
        CHECK(pixels > 500);
        MESSAGE(std::string(moments == 0.0 ? "VSSM" : "MSSM")
                << ": mean visibility of " << pixels << " pixels deep in the umbra " << sum / double(pixels));
        return sum / double(pixels);
    };
    const double two = leak(0.0), four = leak(1.0);
    CHECK(four < two);
}

} // namespace gnomon::exact
