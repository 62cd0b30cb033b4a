#include "demo/scene/scene.hpp"

#include <doctest/doctest.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>
#include <set>
#include <string>

using namespace gnomon::demo;
using doctest::Approx;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

bool close(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-12)
{
    return glm::length(a - b) <= tolerance;
}

Scene sceneWithCamera(std::vector<CameraKey> keys)
{
    Scene scene;
    scene.camera = std::move(keys);
    return scene;
}

Light spot(const glm::dvec3& position)
{
    Light light;
    light.position = position;
    light.direction = glm::normalize(-position);
    light.outerAngle = 0.5f;
    light.range = 30.0f;
    return light;
}

} // namespace

TEST_CASE("an instance holds its end keys outside them, moves straight and turns along the shortest arc between")
{
    Instance instance;
    instance.keys = {
        {1.0, {{0.0, 0.0, 0.0}, glm::dquat(1.0, 0.0, 0.0, 0.0), glm::dvec3(1.0)}},
        {3.0, {{4.0, 2.0, 0.0}, glm::angleAxis(90.0 * kDegree, glm::dvec3(0.0, 0.0, 1.0)), glm::dvec3(3.0)}}};
    CHECK(instanceAt(instance, 0.0).translation == glm::dvec3(0.0));
    CHECK(instanceAt(instance, 99.0).translation == glm::dvec3(4.0, 2.0, 0.0));
    const Transform half = instanceAt(instance, 2.0);
    CHECK(half.translation == glm::dvec3(2.0, 1.0, 0.0));
    const double c = std::cos(45.0 * kDegree);
    CHECK(close(half.linear * glm::dvec3(1.0, 0.0, 0.0), 2.0 * glm::dvec3(c, c, 0.0)));
    CHECK(moves(instance));
}

TEST_CASE("a spin of one degree a frame has turned 90 degrees in frame 90 and is home again in frame 360000")
{
    Instance instance;
    instance.spin = {{1.0, 0.0, 0.0}, 60.0 * kDegree};
    Scene scene;
    CHECK(close(instanceAt(instance, frameTime(scene, 90)).linear * glm::dvec3(0.0, 1.0, 0.0), {0.0, 0.0, 1.0}));
    CHECK(close(instanceAt(instance, frameTime(scene, 360000)).linear * glm::dvec3(0.0, 1.0, 0.0), {0.0, 1.0, 0.0},
                1e-9));
}

TEST_CASE("scale acts before rotation, and the row-major matrix is the transposed column-major one")
{
    Instance instance;
    instance.pose.rotation = glm::angleAxis(90.0 * kDegree, glm::dvec3(0.0, 0.0, 1.0));
    instance.pose.scale = {2.0, 3.0, 4.0};
    const Transform transform = instanceAt(instance, 0.0);
    CHECK(close(transform.apply({1.0f, 1.0f, 1.0f}), {-3.0, 2.0, 4.0}));
    const std::array<float, 9> rows = transform.linearRowMajor();
    CHECK(rows[1] == -3.0f);
    CHECK(rows[3] == 2.0f);
    CHECK(rows[8] == 4.0f);
}

TEST_CASE("frame times are correctly rounded, so that keys at frame / fps are hit exactly")
{
    Scene scene;
    scene.framesPerSecond = 10.0;
    CHECK(frameTime(scene, 1) == 0.1);
    CHECK(frameTime(scene, 3) == 0.3);
}

TEST_CASE("a light is present from its appearance up to, not including, its disappearance")
{
    Light light = spot({0.0, 5.0, 1.0});
    light.appear = 2.0;
    light.disappear = 4.0;
    CHECK_FALSE(lightAt(light, 1.999).present);
    CHECK(lightAt(light, 2.0).present);
    CHECK(lightAt(light, 3.999).present);
    CHECK_FALSE(lightAt(light, 4.0).present);
}

TEST_CASE("an orbiting light keeps its distance and goes on looking at what it looked at")
{
    Light light = spot({3.0, 4.0, 0.0});
    light.orbit.radiansPerSecond = 90.0 * kDegree;
    const LightState state = lightAt(light, 1.0);
    CHECK(close(state.position, {0.0, 4.0, -3.0}));
    CHECK(close(state.direction, glm::normalize(-state.position)));
    CHECK(moves(light));
}

TEST_CASE("a light's direction turns evenly between keys, through opposite directions as well")
{
    Light light = spot({0.0, 1.0, 0.0});
    light.keys = {{0.0, {}, {1.0, 0.0, 0.0}}, {1.0, {}, {0.0, 0.0, 1.0}}, {2.0, {}, {0.0, 0.0, -1.0}}};
    CHECK(close(lightAt(light, 1.0 / 3.0).direction, {std::cos(30.0 * kDegree), 0.0, 0.5}));
    const glm::dvec3 halfWay = lightAt(light, 1.5).direction;
    CHECK(glm::length(halfWay) == Approx(1.0));
    CHECK(std::abs(halfWay.z) < 1e-12);
}

TEST_CASE("the camera glides between keys, and jumps at a cut without moving before it")
{
    const Scene scene = sceneWithCamera({{0.0, {0.0, 0.0, 10.0}, {0.0, 0.0, 0.0}, 0.5f, false},
                                         {2.0, {4.0, 0.0, 10.0}, {0.0, 0.0, 0.0}, 0.7f, false},
                                         {3.0, {0.0, 50.0, 10.0}, {0.0, 0.0, 0.0}, 0.9f, true}});
    CHECK(cameraAt(scene, 1.0).eye == glm::dvec3(2.0, 0.0, 10.0));
    CHECK(cameraAt(scene, 1.0).verticalFov == Approx(0.6));
    CHECK(cameraAt(scene, 2.9).eye == glm::dvec3(4.0, 0.0, 10.0));
    CHECK(cameraAt(scene, 3.0).eye == glm::dvec3(0.0, 50.0, 10.0));
    CHECK(cameraCutsBetween(scene, 2.9, 3.0));
    CHECK_FALSE(cameraCutsBetween(scene, 3.0, 3.1));
    CHECK_FALSE(cameraCutsBetween(scene, 1.9, 2.0));
}

TEST_CASE("the up vector is a unit across the view, also when looking straight down")
{
    const Scene scene = sceneWithCamera({{0.0, {0.0, 9.0, 0.0}, {0.0, 0.0, 0.0}, 0.5f, false}});
    const CameraState state = cameraAt(scene, 0.0);
    CHECK(glm::length(state.up) == Approx(1.0));
    CHECK(glm::dot(state.up, state.forward()) == Approx(0.0));
}

TEST_CASE("clip space has y down, and depth 1 at the near plane when reversed, 0 when standard")
{
    const Scene scene = sceneWithCamera({{0.0, {1.0, 2.0, 10.0}, {1.0, 2.0, 0.0}, 1.0f, false}});
    const CameraState camera = cameraAt(scene, 0.0);
    const auto depthAt = [&](const DepthSettings& depth, double distance) {
        const glm::dvec4 clip = clipFromView(depth, camera.verticalFov, 1.5) * viewFromWorld(camera) *
                                glm::dvec4(1.0, 2.0, 10.0 - distance, 1.0);
        CHECK(clip.w == Approx(distance));
        return clip.z / clip.w;
    };
    const DepthSettings reversed{DepthConvention::ReversedInfinite, 0.1, 200.0};
    CHECK(depthAt(reversed, 0.1) == Approx(1.0));
    CHECK(depthAt(reversed, 1e9) == Approx(0.0));
    const DepthSettings standard{DepthConvention::Standard, 0.1, 200.0};
    CHECK(depthAt(standard, 0.1) == Approx(0.0));
    CHECK(depthAt(standard, 200.0) == Approx(1.0));

    // The top right corner of the picture: x = +1, y = -1.
    const double half = std::tan(0.5);
    const glm::dvec4 corner =
        clipFromView(reversed, 1.0f, 1.5) * viewFromWorld(camera) * glm::dvec4(1.0 + 1.5 * half, 2.0 + half, 9.0, 1.0);
    CHECK(corner.x / corner.w == Approx(1.0));
    CHECK(corner.y / corner.w == Approx(-1.0));
}

TEST_CASE("limitLights keeps the first, uses the spare ones, then turns copies about the centre")
{
    Scene scene;
    scene.center = {10.0, 0.0, 0.0};
    scene.lights = {spot({12.0, 5.0, 0.0}), spot({10.0, 6.0, 3.0})};
    scene.spareLights = {spot({7.0, 7.0, 0.0})};
    scene.spareLights[0].name = "spare";
    Scene fewer = scene;
    limitLights(fewer, 1);
    REQUIRE(fewer.lights.size() == 1);
    CHECK(fewer.lights[0].position == scene.lights[0].position);
    CHECK(fewer.spareLights.size() == 2);

    Scene more = scene;
    limitLights(more, 16);
    REQUIRE(more.lights.size() == 16);
    CHECK(more.lights[2].name == "spare");
    for (size_t i = 0; i < more.lights.size(); ++i) {
        const glm::dvec3 offset = more.lights[i].position - scene.center;
        const glm::dvec3 original = more.lights[i % 3].position - scene.center;
        CHECK(offset.y == Approx(original.y));
        CHECK(glm::length(offset) == Approx(glm::length(original)));
        for (size_t j = 0; j < i; ++j)
            CHECK(glm::length(more.lights[i].position - more.lights[j].position) > 0.2);
    }
    Scene again = scene;
    limitLights(again, 16);
    CHECK(again.lights[15].position == more.lights[15].position);
    Scene named = scene; // the other one's copy would be called the same
    named.lights[0].name = std::string("a+1");
    named.lights[1].name = std::string("a");
    limitLights(named, 9);
    std::set<std::string> names;
    for (const Light& light : named.lights)
        names.insert(light.name);
    CHECK(names.size() == 9);
    Scene dark;
    limitLights(dark, 4);
    CHECK(dark.lights.empty());
}

TEST_CASE("what stands still becomes one mesh in the world, the rest stays as it is")
{
    Scene scene;
    const auto triangle = [](const char* name, float size) {
        return Mesh{name, {{0, 0, 0}, {size, 0, 0}, {0, size, 0}}, {0, 1, 2}};
    };
    scene.meshes = {triangle("unused", 1.0f), triangle("still", 1.0f), triangle("leaf", 2.0f), triangle("top", 3.0f)};
    const auto place = [&](uint32_t mesh, const glm::dvec3& at, bool still) -> Instance& {
        Instance& instance = scene.instances.emplace_back();
        instance.mesh = mesh;
        instance.pose.position = at;
        instance.isStatic = still;
        return instance;
    };
    place(1, {10, 0, 0}, true).pose.scale = glm::dvec3(2.0);
    place(3, {0, 5, 0}, false);
    place(1, {0, 0, 7}, true);
    place(2, {1, 1, 1}, true).alphaTested = true;
    const Scene before = scene;
    mergeStatics(scene);
    REQUIRE(scene.instances.size() == 3);
    REQUIRE(scene.meshes.size() == 3); // what nobody uses is gone
    const Mesh& merged = scene.meshes[scene.instances[0].mesh];
    CHECK(scene.instances[0].isStatic);
    CHECK(instanceAt(scene.instances[0], 0.0).translation == glm::dvec3(0.0));
    CHECK(merged.indices == std::vector<uint32_t>{0, 1, 2, 3, 4, 5});
    CHECK(merged.positions[1] == glm::vec3(12, 0, 0));
    CHECK(merged.positions[5] == glm::vec3(0, 1, 7));
    CHECK(scene.meshes[scene.instances[1].mesh].name == "top");
    CHECK(scene.meshes[scene.instances[2].mesh].name == "leaf");
    CHECK(triangleCount(scene) == triangleCount(before));

    Scene moving = before;
    for (Instance& instance : moving.instances)
        instance.isStatic = false;
    mergeStatics(moving);
    CHECK(moving.instances.size() == 4);
    CHECK(moving.meshes.size() == 4); // untouched
}
