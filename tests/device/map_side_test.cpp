// Maps as large as pixels can show, drawn as seldom as nobody sees, within a memory for all of them; and lights that no
// pixel shows.
#include <algorithm>
#include <string>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr const char* kDraws = "depth_map.casters"; // of shadow_map
constexpr uint32_t kLong = 60;                      // frames: receivers are measured, and a side has shrunk

void load(Host& host, const char* name)
{
    const std::string rules = shippedRules(name);
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), name));
}

void set(Host& host, const char* method, double side)
{
    host.require(gnSetMethodSetting(host.context, method, "resolution", side));
}

/// The scene's eye, so many times as far.
std::vector<demo::CameraState> eyeAt(const Host& host, double times)
{
    demo::CameraState eye = demo::cameraAt(host.scene, 0.0);
    eye.eye = eye.target + times * (eye.eye - eye.target);
    return {eye};
}

/// Frames of `count` in which the light's map was drawn.
uint32_t drawings(Host& host, uint32_t count, const std::function<void()>& between = {})
{
    uint32_t drawn = 0;
    for (uint32_t frame = 0; frame < count; ++frame) {
        if (between) between();
        host.require(host.draw());
        drawn += host.passCount(kDraws);
    }
    return drawn;
}

std::string why(const Host& host, size_t light)
{
    size_t size = 0;
    host.require(gnExplain(host.context, host.views[0], host.lights[light], nullptr, &size, nullptr));
    std::string text(size, '\0');
    host.require(gnExplain(host.context, host.views[0], host.lights[light], nullptr, &size, text.data()));
    return text;
}

bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a kept map gets smaller as the eye goes away, larger as it comes back, once each")
{
    Host host(smallScene(), {.mapSide = 0.0});
    load(host, "default");
    host.pin(0, "shadow_map");
    host.require(host.draw());
    const uint32_t guessed = host.decision(0).mapSide;
    host.draw(kLong, {});
    const uint32_t near = host.decision(0).mapSide;
    CHECK(guessed <= 2 * near); // in so small a picture
    CHECK(near <= 2 * guessed);
    CHECK(drawings(host, 20) == 0);

    uint32_t drawn = 0;
    const std::vector<demo::CameraState> away = eyeAt(host, 12.0);
    for (uint32_t frame = 0; frame < kLong; ++frame) {
        host.require(host.draw({.cameras = &away}));
        drawn += host.passCount(kDraws);
    }
    const uint32_t far = host.decision(0).mapSide;
    CHECK(far < near);
    CHECK(drawn <= 2); // for one side, or for one on the way
    CHECK(contains(why(host, 0), "shadow_map at " + std::to_string(far) + ","));

    CHECK(drawings(host, kLong) <= 2);
    CHECK(host.decision(0).mapSide == near);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "a side that the host sets stays, and 0 hands it back; nothing else below the least is taken")
{
    Host host(smallScene(), {.mapSide = 0.0});
    load(host, "default");
    host.pin(0, "shadow_map");
    set(host, "shadow_map", 320);
    host.draw(kLong, {});
    CHECK(host.decision(0).mapSide == 320);
    CHECK(gnSetMethodSetting(host.context, "shadow_map", "resolution", 32) == GN_ERROR_OUT_OF_RANGE);
    CHECK(contains(host.lastError(), "not 0"));
    set(host, "shadow_map", 0);
    host.draw(kLong, {});
    CHECK(host.decision(0).mapSide != 320);
    CHECK(host.decision(0).mapSide == host.decision(0).wantedMapSide);
    host.pin(0, "ray_traced");
    host.require(host.draw());
    CHECK(host.decision(0).mapSide == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "a map by coverage is the map of the same side, bit for bit")
{
    Host host(smallScene(), {.mapSide = 0.0});
    load(host, "default");
    host.pin(0, "shadow_map");
    host.draw(kLong, {});
    const std::vector<Image8> byCoverage = host.pictures();
    set(host, "shadow_map", host.decision(0).mapSide);
    host.draw(2, {});
    CHECK(differences(byCoverage, host.pictures()) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "where the memory for maps is short sides shrink, and every light keeps its shadow")
{
    Scene scene = smallScene();
    scene.lights.clear();
    for (int i = 0; i < 6; ++i)
        scene.lights.push_back(pointLight("bulb", {-2.5 + i, 5.0, 1.0}, true));
    scene.lights[5].importance = 0.01f;
    const VkDeviceSize limit = 24u << 20; // six cubes of 256 texels would take 18 MiB, where maps may take 12
    Host host(scene, {.extent = {640, 360}, .mapSide = 0.0, .context = [](GnContextCreateInfo& info) {
                          info.memoryLimit = limit;
                      }});
    load(host, "default");
    host.pinAll("cube_map");
    host.draw(kLong, {});
    uint64_t bytes = 0;
    uint32_t largest = 0;
    for (size_t light = 0; light < 6; ++light) {
        const GnDecision decision = host.decision(light);
        REQUIRE(decision.reason == GN_REASON_PINNED);
        REQUIRE(std::string(decision.pMethod) == "cube_map");
        CHECK(decision.mapSide <= decision.wantedMapSide);
        CHECK(decision.mapSide >= 128);
        largest = std::max(largest, decision.mapSide);
        CHECK(dark(host.pictures()[light]) > 20);
        bytes += uint64_t{decision.mapSide} * decision.mapSide * 6 * 8;
    }
    CHECK(bytes <= limit / 2);
    CHECK(host.decision(5).mapSide < largest);
    CHECK(host.decision(5).mapSide < host.decision(5).wantedMapSide);
    CHECK(contains(why(host, 5), "its pixels could show"));
}

TEST_CASE_FIXTURE(DeviceTest,
                  "a light that no pixel can show runs nothing, says why, and is back with its method at once")
{
    Scene scene = smallScene();
    scene.lights.push_back(pointLight("behind", {0.0, 6.0, 60.0}, true)); // 30 m of range; the eye is 8 m off
    Host host(scene, {.mapSide = 0.0});
    load(host, "default");
    host.draw(4, {});
    CHECK(host.decision(0).pMethod != nullptr);
    const GnDecision unseen = host.decision(1);
    CHECK(unseen.pMethod == nullptr);
    CHECK(unseen.reason == GN_REASON_UNSEEN);
    for (const GnPassTiming& pass : host.passes())
        CHECK((pass.light != host.lights[1] || std::string(pass.pName) == "view.lit"));
    const std::vector<Image8> pictures = host.pictures();
    CHECK(lit(pictures[1]) == pictures[1].texels.size());
    CHECK(contains(why(host, 1), "no pixel can be in its range"));

    demo::CameraState back = demo::cameraAt(host.scene, 0.0);
    back.target = {0.0, 0.0, 60.0};
    const std::vector<demo::CameraState> around{back};
    host.require(host.draw({.cameras = &around}));
    CHECK(host.decision(1).pMethod != nullptr);
    const std::string method = host.decision(1).pMethod;
    host.draw(4, {});
    CHECK(host.decision(1).reason == GN_REASON_UNSEEN);
    host.require(host.draw({.cameras = &around}));
    CHECK(host.decision(1).pMethod == method);
    CHECK(!host.decision(1).switched);

    host.pin(1, "cube_map"); // what the host asks for runs whatever is seen
    host.draw(2, {});
    CHECK(host.decision(1).reason == GN_REASON_PINNED);
}

TEST_CASE_FIXTURE(DeviceTest, "a map in which things move slowly is drawn every few frames, after a jump at once")
{
    Scene scene = smallScene();
    scene.instances[1].isStatic = false; // the ball
    Host host(scene, {.mapSide = 0.0});
    load(host, "default");
    host.pin(0, "shadow_map");
    host.draw(kLong, {});
    const uint32_t side = host.decision(0).mapSide;
    CHECK(host.decision(0).redrawEvery == 0); // nothing moves

    // A texel at the ball is about 2 * 7 * tan(0.7) / side metres wide.
    const double texel = 14.0 * 0.84 / side;
    const auto roll = [&](double texels) {
        return [&host, texel, texels] { host.scene.instances[1].pose.position.x += texels * texel; };
    };
    CHECK(drawings(host, 32, roll(0.05)) <= 32 / 8 + 2);
    CHECK(host.decision(0).redrawEvery == 8);
    CHECK(drawings(host, 32, roll(0.3)) >= 32 / 4);
    CHECK(host.decision(0).redrawEvery == 2);
    CHECK(contains(why(host, 0), "drawn in every 2nd frame"));
    CHECK(drawings(host, 16, roll(2.0)) == 16);
    CHECK(host.decision(0).redrawEvery == 1);

    // What is shown is never off by more than a texel: a picture that was drawn for now differs along edges alone.
    drawings(host, 17, roll(0.05));
    const std::vector<Image8> kept = host.pictures();
    CHECK(host.decision(0).mapAge > 0);
    set(host, "shadow_map", side); // by the host: drawn whenever something moves
    host.draw(1, {});
    const std::vector<Image8> now = host.pictures();
    CHECK(differences(kept, now) < dark(now[0]) / 10);

    set(host, "shadow_map", 0);
    host.draw(kLong, {});
    roll(40.0)();
    host.require(host.draw());
    CHECK(host.decision(0).mapAge == 0);
    const std::vector<Image8> jumped = host.pictures();
    set(host, "shadow_map", host.decision(0).mapSide);
    host.draw(1, {});
    CHECK(differences(jumped, host.pictures()) == 0);
}
