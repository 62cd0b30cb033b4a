// What stands still costs no allocation of any kind. Without validation: the layer allocates in every call.
#include "device/fixture.hpp"
#include "runtime/allocation_count.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

// Rings, pools and lists reach their final size: two timed frames (one in eight) in every slot.
constexpr uint32_t kWarmFrames = 40;
constexpr uint32_t kFrames = 20;

[[maybe_unused]] const bool unvalidated = (withoutValidation(), true);

Scene steadyScene(demo::LightKind kind)
{
    Scene scene = smallScene();
    if (kind == demo::LightKind::Point) scene.lights = {pointLight("bulb", {1.0, 5.0, 2.0}, true)};
    if (kind == demo::LightKind::Directional) {
        scene.lights[0].kind = demo::LightKind::Directional;
        scene.lights[0].range = 0.0f;
    }
    return scene;
}

/// Nothing is new in the frame: on a machine whose speed changes, rules may choose again at any time.
bool keepsChoice(const GnDecision& now, const GnDecision& before)
{
    return !now.switched && !now.pOutgoing && !now.pProbed && !before.pProbed && now.mapSide == before.mapSide &&
           now.redrawEvery == before.redrawEvery;
}

void checkSteady(Host& host)
{
    host.draw(kWarmFrames, {});
    size_t heap = 0;
    uint32_t objects = 0, lists = 0, pipelines = 0, steady = 0;
    for (uint32_t frame = 0; frame < 20 * kFrames && steady < kFrames; ++frame) {
        const GnDecision before = host.decision(0);
        host.require(host.draw({.counter = &allocationCount}));
        const GnFrameStats stats = host.stats();
        if (!keepsChoice(host.decision(0), before)) {
            frame += kWarmFrames - 1; // lists of the new choice reach their size as well
            host.draw(kWarmFrames, {});
            continue;
        }
        ++steady;
        heap += host.counted;
        objects += stats.deviceAllocations;
        lists += stats.indexListsBuilt;
        pipelines += stats.pipelinesCreated;
    }
    CHECK(steady == kFrames);
    if (test::countsOnlyOurs()) CHECK(heap == 0);
    CHECK(objects == 0);
    CHECK(lists == 0);
    CHECK(pipelines == 0);
}

} // namespace

TEST_CASE("the counter counts")
{
    const size_t before = allocationCount();
    const auto made = std::make_unique<int>(7);
    CHECK(*made == 7);
    CHECK(allocationCount() == before + 1);
}

TEST_CASE("a steady frame allocates nothing, whatever the method and the kind of light")
{
    for (const demo::LightKind kind : {demo::LightKind::Spot, demo::LightKind::Point, demo::LightKind::Directional}) {
        Host host(steadyScene(kind));
        for (const GnMethodInfo& method : availableMethods(host.context)) {
            if (!serves(method, kind)) continue;
            CAPTURE(std::string(demo::nameOf(kind)));
            CAPTURE(std::string(method.pName));
            host.pinAll(method.pName);
            checkSteady(host);
            CHECK(host.decision(0).reason == GN_REASON_PINNED);
        }
    }
}

TEST_CASE("a steady frame under rules allocates nothing")
{
    Host host(steadyScene(demo::LightKind::Spot));
    const std::string rules = shippedRules("default");
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), "default"));
    checkSteady(host);
}

TEST_CASE("a frame in which a caster moves allocates nothing either")
{
    Scene scene = smallScene();
    scene.instances[1].isStatic = false;
    Host host(scene);
    for (const GnMethodInfo& method : availableMethods(host.context)) {
        if (!serves(method, demo::LightKind::Spot)) continue;
        CAPTURE(std::string(method.pName));
        host.pinAll(method.pName);
        size_t heap = 0;
        uint32_t objects = 0;
        for (uint32_t frame = 0; frame < kWarmFrames + kFrames; ++frame) {
            // To and fro, so that every list has had its largest size before the count begins.
            host.scene.instances[1].pose.position.x = frame % 2 ? -1.5 : -1.4;
            host.require(host.draw({.counter = &allocationCount}));
            if (frame < kWarmFrames) continue;
            heap += host.counted;
            objects += host.stats().deviceAllocations;
        }
        // Embree allocates when the tree over the instances is committed again; nothing of ours does.
        if (test::countsOnlyOurs()) CHECK(heap <= (method.traits & GN_TRAIT_RAYS_BIT ? kFrames : 0));
        CHECK(objects == 0);
    }
}
