// Casters that volumes cannot see, and that may be missed: no method draws a part of them.
#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// A box between lamp and floor, out of the camera's sight, whose holes only a texture knows.
GnInstance addFoliage(Host& host, bool isStatic)
{
    constexpr size_t kBox = 2;
    demo::Instance instance = host.scene.instances[kBox];
    instance.pose.position = {0.8, 3.4, 1.2};
    GnInstanceCreateInfo info{};
    info.flags = GN_INSTANCE_ALPHA_TESTED_BIT | GN_INSTANCE_MAY_BE_MISSED_BIT;
    if (isStatic) info.flags |= GN_INSTANCE_STATIC_BIT;
    info.pName = "foliage";
    info.mesh = host.meshes[kBox];
    info.transform = demo::toGnTransform(demo::instanceAt(instance, 0.0));
    info.casterMask = 0xffffffffu;
    for (int axis = 0; axis < 3; ++axis) {
        info.boundsMin[axis] = -1.0f;
        info.boundsMax[axis] = 1.0f;
    }
    GnInstance out = VK_NULL_HANDLE;
    host.require(gnCreateInstance(host.context, &info, &out));
    return out;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "an alpha-tested caster that may be missed is left out, not drawn as solid")
{
    for (const std::string name : {"stencil_volume", "all_edges_volume", "octree_volume", "penumbra_wedges",
                                   "angular_spans", "projected_planar"}) {
        CAPTURE(name);
        for (const bool isStatic : {true, false}) {
            Scene scene = smallScene();
            scene.lights[0].radius = 0.2f;
            Host without(scene), with(scene);
            addFoliage(with, isStatic);
            for (Host* host : {&without, &with}) {
                host->pinAll(name.c_str());
                host->require(host->draw());
                CHECK(std::string(host->decision(0).pMethod) == name);
            }
            CHECK(differences(without.pictures(), with.pictures()) == 0);
            CHECK(dark(with.pictures()[0]) > 300);
        }
    }
}
