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
    for (const demo::LightKind kind : {demo::LightKind::Directional, demo::LightKind::Point, demo::LightKind::Spot})
        if (serves(method, kind)) scene.lights[0].kind = kind;
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

/// Draws frames that change nothing, each dropped once before, until a list is copied to the GPU's own memory.
/// @return frames drawn; 0: none was
uint32_t framesUntilCopied(Host& plain, Host& host)
{
    for (uint32_t frame = 1; frame <= 20; ++frame) {
        host.require(host.draw({.call = Call::record, .drop = true}));
        discreteBooks() = {};
        CHECK(differing(plain, host) == 0);
        if (discreteBooks().copies > 0) return frame;
    }
    return 0;
}

void settle(const char* method, double silhouettes)
{
    CAPTURE(std::string(method));
    CAPTURE(silhouettes);
    Scene scene = smallScene();
    scene.instances[kBall].isStatic = false;
    Host plain(scene), host(scene, discrete());
    for (Host* each : {&plain, &host}) {
        each->pinAll(method);
        each->require(gnSetMethodSetting(each->context, method, "z_fail", 1.0)); // caps too
        if (silhouettes > 0.0) each->require(gnSetMethodSetting(each->context, method, "silhouettes", silhouettes));
    }
    CHECK(differing(plain, host) == 0); // meshes are copied
    for (int round = 0; round < 2; ++round) {
        CAPTURE(round);
        discreteBooks() = {};
        CHECK(differing(plain, host) == 0);
        CHECK(discreteBooks().copies == 0); // it may change at once
        CHECK(discreteBooks().hostIndexes > 0);
        CHECK(framesUntilCopied(plain, host) > 3);
        for (int frame = 0; frame < 2; ++frame) {
            discreteBooks() = {};
            CHECK(differing(plain, host) == 0);
            CHECK(discreteBooks().indexLists > 0);
            CHECK(discreteBooks().hostIndexes == 0);
            CHECK(discreteBooks().copies == 0);
        }
        for (Host* each : {&plain, &host}) // every list of the ball changes, for one method its mesh's
            squeezeBall(*each, 1.0f + 0.1f * static_cast<float>(round));
        CHECK(differing(plain, host) == 0);
    }
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest,
                  "with memory of its own every method shows the same: new, still, dropped, deformed, moved")
{
    if (!canShowDiscrete()) return;
    const Host named(smallScene()); // whose methods' names live as long
    const std::vector<GnMethodInfo> methods = availableMethods(named.context);
    REQUIRE(methods.size() > 12);
    for (const GnMethodInfo& method : methods)
        drawEverything(method);
}

TEST_CASE_FIXTURE(DeviceTest, "lists that no longer change are copied to the GPU's own memory once, and read there")
{
    if (!canShowDiscrete()) return;
    settle("all_edges_volume", 0.0);
    settle("stencil_volume", 0.0);
    settle("stencil_volume", 1.0);
}
