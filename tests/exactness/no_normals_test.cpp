// A host without a normal target: exact methods trace every pixel instead of guessing which way it faces, and maps
// guess well enough to stay free of acne.
#include <algorithm>

#include "device/fixture.hpp"
#include "exactness/stage.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{640, 360};

/// The device fixture's host beside the stage: the same camera, depth drawn the same way, and normals that can be left
/// out.
class BareHost {
public:
    explicit BareHost(const Scene& scene) : host_(scene, {.extent = kSize, .mapSide = 1024.0}) {}

    Pictures draw(const GnMethodInfo& method, bool normals)
    {
        for (size_t i = 0; i < host_.lights.size(); ++i) {
            const bool served = serves(method.traits, host_.scene.lights[i].kind);
            host_.pin(i, served ? method.pName : "ray_traced");
        }
        test::FrameOptions frame;
        if (!normals)
            frame.adjust = [](GnFrameInfo&, std::vector<GnViewFrame>& views) {
                views[0].normalImage = VK_NULL_HANDLE;
                views[0].normalView = VK_NULL_HANDLE;
                views[0].normalFormat = VK_FORMAT_UNDEFINED;
            };
        REQUIRE(host_.draw(frame) == GN_SUCCESS);
        Pictures pictures = host_.pictures();
        for (size_t i = 0; i < pictures.size(); ++i) {
            if (serves(method.traits, host_.scene.lights[i].kind))
                CHECK(std::string(host_.decision(i).pMethod) == method.pName);
            else
                pictures[i] = {};
        }
        return pictures;
    }
    test::Host& host() { return host_; }

private:
    test::Host host_;
};

/// Pixels that are not sky and lie within the light's range and cone, counted as the definitions say.
uint64_t reachedPixels(const Stage& stage)
{
    demo::FrameSurfaces towards = stage.surfaces;
    uint64_t reached = 0;
    for (size_t layer = 0; layer < stage.present.size(); ++layer) {
        const uint32_t index = stage.present[layer];
        // countedPixels() wants normals that face the light; without any, every reached pixel counts: ask with both
        // signs of the drawn ones and add up. What faces neither way lies exactly edge-on.
        for (const float sign : {1.0f, -1.0f}) {
            for (size_t i = 0; i < towards.normals.texels.size(); ++i)
                towards.normals.texels[i] = sign * stage.surfaces.normals.texels[i];
            for (const uint8_t pixel : demo::countedPixels(stage.scene(), stage.camera, towards,
                                                           stage.scene().lights[index], stage.state.lights[index]))
                reached += pixel != 0;
        }
    }
    return reached;
}

/// How far one set of pictures is from another, over the pixels that count.
ErrorCount between(const Stage& stage, const Pictures& a, const Pictures& b)
{
    ErrorCount sum;
    for (size_t i = 0; i < a.size(); ++i)
        if (a[i].width > 0) sum += demo::compare(b[i], a[i], stage.counted[i]);
    return sum;
}

/// Pixels of all lights that are lit in one picture and dark in the other, whichever way surfaces face.
uint64_t litAlone(const Pictures& lit, const Pictures& dark)
{
    uint64_t count = 0;
    for (size_t i = 0; i < lit.size(); ++i)
        for (size_t texel = 0; texel < lit[i].texels.size() && lit[i].width == dark[i].width; ++texel)
            count += lit[i].texels[texel] > 127 && dark[i].texels[texel] <= 127;
    return count;
}

/// @param turn Counts methods over all scenes: those that are not exact are drawn in two of three.
void checkScene(const std::string& name, size_t& turn)
{
    CAPTURE(name);
    const Scene scene = shippedScene(name);
    const Stage stage(scene, kSize);
    BareHost bare(scene);
    uint32_t exact = 0;
    for (const GnMethodInfo& method : stage.methods()) {
        const std::string methodName = method.pName;
        CAPTURE(methodName);
        if (!(method.traits & GN_TRAIT_EXACT_BIT) && turn++ % 3 == 0) continue;
        if (std::none_of(scene.lights.begin(), scene.lights.end(),
                         [&](const demo::Light& light) { return serves(method.traits, light.kind); }))
            continue;
        const Pictures given = bare.draw(method, true);
        const Pictures guessed = bare.draw(method, false);
        if (methodName == "ray_traced") {
            const uint64_t reached = reachedPixels(stage);
            const uint64_t rays = bare.host().stats().rays;
            MESSAGE(name << ": " << rays << " rays without normals for " << reached << " reached pixels");
            // Borders of range and cone are decided in float by either side.
            CHECK(rays + 20 >= reached);
            CHECK(rays <= reached + 20);
        }
        const ErrorCount without = pooled(stage, guessed);
        const ErrorCount change = between(stage, given, guessed);
        MESSAGE(name << ", " << methodName << ": with normals wrong " << inWords(pooled(stage, given)) << ", without "
                     << inWords(without) << "; change " << percentText(change.percent(change.wrong())));
        CHECK(without.counted > 50000);
        if ((method.traits & GN_TRAIT_EXACT_BIT) != 0) {
            ++exact;
            CHECK(change.percent(change.wrong()) <= 0.05);
        }
        CHECK(without.percent(without.falseShadow) < 2.0);
        // What shadows one plane only leaves the others lit, with and without normals.
        if ((method.traits & GN_TRAIT_PLANAR_BIT) == 0) CHECK(without.percent(without.falseLit) < 2.0);
    }
    CHECK(exact >= 2);
}

} // namespace

TEST_CASE("without normals exact methods trace every pixel and change at most 0.05 %, and maps show no acne")
{
    const test::DeviceTest silence;
    size_t turn = 0;
    for (const std::string name : {"room", "colonnade", "bunny"})
        checkScene(name, turn);
}

TEST_CASE(
    "without normals the underside of a solid is as dark as ray_traced has it, however flat the light falls on it")
{
    const test::DeviceTest silence;
    for (const bool sun : {true, false}) {
        CAPTURE(sun);
        Scene scene = test::smallScene();
        scene.instances[2].pose.position = {1.4, 4.0, -0.6}; // the box, over the camera
        scene.lights = {sun ? demo::Light{.name = "sun", .kind = LightKind::Directional}
                            : test::pointLight("bulb", {1.4, 8.0, -0.6}, true)};
        scene.lights[0].isStatic = true;
        scene.camera = {demo::CameraKey{.eye = {1.4, 1.0, 0.6}, .target = {1.4, 4.0, -0.5}}};
        BareHost bare(scene);
        const GnTraits all = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT;
        const Pictures truth = bare.draw({.pName = "ray_traced", .traits = all}, false);
        CHECK(test::dark(truth[0]) > 2000);
        for (const char* method : {"conservative_map", "conservative_map_adjacency"})
            for (const double side : {64.0, 1024.0}) {
                CAPTURE(std::string(method));
                CAPTURE(side);
                bare.host().require(gnSetMethodSetting(bare.host().context, method, "resolution", side));
                const Pictures guessed = bare.draw({.pName = method, .traits = all}, false);
                CHECK(litAlone(guessed, truth) == 0);
                CHECK(litAlone(truth, guessed) == 0);
            }
    }
}

} // namespace gnomon::exact
