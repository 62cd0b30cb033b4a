// octree_volume: stencil_volume's picture bit by bit, from volumes that are kept while everything stands still, and
// with far fewer of them where most are concealed.
#include "device/draw_counter.hpp"
#include "device/method_pair.hpp"
#include "device/small_scenes.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr const char* kPlain = "stencil_volume";
constexpr const char* kTree = "octree_volume";

Scene shipped(const char* name)
{
    return demo::valueOf(demo::loadScene(name));
}

/// The same scene drawn by both methods.
struct Pair : MethodPair {
    Host& tree = other;

    explicit Pair(const Scene& scene, const HostOptions& options = {}) : MethodPair(kPlain, kTree, scene, options) {}
};

/// Light kinds that a scene of rooms can be lit by, all static.
Scene litBy(const char* kind)
{
    Scene scene = shipped("rooms");
    demo::limitLights(scene, 2);
    for (demo::Light& light : scene.lights) {
        if (std::string(kind) == "sun") {
            light.kind = demo::LightKind::Directional;
            light.direction = glm::normalize(glm::dvec3(light.position.x > 0.0 ? 0.8 : -0.3, -0.45, 0.35));
        } else if (std::string(kind) == "spot") {
            light.kind = demo::LightKind::Spot;
            light.direction = glm::normalize(glm::dvec3(-0.9, -0.1, 0.2));
            light.outerAngle = 1.1f;
            light.innerAngle = 0.9f;
        }
    }
    return scene;
}

std::vector<demo::CameraState> look(const glm::dvec3& eye, const glm::dvec3& target)
{
    return {{.eye = eye, .target = target, .verticalFov = 1.2f}};
}

/// Passes of the light's own that bring kept things up to date.
uint32_t updates(const Host& host)
{
    uint32_t count = 0;
    for (const GnPassTiming& pass : host.passes())
        count += pass.light && !pass.view;
    return count;
}

uint32_t passesNamed(const Host& host, const char* name)
{
    return host.passCount(name);
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "octree_volume draws stencil_volume's picture bit by bit in every shipped scene")
{
    for (const Scene& each : smallShippedScenes()) {
        CAPTURE(each.name);
        Pair pair(each, {.maxLights = 32});
        for (const double time : {0.0, 0.5})
            CHECK(pair.differing({.time = time}) == 0);
        CHECK(dark(pair.pictures[0]) > 100);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "it does so for every kind of light, inside and outside of shadows, walls and rooms")
{
    // Above; in a room; in its corner, where walls' umbrae begin; in the next room's umbra; with the near plane across
    // a wall; inside a wall and inside a shelf; under the floor; far away.
    const std::pair<glm::dvec3, glm::dvec3> places[] = {
        {{0, 20, 12}, {0, 0, 0.8}},         {{3.4, 1.6, 2.5}, {1, 0.8, 2.4}},   {{0.3, 2.2, 0.3}, {4, 0.5, 4}},
        {{-2.5, 1.2, 2.4}, {-9, 0.6, 2.5}}, {{2.5, 2.55, 0.05}, {2.4, 0.5, 4}}, {{2.5, 1.2, 0.02}, {2.4, 1, 4}},
        {{2.5, 1.1, 1.22}, {-1, 1.2, -2}},  {{1, -2, 1}, {-3, 0.5, -4}},        {{60, 30, 80}, {0, 0, 0}}};
    for (const char* kind : {"lamp", "sun", "spot"}) {
        CAPTURE(std::string(kind));
        Pair pair(litBy(kind));
        for (const double zFail : {0.0, 1.0}) {
            pair.set("z_fail", zFail);
            for (const auto& place : places) {
                const std::vector<demo::CameraState> cameras = look(place.first, place.second);
                CAPTURE(place.first.x);
                CAPTURE(place.first.y);
                CHECK(pair.differing({.cameras = &cameras}) == 0);
            }
        }
        pair.set("bounded", 0.0);
        CHECK(pair.differing({}) == 0);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "it does so with standard depth, without its culling, and in two views at once")
{
    Scene scene = litBy("lamp");
    scene.depth = {.convention = demo::DepthConvention::Standard, .nearPlane = 0.1f, .farPlane = 200.0f};
    Pair standard(scene);
    CHECK(standard.differing({}) == 0);

    Pair pair(litBy("lamp"), {.viewCount = 2});
    const std::vector<demo::CameraState> cameras = {look({0, 20, 12}, {0, 0, 0.8})[0],
                                                    look({-2.5, 1.2, 2.4}, {-9, 0.6, 2.5})[0]};
    for (const double extents : {1.0, 0.0}) {
        pair.tree.require(gnSetMethodSetting(pair.tree.context, kTree, "extents", extents));
        CHECK(pair.differing({.cameras = &cameras}) == 0);
        CHECK(differences(pair.plain.pictures(1), pair.tree.pictures(1)) == 0);
        CHECK(dark(pair.tree.pictures(1)[0]) > 100);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "kept volumes are built once, and again exactly when a caster in range moved")
{
    Scene scene = litBy("lamp");
    scene.lights.resize(1);
    scene.lights[0].range = 10.0f; // not all of the rooms
    Pair pair(scene);
    Host& host = pair.tree;
    size_t nearby = 0, distant = 0; // a shelf in the lamp's room, and one out of its range
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const double away = glm::length(scene.instances[i].pose.position - scene.lights[0].position);
        if (scene.instances[i].name.find("shelf_left") == std::string::npos) continue;
        if (away < 2.0) nearby = i;
        if (away > 13.0) distant = i;
    }
    REQUIRE(nearby * distant > 0);

    CHECK(pair.differing({}) == 0);
    CHECK(updates(host) == 3); // static sides, moving sides, regions
    for (int frame = 0; frame < 3; ++frame) {
        CHECK(pair.differing({}) == 0);
        CHECK(updates(host) == 0);
        CHECK(host.stats().indexListsBuilt == 0);
        CHECK(host.stats().passesKept == 3);
        CHECK(passesNamed(host, "volumes.cull") == 1);
    }
    // Looking elsewhere builds nothing either, but for the caps when z-fail is needed for the first time.
    const std::vector<demo::CameraState> inside = look({3.4, 1.6, 2.5}, {1, 0.8, 2.4});
    const std::vector<demo::CameraState> shaded = look({-2.5, 1.2, 2.4}, {-9, 0.6, 2.5});
    CHECK(pair.differing({.cameras = &inside}) == 0);
    CHECK(pair.differing({.cameras = &shaded}) == 0);
    CHECK(pair.differing({}) == 0);
    CHECK(pair.differing({.cameras = &inside}) == 0);
    CHECK(updates(host) == 0);
    CHECK(pair.differing({.cameras = &shaded}) == 0);
    CHECK(updates(host) == 0);

    const auto move = [&](size_t instance, double way) {
        for (Host* each : {&pair.plain, &pair.tree})
            each->scene.instances[instance].pose.position.x += way;
    };
    move(distant, 0.2);
    CHECK(pair.differing({}) == 0);
    CHECK(updates(host) == 0);

    move(nearby, 0.2);
    CHECK(pair.differing({}) == 0);
    CHECK(updates(host) == 3);
    CHECK(pair.differing({}) == 0);
    CHECK(updates(host) == 0);

    // It counts as moving now: the next move is beside what is kept.
    move(nearby, 0.2);
    CHECK(pair.differing({}) == 0);
    CHECK(updates(host) == 1);
}

TEST_CASE_FIXTURE(DeviceTest, "a caster that moves is drawn beside the tree, which stays as it is")
{
    Scene scene = shipped("rooms");
    demo::limitLights(scene, 1);
    Pair pair(scene);
    CHECK(pair.differing({}) == 0);
    const std::vector<Image8> before = pair.pictures;
    size_t changed = 0;
    for (const double time : {0.2, 0.6, 1.0}) {
        CHECK(pair.differing({.time = time}) == 0);
        CHECK(updates(pair.tree) == 1); // its own sides
        CHECK(passesNamed(pair.tree, "volumes.regions") == 0);
        changed += differences(before, pair.pictures);
    }
    CHECK(changed > 20);
}

TEST_CASE_FIXTURE(DeviceTest, "a light that moves is drawn as stencil_volume draws it")
{
    Scene scene = litBy("lamp");
    Pair pair(scene);
    CHECK(pair.differing({}) == 0);
    for (int step = 0; step < 2; ++step) {
        for (Host* each : {&pair.plain, &pair.tree})
            for (demo::Light& light : each->scene.lights)
                light.position.x += 0.1;
        CHECK(pair.differing({}) == 0);
        CHECK(passesNamed(pair.tree, "volumes.cull") == 0);
        CHECK(updates(pair.tree) == updates(pair.plain));
    }
}

TEST_CASE_FIXTURE(DeviceTest, "in the rooms a third of the volume triangles and stencil samples is enough, or less")
{
    if (!DrawCounter::possible()) {
        MESSAGE("no queries: nothing is checked");
        return;
    }
    DrawCounter counter;
    for (const uint32_t lights : {1u, 2u, 4u, 8u, 16u}) {
        Scene scene = shipped("rooms");
        demo::limitLights(scene, lights);
        Host plain(scene, counter.options({.maxLights = 16})), tree(scene, counter.options({.maxLights = 16}));
        plain.pinAll(kPlain);
        tree.pinAll(kTree);
        const DrawCount all = counter.count(plain, {}), kept = counter.count(tree, {});
        MESSAGE(lights << " lights: " << all.triangles << " -> " << kept.triangles << " triangles, " << all.samples
                       << " -> " << kept.samples << " samples, " << all.draws << " -> " << kept.draws << " draws");
        CHECK(all.triangles > 1000 * lights);
        CHECK(3 * kept.triangles <= all.triangles);
        CHECK(3 * kept.samples <= all.samples);
        CHECK(differences(plain.pictures(), tree.pictures()) == 0);
    }
}
