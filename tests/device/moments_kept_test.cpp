// Statistics of a light's depths are kept from frame to frame, and are made again where the scale of depths has
// changed.
#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

TEST_CASE_FIXTURE(DeviceTest, "a caster that moves the far end of a lamp's maps changes the statistics of all faces")
{
    constexpr size_t kBall = 1;
    for (const char* method : {"moments", "moments_soft"}) {
        CAPTURE(std::string(method));
        Scene scene = smallScene();
        demo::Light lamp = pointLight("lamp", {0.0, 8.0, 0.0}, true);
        lamp.range = 40.0f;
        lamp.radius = 0.2f;
        scene.lights = {lamp};
        scene.instances[kBall].isStatic = false;
        scene.instances[kBall].pose.position = {-10.0, 1.6, 0.0}; // in one face alone, not the floor's
        Host host(scene, {.mapSide = 1024.0});                    // finer texels leave more of the umbra
        host.pinAll(method);
        host.require(host.draw());
        REQUIRE(std::string(host.decision(0).pMethod) == method);
        const std::vector<Image8> before = host.pictures();
        CHECK(dark(before[0]) > 50); // where a penumbra has an umbra
        host.scene.instances[kBall].pose.position.x = -18.0;
        host.require(host.draw());
        Host fresh(host.scene, {.mapSide = 1024.0});
        fresh.pinAll(method);
        fresh.require(fresh.draw());
        CHECK(differences(host.pictures(), fresh.pictures()) == 0);
    }
}
