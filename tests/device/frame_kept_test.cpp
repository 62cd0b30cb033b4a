// What stands still is not done again, and what moves is done again exactly once.
#include <array>
#include <map>
#include <memory>
#include <random>

#include "device/fixture.hpp"
#include "gnomon/algorithm.h"
#include "runtime/registry.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// A far caster, out of every light's range, that a test may move; the ball may move as well.
Scene sceneWithFarCaster(demo::LightKind kind)
{
    Scene scene = smallScene();
    demo::Instance far = scene.instances[2];
    far.name = "far";
    far.pose.position = {200.0, 1.0, 0.0};
    far.isStatic = false;
    scene.instances[1].isStatic = false;
    scene.instances.push_back(far);
    if (kind == demo::LightKind::Point) scene.lights = {pointLight("bulb", {1.0, 5.0, 2.0}, true)};
    return scene;
}

constexpr size_t kBall = 1, kFar = 3;
const HostOptions kSmall{.extent = {160, 90}}; ///< Where all methods draw many frames.

/// Small casters that move over a floor on which large ones stand, under one static light.
Scene sceneWithSwarm(demo::LightKind kind)
{
    Scene scene = smallScene();
    scene.meshes.push_back(demo::makeSphere({.radius = 0.25f, .slices = 12, .stacks = 6}));
    for (const char* name : {"first", "second", "third"}) {
        demo::Instance moving = scene.instances[kBall];
        moving.name = name;
        moving.mesh = static_cast<uint32_t>(scene.meshes.size() - 1);
        moving.isStatic = false;
        scene.instances.push_back(moving);
    }
    if (kind == demo::LightKind::Point) scene.lights = {pointLight("bulb", {1.0, 3.0, 2.0}, true)};
    if (kind == demo::LightKind::Directional) {
        scene.lights[0].kind = kind;
        scene.lights[0].range = 0.0f;
    }
    return scene;
}

/// Moves the swarm: most of it in steps, some out of range or close to the light, some not at all.
void moveSwarm(Scene& scene, std::mt19937& random)
{
    std::uniform_real_distribution<double> step(-0.6, 0.6), anywhere(-6.0, 6.0), height(0.3, 7.5);
    for (size_t i = 3; i < scene.instances.size(); ++i) {
        glm::dvec3& position = scene.instances[i].pose.position;
        switch (random() % 6) {
        case 0:
            break;
        case 1:
            position = {anywhere(random), height(random), anywhere(random)};
            break;
        case 2:
            position = {100.0, 1.0, 0.0};
            break;
        default:
            position += glm::dvec3(step(random), 0.3 * step(random), step(random));
        }
    }
}

/// A method with a map of its own, and a kind of light that it serves.
struct Served {
    GnMethodInfo method;
    demo::LightKind kind;
};

std::vector<Served> mapsOf(GnContext context, std::initializer_list<demo::LightKind> kinds)
{
    std::vector<Served> all;
    for (const GnMethodInfo& method : availableMethods(context))
        for (const demo::LightKind kind : kinds)
            if (hasMap(method) && serves(method, kind)) all.push_back({method, kind});
    return all;
}

/// Passes of the light's own that draw casters or make its volumes.
uint32_t updates(const Host& host)
{
    uint32_t count = 0;
    for (const GnPassTiming& pass : host.passes())
        count += pass.light && !pass.view;
    return count;
}

/// A method of a host's own that leaves every pixel lit and notes the stamps of its tasks.
struct StampNoter {
    const GnPluginInterface* gn = nullptr;
    std::vector<uint64_t> stamps;

    void registerIn(const Host& host)
    {
        host.require(gnGetPluginInterface(host.context, &gn));
        const GnAlgorithmInfo info{
            .pName = "stamp_noter", .traits = GN_TRAIT_SPOT_BIT, .pfnDeclare = declare, .pAlgorithm = this};
        host.require(gnRegisterAlgorithm(host.context, &info));
    }
    static void GN_CALL declare(void* self, GnPassBuilder builder, const GnShadowTask* task)
    {
        StampNoter& noter = *static_cast<StampNoter*>(self);
        noter.stamps.push_back(task->casterStamp);
        const GnAccess lit{.kind = GN_ACCESS_WRITE,
                           .image = task->visibility,
                           .baseLayer = task->layer,
                           .clear = VK_TRUE,
                           .clearValue = {.color = {{1.0f, 0.0f, 0.0f, 0.0f}}}};
        const GnPassInfo pass{.pName = "stamp_noter.fill",
                              .kind = GN_PASS_RASTER,
                              .scope = GN_SCOPE_TASK,
                              .accessCount = 1,
                              .pAccesses = &lit,
                              .area = task->area,
                              .pfnRecord = [](GnPassContext, VkCommandBuffer, const VkRect2D*, void*) {}};
        noter.gn->pfnPass(builder, &pass);
    }
};

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a mask that changes takes a standing caster from its lights, and gives it back")
{
    Scene scene = smallScene();
    scene.lights[0].casterMask = 1;
    Host host(scene, kSmall);
    scene.instances[kBall].casterMask = 6;
    Host without(scene, kSmall);
    for (const GnMethodInfo& served : availableMethods(host.context)) {
        if (!serves(served, demo::LightKind::Spot)) continue;
        const char* method = served.pName;
        CAPTURE(std::string(method));
        host.beginAnew(host.scene, method);
        host.draw(3, {});
        const std::vector<Image8> all = host.pictures();
        without.beginAnew(scene, method);
        without.require(without.draw());
        const std::vector<Image8> fewer = without.pictures();
        REQUIRE(differences(all, fewer) > 25);

        host.require(gnSetInstanceCasterMask(host.context, host.instances[kBall], 6));
        host.draw(2, {});
        CHECK(differences(host.pictures(), fewer) == 0);
        host.require(gnSetInstanceCasterMask(host.context, host.instances[kBall], 0));
        host.draw(2, {});
        CHECK(differences(host.pictures(), all) == 0);
        host.require(gnSetInstanceCasterMask(host.context, host.instances[kBall], 1)); // as good as all bits here
        host.require(host.draw());
        CHECK(differences(host.pictures(), all) == 0);
        CHECK(host.takeMessages().empty());
    }
    CHECK(gnSetInstanceCasterMask(host.context, VK_NULL_HANDLE, 1) == GN_ERROR_INVALID_HANDLE);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "a static light over standing casters draws its map once, again exactly when one in range moved")
{
    std::map<demo::LightKind, std::unique_ptr<Host>> hosts;
    for (const auto kind : {demo::LightKind::Spot, demo::LightKind::Point})
        hosts[kind] = std::make_unique<Host>(sceneWithFarCaster(kind));
    for (const Served& served :
         mapsOf(hosts.begin()->second->context, {demo::LightKind::Spot, demo::LightKind::Point})) {
        if (served.method.roundTrips != 0) continue; // they have passes of the light's beside the map's
        const char* method = served.method.pName;
        const auto all = builtinRegistry().algorithms;
        const auto same = [&](const BuiltinAlgorithm& a) { return std::string_view(a.entry->name) == method; };
        const auto algorithm = std::ranges::find_if(all, same);
        if (algorithm != all.end() && algorithm->entry->followsView) continue; // the map is the view's
        CAPTURE(std::string(method));
        Host& host = *hosts[served.kind];
        host.beginAnew(sceneWithFarCaster(served.kind), method);
        host.require(host.draw());
        const uint32_t first = updates(host);
        CHECK(first > 0);
        const std::vector<Image8> before = host.pictures();
        CHECK(dark(before[0]) > 100);
        for (int frame = 0; frame < 3; ++frame) {
            host.require(host.draw());
            CHECK(updates(host) == 0);
            CHECK(host.stats().passesKept > 0);
        }
        CHECK(differences(before, host.pictures()) == 0);

        host.scene.instances[kFar].pose.position.z += 1.0;
        host.require(host.draw());
        CHECK(updates(host) == 0);

        host.scene.instances[kBall].pose.position.x += 0.4;
        host.require(host.draw());
        CHECK(updates(host) > 0);
        CHECK(updates(host) <= first);
        const std::vector<Image8> moved = host.pictures();
        CHECK(differences(before, moved) > 50);
        host.require(host.draw());
        CHECK(updates(host) == 0);
        CHECK(differences(moved, host.pictures()) == 0);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "casters that the host draws are drawn in every frame, static ones once")
{
    for (const GnInstanceFlags flags : {0u, uint32_t(GN_INSTANCE_STATIC_BIT)}) {
        Host host(sceneWithFarCaster(demo::LightKind::Spot));
        addHostDrawn(host, flags, 0.0, 0xffffffffu);
        host.pinAll("shadow_map");
        host.require(host.draw());
        CHECK(updates(host) > 0);
        for (int frame = 0; frame < 3; ++frame) {
            host.require(host.draw());
            CHECK((updates(host) > 0) == (flags == 0));
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "what does not hold casters that the host draws is kept beside them")
{
    uint32_t keeping = 0;
    const Host known(smallScene(), {.warmUp = false});
    for (const GnMethodInfo& method : availableMethods(known.context)) {
        if (!(method.traits & GN_TRAIT_CPU_GEOMETRY_BIT)) continue;
        CAPTURE(std::string(method.pName));
        const demo::LightKind kind = servedKind(method);
        if (kind == demo::LightKind::Directional) continue; // whose range ends nowhere
        Host host(sceneWithFarCaster(kind));
        uint32_t draws = 0;
        addHostDrawn(host, GN_INSTANCE_MAY_BE_MISSED_BIT, 0.0, 0xffffffffu, &draws);
        host.pinAll(method.pName);
        host.require(host.draw());
        REQUIRE(std::string(host.decision(0).pMethod) == method.pName);
        if (updates(host) == 0) continue; // it makes nothing for a light
        ++keeping;
        for (int frame = 0; frame < 3; ++frame) {
            draws = 0;
            host.require(host.draw());
            CHECK(host.stats().indexListsBuilt == 0);
            CHECK((updates(host) == 0) == (draws == 0)); // a map that holds what the host draws is drawn again
        }
        host.scene.instances[kBall].pose.position.x += 0.4;
        host.require(host.draw());
        CHECK(updates(host) > 0);
    }
    CHECK(keeping >= 6);
}

TEST_CASE_FIXTURE(DeviceTest, "a plug-in's stamp changes with what moves, not with what the host draws")
{
    Host host(sceneWithFarCaster(demo::LightKind::Spot));
    const GnInstance grass = addHostDrawn(host, GN_INSTANCE_MAY_BE_MISSED_BIT, 0.0, 0xffffffffu);
    StampNoter noter;
    noter.registerIn(host);
    host.pinAll("stamp_noter");
    const auto stamp = [&] {
        host.require(host.draw());
        return noter.stamps.back();
    };
    const uint64_t first = stamp();
    CHECK(stamp() == first);
    host.scene.instances[kFar].pose.position.z += 1.0; // out of range
    CHECK(stamp() == first);
    host.scene.instances[kBall].pose.position.x += 0.4;
    const uint64_t moved = stamp();
    CHECK(moved != first);
    const GnTransform beside{.basis = {}, .translation = {0.2, 1.0, 0.0}};
    host.require(gnSetInstanceTransform(host.context, grass, &beside));
    const uint64_t blown = stamp();
    CHECK(blown != moved);
    CHECK(stamp() == blown);
}

TEST_CASE_FIXTURE(DeviceTest, "silhouettes are found once, again exactly when a caster in range moved")
{
    Host host(sceneWithFarCaster(demo::LightKind::Spot));
    host.pinAll("stencil_volume");
    host.require(host.draw());
    CHECK(host.stats().indexListsBuilt > 0);
    for (int frame = 0; frame < 3; ++frame) {
        host.require(host.draw());
        CHECK(host.stats().indexListsBuilt == 0);
    }
    host.scene.instances[kFar].pose.position.z += 1.0;
    host.require(host.draw());
    CHECK(host.stats().indexListsBuilt == 0);
    host.scene.instances[kBall].pose.position.x += 0.4;
    host.require(host.draw());
    CHECK(host.stats().indexListsBuilt > 0);
    host.require(host.draw());
    CHECK(host.stats().indexListsBuilt == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "a kept map equals the map of a new light, after moves of every kind")
{
    const Scene scene = sceneWithFarCaster(demo::LightKind::Spot);
    Host host(scene, kSmall), fresh(scene, kSmall);
    for (const GnMethodInfo& served : availableMethods(host.context)) {
        if (served.roundTrips != 0 || !serves(served, demo::LightKind::Spot)) continue;
        const char* method = served.pName;
        CAPTURE(std::string(method));
        host.beginAnew(scene, method);
        for (int step = 0; step < 6; ++step) {
            if (step % 2) host.scene.instances[kBall].pose.position.x += 0.3;
            if (step == 2) host.scene.lights[0].position.x -= 0.7;         // a static light that moves after all
            if (step == 4) host.scene.instances[2].pose.position.z += 0.5; // and a static caster
            host.draw(2, {});
            if (step % 2 == 0) continue;
            fresh.beginAnew(host.scene, method);
            fresh.require(fresh.draw());
            CHECK(differences(host.pictures(), fresh.pictures()) == 0);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest,
                  "however small casters move, the parts of a map and of its copy that stay are those of a new light")
{
    std::mt19937 random(29);
    std::map<demo::LightKind, std::array<std::unique_ptr<Host>, 2>> pairs;
    for (const auto kind : {demo::LightKind::Spot, demo::LightKind::Point, demo::LightKind::Directional})
        for (std::unique_ptr<Host>& host : pairs[kind])
            host = std::make_unique<Host>(sceneWithSwarm(kind), kSmall);
    uint32_t turn = 0;
    for (const Served& served : mapsOf(pairs.begin()->second[0]->context,
                                       {demo::LightKind::Spot, demo::LightKind::Point, demo::LightKind::Directional})) {
        if (++turn % 3 == 0) continue; // two of the three kinds of light, not the same for all methods
        const char* method = served.method.pName;
        CAPTURE(std::string(method));
        Host &host = *pairs[served.kind][0], &again = *pairs[served.kind][1];
        host.beginAnew(sceneWithSwarm(served.kind), method);
        for (int step = 0; step < 4; ++step) {
            CAPTURE(step);
            const bool recordable = served.method.roundTrips == 0;
            moveSwarm(host.scene, random);
            if (step == 3) host.scene.instances[2].pose.position.z += 0.5; // a static one after all
            if (recordable && random() % 3 == 0) { // seen by nobody, then tried again with everything elsewhere
                host.draw({.call = Call::record, .drop = true});
                moveSwarm(host.scene, random);
            }
            for (size_t frames = random() % 3; frames > 0; --frames) { // in flight
                host.require(host.draw());
                moveSwarm(host.scene, random);
            }
            host.require(host.draw());
            again.beginAnew(host.scene, method);
            again.require(again.draw());
            CHECK(differences(host.pictures(), again.pictures()) == 0);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a static thing that moves is reported once")
{
    Host host(smallScene());
    host.require(host.draw());
    host.takeMessages();
    host.scene.instances[1].pose.position.x += 0.1;
    host.require(host.draw());
    const std::vector<std::string> messages = host.takeMessages();
    REQUIRE(messages.size() == 1);
    CHECK(messages[0].find("ball") != std::string::npos);
    host.scene.instances[1].pose.position.x += 0.1;
    host.require(host.draw());
    CHECK(host.takeMessages().empty());
}
