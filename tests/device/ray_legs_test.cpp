// Methods that ask a map first trace the rest on the device where that has ray queries and is no software one, else on
// the CPU: both legs side by side. On devices without ray queries there is one leg, and nothing to compare.
#include <algorithm>
#include <array>

#include "device/fixture.hpp"
#include "shaders/hybrid/reasons.h"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr std::array kMethods = {"pcf_hybrid", "conservative_map", "conservative_map_adjacency"};

GnMethodInfo methodOf(const Host& host, std::string_view name)
{
    for (const GnMethodInfo& method : availableMethods(host.context))
        if (name == method.pName) return method;
    FAIL("no method " << name);
    return {};
}

/// On a software device, too.
HostOptions withRays(HostOptions options = {})
{
    options.flags |= GN_CONTEXT_DEVICE_RAYS_BIT;
    return options;
}

/// The host has not enabled ray queries.
void withoutRays(GnContextCreateInfo& info)
{
    info.enabledExtensionCount = 0;
}

/// The same scene with either leg, and the device classifying for both.
struct Legs {
    explicit Legs(const Scene& scene, const HostOptions& options = {})
        : device(scene, withRays(options)), cpu(scene, [&] {
              HostOptions without = options;
              without.context = withoutRays;
              return without;
          }())
    {
        for (Host* host : {&device, &cpu})
            host->require(gnSetMethodSetting(host->context, "pcf_hybrid", "classify", 0.0));
    }
    void set(const char* method, const char* setting, double value)
    {
        for (Host* host : {&device, &cpu})
            host->require(gnSetMethodSetting(host->context, method, setting, value));
    }
    Host device, cpu;
};

bool hasTwo(const Host& host)
{
    if (!tracesRays(host.context)) return false;
    for (const char* name : kMethods)
        REQUIRE(methodOf(host, name).roundTrips == 0);
    return true;
}

std::vector<Image8> drawn(Host& host, const char* method, const FrameOptions& options = {})
{
    host.pinAll(method);
    host.require(host.draw(options));
    REQUIRE(host.decision(0).reason == GN_REASON_PINNED);
    return host.pictures();
}

size_t count(const std::vector<Image8>& pictures, uint8_t byte)
{
    size_t found = 0;
    for (const Image8& picture : pictures)
        found += static_cast<size_t>(std::ranges::count(picture.texels, byte));
    return found;
}

/// What the camera draws of them.
std::vector<Image8> within(const std::vector<Image8>& pictures, const VkRect2D& area)
{
    std::vector<Image8> parts;
    for (const Image8& picture : pictures) {
        Image8& part = parts.emplace_back(area.extent.width, area.extent.height, 1);
        for (uint32_t y = 0; y < area.extent.height; ++y)
            std::copy_n(picture.at(area.offset.x, area.offset.y + y), area.extent.width, part.at(0, y));
    }
    return parts;
}

/// One light of each kind over things that move.
Scene manyLights()
{
    Scene scene = smallScene();
    demo::Light sun = spotLight("sun", {3.0, 6.0, 2.0}, {0.0, 0.0, 0.0}, true);
    sun.kind = demo::LightKind::Directional;
    sun.range = sun.innerAngle = sun.outerAngle = 0.0f;
    scene.lights.push_back(sun);
    scene.lights.push_back(pointLight("lamp", {-1.5, 2.5, 1.0}, true));
    for (demo::Instance& instance : scene.instances)
        instance.isStatic = false;
    return scene;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "what the device can trace needs no round trip, and is said to be traced there")
{
    Legs legs(smallScene());
    if (!hasTwo(legs.device)) return;
    for (const char* name : kMethods) {
        CAPTURE(std::string(name));
        const GnMethodInfo device = methodOf(legs.device, name), cpu = methodOf(legs.cpu, name);
        CHECK(device.roundTrips == 0);
        CHECK(cpu.roundTrips == 1);
        CHECK((device.traits & (GN_TRAIT_RAYS_BIT | GN_TRAIT_DEVICE_RAYS_BIT)) == GN_TRAIT_DEVICE_RAYS_BIT);
        CHECK((cpu.traits & (GN_TRAIT_RAYS_BIT | GN_TRAIT_DEVICE_RAYS_BIT)) == GN_TRAIT_RAYS_BIT);
        CHECK((device.traits ^ cpu.traits) == (GN_TRAIT_RAYS_BIT | GN_TRAIT_DEVICE_RAYS_BIT));
        drawn(legs.device, name, {.call = Call::record});
        CHECK(legs.device.stats().hostWaits == 0);
        CHECK(legs.device.passCount(std::string(name) + ".list") == 1);
        CHECK(legs.device.explanation(0).find(std::string(name) + " at 256 by rays on the device") !=
              std::string::npos);
        drawn(legs.cpu, name);
        CHECK(legs.cpu.passCount(std::string(name) + ".readback") == 1);
        CHECK(legs.cpu.explanation(0).find("rays on the device (") == std::string::npos);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "both trace the same pixels of every kind of light, and say the same of them")
{
    Legs legs(manyLights());
    if (!hasTwo(legs.device)) return;
    for (const char* name : kMethods) {
        CAPTURE(std::string(name));
        for (const double reasons : {0.0, 1.0}) {
            CAPTURE(reasons);
            legs.set(name, "reasons", reasons);
            const std::vector<Image8> device = drawn(legs.device, name), cpu = drawn(legs.cpu, name);
            CHECK(differences(device, cpu) <= 3); // of 3 * 57 600: a ray along an edge
            if (reasons == 0.0) continue;
            CHECK(count(device, gpu::UNDECIDED) == 0);
            CHECK(count(device, gpu::REASON_RT_LIT) > 50);
            CHECK(count(device, gpu::REASON_RT_SHADOW) > 50);
        }
        legs.set(name, "reasons", 0.0);
        CHECK(differences(drawn(legs.device, name), drawn(legs.device, "ray_traced")) <= 30); // pcf_hybrid's own errors
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a part of the image, no normals and odd sizes change nothing of that")
{
    constexpr VkRect2D area{{13, 7}, {131, 70}};
    Legs legs(manyLights(), {.extent = {157, 93}, .area = area});
    if (!hasTwo(legs.device)) return;
    for (const bool normals : {true, false}) {
        CAPTURE(normals);
        FrameOptions options;
        options.adjust = [normals](GnFrameInfo&, std::vector<GnViewFrame>& views) {
            if (normals) return;
            views[0].normalImage = VK_NULL_HANDLE;
            views[0].normalView = VK_NULL_HANDLE;
        };
        for (const char* name : kMethods) {
            CAPTURE(std::string(name));
            const std::vector<Image8> device = within(drawn(legs.device, name, options), area);
            CHECK(dark(device[0]) > 100);
            CHECK(differences(device, within(drawn(legs.cpu, name, options), area)) <= 3);
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest, "receivers inside of what the near plane cuts open are traced by both")
{
    Legs legs(smallScene());
    if (!hasTwo(legs.device)) return;
    std::vector<demo::CameraState> inside{demo::cameraAt(legs.device.scene, 0.0)};
    inside[0].eye = legs.device.scene.instances[1].pose.position; // in the ball
    legs.set("conservative_map", "reasons", 1.0);
    const FrameOptions options{.cameras = &inside};
    const std::vector<Image8> device = drawn(legs.device, "conservative_map", options);
    CHECK(count(device, gpu::REASON_RT_LIT) + count(device, gpu::REASON_RT_SHADOW) > 1000);
    CHECK(differences(device, drawn(legs.cpu, "conservative_map", options)) <= 3);
}

TEST_CASE_FIXTURE(DeviceTest, "a light with casters that only the host can judge is traced on the CPU")
{
    Scene scene = smallScene();
    scene.lights.push_back(pointLight("near", {2.5, 1.5, 1.0}, true)); // has none of them in its range
    scene.lights[1].range = 2.0f;
    scene.instances[1].alphaTested = true;
    Legs legs(scene);
    if (!hasTwo(legs.device)) return;
    for (const char* name : kMethods) {
        CAPTURE(std::string(name));
        const std::vector<Image8> device = drawn(legs.device, name);
        CHECK(legs.device.passCount(std::string(name) + ".readback") == 1);
        CHECK(legs.device.explanation(0).find("by rays on the device") == std::string::npos);
        CHECK(legs.device.passCount(std::string(name) + ".list") == 1);
        CHECK(legs.device.explanation(1).find("by rays on the device") != std::string::npos);
        CHECK(differences(device, drawn(legs.cpu, name)) <= 3);
        if (methodOf(legs.device, name).traits & GN_TRAIT_EXACT_BIT) // a plain map draws all of what is alpha-tested
            CHECK(differences(device, drawn(legs.device, "ray_traced")) <= 3);

        legs.device.pinAll(name);
        legs.device.require(legs.device.draw({.call = Call::record}));
        CHECK(legs.device.decision(0).reason == GN_REASON_NOT_RECORDABLE);
        CHECK(legs.device.explanation(0).find(
                  std::string(name) + ": out, needs the CPU between passes (1 round trips)") != std::string::npos);
        CHECK(legs.device.decision(1).reason == GN_REASON_PINNED);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a software device leaves the rays to the CPU unless the host asks it for them")
{
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(device().physicalDevice, &properties);
    const bool software = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    const Host asked(smallScene(), withRays());
    if (!hasTwo(asked)) return;
    HostOptions options;
    options.context = [](GnContextCreateInfo& info) {
        info.flags &= ~GnContextCreateFlags{GN_CONTEXT_DEVICE_RAYS_BIT};
    };
    const Host host(smallScene(), options);
    for (const char* name : kMethods)
        CHECK(methodOf(host, name).roundTrips == (software ? 1 : 0));
    CHECK(methodOf(host, "ray_query").roundTrips == 0);
}
