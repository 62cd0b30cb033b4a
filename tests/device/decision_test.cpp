// What was decided, why, and what the decision rests on.
#include <algorithm>
#include <cmath>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

void load(Host& host, const char* name)
{
    const std::string rules = shippedRules(name);
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), name));
}

bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a pinned light is served by its method until it is handed back to the rules")
{
    Host host(smallScene());
    load(host, "thesis");
    host.draw(4, {});
    GnDecision decision = host.decision(0);
    CHECK(std::string(decision.pMethod) == "octree_volume");
    CHECK((decision.reason == GN_REASON_RULES));
    CHECK(decision.suitability > 0.5f);
    CHECK(decision.suitability <= 1.0f);
    CHECK(!decision.switched);

    host.pinAll("shadow_map");
    host.require(host.draw());
    decision = host.decision(0);
    CHECK(std::string(decision.pMethod) == "shadow_map");
    CHECK(decision.reason == GN_REASON_PINNED);
    CHECK(decision.switched);
    CHECK(host.stats().switches == 1);
    CHECK(contains(host.explanation(0), "before: octree_volume"));
    host.require(host.draw());
    CHECK(!host.decision(0).switched);
    CHECK(host.stats().switches == 0);

    host.pinAll(nullptr);
    host.require(host.draw());
    CHECK(std::string(host.decision(0).pMethod) == "octree_volume");
    CHECK(host.decision(0).switched);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "an explanation gives the facts, the rules that fired and every candidate with why it lost")
{
    Host host(smallScene(), {.warmAll = true});
    load(host, "thesis");
    host.draw(6, {});
    const std::string text = host.explanation(0);
    INFO(text);
    CHECK(contains(text, "method: octree_volume (highest suitability)"));
    for (const char* part : {"dynamicLights 0.00",
                             "lightMotion 0.00",
                             "viewerDistance ",
                             "screenShare ",
                             "casterTriangles ",
                             "T1",
                             "octree_volume: chosen",
                             "stencil_volume: outscored",
                             "shadow_map: outscored",
                             "cube_map: out, does not serve this kind of light",
                             "dual_paraboloid: out, does not serve this kind of light",
                             "chan_durand: outscored",
                             "mccool: outscored",
                             "all_edges_volume: outscored",
                             "projected_planar: outscored",
                             "pcf_hybrid: outscored",
                             "ray_traced: outscored",
                             "tile_shafts: outscored",
                             "conservative_map: outscored",
                             "conservative_map_adjacency: outscored",
                             "penumbra_wedges: outscored",
                             "coherence_sampling: outscored",
                             "eight_point_hybrid: outscored"})
        CHECK_MESSAGE(contains(text, part), std::string(part));
    CHECK(!contains(text, "nan"));

    // A buffer that is too small gets what fits, and says so.
    size_t size = 12;
    char small[12];
    GnQuestion question{.kind = GN_QUESTION_DECISION};
    CHECK(gnExplain(host.context, host.views[0], host.lights[0], &question, &size, small) == GN_INCOMPLETE);
    CHECK(size == text.size() + 1);
    CHECK(std::string(small) == text.substr(0, 11));

    // It is known of the newest frame, by whichever number.
    question.frame = host.frame();
    host.require(gnExplain(host.context, host.views[0], host.lights[0], &question, &size, nullptr));
    CHECK(size == text.size() + 1);
    --question.frame;
    CHECK(gnExplain(host.context, host.views[0], host.lights[0], &question, &size, nullptr) == GN_ERROR_OUT_OF_RANGE);
    CHECK(contains(gnGetLastError(host.context), "of the newest frame"));
}

TEST_CASE_FIXTURE(DeviceTest, "a preset changes the rules in force from the next frame on, and an unknown one nothing")
{
    Host host(smallScene());
    CHECK(gnSetPreset(host.context, "exact") == GN_ERROR_RULES); // no rules are loaded
    const std::string rules = R"(version: 1
variables: {screenShare: {universe: [0, 1], terms: {all: [-.inf, -.inf, .inf, .inf]}}}
rules: [{id: A, rule: if screenShare is all then shadow_map is favoured}]
presets:
  exact: {rules: [{id: A, rule: if screenShare is all then ray_traced is favoured}]}
  volumes: {rules: [{id: A, rule: if screenShare is all then stencil_volume is favoured}]}
)";
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), "three.yaml"));
    const auto serves = [&] {
        host.draw(3, {});
        return std::string(host.decision(0).pMethod);
    };
    CHECK(serves() == "shadow_map");
    host.require(gnSetPreset(host.context, "exact"));
    CHECK(serves() == "ray_traced");
    CHECK(contains(host.explanation(0), "rule A"));
    host.require(gnSetPreset(host.context, "volumes")); // of the base, not of the preset before
    CHECK(serves() == "stencil_volume");
    CHECK(gnSetPreset(host.context, "exakt") == GN_ERROR_OUT_OF_RANGE);
    CHECK(contains(gnGetLastError(host.context), "three.yaml: there is no preset 'exakt'; did you mean 'exact'?"));
    CHECK(serves() == "stencil_volume");
    host.require(gnSetPreset(host.context, nullptr));
    CHECK(serves() == "shadow_map");
    host.require(gnSetPreset(host.context, "exact"));
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), "three.yaml"));
    CHECK(serves() == "shadow_map");
}

TEST_CASE_FIXTURE(DeviceTest, "without rules an exact method serves, recorded frames included")
{
    Scene scene = smallScene();
    scene.lights.push_back(pointLight("bulb", {1.0, 5.0, 2.0}, true));
    Host host(scene);
    for (const Call call : {Call::submit, Call::record}) {
        host.require(host.draw({.call = call}));
        for (size_t light = 0; light < 2; ++light) {
            const std::string method = host.decision(light).pMethod;
            bool exact = false;
            for (const GnMethodInfo& info : availableMethods(host.context))
                exact = exact || (method == info.pName && (info.traits & GN_TRAIT_EXACT_BIT));
            CHECK_MESSAGE(exact, method);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "the viewer's distance is a lower bound at first, then the nearest visible receiver's")
{
    // A bare floor that fills the screen: the nearest point of it lies under the middle of the lowest row.
    Scene scene = smallScene();
    scene.instances.resize(1);
    scene.camera = {demo::CameraKey{.eye = {0.0, 5.0, 5.0}, .target = {0.0, 0.0, 0.0}, .verticalFov = 0.6f}};
    scene.lights = {spotLight("lamp", {0.0, 8.0, 0.0}, {0.0, 0.0, 0.0}, true)};
    Host host(scene);
    load(host, "default");
    const demo::CameraMatrices camera = demo::cameraMatrices(scene, demo::cameraAt(scene, 0.0), host.extent());
    const glm::dvec3 ray =
        glm::dvec3(camera.rayCorner) + 160.0 * glm::dvec3(camera.rayDx) + 180.0 * glm::dvec3(camera.rayDy);
    const double truth = glm::length(ray * (-camera.eye.y / ray.y));

    host.require(host.draw());
    CHECK(!host.decision(0).viewerDistanceMeasured);
    CHECK(double(host.decision(0).viewerDistance) <= truth);
    CHECK(contains(host.explanation(0), "viewerDistance: lower bound"));
    host.draw(6, {});
    CHECK(host.decision(0).viewerDistanceMeasured);
    CHECK(double(host.decision(0).viewerDistance) <= truth + 1e-3);
    CHECK(double(host.decision(0).viewerDistance) >= truth * 0.9); // to the nearest corner of a tile of 16 pixels

    // After a cut what was measured says nothing; the bound holds until the new picture has been looked at.
    host.require(
        host.draw({.adjust = [](GnFrameInfo&, std::vector<GnViewFrame>& views) { views[0].cameraCut = true; }}));
    CHECK(!host.decision(0).viewerDistanceMeasured);
}

TEST_CASE_FIXTURE(DeviceTest, "what only the host can draw puts methods that read triangles out, by name and number")
{
    Host host(smallScene());
    load(host, "default");
    const auto outs = [&] {
        host.require(host.draw());
        return host.explanation(0);
    };
    CHECK(!contains(outs(), "host-drawn"));

    GnInstance grass = addHostDrawn(host, 0, 0.0, 0xffffffffu);
    std::string text = outs();
    INFO(text);
    for (const char* method : {"stencil_volume", "pcf_hybrid", "ray_traced"})
        CHECK(contains(text, std::string(method) + ": out, 1 host-drawn casters in range"));
    CHECK(contains(text, "method: shadow_map"));
    host.pinAll("ray_traced");
    host.require(host.draw());
    CHECK(std::string(host.decision(0).pMethod) == "shadow_map");
    CHECK(host.decision(0).reason != GN_REASON_PINNED);
    const GnInstance more = addHostDrawn(host, 0, 1.0, 0xffffffffu);
    CHECK(contains(outs(), "ray_traced: out, 2 host-drawn casters in range"));
    gnDestroyInstance(host.context, more);
    gnDestroyInstance(host.context, grass);

    // Out of range, not casting for this light, or allowed to be missed: nobody minds.
    for (const auto& [extra, x, mask] :
         {std::tuple{0u, 200.0, 0xffffffffu}, {uint32_t(GN_INSTANCE_MAY_BE_MISSED_BIT), 0.0, 0xffffffffu}}) {
        grass = addHostDrawn(host, extra, x, mask);
        CHECK(!contains(outs(), "host-drawn"));
        CHECK(host.decision(0).reason == GN_REASON_PINNED);
        gnDestroyInstance(host.context, grass);
    }
    GnLightInfo masked = demo::toGnLight(host.scene.lights[0], demo::lightAt(host.scene.lights[0], 0.0));
    masked.casterMask = 1;
    host.require(gnUpdateLight(host.context, host.lights[0], &masked));
    grass = addHostDrawn(host, 0, 0.0, 2);
    CHECK(!contains(outs(), "host-drawn"));
}

TEST_CASE_FIXTURE(DeviceTest, "an alpha-tested card that the host draws casts its holes in a shadow map")
{
    // A card of 2 x 2 m, flat over the floor, straight under a lamp far above it.
    Scene scene = smallScene();
    scene.instances.resize(1);
    scene.meshes.push_back(demo::makeCard({.width = 2.0f, .height = 2.0f}));
    demo::Instance card;
    card.name = "card";
    card.mesh = 3;
    card.pose.position = {0.0, 1.0, 0.0};
    card.pose.rotation = glm::angleAxis(glm::radians(-90.0), glm::dvec3(1.0, 0.0, 0.0));
    card.isStatic = card.hostDrawn = true;
    scene.lights = {spotLight("lamp", {0.0, 20.0, 0.0}, {0.0, 0.0, 0.0}, true)};
    scene.lights[0].outerAngle = 0.25f;
    scene.camera = {demo::CameraKey{.eye = {0.0, 6.0, 6.0}, .target = {0.0, 0.0, 0.0}, .verticalFov = 0.7f}};
    const auto picture = [&](bool present, bool alphaTested) {
        Scene copy = scene;
        card.alphaTested = alphaTested;
        if (present) copy.instances.push_back(card);
        Host host(copy, {.extent = {480, 360}});
        host.require(gnSetMethodSetting(host.context, "shadow_map", "resolution", 2048));
        host.pinAll("shadow_map");
        host.draw(2, {});
        CHECK(host.decision(0).reason == GN_REASON_PINNED);
        return host.pictures()[0];
    };
    const Image8 none = picture(false, false), solid = picture(true, false), holed = picture(true, true);
    size_t shadow = 0, holes = 0, elsewhere = 0;
    for (size_t i = 0; i < none.texels.size(); ++i) {
        const bool inShadow = none.texels[i] == 255 && solid.texels[i] == 0;
        shadow += inShadow;
        holes += inShadow && holed.texels[i] == 255;
        elsewhere += !inShadow && holed.texels[i] != none.texels[i];
    }
    CHECK(shadow > 5000);
    CHECK(elsewhere == 0);
    // Round holes of radius 0.08 every 0.25 m.
    const double share = 3.14159265 * 0.08 * 0.08 / (0.25 * 0.25);
    CHECK(std::abs(double(holes) / double(shadow) - share) < 0.03);
}

TEST_CASE_FIXTURE(DeviceTest, "whatever state a host's callback leaves, the casters drawn after it are all there")
{
    // Statics are drawn first: what leaves the state behind, then the ball and the card, which the host draws as well.
    Scene scene = smallScene();
    scene.instances[1].isStatic = false;
    scene.meshes.push_back(demo::makeCard({.width = 2.0f, .height = 2.0f}));
    demo::Instance card;
    card.name = "card";
    card.mesh = 3;
    card.pose.position = {-2.0, 1.0, 0.0};
    card.pose.rotation = glm::angleAxis(glm::radians(-90.0), glm::dvec3(1.0, 0.0, 0.0));
    card.hostDrawn = true;
    scene.instances.push_back(card);
    const auto picture = [&](PFN_gnDrawCasters leave) {
        Host host(scene);
        GnInstanceCreateInfo info{};
        info.flags = GN_INSTANCE_HOST_DRAWN_BIT | GN_INSTANCE_STATIC_BIT;
        std::fill_n(info.boundsMin, 3, -0.5f);
        std::fill_n(info.boundsMax, 3, 0.5f);
        info.pfnDrawCasters = leave;
        GnInstance instance = VK_NULL_HANDLE;
        host.require(gnCreateInstance(host.context, &info, &instance));
        host.pinAll("shadow_map");
        host.require(host.draw());
        CHECK(host.decision(0).reason == GN_REASON_PINNED);
        return host.pictures()[0];
    };
    const Image8 clean = picture([](VkCommandBuffer, const GnCasterProjection*, void*) {});
    static uint32_t calls = 0;
    const Image8 messy = picture([](VkCommandBuffer cmd, const GnCasterProjection* projection, void*) {
        ++calls;
        CHECK(projection->area.extent.width > 1);
        const VkViewport viewport{0.0f, 0.0f, 1.0f, 1.0f, 0.0f, 1.0f};
        const VkRect2D scissor{{0, 0}, {1, 1}};
        vkCmdSetViewport(cmd, 0, 1, &viewport);
        vkCmdSetScissor(cmd, 0, 1, &scissor);
        vkCmdSetDepthBias(cmd, 1e9f, 0.0f, 0.0f);
    });
    CHECK(calls == 1);
    CHECK(dark(clean) > 500);
    CHECK(differences(clean, messy) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "two paraboloids do not depend on how far a light reaches past all casters")
{
    Scene scene = smallScene();
    scene.lights = {pointLight("bulb", {1.0, 5.0, 2.0}, true)};
    const auto picture = [&](float range) {
        Scene copy = scene;
        copy.lights[0].range = range;
        Host host(copy);
        host.pinAll("dual_paraboloid");
        host.require(host.draw());
        return host.pictures()[0];
    };
    const Image8 hundreds = picture(500.0f);
    CHECK(dark(hundreds) > 100);
    CHECK(differences(hundreds, picture(1e6f)) == 0);
    CHECK(differences(hundreds, picture(0.0f)) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "a light's map says which of its layers hold the frame's casters")
{
    Scene scene = smallScene();
    scene.lights = {pointLight("bulb", {0.0, 5.0, 0.0}, true)};
    scene.camera = {demo::CameraKey{.eye = {0.0, 4.0, 6.0}, .target = {0.0, -1.0, 0.0}}}; // nothing above the bulb
    Host host(scene);
    const auto valid = [&](const char* method) {
        host.pinAll(method);
        host.require(host.draw());
        GnLightMap map{};
        host.require(gnGetLightMap(host.context, host.lights[0], &map));
        CHECK(map.validLayers < 1u << map.layerCount);
        return map.validLayers;
    };
    const uint32_t faces = valid("cube_map");
    CHECK((faces >> 3 & 1) == 1); // down
    CHECK((faces >> 2 & 1) == 0); // up
    CHECK(valid("dual_paraboloid") == 1);
    CHECK(valid("cube_map") == faces); // kept
}

TEST_CASE_FIXTURE(DeviceTest, "a light's map is what its method kept: size, matrices and origin fit the scene")
{
    Scene scene = smallScene();
    Host host(scene);
    host.require(gnSetMethodSetting(host.context, "shadow_map", "resolution", 512));
    host.pinAll("shadow_map");
    host.require(host.draw());
    GnLightMap map{};
    host.require(gnGetLightMap(host.context, host.lights[0], &map));
    CHECK(map.image != VK_NULL_HANDLE);
    CHECK(map.imageView != VK_NULL_HANDLE);
    CHECK(map.format == VK_FORMAT_D32_SFLOAT);
    CHECK(map.extent.width == 512);
    CHECK(map.extent.height == 512);
    CHECK(map.layerCount == 1);
    CHECK(map.validLayers == 1);
    const auto project = [&](const glm::dvec3& world) {
        glm::dvec4 clip(0.0);
        const glm::dvec4 relative(world - glm::dvec3(map.origin[0], map.origin[1], map.origin[2]), 1.0);
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                clip[row] += double(map.clipFromWorld[0][4 * column + row]) * relative[column];
        return glm::dvec3(clip) / clip.w;
    };
    const demo::Light& light = scene.lights[0];
    const glm::dvec3 target(0.0); // on the axis
    CHECK(std::abs(project(target).x) < 1e-3);
    CHECK(std::abs(project(target).y) < 1e-3);
    const glm::dvec3 nearer = light.position + 0.5 * (target - light.position);
    CHECK(project(nearer).z < project(target).z);
    CHECK(project(target).z <= 1.0);
    CHECK(project(nearer).z >= 0.0);
    for (const float value : map.clipFromWorld[1])
        CHECK(value == 0.0f);

    host.require(gnSetMethodSetting(host.context, "shadow_map", "resolution", 256));
    host.require(host.draw());
    host.require(gnGetLightMap(host.context, host.lights[0], &map));
    CHECK(map.extent.width == 256);
    host.pinAll("stencil_volume");
    host.require(host.draw());
    CHECK(gnGetLightMap(host.context, host.lights[0], &map) == GN_ERROR_UNKNOWN_METHOD);
    CHECK(contains(host.lastError(), "'lamp'"));
    CHECK(map.image == VK_NULL_HANDLE);
}

TEST_CASE_FIXTURE(DeviceTest, "a method added under a name of its own has settings of its own")
{
    Host host(smallScene());
    host.require(gnAddMethod(host.context, "shadow_map_coarse", "shadow_map"));
    host.require(gnSetMethodSetting(host.context, "shadow_map_coarse", "resolution", 64));
    host.require(gnWarmUp(host.context));
    host.pinAll("shadow_map");
    host.require(host.draw());
    const std::vector<Image8> fine = host.pictures();
    host.pinAll("shadow_map_coarse");
    host.require(host.draw());
    CHECK(host.decision(0).reason == GN_REASON_PINNED);
    CHECK(std::string(host.decision(0).pMethod) == "shadow_map_coarse");
    GnLightMap map{};
    host.require(gnGetLightMap(host.context, host.lights[0], &map));
    CHECK(map.extent.width == 64);
    CHECK(differences(fine, host.pictures()) > 100);
    host.pinAll("shadow_map");
    host.require(host.draw());
    CHECK(differences(fine, host.pictures()) == 0);
}
