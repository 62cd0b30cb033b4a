// conservative_map and conservative_map_adjacency from frame to frame: layers and borders are kept while nothing moves,
// and what is drawn again equals a fresh context's.
#include "device/fixture.hpp"

#include <random>

#include <glm/geometric.hpp>

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr demo::LightKind kKinds[] = {demo::LightKind::Directional, demo::LightKind::Spot, demo::LightKind::Point};

Scene litBy(demo::LightKind kind)
{
    Scene scene = smallScene();
    scene.instances[1].isStatic = false;
    if (kind == demo::LightKind::Point) scene.lights = {pointLight("bulb", {1.0, 5.0, 2.0}, true)};
    if (kind == demo::LightKind::Directional) {
        scene.lights[0].kind = kind;
        scene.lights[0].direction = glm::normalize(glm::dvec3(0.4, -1.0, 0.3));
    }
    return scene;
}

/// Small triangles at random in a cube about the origin.
demo::Mesh flakes(uint32_t count, float half, float size)
{
    std::mt19937 random(3);
    const auto in = [&](float most) { return std::uniform_real_distribution(-most, most)(random); };
    demo::Mesh mesh;
    mesh.name = "flakes";
    for (uint32_t i = 0; i < count; ++i) {
        const glm::vec3 at(in(half), in(half), in(half));
        for (uint32_t corner = 0; corner < 3; ++corner) {
            mesh.positions.push_back(at + glm::vec3(in(size), in(size), in(size)));
            mesh.indices.push_back(3 * i + corner);
        }
    }
    return mesh;
}

/// A wall that a low sun lights past `flakes` at the origin, 900 m away, seen from before it.
Scene farWall()
{
    Scene scene = smallScene();
    scene.meshes = {demo::makeBox({.size = {2.0f, 30.0f, 40.0f}}), flakes(3000, 18.0f, 0.4f)};
    scene.instances.resize(2);
    scene.instances[0].pose.position = {900.0, 0.0, 0.0};
    scene.instances[1].mesh = 1;
    scene.instances[1].pose.position = {0.0, 0.0, 0.0};
    scene.lights[0].kind = demo::LightKind::Directional;
    scene.lights[0].direction = glm::normalize(glm::dvec3(1.0, -1e-4, 2e-4));
    scene.camera = {demo::CameraKey{.eye = {875.0, 1.0, 2.0}, .target = {900.0, 0.0, 0.0}}};
    return scene;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "casters squashed aslant, far from receivers, are answered as their rays are")
{
    for (const std::string method : {"conservative_map", "conservative_map_adjacency"}) {
        Host host(farWall(), {.extent = {960, 540}}), traced(farWall(), {.extent = {960, 540}});
        host.require(gnSetMethodSetting(host.context, method.c_str(), "resolution", 4096.0));
        host.pinAll(method.c_str());
        traced.pinAll("ray_traced");
        host.hide(1); // the host's own poses are not squashed
        traced.hide(1);
        // Of its extent along one direction this share is left: what is rounded on the way into its space comes back
        // many times as large as from a rotated one's.
        constexpr glm::vec3 along(0.98f, 0.15f, 0.13f);
        for (const float left : {1.0f, 0.01f, 0.002f}) {
            CAPTURE(method);
            CAPTURE(left);
            GnTransform squashed{};
            for (int i = 0; i < 9; ++i)
                squashed.basis[i] = (i % 4 == 0 ? 1.0f : 0.0f) - (1.0f - left) * along[i / 3] * along[i % 3];
            for (Host* each : {&host, &traced}) {
                each->require(each->draw());
                each->require(gnSetInstanceTransform(each->context, each->instances[1], &squashed));
                each->require(each->draw());
            }
            REQUIRE(std::string(host.decision(0).pMethod) == method);
            CHECK(dark(traced.pictures()[0]) > 10000);
            CHECK(differences(host.pictures(), traced.pictures()) == 0);
            if (left == 1.0f) CHECK(2 * host.stats().rays < traced.stats().rays);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a part of the images is answered as images of its size are")
{
    constexpr VkRect2D area{{37, 22}, {243, 131}}; // no side a multiple of a tile or a word
    for (const demo::LightKind kind : kKinds) {
        Scene scene = litBy(kind);
        if (kind == demo::LightKind::Point) scene.lights[0].range = 7.0f; // reaches a part of the area
        Host part(scene, {.extent = {320, 180}, .area = area}), whole(scene, {.extent = area.extent});
        for (const std::string method : {"ray_traced", "tile_shafts", "pcf_hybrid", "contour_chain", "conservative_map",
                                         "conservative_map_adjacency"}) {
            CAPTURE(method);
            CAPTURE(static_cast<int>(kind));
            for (Host* host : {&part, &whole}) {
                host->pinAll(method.c_str());
                host->require(host->draw());
                REQUIRE(std::string(host->decision(0).pMethod) == method);
            }
            const Image8 left = part.pictures()[0], right = whole.pictures()[0];
            size_t differing = 0, shaded = 0;
            for (uint32_t y = 0; y < area.extent.height; ++y)
                for (uint32_t x = 0; x < area.extent.width; ++x) {
                    differing += *left.at(x + 37, y + 22) != *right.at(x, y);
                    shaded += *right.at(x, y) == 0;
                }
            CHECK(shaded > 500);
            CHECK(differing <= 3); // view rays of the two round apart: borders of shadows
            CHECK(part.stats().rays >= whole.stats().rays * 9 / 10); // tile_shafts may need none
            CHECK(part.stats().rays < whole.stats().rays * 11 / 10 + 10);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest,
                  "conservative layers are drawn once, again when a caster moves, and equal a fresh context's")
{
    for (const std::string method : {"conservative_map", "conservative_map_adjacency"}) {
        const std::string covered = method == "conservative_map" ? "conservative.covered.casters" : "sheets.casters";
        for (const demo::LightKind kind : kKinds) {
            CAPTURE(method);
            CAPTURE(static_cast<int>(kind));
            Host host(litBy(kind), {.viewCount = 2});
            host.pinAll(method.c_str());
            host.require(host.draw());
            REQUIRE(std::string(host.decision(0).pMethod) == method);
            CHECK(host.passCount("conservative.near.casters") >= 1);
            CHECK(host.passCount(covered) >= 1);
            for (int frame = 0; frame < 3; ++frame) {
                host.require(host.draw());
                CHECK(host.passCount("conservative.near.casters") == 0);
                CHECK(host.passCount(covered) == 0);
                CHECK(host.passCount("sheets.slope") == 0);
                CHECK(host.stats().indexListsBuilt == 0);
            }
            host.scene.instances[1].pose.position.x += 0.4;
            host.require(host.draw());
            CHECK(host.passCount("conservative.near.casters") >= 1);
            CHECK(host.stats().indexListsBuilt == (method == "conservative_map" ? 0 : 1)); // the ball's borders
            Host fresh(host.scene, {.viewCount = 2});
            fresh.pinAll(method.c_str());
            fresh.require(fresh.draw());
            Host traced(host.scene, {.viewCount = 2});
            traced.pinAll("ray_traced");
            traced.require(traced.draw());
            for (const uint32_t view : {0u, 1u}) {
                CHECK(differences(host.pictures(view), fresh.pictures(view)) == 0);
                CHECK(differences(host.pictures(view), traced.pictures(view)) == 0);
            }
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "what is alpha-tested may block and covers nothing: pictures are the rays' own")
{
    for (const char* method : {"conservative_map", "conservative_map_adjacency"}) {
        CAPTURE(std::string(method));
        Scene scene = litBy(demo::LightKind::Spot);
        scene.instances[1].alphaTested = true;
        Host host(scene), traced(scene);
        host.pinAll(method);
        traced.pinAll("ray_traced");
        for (Host* each : {&host, &traced})
            each->require(each->draw());
        REQUIRE(std::string(host.decision(0).pMethod) == method); // the host says where its casters are opaque
        CHECK(dark(host.pictures()[0]) > 100);
        CHECK(differences(host.pictures(), traced.pictures()) == 0);
    }
}
