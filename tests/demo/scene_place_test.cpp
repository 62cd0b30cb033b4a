// Copies of one entry, shapes put together, and casters on an orbit.
#include "demo/scene/scene_file.hpp"
#include "scene_analysis.hpp"

#include <doctest/doctest.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <string>

using namespace gnomon::demo;
using doctest::Approx;

namespace {

Scene parsed(const std::string& entries)
{
    auto scene = parseScene("camera: [{eye: [0, 0, 9], target: [0, 0, 0]}]\n" + entries, "test.yaml");
    REQUIRE_MESSAGE(scene, scene.error());
    return std::move(*scene);
}

Scene boxes(const std::string& instance)
{
    return parsed("meshes: {b: {box: }}\ninstances:\n  - {mesh: b, " + instance + "}\n");
}

} // namespace

TEST_CASE("copies of a grid are strewn within the bounds asked for, by the seed alone")
{
    const std::string strewn = "at: [5, 0, 0], repeat: {count: [20, 1, 20], spacing: [4, 0, 4], jitter: [1, 0.2, 0.5], "
                               "turn: 90, grow: 0.25, seed: ";
    const Scene even = boxes("at: [5, 0, 0], repeat: {count: [20, 1, 20], spacing: [4, 0, 4]}");
    const Scene one = boxes(strewn + "7}"), again = boxes(strewn + "7}"), other = boxes(strewn + "8}");
    REQUIRE(one.instances.size() == 400);
    CHECK(one.instances[21].name == "b.21");
    double moved = 0.0, turned = 0.0, smallest = 9.0, largest = 0.0;
    uint32_t same = 0;
    for (size_t i = 0; i < 400; ++i) {
        const Pose &pose = one.instances[i].pose, &plain = even.instances[i].pose;
        const glm::dvec3 off = pose.position - plain.position;
        CHECK(std::abs(off.x) <= 1.0);
        CHECK(std::abs(off.y) <= 0.2);
        CHECK(std::abs(off.z) <= 0.5);
        moved += glm::length(off);
        CHECK(pose.rotation.x == 0.0);
        CHECK(std::abs(pose.rotation.y) <= std::sin(0.7853981634)); // half of 90 degrees
        turned += std::abs(pose.rotation.y);
        smallest = std::min(smallest, pose.scale.y);
        largest = std::max(largest, pose.scale.y);
        CHECK(plain.scale == glm::dvec3(1.0));
        CHECK(again.instances[i].pose.position == pose.position);
        same += other.instances[i].pose.position == pose.position;
    }
    CHECK(same == 0);
    CHECK(moved / 400.0 > 0.4);
    CHECK(turned / 400.0 > 0.3);
    CHECK(smallest >= 0.75);
    CHECK(smallest < 0.78);
    CHECK(largest <= 1.25);
    CHECK(largest > 1.22);
    // The same everywhere: whole numbers until the last step.
    CHECK(one.instances[0].pose.position.x == Approx(-32.839488744736).epsilon(1e-12));
}

TEST_CASE("copies of a ring are turned evenly round its centre, casters as well as lights")
{
    const Scene scene =
        parsed("meshes: {b: {box: }}\ninstances:\n  - {mesh: b, at: [1, 2, 5], ring: {count: 4, center: "
               "[1, 0, 1]}}\nlights:\n  - {name: l, kind: spot, at: [1, 2, 5], aim: [1, 0, 1], range: 9, "
               "cone: {outer: 20}, ring: {count: 4, center: [1, 0, 1]}, orbit: {degrees_per_second: 90}}\n");
    REQUIRE(scene.instances.size() == 4);
    REQUIRE(scene.lights.size() == 4);
    CHECK(scene.lights[3].name == "l.3");
    const glm::dvec3 expected[] = {{1, 2, 5}, {5, 2, 1}, {1, 2, -3}, {-3, 2, 1}};
    for (size_t i = 0; i < 4; ++i) {
        const Transform transform = instanceAt(scene.instances[i], 0.0);
        CHECK(glm::length(transform.translation - expected[i]) < 1e-12);
        // What looked away from the centre still does.
        const glm::dvec3 away = glm::normalize((expected[i] - glm::dvec3(1, 2, 1)));
        CHECK(glm::length(transform.linear * glm::dvec3(0, 0, 1) - away) < 1e-12);
        const LightState light = lightAt(scene.lights[i], 0.0);
        CHECK(glm::length(light.position - expected[i]) < 1e-12);
        CHECK(glm::length(light.direction - glm::normalize(glm::dvec3(1, 0, 1) - expected[i])) < 1e-12);
        CHECK(scene.lights[i].orbit.center == glm::dvec3(0.0));
    }
}

TEST_CASE("lights repeat on a grid, keys and all")
{
    const Scene scene =
        parsed("lights:\n  - {kind: point, range: 9, keys: [{time: 0, at: [0, 1, 0]}, {time: 2, at: [0, 3, "
               "0]}], repeat: {count: [3, 1, 1], spacing: [10, 0, 0]}}\n");
    REQUIRE(scene.lights.size() == 3);
    for (int i = 0; i < 3; ++i)
        CHECK(lightAt(scene.lights[size_t(i)], 1.0).position == glm::dvec3(10.0 * (i - 1), 2.0, 0.0));
}

TEST_CASE("an instance on an orbit keeps its distance, and turns as far as it has gone round")
{
    const Scene scene = boxes("at: [3, 1, 0], orbit: {center: [1, 0, 0], degrees_per_second: 90}");
    const Instance& instance = scene.instances[0];
    CHECK(moves(instance));
    const Transform later = instanceAt(instance, 1.0);
    CHECK(glm::length(later.translation - glm::dvec3(1, 1, -2)) < 1e-12);
    CHECK(glm::length(later.linear * glm::dvec3(1, 0, 0) - glm::dvec3(0, 0, -1)) < 1e-12);
    CHECK(instanceAt(instance, 0.0).translation == glm::dvec3(3, 1, 0));
}

TEST_CASE("shapes put together keep their size, their places and their fronts")
{
    const Scene scene =
        parsed("meshes:\n  m: {parts: [{box: {size: [1, 2, 1]}, at: [0, 1, 0]}, {box: , at: [4, 0, 0], scale: "
               "[-2, 1, 1], rotate: {axis: [0, 0, 1], degrees: 90}}]}\n");
    const Mesh& mesh = scene.meshes[0];
    CHECK(mesh.name == "m");
    CHECK(mesh.triangleCount() == 24);
    CHECK(countEdges(mesh).closed());
    CHECK(signedVolume(mesh) == Approx(2.0 + 2.0));
    glm::vec3 low(9.0f), high(-9.0f);
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    CHECK(glm::length(low - glm::vec3(-0.5f, -1.0f, -0.5f)) < 1e-5f); // the second stands upright, 2 m high
    CHECK(glm::length(high - glm::vec3(4.5f, 2.0f, 0.5f)) < 1e-5f);
}

TEST_CASE("sky and ambient light are read, and are what they were where nothing is said")
{
    const Scene night = parsed("sky: [0, 0.1, 0.2]\nambient: 0.5\n"), day = parsed("");
    CHECK(night.sky == glm::vec3(0.0f, 0.1f, 0.2f));
    CHECK(night.ambient == 0.5f);
    CHECK(day.sky == glm::vec3(0.30f, 0.38f, 0.50f));
    CHECK(day.ambient == 1.0f);
}
