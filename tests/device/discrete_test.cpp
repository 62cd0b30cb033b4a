// A device with memory of its own: what the host writes is copied there, and the pictures are the same.
#include "device/discrete.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr size_t kBall = 1;

Scene sceneFor(const GnMethodInfo& method)
{
    Scene scene = smallScene();
    scene.instances[kBall].isStatic = false;
    if (!serves(method, demo::LightKind::Spot)) scene.lights[0].kind = demo::LightKind::Point;
    if (!(method.traits & GN_TRAIT_HARD_BIT)) scene.lights[0].radius = 0.2f;
    return scene;
}

void squeezeBall(Host& host, float size = 1.0f)
{
    demo::Mesh ball = host.scene.meshes[kBall];
    for (glm::vec3& position : ball.positions)
        position *= size * glm::vec3(1.2f, 0.8f, 1.1f);
    host.require(gnUpdateMeshPositions(host.context, host.meshes[kBall], &ball.positions[0].x,
                                       static_cast<uint32_t>(ball.positions.size()), 0));
}

/// One more frame of both. @return texels that differ.
size_t differing(Host& plain, Host& discrete, const FrameOptions& frame = {})
{
    for (Host* host : {&plain, &discrete}) {
        host->require(host->draw(frame));
        CHECK(host->decision(0).reason == GN_REASON_PINNED);
    }
    const std::vector<Image8> pictures = discrete.pictures();
    CHECK(dark(pictures[0]) > 50);
    return differences(plain.pictures(), pictures);
}

void drawEverything(const GnMethodInfo& method)
{
    CAPTURE(std::string(method.pName));
    const Scene scene = sceneFor(method);
    Host plain(scene), host(scene, discrete());
    for (Host* each : {&plain, &host})
        each->pinAll(method.pName);
    discreteBooks() = {};
    CHECK(differing(plain, host) == 0);
    CHECK(discreteBooks().copies > 0); // the meshes, at least
    CHECK(differing(plain, host) == 0);
    discreteBooks() = {};
    CHECK(differing(plain, host) == 0);
    CHECK(discreteBooks().copies == 0); // nothing has changed
    if (method.roundTrips == 0) {       // what a dropped frame was to copy, the next one copies
        for (Host* each : {&plain, &host})
            squeezeBall(*each);
        host.require(host.draw({.call = Call::record, .drop = true}));
        CHECK(differing(plain, host, {.call = Call::record}) == 0);
    }
    for (int frame = 0; frame < 3; ++frame) { // deformed and moved, faster than the GPU is done
        for (Host* each : {&plain, &host}) {
            squeezeBall(*each);
            each->scene.instances[kBall].pose.position.x += 0.2;
            each->require(each->draw());
        }
    }
    CHECK(differing(plain, host) == 0);
    CHECK(discreteBooks().mapped == 0);
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest,
                  "with memory of its own every method shows the same: new, still, dropped, deformed, moved")
{
    const Host named(smallScene()); // whose methods' names live as long
    const std::vector<GnMethodInfo> methods = availableMethods(named.context);
    REQUIRE(methods.size() > 12);
    for (const GnMethodInfo& method : methods)
        drawEverything(method);
}
