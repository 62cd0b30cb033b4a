// gnomon through the demo's host, on small scenes: both ways to call it, and casters that only the host can draw.
#include "host_fixture.hpp"

#include <chrono>
#include <fstream>
#include <thread>

#include "demo/program/error_count.hpp"
#include "demo/program/measure.hpp"
#include "demo/program/rule_watch.hpp"
#include "shaders/demo/alpha.h"

namespace gnomon::demo {
namespace {

bool servesSpots(const GnMethodInfo& info)
{
    return (info.traits & GN_TRAIT_SPOT_BIT) != 0 && !info.pUnavailable;
}

/// A card with holes hung above the floor under a spot light that looks straight down. The host draws it.
Scene cardAboveFloor()
{
    Scene scene = boxOnFloor();
    scene.meshes[1] = makeCard({.width = 2.0f, .height = 2.0f});
    scene.meshes[1].name = "card";
    Instance& card = scene.instances[1];
    card.name = "card";
    card.pose.position = glm::dvec3(0.0, 2.0, 0.0);
    card.pose.rotation = glm::angleAxis(glm::radians(-90.0), glm::dvec3(1.0, 0.0, 0.0));
    card.alphaTested = card.hostDrawn = true;
    scene.lights[0].position = glm::dvec3(0.0, 8.0, 0.0);
    scene.lights[0].direction = glm::dvec3(0.0, -1.0, 0.0);
    scene.lights[0].range = 20.0f;
    scene.camera = {{.eye = glm::dvec3(0.0, 3.0, 8.0), .target = glm::dvec3(0.0, 0.0, 0.0)}};
    scene.width = 256;
    scene.height = 160;
    return scene;
}

} // namespace

TEST_CASE("recorded and submitted frames have the same visibility, for every method that may be recorded")
{
    const Scene scene = boxOnFloor();
    uint32_t compared = 0;
    Session list(testDevice(), scene, {});
    for (const GnMethodInfo& info : list.shadows.methods()) {
        if (!servesSpots(info) || info.roundTrips > 0) continue;
        CAPTURE(info.pName);
        Session submitted(testDevice(), scene, {}), recorded(testDevice(), scene, {});
        expect(submitted.shadows.pinAll(info.pName));
        expect(recorded.shadows.pinAll(info.pName));
        settle(submitted, info.pName, 0.0, false);
        settle(recorded, info.pName, 0.0, true);
        CHECK(submitted.renderer.readVisibility()[0].texels == recorded.renderer.readVisibility()[0].texels);
        ++compared;
    }
    CHECK(compared >= 1);
    checkSilence();
}

TEST_CASE("an alpha-tested card drawn by the host throws a shadow with holes into the shadow map")
{
    const Scene scene = cardAboveFloor();
    Session session(testDevice(), scene, {});
    expect(session.shadows.set("shadow_map", kResolutionSetting, 2048));
    expect(session.shadows.pinAll("shadow_map"));
    settle(session, "shadow_map", 0.0, false);
    const Image8 visibility = session.renderer.readVisibility()[0];
    const ImageF depth = session.renderer.readDepth(), normals = session.renderer.readNormals();
    const CameraMatrices& camera = session.renderer.camera();

    // On the floor the answer is a formula: follow the ray to the lamp up to the card's plane and ask the pattern.
    uint32_t floorPixels = 0, wrong = 0, inHoles = 0;
    for (uint32_t y = 0; y < depth.height; ++y) {
        for (uint32_t x = 0; x < depth.width; ++x) {
            const double linear = double(camera.depthScale) / (double(*depth.at(x, y)) + double(camera.depthAdd));
            const glm::dvec3 ray = glm::dvec3(camera.rayCorner) + (x + 0.5) * glm::dvec3(camera.rayDx) +
                                   (y + 0.5) * glm::dvec3(camera.rayDy);
            const glm::dvec3 p = camera.eye + linear * ray;
            if (*depth.at(x, y) == camera.skyDepth || normals.at(x, y)[1] < 0.99f || std::abs(p.y) > 0.01) continue;
            const glm::dvec3 lamp = scene.lights[0].position;
            const glm::dvec3 onCard = p + (lamp - p) * ((2.0 - p.y) / (lamp.y - p.y));
            if (std::abs(onCard.x) > 1.2 || std::abs(onCard.z) > 1.2) continue; // far beside the card
            const bool behindCard = std::abs(onCard.x) < 1.0 && std::abs(onCard.z) < 1.0;
            // The card's own y runs against the world's z after its quarter turn.
            const bool hole = gpu::alphaOpacity(glm::vec3(float(onCard.x), float(-onCard.z), 0.0f)) < 0.5f;
            const bool lit = !behindCard || hole;
            ++floorPixels;
            inHoles += behindCard && hole;
            wrong += lit != (visibility.texels[size_t(y) * depth.width + x] >= 128);
        }
    }
    CHECK(floorPixels > 1000);
    CHECK(inHoles > 100);
    CHECK(double(wrong) < 0.06 * double(floorPixels)); // texels of 5 mm at 64 rims of 8 cm radius
    checkSilence();
}

TEST_CASE("no method that reads triangles serves a light with a host-drawn caster in range")
{
    const Scene scene = cardAboveFloor();
    Session session(testDevice(), scene, {});
    REQUIRE(gnWarmUp(session.shadows.context()) >= 0);
    for (uint32_t i = 0; i < 3; ++i)
        drawFrame(session, {.shadows = &session.shadows});
    GnDecision decision{};
    REQUIRE(gnGetDecision(session.shadows.context(), session.shadows.view(0), session.shadows.light(0), &decision) >=
            0);
    REQUIRE(decision.pMethod != nullptr);
    for (const GnMethodInfo& info : session.shadows.methods())
        if (std::string_view(info.pName) == decision.pMethod) CHECK((info.traits & GN_TRAIT_CPU_GEOMETRY_BIT) == 0);
    checkSilence();
}

TEST_CASE(
    "an edit of watched rules is loaded, also one made while the scene was set up or that was unreadable at first")
{
    namespace fs = std::filesystem;
    using namespace std::chrono_literals;
    const fs::path file = fs::temp_directory_path() / "gnomon_watched.yaml";
    const std::string rules = valueOf(findRules("thesis")).text;
    fs::remove_all(file);
    std::ofstream(file) << rules;
    const Scene scene = boxOnFloor();
    RuleWatch watch(file.string());
    fs::last_write_time(file, fs::last_write_time(file) + 1s); // an edit while everything else is made
    Session session(testDevice(), scene, {});
    int loads = 0;
    const auto poll = [&] {
        (void)watch.poll(session.shadows, [&] { ++loads; });
        std::this_thread::sleep_for(510ms); // it looks twice a second
    };
    poll();
    CHECK(loads == 1);
    poll();
    CHECK(loads == 1);

    const auto edited = fs::last_write_time(file) + 1s;
    fs::remove(file);
    fs::create_directory(file); // there, and not to be read
    fs::last_write_time(file, edited);
    poll();
    CHECK(loads == 1);
    fs::remove(file);
    std::ofstream(file) << rules;
    fs::last_write_time(file, edited);
    poll();
    CHECK(loads == 2);
    CHECK(watch.fault().empty());
    fs::remove(file);
    poll();
    CHECK(watch.fault().empty()); // an editor may be replacing it
    poll();
    CHECK(watch.fault() == file.string() + ": cannot be read");
    CHECK(loads == 2);
    std::ofstream(file) << rules;
    poll();
    CHECK(loads == 3);
    CHECK(watch.fault().empty());
    fs::remove(file);
    checkSilence();
}

TEST_CASE("watched rules that lose their preset leave the preset in force, and say which is missing")
{
    namespace fs = std::filesystem;
    using namespace std::chrono_literals;
    const fs::path file = fs::temp_directory_path() / "gnomon_watched_preset.yaml";
    const std::string base = R"(version: 1
variables: {screenShare: {universe: [0, 1], terms: {all: [-.inf, -.inf, .inf, .inf]}}}
rules: [{id: A, rule: if screenShare is all then shadow_map is favoured}]
)";
    const std::string preset = R"(presets:
  exact: {rules: [{id: A, rule: if screenShare is all then ray_traced is favoured}]}
)";
    const std::string watched = file.string() + ":exact";
    fs::remove(file);
    std::ofstream(file) << base << preset;
    const Scene scene = boxOnFloor();
    Session session(testDevice(), scene, {});
    expect(session.shadows.warmUp());
    RuleWatch watch(watched);
    const auto edit = [&](const std::string& text) {
        const auto newer = fs::last_write_time(file) + 1s;
        std::ofstream(file) << text;
        fs::last_write_time(file, newer);
        (void)watch.poll(session.shadows);
        std::this_thread::sleep_for(510ms); // it looks twice a second
    };
    const auto serves = [&] {
        for (uint32_t i = 0; i < 3; ++i)
            drawFrame(session, {.shadows = &session.shadows});
        GnDecision decision{};
        REQUIRE(gnGetDecision(session.shadows.context(), session.shadows.view(0), session.shadows.light(0),
                              &decision) >= 0);
        return std::string(decision.pMethod);
    };
    edit(base + preset);
    CHECK(serves() == "ray_traced");
    edit(base);
    CHECK(watch.fault().find("there is no preset 'exact'") != std::string::npos);
    CHECK(serves() == "ray_traced"); // not what the base alone says
    (void)session.shadows.takeMessages();
    edit(base + preset);
    CHECK(watch.fault().empty());
    CHECK(serves() == "ray_traced");
    fs::remove(file);
    checkSilence();
}

} // namespace gnomon::demo
