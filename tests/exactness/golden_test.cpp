// Golden images: what each method made of the colonnade when a person last looked, 160x90 per light it serves, side by
// side. They catch what error bounds let through, such as a soft edge grown wider. See tests/images/README.md.
#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "demo/io/png.hpp"
#include "exactness/stage.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{160, 90};
constexpr const char* kScene = "colonnade"; ///< Has a light of each kind.

// A pixel differs if it is off by more than 8 of 255 levels, which rounding in another driver's filter stays below.
// Hard edges may fall to the other side in single pixels: 0.2 % of them is 1 to 3 % of the pixels along edges; a
// picture shifted by one pixel has 5 % and more.
constexpr int kLevels = 8;
constexpr double kTolerancePercent = 0.2;

struct Difference {
    Image8 picture; ///< Amplified: 8 levels are visible, 32 are white.
    uint64_t pixels = 0;
    double percent = 0.0;
};

Image8 sideBySide(const Pictures& pictures)
{
    uint32_t count = 0, placed = 0;
    for (const Image8& picture : pictures)
        count += picture.width > 0;
    Image8 strip(kSize.width * count, kSize.height, 1);
    for (const Image8& picture : pictures)
        if (picture.width > 0) demo::blit(strip, static_cast<int32_t>(kSize.width * placed++), 0, picture);
    return strip;
}

Difference difference(const Image8& a, const Image8& b)
{
    Difference out{.picture = Image8(a.width, a.height, 1)};
    for (size_t i = 0; i < a.texels.size(); ++i) {
        const int levels = std::abs(int(a.texels[i]) - int(b.texels[i]));
        out.picture.texels[i] = static_cast<uint8_t>(std::min(255, 8 * levels));
        out.pixels += levels > kLevels;
    }
    out.percent = 100.0 * double(out.pixels) / double(a.texels.size());
    return out;
}

void compareWithGolden(const std::string& name, const Image8& picture)
{
    CAPTURE(name);
    const std::filesystem::path golden = std::filesystem::path(GNOMON_GOLDEN_IMAGES) / (name + ".png");
    if (std::getenv("GNOMON_UPDATE_IMAGES")) {
        std::filesystem::create_directories(golden.parent_path());
        demo::expect(demo::writePng(golden, picture));
        MESSAGE("wrote " << golden.string() << ": look at it");
        return;
    }
    const demo::Outcome<Image8> wanted = demo::readPng(golden, 1);
    REQUIRE_MESSAGE(wanted, wanted.error());
    REQUIRE(wanted->width == picture.width);
    REQUIRE(wanted->height == picture.height);
    const Difference found = difference(picture, *wanted);
    MESSAGE(name << ": " << found.pixels << " pixels differ, " << percentText(found.percent));
    CHECK(found.percent <= kTolerancePercent);
    if (found.percent <= kTolerancePercent) return;
    const std::filesystem::path folder = GNOMON_DIFFERENCE_IMAGES;
    std::filesystem::create_directories(folder);
    demo::expect(demo::writePng(folder / (name + ".png"), picture));
    demo::expect(demo::writePng(folder / (name + "_difference.png"), found.picture));
    MESSAGE("see " << (folder / (name + "_difference.png")).string());
}

} // namespace

TEST_CASE("every method draws the colonnade as it did when its golden image was looked at")
{
    const test::DeviceTest silence;
    Stage stage(shippedScene(kScene), kSize);
    const std::string prefix = std::string(kScene) + "_";
    const std::vector<GnMethodInfo> methods = stage.methods();
    CHECK(methods.size() >= 6);
    for (const GnMethodInfo& method : methods)
        compareWithGolden(prefix + method.pName, sideBySide(stage.draw(method.pName)));
    for (const std::string filtered : {"shadow_map", "cube_map", "dual_paraboloid"})
        compareWithGolden(prefix + filtered + "_filter5",
                          sideBySide(stage.draw(filtered, {{"filter", 5.0}, {"resolution", 512.0}})));
    for (const std::string warp : {"rectilinear_warp", "nonorthogonal_warp"})
        compareWithGolden(prefix + warp + "_paraboloids",
                          sideBySide(stage.draw(warp, {{"paraboloids", 1.0}, {"resolution", 512.0}})));
}

TEST_CASE("soft rays draw the colonnade under wide lights as they did when their golden images were looked at")
{
    const test::DeviceTest silence;
    Scene scene = shippedScene(kScene);
    for (demo::Light& light : scene.lights)
        light.radius = light.kind == LightKind::Directional ? 0.05f : 0.3f;
    Stage stage(std::move(scene), kSize);
    for (const std::string soft : {"coherence_sampling", "eight_point_hybrid", "pcss", "screen_soft", "ssrbssm"})
        compareWithGolden(std::string(kScene) + "_soft_" + soft, sideBySide(stage.draw(soft)));
    const std::string traced = "ray_soft";
    const std::vector<GnMethodInfo> methods = stage.methods();
    if (std::ranges::none_of(methods, [&](const GnMethodInfo& method) { return method.pName == traced; })) return;
    Pictures settled;
    for (int frame = 0; frame < 32; ++frame) // what is left of noise is less than the comparison sees
        settled = stage.draw(traced, {{"rays", 4.0}});
    compareWithGolden(std::string(kScene) + "_soft_" + traced, sideBySide(settled));
}

TEST_CASE("the comparison with golden images sees a shift by one pixel and a shadow that is missing")
{
    const test::DeviceTest silence;
    Stage stage(shippedScene(kScene), kSize);
    const Image8 picture = sideBySide(stage.truth);
    CHECK(difference(picture, picture).pixels == 0);
    Image8 shifted = picture;
    std::copy(picture.texels.begin(), picture.texels.end() - 1, shifted.texels.begin() + 1);
    CHECK(difference(picture, shifted).percent > 10.0 * kTolerancePercent);
    Image8 patched = picture;
    demo::fill(patched, {.x = 40, .y = 30, .width = 24, .height = 24}, {.r = 128, .g = 128, .b = 128});
    CHECK(difference(picture, patched).percent > kTolerancePercent);
}

} // namespace gnomon::exact
