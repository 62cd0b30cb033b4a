// Handles, instances and lights: what is taken and what is refused, with which words.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "runtime/base/slot_map.hpp"
#include "runtime/scene_fixture.hpp"
#include "runtime/store/scene_input.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

template <typename T>
void checkRefused(const Result<T>& result, GnResult code, const char* words)
{
    REQUIRE_FALSE(result);
    CAPTURE(result.error().text);
    CHECK(result.error().result == code);
    CHECK(result.error().text.find(words) != std::string::npos);
}

GnLightInfo spot()
{
    GnLightInfo info{};
    info.type = GN_LIGHT_TYPE_SPOT;
    info.pName = "lamp";
    info.direction[1] = -2.0f;
    return info;
}

} // namespace

TEST_CASE("what has no name is called by its kind, with the article that it takes")
{
    CHECK(named("instance", nullptr) == "an instance without a name");
    CHECK(named("light", "") == "a light without a name");
    CHECK(named("mesh", "rock") == "mesh 'rock'");
}

TEST_CASE("a handle finds its object until it is taken, and never another one")
{
    SlotMap<int> map, other;
    std::set<std::uint64_t> all;
    const std::uint64_t first = map.insert(1);
    CHECK(first != 0);
    CHECK(map.find(0) == nullptr);
    CHECK(other.insert(7) != first);
    CHECK(other.find(first) == nullptr);
    for (std::uint64_t bit = 1; bit; bit <<= 1)
        CHECK(map.find(first ^ bit) == nullptr);
    int* address = map.find(first);
    for (int i = 0; i < 1000; ++i)
        all.insert(map.insert(i));
    CHECK(all.size() == 1000);
    CHECK(map.find(first) == address);
    CHECK(map.take(first) == 1);
    CHECK(map.find(first) == nullptr);
    CHECK(map.take(first) == 0);
    const std::uint64_t again = map.insert(2);
    CHECK(SlotMap<int>::indexOf(again) == SlotMap<int>::indexOf(first));
    CHECK(again != first);
    CHECK(map.find(first) == nullptr);
    CHECK(map.size() == 1001);
}

TEST_CASE("stale, foreign and null handles are refused by kind")
{
    SceneFixture scene;
    const std::unique_ptr<SceneRegistry> foreign = scene.makeRegistry({});
    const GnMesh mesh = *scene.registry->createMesh(cube().info("rock"));
    const GnInstance instance = *scene.registry->createInstance(instanceOf(mesh));
    const GnLight light = *scene.registry->createLight(spot());
    const auto refusedIn = [&](SceneRegistry& registry, GnMesh m, GnInstance i, GnLight l) {
        const Shape shape = cube();
        checkRefused(registry.updateMeshPositions(m, shape.positions.data(), 8, 0), GN_ERROR_INVALID_HANDLE, "mesh");
        checkRefused(registry.createInstance(instanceOf(m)), GN_ERROR_INVALID_HANDLE, "mesh");
        checkRefused(registry.setInstanceTransform(i, {}), GN_ERROR_INVALID_HANDLE, "instance");
        checkRefused(registry.setInstanceMesh(i, m), GN_ERROR_INVALID_HANDLE, "instance");
        checkRefused(registry.updateLight(l, spot()), GN_ERROR_INVALID_HANDLE, "light");
        CHECK_FALSE(registry.validLight(l));
        CHECK(registry.light(l) == nullptr);
        registry.destroyMesh(m); // all without effect
        registry.destroyInstance(i);
        registry.destroyLight(l);
    };
    refusedIn(*foreign, mesh, instance, light);
    refusedIn(*scene.registry, VK_NULL_HANDLE, VK_NULL_HANDLE, VK_NULL_HANDLE);
    // Handles of the other kinds.
    refusedIn(*scene.registry, handleFromBits<GnMesh>(bitsOf(light)), handleFromBits<GnInstance>(bitsOf(mesh)),
              handleFromBits<GnLight>(bitsOf(instance)));
    CHECK(scene.begin().casters.size() == 1);
    scene.registry->destroyMesh(mesh);
    checkRefused(scene.registry->setInstanceMesh(instance, mesh), GN_ERROR_INVALID_HANDLE, "mesh");
    scene.registry->destroyInstance(instance);
    scene.registry->destroyLight(light);
    // New objects in the same slots are not found by the old handles.
    const GnMesh mesh2 = *scene.registry->createMesh(cube().info("rock"));
    REQUIRE(scene.registry->createInstance(instanceOf(mesh2)));
    REQUIRE(scene.registry->createLight(spot()));
    refusedIn(*scene.registry, mesh, instance, light);
    CHECK(scene.begin().casters.size() == 1);
}

TEST_CASE("an instance with a wrong number is refused by element, and a refused transform changes nothing")
{
    SceneFixture scene;
    const GnMesh mesh = *scene.registry->createMesh(cube().info("rock"));
    const GnInstance instance = *scene.registry->createInstance(instanceOf(mesh, at(1, 2, 3), 0, "tower"));
    const std::uint64_t revision = scene.begin().casters[0].revision;
    const auto refused = [&](const GnTransform& transform, GnResult code, const char* words) {
        checkRefused(scene.registry->setInstanceTransform(instance, transform), code, words);
        checkRefused(scene.registry->createInstance(instanceOf(mesh, transform, 0, "tower")), code, "'tower'");
    };
    for (int i = 0; i < 9; ++i) {
        GnTransform transform = at(4);
        transform.basis[i] = kNan;
        refused(transform, GN_ERROR_NOT_A_NUMBER, ("basis[" + std::to_string(i) + "]").c_str());
        transform.basis[i] = -kInfinity;
        refused(transform, GN_ERROR_INFINITE, ("basis[" + std::to_string(i) + "]").c_str());
    }
    for (int i = 0; i < 3; ++i) {
        GnTransform transform = at(4);
        transform.translation[i] = kNan;
        refused(transform, GN_ERROR_NOT_A_NUMBER, ("translation[" + std::to_string(i) + "]").c_str());
        transform.translation[i] = kInfinity;
        refused(transform, GN_ERROR_INFINITE, ("translation[" + std::to_string(i) + "]").c_str());
        transform.translation[i] = -1e19;
        refused(transform, GN_ERROR_OUT_OF_RANGE, "1e+19");
    }
    GnTransform flat = at(4);
    flat.basis[0] = flat.basis[4] = 1.0f;
    refused(flat, GN_ERROR_OUT_OF_RANGE, "singular");
    GnTransform thin = at(4); // its inverse is no number that the library takes
    thin.basis[0] = thin.basis[8] = 1.0f;
    thin.basis[4] = 1e-19f;
    refused(thin, GN_ERROR_OUT_OF_RANGE, "basis is nearly singular: element [4] of its inverse is 1000000");
    thin.basis[4] = std::numeric_limits<float>::denorm_min();
    thin.basis[0] = thin.basis[8] = 1e18f;
    refused(thin, GN_ERROR_OUT_OF_RANGE, "element [4]");
    thin.basis[8] = -1e-20f;
    thin.basis[4] = 1.0f;
    refused(thin, GN_ERROR_OUT_OF_RANGE, "element [8]");
    thin.basis[0] = thin.basis[4] = thin.basis[8] = 2e-18f;
    CHECK(readTransform({"instance", "speck"}, thin));
    thin.basis[0] = thin.basis[4] = thin.basis[8] = 1e18f;
    CHECK(readTransform({"instance", "everything"}, thin));
    GnInstanceCreateInfo info = instanceOf(mesh, {}, 0x100, "tower");
    checkRefused(scene.registry->createInstance(info), GN_ERROR_OUT_OF_RANGE, "flags");
    CHECK(scene.begin().casters.size() == 1);
    CHECK(scene.begin().casters[0].revision == revision);
}

TEST_CASE("a host-drawn instance needs its callback and bounds, and no mesh")
{
    SceneFixture scene;
    GnInstanceCreateInfo info = instanceOf(VK_NULL_HANDLE, at(10), GN_INSTANCE_HOST_DRAWN_BIT, "grass");
    checkRefused(scene.registry->createInstance(info), GN_ERROR_NULL_ARGUMENT, "pfnDrawCasters");
    info.pfnDrawCasters = [](VkCommandBuffer, const GnCasterProjection*, void*) {};
    info.boundsMax[1] = kNan;
    checkRefused(scene.registry->createInstance(info), GN_ERROR_NOT_A_NUMBER, "boundsMax[1]");
    info.boundsMax[1] = -1.0f;
    checkRefused(scene.registry->createInstance(info), GN_ERROR_OUT_OF_RANGE, "boundsMin[1]");
    info.boundsMax[1] = 2.0f;
    const Result<GnInstance> instance = scene.registry->createInstance(info);
    REQUIRE(instance);
    const Caster caster = scene.begin().casters[0];
    CHECK(caster.hostDrawn);
    CHECK(caster.mesh == nullptr);
    CHECK((caster.drawCasters == info.pfnDrawCasters));
    CHECK(caster.bounds.upper.y == doctest::Approx(2.0f));
    CHECK(caster.bounds.lower.x == doctest::Approx(10.0f));
    const GnMesh mesh = *scene.registry->createMesh(cube().info("rock"));
    checkRefused(scene.registry->setInstanceMesh(*instance, mesh), GN_ERROR_INVALID_HANDLE, "host-drawn");

    // Its shape is the host's to change.
    checkRefused(scene.registry->setInstanceBounds(*instance, {0, 0, 0}, {1, kNan, 1}), GN_ERROR_NOT_A_NUMBER,
                 "boundsMax[1]");
    checkRefused(scene.registry->setInstanceBounds(*instance, {0, 0, 2}, {1, 1, 1.5f}), GN_ERROR_OUT_OF_RANGE,
                 "boundsMax[2], which is 1.5");
    CHECK(scene.begin().casters[0].bounds.upper.y == doctest::Approx(2.0f));
    CHECK(scene.registry->setInstanceBounds(*instance, {-1, -1, -1}, {1, 5, 1}));
    CHECK(scene.begin().casters[0].bounds.upper.y == doctest::Approx(5.0f));
    CHECK(scene.begin().casters[0].bounds.lower.x == doctest::Approx(9.0f));
    const Result<GnInstance> rock = scene.registry->createInstance(instanceOf(mesh, at(4), 0, "boulder"));
    REQUIRE(rock);
    checkRefused(scene.registry->setInstanceBounds(*rock, {0, 0, 0}, {1, 1, 1}), GN_ERROR_INVALID_HANDLE, "boulder");
}

namespace {

/// The spot, which looks down, as a rectangle.
GnLightInfo panel()
{
    GnLightInfo info = spot();
    info.sourceShape = GN_SOURCE_SHAPE_RECTANGLE;
    info.sourceExtents[0] = 2.0f;
    info.sourceExtents[1] = 0.5f;
    info.sourceAxis[0] = 3.0f;
    return info;
}

} // namespace

TEST_CASE("a rectangle's axes lie across the light, and its radius is that of a disc of the same area")
{
    SceneFixture scene;
    GnLightInfo info = panel();
    info.sourceAxis[1] = 7.0f; // along the light's direction: does not count
    const GnLight light = *scene.registry->createLight(info);
    scene.begin();
    const LightView* view = scene.registry->light(light);
    CHECK(view->rectangular());
    CHECK(glm::distance(view->sourceX, glm::vec3(2, 0, 0)) < 1e-6f);
    CHECK(glm::length(view->sourceY) == doctest::Approx(0.5));
    CHECK(std::abs(view->sourceY.z) == doctest::Approx(0.5));
    CHECK(std::numbers::pi * view->constants.sourceRadius * view->constants.sourceRadius == doctest::Approx(4.0));
    CHECK(view->sourceReach() == doctest::Approx(std::sqrt(4.25))); // past the disc: casters before its corners count
    const std::uint64_t revision = view->revision;

    info.sourceExtents[0] = 0.5f, info.sourceExtents[1] = 2.0f; // the same area
    CHECK(scene.registry->updateLight(light, info));
    scene.begin();
    CHECK(scene.registry->light(light)->revision != revision);
    info.sourceExtents[0] = info.sourceExtents[1] = 0.0f;
    CHECK(scene.registry->updateLight(light, info));
    scene.begin();
    view = scene.registry->light(light);
    CHECK(!view->rectangular());
    CHECK(view->constants.sourceRadius == 0.0f);
}

TEST_CASE("a disc lies across the light, whichever way that looks, and is another light than a sphere of its radius")
{
    SceneFixture scene;
    GnLightInfo info = spot();
    info.sourceRadius = 0.5f;
    const GnLight light = *scene.registry->createLight(info);
    scene.begin();
    const std::uint64_t sphere = scene.registry->light(light)->revision;
    CHECK(!scene.registry->light(light)->flat());
    info.sourceShape = GN_SOURCE_SHAPE_DISC;
    for (const glm::vec3 way : {glm::vec3(0, -2, 0), glm::vec3(3, 0, 0), glm::vec3(0, 0, 1), glm::vec3(1, -2, 3)}) {
        for (int i = 0; i < 3; ++i)
            info.direction[i] = way[i];
        CHECK(scene.registry->updateLight(light, info));
        scene.begin();
        const LightView* view = scene.registry->light(light);
        CHECK(view->revision != sphere);
        CHECK(view->flat());
        CHECK(!view->rectangular());
        CHECK(view->sourceReach() == doctest::Approx(0.5));
        for (const glm::vec3 axis : {view->sourceX, view->sourceY}) {
            CHECK(glm::length(axis) == doctest::Approx(0.5));
            CHECK(std::abs(glm::dot(axis, way)) < 1e-6f);
        }
        CHECK(std::abs(glm::dot(view->sourceX, view->sourceY)) < 1e-6f);
    }
    info.sourceRadius = 0.0f; // hard
    CHECK(scene.registry->updateLight(light, info));
    scene.begin();
    CHECK(!scene.registry->light(light)->flat());
}

TEST_CASE("a light with a wrong number is refused by element, and a refused update changes nothing")
{
    SceneFixture scene;
    const GnLight light = *scene.registry->createLight(spot());
    scene.begin();
    const std::uint64_t revision = scene.registry->light(light)->revision;
    const auto refused = [&](auto change, GnResult code, const char* words) {
        GnLightInfo info = spot();
        change(info);
        checkRefused(scene.registry->updateLight(light, info), code, words);
        checkRefused(scene.registry->createLight(info), code, "'lamp'");
    };
    refused([](GnLightInfo& i) { i.position[2] = kNan; }, GN_ERROR_NOT_A_NUMBER, "position[2]");
    refused([](GnLightInfo& i) { i.position[0] = kInfinity; }, GN_ERROR_INFINITE, "position[0]");
    refused([](GnLightInfo& i) { i.direction[0] = kNan; }, GN_ERROR_NOT_A_NUMBER, "direction[0]");
    refused([](GnLightInfo& i) { i.direction[1] = 0.0f; }, GN_ERROR_OUT_OF_RANGE, "direction is zero");
    refused([](GnLightInfo& i) { i.range = -1.0f; }, GN_ERROR_OUT_OF_RANGE, "range is -1");
    refused([](GnLightInfo& i) { i.range = kInfinity; }, GN_ERROR_INFINITE, "range");
    refused([](GnLightInfo& i) { i.coneAngle = -0.5f; }, GN_ERROR_OUT_OF_RANGE, "coneAngle is -0.5");
    refused([](GnLightInfo& i) { i.coneAngle = 1.56f; }, GN_ERROR_OUT_OF_RANGE, "coneAngle");
    refused([](GnLightInfo& i) { i.sourceRadius = -1.0f; }, GN_ERROR_OUT_OF_RANGE, "sourceRadius");
    refused([](GnLightInfo& i) { i.sourceShape = static_cast<GnSourceShape>(3); }, GN_ERROR_OUT_OF_RANGE,
            "sourceShape is 3");
    refused(
        [](GnLightInfo& i) {
            i.sourceShape = GN_SOURCE_SHAPE_DISC;
            i.type = GN_LIGHT_TYPE_POINT;
        },
        GN_ERROR_OUT_OF_RANGE, "type is 2, not in a spot light's, which GN_SOURCE_SHAPE_DISC");
    const auto refusedRectangle = [&](auto change, GnResult code, const char* words) {
        refused(
            [&](GnLightInfo& i) {
                i = panel();
                change(i);
            },
            code, words);
    };
    refusedRectangle([](GnLightInfo& i) { i.sourceExtents[1] = kNan; }, GN_ERROR_NOT_A_NUMBER, "sourceExtents[1]");
    refusedRectangle([](GnLightInfo& i) { i.sourceExtents[0] = -1; }, GN_ERROR_OUT_OF_RANGE, "sourceExtents[0] is -1");
    refusedRectangle([](GnLightInfo& i) { i.sourceExtents[1] = 0; }, GN_ERROR_OUT_OF_RANGE, "sourceExtents[1] is 0");
    refusedRectangle([](GnLightInfo& i) { i.sourceAxis[0] = kInfinity; }, GN_ERROR_INFINITE, "sourceAxis[0]");
    refusedRectangle([](GnLightInfo& i) { i.sourceAxis[0] = 0; }, GN_ERROR_OUT_OF_RANGE, "sourceAxis is zero");
    refusedRectangle(
        [](GnLightInfo& i) {
            i.sourceAxis[0] = 0;
            i.sourceAxis[1] = 3;
        },
        GN_ERROR_OUT_OF_RANGE, "along direction");
    refusedRectangle([](GnLightInfo& i) { i.sourceRadius = 0.5f; }, GN_ERROR_OUT_OF_RANGE, "sourceRadius is 0.5");
    refusedRectangle([](GnLightInfo& i) { i.type = GN_LIGHT_TYPE_POINT; }, GN_ERROR_OUT_OF_RANGE, "type is 2");
    refused([](GnLightInfo& i) { i.importance = kNan; }, GN_ERROR_NOT_A_NUMBER, "importance");
    refused([](GnLightInfo& i) { i.flags = 8; }, GN_ERROR_OUT_OF_RANGE, "flags");
    refused([](GnLightInfo& i) { i.type = static_cast<GnLightType>(3); }, GN_ERROR_OUT_OF_RANGE, "type is 3");
    scene.begin();
    CHECK(scene.registry->light(light)->revision == revision);
}

TEST_CASE("a light's defaults are a quarter pi, no range, all casters and weight 1")
{
    SceneFixture scene;
    GnLightInfo info = spot();
    info.position[0] = 5.0;
    const GnLight light = *scene.registry->createLight(info);
    CHECK(scene.registry->light(light) == nullptr); // no frame has begun yet
    scene.begin({1.0, 0.0, 0.0});
    const LightView& view = *scene.registry->light(light);
    CHECK(view.coneAngle == doctest::Approx(std::numbers::pi / 4));
    CHECK(view.constants.directionWs == glm::vec4(0, -1, 0, std::cos(view.coneAngle)));
    CHECK(view.constants.positionWs == glm::vec4(4, 0, 0, 1));
    CHECK(view.constants.range == kUnlimitedRange);
    CHECK(view.constants.type == gpu::LIGHT_SPOT);
    CHECK(view.unlimited());
    CHECK(view.mask == 0xffffffffu);
    CHECK(view.importance == 1.0f);
    CHECK(std::string(view.name) == "lamp");
    CHECK(view.handle == light);
    CHECK(view.id != 0);

    info.type = GN_LIGHT_TYPE_DIRECTIONAL;
    info.position[0] = kNan; // not used, not looked at
    const GnLight sun = *scene.registry->createLight(info);
    info.type = GN_LIGHT_TYPE_POINT;
    info.position[0] = 0.0;
    info.direction[1] = 0.0f;
    const GnLight bulb = *scene.registry->createLight(info);
    scene.begin({1.0, 0.0, 0.0});
    CHECK(scene.registry->light(sun)->constants.positionWs == glm::vec4(0.0f));
    CHECK(scene.registry->light(sun)->constants.directionWs.w == -2.0f);
    CHECK(scene.registry->light(bulb)->constants.directionWs.w == -2.0f);
    CHECK(scene.registry->light(bulb)->constants.positionWs == glm::vec4(-1, 0, 0, 1));
}
