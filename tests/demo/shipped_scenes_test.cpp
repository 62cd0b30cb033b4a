#include "demo/scene/scene_file.hpp"
#include "scene_analysis.hpp"

#include <doctest/doctest.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string_view>

using namespace gnomon::demo;
using doctest::Approx;

namespace {

/// Loading reads real mesh files: once for all test cases.
const Scene& shipped(std::string_view name)
{
    static std::map<std::string, Scene, std::less<>> loaded;
    const auto found = loaded.find(name);
    if (found != loaded.end()) return found->second;
    auto scene = loadScene(std::string(name));
    REQUIRE_MESSAGE(scene, scene.error());
    return loaded.emplace(name, std::move(*scene)).first->second;
}

double runLength(const Scene& scene)
{
    return frameTime(scene, scene.frames - 1);
}

struct Box {
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

    void add(const WorldTriangle& t)
    {
        low = glm::min(low, glm::min(glm::min(t.a, t.b), t.c));
        high = glm::max(high, glm::max(glm::max(t.a, t.b), t.c));
    }
    double distance(const glm::dvec3& point) const
    {
        return glm::length(glm::max(glm::max(low - point, point - high), 0.0));
    }
};

struct Nearest {
    double lit = std::numeric_limits<double>::infinity();   ///< From the eye to a vertex the light may reach.
    double bound = std::numeric_limits<double>::infinity(); ///< From the eye to the light's sphere of range.
};

Nearest nearestReceiver(const std::vector<WorldTriangle>& triangles, const Light& light, double time,
                        const CameraState& camera)
{
    const LightState state = lightAt(light, time);
    Nearest nearest;
    nearest.bound = std::max(0.0, glm::length(camera.eye - state.position) - light.range);
    for (const WorldTriangle& triangle : triangles)
        for (const glm::dvec3& corner : {triangle.a, triangle.b, triangle.c})
            if (reaches(light, state, corner)) nearest.lit = std::min(nearest.lit, glm::length(corner - camera.eye));
    return nearest;
}

uint32_t countOf(const Scene& scene, LightKind kind)
{
    return static_cast<uint32_t>(
        std::count_if(scene.lights.begin(), scene.lights.end(), [kind](const Light& l) { return l.kind == kind; }));
}

uint32_t movingLights(const Scene& scene)
{
    return static_cast<uint32_t>(
        std::count_if(scene.lights.begin(), scene.lights.end(), [](const Light& l) { return moves(l); }));
}

uint32_t movingInstances(const Scene& scene)
{
    return static_cast<uint32_t>(
        std::count_if(scene.instances.begin(), scene.instances.end(), [](const Instance& i) { return moves(i); }));
}

struct Phase {
    double time;
    uint32_t lights, dynamicLights;
    bool far;
};

void checkPhases(const Scene& scene, const std::vector<Phase>& phases)
{
    for (const Phase& phase : phases) {
        INFO(scene.name, " at ", phase.time, " s");
        CHECK(lightCountAt(scene, phase.time, false) == phase.lights);
        CHECK(lightCountAt(scene, phase.time, true) == phase.dynamicLights);
        const std::vector<WorldTriangle> triangles = worldTriangles(scene, phase.time);
        const CameraState camera = cameraAt(scene, phase.time);
        for (const Light& light : scene.lights) {
            if (!lightAt(light, phase.time).present) continue;
            INFO(light.name);
            CHECK(light.kind == LightKind::Spot);
            const Nearest nearest = nearestReceiver(triangles, light, phase.time, camera);
            if (phase.far) {
                CHECK(nearest.bound > 60.0);
                CHECK(nearest.lit < 90.0); // the end of the thesis's universe
            } else {
                CHECK(nearest.lit < 30.0);
            }
        }
    }
}

} // namespace

TEST_CASE("the shipped scenes are found by name and keep to their triangle budgets")
{
    const std::map<std::string, uint64_t> budgets = {{"arena", 150'000},
                                                     {"bunny", 150'000},
                                                     {"city_night", 350'000},
                                                     {"colonnade", 60'000},
                                                     {"forest_walk", 1'100'000},
                                                     {"gallery", 150'000},
                                                     {"room", 20'000},
                                                     {"rooms", 8'000},
                                                     {"scenario", 8'000},
                                                     {"scenario_reverse", 8'000},
                                                     {"torus_grid", 57'600 + 2 + 100},
                                                     {"torus_grid_standard", 57'600 + 2 + 100}};
    const std::vector<ShippedScene> scenes = shippedScenes();
    REQUIRE(scenes.size() == budgets.size());
    for (const ShippedScene& scene : scenes) {
        INFO(scene.name);
        REQUIRE(budgets.count(scene.name) == 1);
        const Scene& loaded = shipped(scene.name);
        CHECK(loaded.name == scene.name);
        CHECK(triangleCount(loaded) <= budgets.at(scene.name));
        CHECK(triangleCount(loaded) > 1000);
        CHECK_FALSE(loaded.description.empty());
    }
}

TEST_CASE("the views of the theses load, a square picture with three cameras each")
{
    for (const char* name : {"primitives", "foliage", "flowers", "bench", "colonnade"}) {
        INFO(name);
        const auto scene = loadScene(std::string("views/") + name);
        REQUIRE_MESSAGE(scene, scene.error());
        CHECK(scene->name == name);
        CHECK(scene->width == scene->height);
        CHECK(scene->camera.size() == 3);
        CHECK(scene->frames == 181); // frames 0, 90 and 180 show the keys
        CHECK(scene->lights.size() == 1);
    }
}

TEST_CASE("soft_table has a light of every kind, each with a surface")
{
    const auto scene = loadScene("views/soft_table");
    REQUIRE_MESSAGE(scene, scene.error());
    std::set<LightKind> kinds;
    for (const Light& light : scene->lights) {
        kinds.insert(light.kind);
        CHECK(light.radius > 0.0f);
    }
    CHECK(kinds.size() == 3);
}

TEST_CASE("still_life has a rectangle light, three times as wide as high, whose axis is not the direction's")
{
    const auto scene = loadScene("views/still_life");
    REQUIRE_MESSAGE(scene, scene.error());
    REQUIRE(scene->lights.size() == 1);
    const Light& light = scene->lights[0];
    CHECK(light.kind == LightKind::Spot);
    CHECK(light.rectangle.x == Approx(3.0f * light.rectangle.y));
    CHECK(std::abs(glm::dot(light.direction, light.rectangleAxis)) < 0.9);
}

TEST_CASE("leaf_shade has a metre of leaves within two metres of the eye, under a sun of 0.53 degrees")
{
    const auto scene = loadScene("views/leaf_shade");
    REQUIRE_MESSAGE(scene, scene.error());
    REQUIRE(scene->lights.size() == 1);
    CHECK(scene->lights[0].kind == LightKind::Directional);
    CHECK(scene->lights[0].radius == Approx(glm::radians(0.53 / 2.0)).epsilon(0.001));
    const auto foliage = std::find_if(scene->instances.begin(), scene->instances.end(),
                                      [](const Instance& instance) { return instance.name == "foliage"; });
    REQUIRE(foliage != scene->instances.end());
    Box box;
    for (const WorldTriangle& triangle : worldTriangles(*scene, 0.0))
        if (triangle.instance == uint32_t(foliage - scene->instances.begin())) box.add(triangle);
    CHECK(box.high.x - box.low.x == Approx(1.0).epsilon(0.15));
    CHECK(box.distance(cameraAt(*scene, 0.0).eye) < 1.0);
}

TEST_CASE("the forest has a million triangles, and nothing in it moves but the camera")
{
    const auto scene = loadScene("views/forest");
    REQUIRE_MESSAGE(scene, scene.error());
    size_t triangles = 0;
    for (const Instance& instance : scene->instances) {
        triangles += scene->meshes[instance.mesh].indices.size() / 3;
        CHECK(instance.isStatic);
    }
    CHECK(triangles > 1'000'000);
    CHECK(scene->lights.at(0).isStatic);
}

TEST_CASE("every shipped scene can fail: each of the six trouble spots is there")
{
    for (const ShippedScene& scene : shippedScenes()) {
        const FailFeatures found = findFailFeatures(shipped(scene.name), 0.0);
        INFO(scene.name);
        CHECK(found.contactEdge);
        CHECK(found.thinWall);
        CHECK(found.grazedReceiver);
        CHECK(found.casterBehindEye);
        if (countOf(shipped(scene.name), LightKind::Spot) > 0) CHECK(found.casterBehindLight);
        CHECK(found.openPart);
    }
}

TEST_CASE("no light comes nearer than half a metre to a surface, with 16 lights and at any time")
{
    for (const ShippedScene& shippedScene : shippedScenes()) {
        Scene scene = shipped(shippedScene.name);
        limitLights(scene, std::max<uint32_t>(16, uint32_t(scene.lights.size())));
        for (const double share : {0.0, 0.21, 0.5, 0.83, 1.0}) {
            const double time = runLength(scene) * share;
            const std::vector<WorldTriangle> triangles = worldTriangles(scene, time);
            std::vector<Box> boxes(scene.instances.size());
            for (const WorldTriangle& triangle : triangles)
                boxes[triangle.instance].add(triangle);
            for (const Light& light : scene.lights) {
                const LightState state = lightAt(light, time);
                if (light.kind == LightKind::Directional || !state.present) continue;
                // Bounding distances first: the exact one is slow.
                std::vector<bool> near;
                for (const Box& box : boxes)
                    near.push_back(box.distance(state.position) <= 1.0);
                double nearest = std::numeric_limits<double>::infinity();
                uint32_t instance = 0;
                for (const WorldTriangle& triangle : triangles) {
                    if (!near[triangle.instance]) continue;
                    Box box;
                    box.add(triangle);
                    if (box.distance(state.position) > 1.0) continue;
                    const double distance = distanceToTriangle(state.position, triangle);
                    if (distance < nearest) instance = triangle.instance;
                    nearest = std::min(nearest, distance);
                }
                INFO(scene.name, " at ", time, ": ", light.name, " and ", scene.instances[instance].name);
                CHECK(nearest >= 0.5);
            }
        }
    }
}

TEST_CASE("the camera never comes nearer than its near plane to a surface")
{
    for (const ShippedScene& shippedScene : shippedScenes()) {
        const Scene& scene = shipped(shippedScene.name);
        for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
            const CameraState camera = cameraAt(scene, runLength(scene) * share);
            double nearest = std::numeric_limits<double>::infinity();
            for (const WorldTriangle& triangle : worldTriangles(scene, runLength(scene) * share))
                nearest = std::min(nearest, distanceToTriangle(camera.eye, triangle));
            INFO(scene.name, " at share ", share);
            CHECK(nearest > scene.depth.nearPlane);
        }
    }
}

TEST_CASE("torus_grid is the scene the timing bounds were measured on")
{
    const Scene& scene = shipped("torus_grid");
    std::vector<const Instance*> tori;
    for (const Instance& instance : scene.instances)
        if (scene.meshes[instance.mesh].triangleCount() == 2 * 48 * 24) tori.push_back(&instance);
    REQUIRE(tori.size() == 25);
    for (size_t i = 0; i < tori.size(); ++i) {
        CHECK(tori[i]->pose.position == glm::dvec3(3.5 * (double(i % 5) - 2.0), 2.0, 3.5 * (double(i / 5) - 2.0)));
        CHECK(tori[i]->spin.radiansPerSecond / scene.framesPerSecond == Approx(0.017453292519943295));
        CHECK_FALSE(tori[i]->isStatic);
    }
    REQUIRE(scene.lights.size() == 1);
    const Light& light = scene.lights[0];
    CHECK(light.kind == LightKind::Spot);
    CHECK(light.position == glm::dvec3(6.0, 14.0, 6.0));
    CHECK(glm::length(glm::cross(light.direction, light.position)) < 1e-12); // aims at the origin
    for (const Instance* torus : tori)
        for (const glm::vec3& p : scene.meshes[torus->mesh].positions)
            CHECK(reaches(light, lightAt(light, 0.0), torus->pose.position + glm::dvec3(p)));
    const CameraState camera = cameraAt(scene, 0.0);
    CHECK(camera.eye == glm::dvec3(0.0, 12.0, 20.0));
    CHECK(camera.target == glm::dvec3(0.0));
    CHECK(camera.verticalFov == Approx(0.7853981634));
    CHECK((scene.width == 640 && scene.height == 480));

    const Scene& standard = shipped("torus_grid_standard");
    CHECK(standard.depth.convention == DepthConvention::Standard);
    CHECK((standard.depth.nearPlane == 0.1 && standard.depth.farPlane == 200.0));
    CHECK(triangleCount(standard) == triangleCount(scene));
}

TEST_CASE("the room is closed, and its 16 lights come in two kinds")
{
    Scene room = shipped("room");
    CHECK(room.lights.size() == 4);
    limitLights(room, 16);
    REQUIRE(room.lights.size() == 16);
    for (const Light& light : room.lights) {
        CHECK(light.kind != LightKind::Directional);
        CHECK(light.name.find('+') == std::string::npos); // all written in the file
        const glm::dvec3 p = lightAt(light, 0.0).position;
        CHECK((std::abs(p.x) < 4.0 && p.y > 0.0 && p.y < 8.0 && std::abs(p.z) < 4.0));
    }
    CHECK(std::count_if(room.lights.begin(), room.lights.end(),
                        [](const Light& light) { return light.kind == LightKind::Point; }) == 8);
    for (const Instance& instance : room.instances)
        if (instance.name.starts_with("wall") || instance.name == "floor" || instance.name == "ceiling")
            CHECK(countEdges(room.meshes[instance.mesh]).closed());
}

TEST_CASE("bunny has lights of all three kinds and real meshes: closed, open and worse")
{
    const Scene& scene = shipped("bunny");
    REQUIRE(scene.lights.size() == 4);
    for (const LightKind kind : {LightKind::Directional, LightKind::Spot, LightKind::Point})
        CHECK(std::any_of(scene.lights.begin(), scene.lights.end(), [kind](const Light& l) { return l.kind == kind; }));
    const auto edges = [&scene](const char* name) {
        const auto mesh =
            std::find_if(scene.meshes.begin(), scene.meshes.end(), [name](const Mesh& m) { return m.name == name; });
        REQUIRE(mesh != scene.meshes.end());
        return countEdges(*mesh);
    };
    CHECK(edges("bunny").closed());
    CHECK(edges("bunny").crowded == 0);
    CHECK(edges("cat").border == 330);
    CHECK(edges("horse").crowded == 24);
}

TEST_CASE("the scenario goes static, 6 near, 13 far, up to 16 far, 9 near, with nothing in between")
{
    const Scene& scene = shipped("scenario");
    checkPhases(scene, {{0.0, 4, 0, false},
                        {1.95, 4, 0, false},
                        {2.0, 6, 6, false},
                        {3.95, 6, 6, false},
                        {4.0, 13, 13, true},
                        {5.95, 13, 13, true},
                        {6.0, 14, 14, true},
                        {6.5, 15, 15, true},
                        {7.0, 16, 16, true},
                        {7.95, 16, 16, true},
                        {8.0, 9, 9, false},
                        {9.95, 9, 9, false}});
    CHECK(runLength(scene) == Approx(9.95));
    for (uint32_t frame = 1; frame < scene.frames; ++frame) {
        const double time = frameTime(scene, frame), before = frameTime(scene, frame - 1);
        const bool jump = glm::length(cameraAt(scene, time).eye - cameraAt(scene, before).eye) > 1.0;
        CHECK(jump == cameraCutsBetween(scene, before, time));
    }
}

TEST_CASE("the reverse scenario goes 9 near, up to 16, 13 far, 6 near, static")
{
    const Scene& scene = shipped("scenario_reverse");
    std::vector<Phase> phases = {{0.0, 9, 9, false}, {1.95, 9, 9, false}};
    for (uint32_t more = 0; more < 7; ++more)
        phases.push_back({2.0 + 0.25 * more, 10 + more, 10 + more, false});
    phases.insert(phases.end(), {{4.45, 16, 16, false},
                                 {4.5, 16, 16, true},
                                 {5.45, 16, 16, true},
                                 {5.5, 13, 13, true},
                                 {7.45, 13, 13, true},
                                 {7.5, 6, 6, false},
                                 {9.45, 6, 6, false},
                                 {9.5, 4, 0, false}});
    checkPhases(scene, phases);
    CHECK(scene.instances.size() == shipped("scenario").instances.size());
}

TEST_CASE("in the city 64 lights of three kinds stand up to 300 m away, 16 of them move, and so do the cars")
{
    const Scene& scene = shipped("city_night");
    REQUIRE(scene.lights.size() == 64);
    CHECK(countOf(scene, LightKind::Directional) == 1);
    CHECK(countOf(scene, LightKind::Spot) == 29);
    CHECK(countOf(scene, LightKind::Point) == 34);
    CHECK(movingLights(scene) == 16);
    CHECK(movingInstances(scene) == 16);
    CHECK(triangleCount(scene) > 280'000);
    for (const Light& light : scene.lights)
        CHECK(light.isStatic != moves(light));
    // Distances from the eye are spread at any time.
    for (const double time : {0.0, 6.0, 12.0}) {
        const glm::dvec3 eye = cameraAt(scene, time).eye;
        uint32_t near = 0, far = 0, farthest = 0;
        for (const Light& light : scene.lights) {
            if (light.kind == LightKind::Directional) continue;
            const double distance = glm::length(lightAt(light, time).position - eye);
            near += distance < 30.0;
            far += distance > 100.0;
            farthest = std::max(farthest, uint32_t(distance));
        }
        INFO(time, " s");
        CHECK(near >= 2);
        CHECK(far >= 16);
        CHECK(farthest > 200);
    }
}

TEST_CASE("headlights and lamps of drones keep to their cars and drones")
{
    const Scene& scene = shipped("city_night");
    for (const Light& light : scene.lights) {
        if (!moves(light)) continue;
        const bool drone = light.name.starts_with("drone");
        const std::string carrier =
            drone ? light.name : "car" + light.name.substr(std::string_view("headlight").size());
        const auto found = std::find_if(scene.instances.begin(), scene.instances.end(),
                                        [&carrier](const Instance& i) { return i.name == carrier; });
        REQUIRE_MESSAGE(found != scene.instances.end(), carrier);
        for (const double time : {0.0, 3.7, 12.0})
            CHECK(glm::length(lightAt(light, time).position - instanceAt(*found, time).translation) < 3.1);
    }
}

TEST_CASE("the walk through the wood is 200 m long, under a million triangles of leaves that are no manifold")
{
    const Scene& scene = shipped("forest_walk");
    CHECK(triangleCount(scene) > 950'000);
    double way = 0.0;
    for (double time = 0.5; time <= runLength(scene); time += 0.5)
        way += glm::length(cameraAt(scene, time).eye - cameraAt(scene, time - 0.5).eye);
    CHECK(way > 195.0);
    REQUIRE(scene.lights.size() == 1);
    CHECK(scene.lights[0].kind == LightKind::Directional);
    uint64_t leafTriangles = 0;
    std::map<uint32_t, bool> crowded;
    for (const Instance& instance : scene.instances) {
        const auto [entry, isNew] = crowded.try_emplace(instance.mesh);
        if (isNew) entry->second = countEdges(scene.meshes[instance.mesh]).crowded > 0;
        if (entry->second) leafTriangles += scene.meshes[instance.mesh].triangleCount();
    }
    CHECK(leafTriangles > 900'000);
}

TEST_CASE("24 point lights go round the eye in the arena, each above the torch of a figure")
{
    const Scene& scene = shipped("arena");
    REQUIRE(scene.lights.size() == 24);
    CHECK(countOf(scene, LightKind::Point) == 24);
    CHECK(movingLights(scene) == 24);
    CHECK(movingInstances(scene) >= 24);
    for (const double time : {0.0, 4.3, 11.0}) {
        const CameraState camera = cameraAt(scene, time);
        uint32_t ahead = 0;
        for (const Light& light : scene.lights) {
            const glm::dvec3 position = lightAt(light, time).position;
            ahead += glm::dot(position - camera.eye, camera.forward()) > 0.0;
            double nearest = std::numeric_limits<double>::infinity();
            for (const Instance& instance : scene.instances)
                if (instance.name.starts_with("bearer"))
                    nearest = std::min(nearest, glm::length(position - instanceAt(instance, time).translation));
            CHECK(nearest < 3.1);
        }
        CHECK(ahead >= 6);
        CHECK(ahead <= 18);
    }
}

TEST_CASE("everything in the gallery stands still but its visitor")
{
    const Scene& scene = shipped("gallery");
    CHECK(scene.lights.size() == 50);
    for (const Light& light : scene.lights)
        CHECK(light.isStatic);
    CHECK(movingInstances(scene) == 1);
    CHECK(scene.instances.size() > 150);
}

TEST_CASE("runs in which distance and motion are to matter last ten seconds at least, and the eye moves")
{
    for (const char* name : {"city_night", "forest_walk", "arena", "gallery"}) {
        INFO(name);
        const Scene& scene = shipped(name);
        CHECK(runLength(scene) > 10.0);
        CHECK(scene.camera.back().time >= 10.0);
        CHECK(cameraAt(scene, 0.0).eye != cameraAt(scene, 10.0).eye);
    }
}
