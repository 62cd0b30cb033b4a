// How many stencil fragments the volume methods fill, counted by precise occlusion queries around gnomon's commands.
#include <glm/gtc/quaternion.hpp>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr VkExtent2D kSize{640, 360};
constexpr double kResolution = 512;

/// Whether the device can count samples; where it can, the host has to have asked for it, or validation complains.
bool countsSamples()
{
    VkPhysicalDeviceFeatures present{};
    vkGetPhysicalDeviceFeatures(device().physicalDevice, &present);
    if (!present.occlusionQueryPrecise) MESSAGE("no precise occlusion queries: nothing is checked");
    return present.occlusionQueryPrecise;
}

/// Counts the samples that pass depth and stencil tests in a recorded frame.
class SampleCounter {
public:
    SampleCounter()
    {
        const VkQueryPoolCreateInfo info{
            .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO, .queryType = VK_QUERY_TYPE_OCCLUSION, .queryCount = 1};
        REQUIRE(vkCreateQueryPool(device().handle, &info, nullptr, &pool_) == VK_SUCCESS);
    }
    ~SampleCounter() { vkDestroyQueryPool(device().handle, pool_, nullptr); }
    SampleCounter(const SampleCounter&) = delete;
    SampleCounter& operator=(const SampleCounter&) = delete;

    void bracket(VkCommandBuffer cmd, bool begins) const
    {
        if (!begins) return vkCmdEndQuery(cmd, pool_, 0);
        vkCmdResetQueryPool(cmd, pool_, 0, 1);
        vkCmdBeginQuery(cmd, pool_, 0, VK_QUERY_CONTROL_PRECISE_BIT);
    }
    uint64_t count() const
    {
        uint64_t samples = 0;
        REQUIRE(vkGetQueryPoolResults(device().handle, pool_, 0, 1, sizeof samples, &samples, sizeof samples,
                                      VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT) == VK_SUCCESS);
        return samples;
    }

private:
    VkQueryPool pool_ = VK_NULL_HANDLE;
};

struct Counted {
    uint64_t samples = 0;
    Image8 picture;
    bool zFail = false; ///< Some volumes counted what fails the depth test; those samples are not seen.
};

/// One light by one method, in a frame that draws no map: that of the frame before is kept.
Counted countSamples(Host& host, const SampleCounter& counter, uint32_t light, const char* method)
{
    const std::vector<GnLight> lit{host.lights[light]};
    host.pin(light, method);
    host.require(host.draw({.call = Call::record, .lights = &lit}));
    Counted counted{.zFail = host.passCount("volumes.caps") > 0};
    host.require(host.draw({.call = Call::record, .lights = &lit, .around = [&](VkCommandBuffer cmd, bool begins) {
                                counter.bracket(cmd, begins);
                            }}));
    for (const GnPassTiming& pass : host.passes())
        CHECK(std::string(pass.pName).find("casters") == std::string::npos);
    counted.picture = host.pictures()[0];
    counted.samples = counter.count();
    return counted;
}

/// Silhouette pixels: those that pcf_hybrid, which classifies as chan_durand does, would trace.
uint64_t silhouettePixels(Host& host, uint32_t light)
{
    const std::vector<GnLight> lit{host.lights[light]};
    host.pin(light, "pcf_hybrid");
    host.require(host.draw({.lights = &lit}));
    return host.stats().rays;
}

struct Fill {
    uint64_t everywhere = 0, masked = 0;
    uint32_t lights = 0;
};

/// Volumes' fragments of every light of the scene that z-pass alone counts. `everywhere` is never too large, `masked`
/// never too small.
Fill fillOf(const std::string& name)
{
    const Scene scene = demo::valueOf(demo::loadScene(name));
    Scene bright = scene; // the same receivers, and nothing casts
    for (demo::Instance& instance : bright.instances)
        instance.casterMask = 1;
    for (demo::Light& light : bright.lights)
        light.casterMask = 2;
    Host host(scene, {.extent = kSize, .maxLights = 32}), bare(bright, {.extent = kSize, .maxLights = 32});
    for (Host* each : {&host, &bare})
        for (const char* method : {"chan_durand", "pcf_hybrid"})
            each->require(gnSetMethodSetting(each->context, method, "resolution", kResolution));
    const SampleCounter counter;
    Fill fill;
    for (const uint32_t light : demo::stateAt(scene, 0.0).present) {
        // stencil_volume passes over tiles that need more than a count once to resolve, and where its stencil is not 0
        // once more: that took a fragment at least. chan_durand passes at all pixels that its map answers.
        const uint64_t mixed = countSamples(bare, counter, light, "stencil_volume").samples;
        const uint64_t area = countSamples(bare, counter, light, "chan_durand").samples;
        const Counted everywhere = countSamples(host, counter, light, "stencil_volume");
        const Counted masked = countSamples(host, counter, light, "chan_durand");
        if (everywhere.zFail || masked.zFail) continue;
        // chan_durand passes at certain pixels to classify, and at silhouette pixels in shadow to resolve.
        const uint64_t silhouettes = silhouettePixels(host, light);
        REQUIRE(mixed <= area);
        REQUIRE(everywhere.samples > mixed);
        REQUIRE(masked.samples + silhouettes > area);
        fill.everywhere += (everywhere.samples - mixed) / 2;
        fill.masked += masked.samples + silhouettes - area;
        ++fill.lights;
        MESSAGE(name << " " << scene.lights[light].name << ": pixels " << area << ", mixed " << mixed
                     << ", silhouettes " << silhouettes << ", samples everywhere " << everywhere.samples << ", masked "
                     << masked.samples);
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
        MESSAGE(std::string(name) << ": " << fill.lights << " lights, at least " << fill.everywhere
                                  << " fragments everywhere, at most " << fill.masked << " under the mask, ratio "
                                  << double(fill.masked) / double(fill.everywhere));
        CHECK(fill.lights > 0);
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
    Host host(scene);
    host.require(gnSetMethodSetting(host.context, "chan_durand", "resolution", 64));
    const SampleCounter counter;
    const Counted culled = countSamples(host, counter, 0, "chan_durand");
    host.require(gnSetMethodSetting(host.context, "chan_durand", "cull", 0));
    const Counted all = countSamples(host, counter, 0, "chan_durand");
    MESSAGE(culled.samples << " samples culled, " << all.samples << " in all");
    CHECK(!all.zFail);
    CHECK(culled.samples < all.samples);
    CHECK(differences(culled.picture, all.picture) == 0);
    CHECK(dark(culled.picture) > 100);
}
