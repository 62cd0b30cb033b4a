// all_edges_volume: stencil_volume's picture bit by bit, from lists that are built once for every mesh and never again
// because of a light or a caster that moves.
#include "device/method_pair.hpp"
#include "device/small_scenes.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr const char* kPlain = "stencil_volume";
constexpr const char* kEdges = "all_edges_volume";
constexpr size_t kBall = 1;

/// The ball and the box of smallScene() move, under two lights that move.
Scene restlessScene()
{
    Scene scene = smallScene();
    for (demo::Instance& instance : scene.instances)
        instance.isStatic = false;
    scene.lights.push_back(pointLight("bulb", {1.5, 5.0, 2.0}, false));
    scene.lights[0].isStatic = false;
    return scene;
}

void moveAll(Scene& scene)
{
    for (size_t i = kBall; i < scene.instances.size(); ++i)
        scene.instances[i].pose.position.x += 0.1;
    for (demo::Light& light : scene.lights)
        light.position.z += 0.1;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "all_edges_volume draws stencil_volume's picture bit by bit in every shipped scene")
{
    for (const Scene& each : smallShippedScenes()) {
        CAPTURE(each.name);
        MethodPair pair(kPlain, kEdges, each, {.maxLights = 32});
        for (const double time : {0.0, 0.5})
            CHECK(pair.differing({.time = time}) == 0);
        CHECK(dark(pair.pictures[0]) > 100);
        pair.set("z_fail", 1.0);
        CHECK(pair.differing({}) == 0);
        pair.set("bounded", 0.0);
        CHECK(pair.differing({}) == 0);
    }
}

TEST_CASE_FIXTURE(DeviceTest,
                  "it does so with standard depth, and for casters that are mirrored, flattened and stretched")
{
    Scene scene = restlessScene();
    const glm::dvec3 scales[] = {{-1.0, 1.0, 1.0}, {1.3, 0.4, -2.0}, {1.0, 0.001, 1.0}};
    for (const auto convention : {demo::DepthConvention::ReversedInfinite, demo::DepthConvention::Standard}) {
        scene.depth = {.convention = convention, .nearPlane = 0.1f, .farPlane = 200.0f};
        for (const glm::dvec3& scale : scales) {
            CAPTURE(scale.x);
            CAPTURE(scale.y);
            scene.instances[kBall].pose.scale = scale;
            MethodPair pair(kPlain, kEdges, scene);
            for (const double zFail : {0.0, 1.0}) {
                pair.set("z_fail", zFail);
                CHECK(pair.differing({}) == 0);
            }
            CHECK(dark(pair.pictures[0]) > 100);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a mesh is listed once for all lights and views, and stays so while everything moves")
{
    Host host(restlessScene(), {.viewCount = 2});
    host.pinAll(kEdges);
    host.require(host.draw());
    const uint32_t built = host.stats().indexListsBuilt;
    CHECK(built >= 2); // ball and box; the floor may be out of sight of its own shadow
    CHECK(built <= host.meshes.size());
    CHECK(host.passCount("all_edges_volume.count") == 4);
    const std::vector<Image8> first = host.pictures();
    for (int frame = 0; frame < 4; ++frame) {
        moveAll(host.scene);
        host.require(host.draw());
        CHECK(host.stats().indexListsBuilt == 0);
        CHECK(host.passCount("volumes.edges") == 0);
        CHECK(host.passCount("volumes.silhouettes") == 0);
    }
    CHECK(differences(first, host.pictures()) > 50);
    Host fresh(host.scene, {.viewCount = 2});
    fresh.pinAll(kEdges);
    fresh.require(fresh.draw());
    CHECK(differences(host.pictures(), fresh.pictures()) == 0);

    // New positions: this mesh again, and no other.
    demo::Mesh ball = host.scene.meshes[kBall];
    for (glm::vec3& position : ball.positions)
        position *= 1.1f;
    host.require(gnUpdateMeshPositions(host.context, host.meshes[kBall], &ball.positions[0].x,
                                       static_cast<uint32_t>(ball.positions.size()), 0));
    host.require(host.draw());
    CHECK(host.stats().indexListsBuilt == 1);
    host.require(host.draw());
    CHECK(host.stats().indexListsBuilt == 0);
}
