// How many stencil fragments the volume methods fill, counted by precise occlusion queries around every volume draw.
#include <glm/gtc/quaternion.hpp>

#include "device/draw_counter.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr VkExtent2D kSize{640, 360};
constexpr double kResolution = 512;

bool countsSamples()
{
    if (!DrawCounter::possible()) MESSAGE("no queries: nothing is checked");
    return DrawCounter::possible();
}

struct Counted {
    uint64_t samples = 0;
    Image8 picture;
    bool zFail = false; ///< Some volumes counted what fails the depth test; those samples are not seen.
};

/// One light by one method. Samples are those that pass the depth test and, under a mask, the stencil test.
Counted countSamples(Host& host, DrawCounter& counter, uint32_t light, const char* method)
{
    const std::vector<GnLight> lit{host.lights[light]};
    host.pin(light, method);
    host.require(host.draw({.call = Call::record, .lights = &lit}));
    Counted counted{.zFail = host.passCount("volumes.caps") > 0};
    counted.samples = counter.count(host, {.call = Call::record, .lights = &lit}).samples;
    counted.picture = host.pictures()[0];
    return counted;
}

struct Fill {
    uint64_t everywhere = 0, masked = 0;
    uint32_t lights = 0;
};

/// Volumes' fragments of every light of the scene that z-pass alone counts.
Fill fillOf(const std::string& name)
{
    const Scene scene = demo::valueOf(demo::loadScene(name));
    DrawCounter counter;
    Host host(scene, counter.options({.extent = kSize, .maxLights = 32}));
    host.require(gnSetMethodSetting(host.context, "chan_durand", "resolution", kResolution));
    Fill fill;
    for (const uint32_t light : demo::stateAt(scene, 0.0).present) {
        const Counted everywhere = countSamples(host, counter, light, "stencil_volume");
        const Counted masked = countSamples(host, counter, light, "chan_durand");
        if (everywhere.zFail || masked.zFail) continue;
        fill.everywhere += everywhere.samples;
        fill.masked += masked.samples;
        ++fill.lights;
        MESSAGE(name << " " << scene.lights[light].name << ": " << everywhere.samples << " fragments everywhere, "
                     << masked.samples << " under the mask");
        CHECK(differences(everywhere.picture, masked.picture) <= kSize.width * kSize.height / 500);
        CHECK(dark(masked.picture) > 100);
    }
    return fill;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "chan_durand fills at most a quarter of stencil_volume's fragments, for the same picture")
{
    if (!countsSamples()) return;
    for (const char* name : {"torus_grid", "room", "bunny", "colonnade"}) {
        CAPTURE(std::string(name));
        const Fill fill = fillOf(name);
        MESSAGE(std::string(name) << ": " << fill.lights << " lights, ratio "
                                  << double(fill.masked) / double(fill.everywhere));
        CHECK(fill.lights > 0);
        CHECK(fill.masked > 0);
        CHECK(4 * fill.masked <= fill.everywhere);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "casters whose shadow's edges nobody sees are not drawn by chan_durand")
{
    if (!countsSamples()) return;
    // From under a roof: what stands on it casts through it, onto ground that is dark already.
    Scene scene = smallScene();
    demo::Instance roof = scene.instances[2];
    roof.name = "roof";
    roof.pose.position = {0.0, 3.0, 0.0};
    roof.pose.rotation = glm::angleAxis(0.3, glm::dvec3(0.0, 1.0, 0.0)); // no edge along texels
    roof.pose.scale = {3.0, 0.1, 3.0};
    scene.instances[1] = roof;
    demo::Instance chest = roof;
    chest.name = "chest";
    chest.pose.position = {0.0, 3.6, 0.0};
    chest.pose.scale = glm::dvec3(0.4);
    scene.instances[2] = chest;
    scene.lights = {spotLight("lamp", {0.0, 8.0, 0.0}, {0.0, 0.0, 0.0}, true)};
    scene.camera = {{.eye = {0.0, 1.5, 9.0}, .target = {0.0, 0.5, 0.0}}};
    DrawCounter counter;
    Host host(scene, counter.options());
    host.require(gnSetMethodSetting(host.context, "chan_durand", "resolution", 64));
    const Counted culled = countSamples(host, counter, 0, "chan_durand");
    host.require(gnSetMethodSetting(host.context, "chan_durand", "cull", 0));
    const Counted all = countSamples(host, counter, 0, "chan_durand");
    MESSAGE(culled.samples << " samples culled, " << all.samples << " in all");
    CHECK(!all.zFail);
    CHECK(culled.samples < all.samples);
    CHECK(differences(culled.picture, all.picture) == 0);
    CHECK(dark(culled.picture) > 100);
}
