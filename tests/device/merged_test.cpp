// Buildings in one mesh: each cluster of it has a volume of its own, as if it were a caster.
#include "device/draw_counter.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

Scene merged(Scene scene)
{
    demo::mergeStatics(scene);
    return scene;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "volumes of what stands still cover as many samples in one mesh as in many")
{
    if (!DrawCounter::possible()) {
        MESSAGE("no queries: nothing is checked");
        return;
    }
    DrawCounter counter;
    for (const char* name : {"room", "rooms", "colonnade"}) {
        const Scene scene = demo::valueOf(demo::loadScene(name));
        Host apart(scene, counter.options({.maxLights = 16})), whole(merged(scene), counter.options({.maxLights = 16}));
        for (const char* method : {"stencil_volume", "octree_volume", "all_edges_volume"}) {
            for (Host* host : {&apart, &whole})
                host->pinAll(method);
            const DrawCount many = counter.count(apart, {}), one = counter.count(whole, {});
            MESSAGE(std::string(name) << ", " << std::string(method) << ": " << many.triangles << " -> "
                                      << one.triangles << " triangles, " << many.samples << " -> " << one.samples
                                      << " samples");
            CHECK(many.samples > 100000);
            // Single pixels lie on edges that products of transforms round apart.
            CHECK(one.samples <= many.samples + many.samples / 1000);
            CHECK(one.triangles <= many.triangles + many.triangles / 100);
        }
    }
}
