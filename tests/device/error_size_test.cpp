// Sizes, places and tongues at their extremes.
#include <cmath>

#include "device/comma_locale.hpp"
#include "device/error_support.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// Everything of the scene somewhere else.
Scene moved(Scene scene, const glm::dvec3& by)
{
    scene.center += by;
    for (demo::Instance& instance : scene.instances) {
        instance.pose.position += by;
        for (demo::PoseKey& key : instance.keys)
            key.pose.position += by;
    }
    for (demo::Light& light : scene.lights) {
        light.position += by;
        light.orbit.center += by;
        for (demo::LightKey& key : light.keys)
            key.position += by;
    }
    for (demo::CameraKey& key : scene.camera) {
        key.eye += by;
        key.target += by;
    }
    return scene;
}

std::string decisionText(const Host& host)
{
    const GnDecision decision = host.decision(0);
    return std::string(decision.pMethod ? decision.pMethod : "none") + " " + std::to_string(decision.reason) + " " +
           std::to_string(std::lround(decision.suitability * 1e6f));
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a view of one pixel is served by every method, and lit by a light above it")
{
    Scene scene = smallScene();
    // Over the middle of the floor, with nothing between.
    scene.lights = {spotLight("spot", {0.0, 5.0, 0.1}, {0.0, 0.0, 0.0}, true),
                    pointLight("point", {0.0, 5.0, 0.1}, true)};
    Host host(scene, {.extent = {1, 1}});
    for (const GnMethodInfo& method : availableMethods(host.context)) {
        CAPTURE(std::string(method.pName));
        for (size_t i = 0; i < 2; ++i) {
            if (!serves(method, scene.lights[i].kind)) continue;
            host.pin(i, method.pName);
            host.require(host.draw());
            const bool planar = (method.traits & GN_TRAIT_PLANAR_BIT) != 0; // finds no plane in less than a tile
            CHECK((host.decision(i).reason == GN_REASON_PINNED) != planar);
            CHECK(lit(host.pictures()[i]) == 1);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a view of 4096x2160 holds the shadows of a small one")
{
    Host host(smallScene(), {.extent = {4096, 2160}, .maxLights = 1}), small(smallScene(), {.extent = {512, 270}});
    for (Host* each : {&host, &small}) {
        each->pinAll("shadow_map");
        each->require(each->draw());
    }
    const Image8 large = host.pictures()[0], reference = small.pictures()[0];
    CHECK(large.width == 4096);
    CHECK(large.height == 2160);
    const double darkShare = double(dark(large)) / (4096.0 * 2160.0);
    const double expected = double(dark(reference)) / (512.0 * 270.0);
    CHECK(darkShare > 0.02);
    CHECK(std::abs(darkShare - expected) < 0.005); // edges of 512 x 270 pixels cover about that much
}

TEST_CASE_FIXTURE(DeviceTest, "a view resized in mid-run shows what a fresh one of that size shows")
{
    for (const char* method : {"shadow_map", "stencil_volume", "pcf_hybrid", "ray_traced"}) {
        CAPTURE(std::string(method));
        Host host(smallScene(), {.framesInFlight = 3});
        host.pinAll(method);
        host.draw(2, {});
        GnVisibility before{}, after{};
        host.require(gnGetVisibility(host.context, host.views[0], &before));
        for (const VkExtent2D extent : {VkExtent2D{321, 187}, {64, 200}, {1, 1}, {500, 16}, {320, 180}}) {
            host.resize(extent);
            host.draw(2, {});
            Host fresh(smallScene(), {.extent = extent});
            fresh.pinAll(method);
            fresh.require(fresh.draw());
            CHECK(differences(host.pictures(), fresh.pictures()) == 0);
        }
        host.require(gnGetVisibility(host.context, host.views[0], &after));
        CHECK(after.revision > before.revision);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "torus_grid a thousand kilometres away looks as it does at the origin")
{
    const Scene here = demo::valueOf(demo::loadScene("torus_grid"));
    const Scene there = moved(here, {1e6, 0.0, -1e6});
    constexpr VkExtent2D extent{320, 240};
    Host near(here, {.extent = extent}), far(there, {.extent = extent});
    for (const GnMethodInfo& method : availableMethods(near.context)) {
        if (!serves(method, demo::LightKind::Spot)) continue;
        CAPTURE(std::string(method.pName));
        for (Host* each : {&near, &far}) {
            each->pinAll(method.pName);
            each->draw(2, {.time = 0.25});
        }
        const Image8 picture = near.pictures()[0];
        CHECK(dark(picture) > 1000);
        const Image8 other = far.pictures()[0];
        size_t changed = 0; // by more than averages round to
        for (size_t i = 0; i < picture.texels.size(); ++i)
            changed += std::abs(picture.texels[i] - other.texels[i]) > 2;
        MESSAGE(std::string(method.pName) << ": " << changed << " of " << picture.texels.size() << " pixels differ");
        // The origin lies up to 128 m from the eye, where a float resolves 0.008 mm: pixels right on an edge and map
        // texels right on a slope may change. Measured: 1 for shadow_map, 17 for rpcf, 0 for most; 19 are allowed.
        CHECK(changed <= picture.texels.size() / 4000);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a surface a metre before the eye shows no rays that hit it, wherever the eye is")
{
    Scene here = smallScene();
    const glm::dvec3 ball = here.instances[1].pose.position;
    REQUIRE(here.instances[1].name == "ball");
    here.camera = {demo::CameraKey{.eye = ball + glm::dvec3(0.9, 0.9, 0.9), .target = ball}};
    constexpr VkExtent2D extent{640, 480};
    Host near(here, {.extent = extent});
    near.pinAll("ray_traced");
    near.draw(2, {});
    const Image8 picture = near.pictures()[0];
    // 383 m is as far from a multiple of the origin's steps as a place can be.
    Host far(moved(here, {383.0, 0.0, 383.0}), {.extent = extent});
    far.pinAll("ray_traced");
    far.draw(2, {});
    const size_t changed = differences(picture, far.pictures()[0]);
    MESSAGE(changed << " of " << picture.texels.size() << " pixels differ");
    CHECK(changed <= picture.texels.size() / 4000);
}

TEST_CASE_FIXTURE(DeviceTest, "malformed rules are refused with line and column, the good ones stay in force")
{
    Watched watched;
    Host& host = watched.host;
    host.pinAll(nullptr);
    const std::string thesis = shippedRules("thesis");
    host.require(gnLoadRules(host.context, thesis.data(), thesis.size(), "thesis.yaml"));
    host.draw(4, {});
    const std::string before = decisionText(host);
    CHECK(before.find("octree_volume 0") == 0); // one static light: by the rules
    const std::string cut = thesis.substr(0, thesis.size() / 2);
    struct Bad {
        const char* what;
        std::string text;
    };
    const Bad bad[] = {
        {"not YAML", "rules: [unclosed\n  - {"},
        {"cut in the middle", cut.substr(0, cut.rfind('"'))},
        {"empty", ""},
        {"a list", "- 1\n- 2\n"},
        {"bytes that are no text", std::string("\x00\xff\xfe: \x01", 6)},
        {"a duplicate key", thesis + "\nname: twice\n"},
        {"an unknown method",
         std::string(thesis).replace(thesis.find("octree_volume is favoured"), 13, "magic_volume ")},
    };
    for (const Bad& b : bad) {
        CAPTURE(std::string(b.what));
        host.takeMessages();
        CHECK(gnLoadRules(host.context, b.text.data(), b.text.size(), "bad.yaml") == GN_ERROR_RULES);
        CHECK_MESSAGE(host.lastError().find("bad.yaml:") == 0, host.lastError());
        bool placed = false; // file:line:column
        for (const std::string& message : host.takeMessages()) {
            const size_t at = message.find("bad.yaml:");
            placed = placed || (at != std::string::npos && std::isdigit(static_cast<unsigned char>(message[at + 9])));
        }
        CHECK(placed);
        host.require(host.draw());
        CHECK(decisionText(host) == before);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "the bases that the library carries are loaded by name, and others are not")
{
    Host host(smallScene());
    host.pinAll(nullptr);
    host.require(gnLoadShippedRules(host.context, "thesis"));
    host.draw(4, {});
    CHECK(decisionText(host).find("octree_volume 0") == 0); // one static light: by the rules
    for (const char* name : {"default", "quality", "battery", "thesis"})
        CHECK(gnLoadShippedRules(host.context, name) == GN_SUCCESS);
    CHECK(gnLoadShippedRules(host.context, "defaults") == GN_ERROR_OUT_OF_RANGE);
    CHECK(host.lastError().find("'defaults'") != std::string::npos);
    CHECK(gnLoadShippedRules(host.context, nullptr) == GN_ERROR_NULL_ARGUMENT);
    host.require(host.draw()); // by the last good one
}

TEST_CASE_FIXTURE(DeviceTest, "in a locale with a decimal comma rules, decisions, pictures and messages are the same")
{
    const auto run = [](std::string& words) {
        Host host(smallScene());
        std::string rules = shippedRules("default");
        const std::string says = "allocation: budget"; // times are no matter of the locale
        rules.replace(rules.find(says), says.size(), "allocation: none");
        host.require(gnLoadRules(host.context, rules.data(), rules.size(), "default.yaml"));
        host.draw(6, {});
        words = decisionText(host) + "\n" + host.explanation(0);
        // Times differ from run to run, and the frame rate with them.
        for (const char* volatileWord : {"frameRate ", "chosen, "})
            if (const size_t at = words.find(volatileWord); at != std::string::npos)
                words.erase(at, words.find_first_of("\n(", at) - at);
        CHECK(host.draw({.adjust = [](GnFrameInfo& f, std::vector<GnViewFrame>&) { f.budgetMs = -1.5f; }}) ==
              GN_ERROR_OUT_OF_RANGE);
        words += host.lastError();
        CHECK(host.draw({.adjust = [](GnFrameInfo&, std::vector<GnViewFrame>& v) { v[0].viewFromWorld[0] *= 2.0f; }}) ==
              GN_ERROR_OUT_OF_RANGE);
        words += host.lastError();
        CHECK(gnSetMethodSetting(host.context, "shadow_map", "filter", 15.5) == GN_ERROR_OUT_OF_RANGE);
        words += host.lastError();
        GnTransform transform{};
        transform.translation[0] = 2.5e18;
        CHECK(gnSetInstanceTransform(host.context, host.instances[0], &transform) == GN_ERROR_OUT_OF_RANGE);
        words += host.lastError();
        return host.pictures();
    };
    std::string plain, comma;
    const std::vector<Image8> pictures = run(plain);
    {
        const CommaLocale locale;
        REQUIRE(locale.inForce());
        CHECK(differences(run(comma), pictures) == 0);
    }
    CHECK(plain == comma);
    CHECK(plain.find("-1.5") != std::string::npos);
}
