// Where in a host's images a view is, and how it is stored: samples, layers, areas, encodings of normals, packed
// visibility. Each against the same view through a plain target.
#include <algorithm>

#include "device/target_support.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr auto kReversed = demo::DepthConvention::ReversedInfinite;
constexpr VkExtent2D kSize{160, 90};

const Lens kPlain{"plain", [](demo::CameraMatrices&) {}, GN_DEPTH_REVERSED_INFINITE};

/// Methods with hard edges, which need no source of a size.
std::vector<GnMethodInfo> hardMethods(const Host& host)
{
    std::vector<GnMethodInfo> methods = availableMethods(host.context);
    std::erase_if(methods, [](const GnMethodInfo& method) { return !(method.traits & GN_TRAIT_HARD_BIT); });
    return methods;
}

std::vector<Image8> drawn(Host& host, const FrameOptions& options, uint32_t view = 0)
{
    host.require(host.draw(options));
    return host.pictures(view);
}

size_t farApart(const std::vector<Image8>& a, const std::vector<Image8>& b)
{
    REQUIRE(a.size() == b.size());
    size_t count = 0;
    for (size_t i = 0; i < a.size(); ++i)
        count += test::farApart(a[i], b[i]);
    return count;
}

// --- samples ---

/// Vulkan 1.3, 26.4 "Multisampling": standard sample locations, in sixteenths.
glm::vec2 standardPlace(uint32_t samples, uint32_t sample)
{
    static constexpr float two[][2] = {{12, 12}, {4, 4}};
    static constexpr float four[][2] = {{6, 2}, {14, 6}, {2, 10}, {10, 14}};
    static constexpr float eight[][2] = {{9, 5}, {7, 11}, {13, 9}, {5, 3}, {3, 13}, {1, 7}, {11, 15}, {15, 1}};
    const float(*places)[2] = samples == 2 ? two : samples == 4 ? four : eight;
    return glm::vec2(places[sample][0], places[sample][1]) / 16.0f;
}

/// A camera of one sample a pixel, in the middle, which sees there what the other's sample sees.
Lens atSample(uint32_t samples, uint32_t sample)
{
    const glm::vec2 shift =
        2.0f * (standardPlace(samples, sample) - 0.5f) / glm::vec2(float(kSize.width), float(kSize.height));
    return {"sample",
            [shift](demo::CameraMatrices& camera) {
                camera.projection[2][0] -= shift.x * camera.projection[2][3];
                camera.projection[2][1] -= shift.y * camera.projection[2][3];
            },
            GN_DEPTH_REVERSED_INFINITE};
}

FrameOptions ofSample(uint32_t sample)
{
    return through(
        kPlain, {.adjust = [sample](GnFrameInfo&, std::vector<GnViewFrame>& views) { views[0].imageSample = sample; }});
}

void checkSamples(uint32_t samples)
{
    const Scene scene = targetScene(kReversed);
    Host several(scene, {.extent = kSize, .target = {.samples = samples}}), one(scene, {.extent = kSize});
    for (const GnMethodInfo& method : hardMethods(one)) {
        CAPTURE(std::string(method.pName));
        pinServed(several, method);
        pinServed(one, method);
        std::vector<Image8> before;
        for (uint32_t sample = 0; sample < samples; ++sample) {
            CAPTURE(sample);
            const std::vector<Image8> picture = drawn(several, ofSample(sample));
            const std::vector<Image8> truth = drawn(one, through(atSample(samples, sample)));
            CHECK(farApart(picture, truth) <= 6);
            if (sample > 0) CHECK(farApart(truth, before) > 20); // edges lie elsewhere for another sample
            before = truth;
        }
    }
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "of several samples a view shows exactly what the judged one sees, by every method")
{
    for (const uint32_t samples : {2u, 4u, 8u}) {
        CAPTURE(samples);
        const VkPhysicalDeviceLimits& limits = device().properties.limits;
        if (!drawable(VK_FORMAT_D32_SFLOAT, samples) || !drawable(VK_FORMAT_R16G16B16A16_SFLOAT, samples) ||
            !limits.standardSampleLocations || !(limits.sampledImageDepthSampleCounts & samples)) {
            MESSAGE("SKIPPED: the device has no images of " << samples
                                                            << " samples to draw, sample and judge at standard places");
            continue;
        }
        checkSamples(samples);
    }
}

// --- layers ---

TEST_CASE_FIXTURE(DeviceTest, "views that are layers of one image show what they show of images of their own")
{
    const Scene scene = targetScene(kReversed);
    Host layered(scene, {.extent = kSize, .target = {.layered = true}, .viewCount = 2});
    Host apart(scene, {.extent = kSize, .viewCount = 2});
    std::vector<demo::CameraState> eyes(2, demo::cameraAt(scene, 0.0));
    eyes[1].eye.x += 2.5;
    for (const GnMethodInfo& method : hardMethods(apart)) {
        CAPTURE(std::string(method.pName));
        for (Host* host : {&layered, &apart}) {
            pinServed(*host, method);
            host->require(host->draw({.cameras = &eyes}));
        }
        for (const uint32_t view : {0u, 1u})
            CHECK(differences(layered.pictures(view), apart.pictures(view)) == 0);
        CHECK(differences(layered.pictures(0), layered.pictures(1)) > 500);
    }
}

// --- areas ---

namespace {

struct Outside {
    size_t inside = 0, outside = 0;
};

/// Texels that differ, inside an area and outside.
Outside differing(const std::vector<Image8>& a, const std::vector<Image8>& b, const VkRect2D& area)
{
    Outside result;
    for (size_t i = 0; i < a.size(); ++i)
        for (uint32_t y = 0; y < a[i].height; ++y)
            for (uint32_t x = 0; x < a[i].width; ++x) {
                const bool inside = x - static_cast<uint32_t>(area.offset.x) < area.extent.width &&
                                    y - static_cast<uint32_t>(area.offset.y) < area.extent.height;
                (inside ? result.inside : result.outside) += *a[i].at(x, y) != *b[i].at(x, y);
            }
    return result;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "beside the area nothing is read and nothing written, by every method, frame by frame")
{
    std::vector<demo::CameraState> aside{demo::cameraAt(targetScene(kReversed), 0.0)};
    aside[0].eye.x += 3.0;
    constexpr VkRect2D first{{3, 5}, {81, 70}}, second{{90, 7}, {67, 41}};
    for (const VkFormat format : {VK_FORMAT_D32_SFLOAT, VK_FORMAT_D16_UNORM}) {
        CAPTURE(static_cast<int>(format));
        Host host(targetScene(kReversed), {.extent = kSize, .target = {.depth = format}, .area = first});
        for (const GnMethodInfo& method : hardMethods(host)) {
            CAPTURE(std::string(method.pName));
            pinServed(host, method);
            host.limit(first);
            const std::vector<Image8> before = drawn(host, {.outside = 0.02f});
            CHECK(dark(before[0]) > 100);
            const std::vector<Image8> again = drawn(host, {.outside = 0.9f});
            CHECK(differing(before, again, first).inside == 0);
            host.limit(second);
            const std::vector<Image8> other = drawn(host, {.cameras = &aside, .outside = 0.9f});
            CHECK(differing(other, again, second).outside == 0);
            const std::vector<Image8> straight = drawn(host, {.outside = 0.9f});
            CHECK(differing(straight, other, second).inside > 20);
            CHECK(differing(straight, other, second).outside == 0);
            CHECK(host.stats().pipelinesCreated == 0);
        }
    }
}

// --- normals ---

TEST_CASE_FIXTURE(DeviceTest, "normals are read as they are encoded")
{
    struct Case {
        VkFormat format;
        GnNormalEncoding encoding;
        size_t bound; ///< Texels of three lights: those that a light just grazes.
    };
    const Scene scene = targetScene(kReversed);
    Host plain(scene, {.extent = kSize});
    // One that goes by normals alone: rays find the truth whatever they are.
    std::vector<GnMethodInfo> methods = hardMethods(plain);
    std::erase_if(methods, [](const GnMethodInfo& method) {
        constexpr GnTraits all = GN_TRAIT_DIRECTIONAL_BIT | GN_TRAIT_SPOT_BIT | GN_TRAIT_POINT_BIT;
        return !hasMap(method) || (method.traits & GN_TRAIT_RAYS_BIT) || (method.traits & all) != all;
    });
    REQUIRE(!methods.empty());
    pinServed(plain, methods[0]);
    const std::vector<Image8> truth = drawn(plain, {});
    for (const Case& one : {Case{VK_FORMAT_R16G16_SNORM, GN_NORMAL_OCTAHEDRAL, 12},
                            Case{VK_FORMAT_R16G16_SFLOAT, GN_NORMAL_OCTAHEDRAL, 12},
                            Case{VK_FORMAT_R16G16_UNORM, GN_NORMAL_OCTAHEDRAL_UNSIGNED, 12},
                            Case{VK_FORMAT_R16G16B16A16_SNORM, GN_NORMAL_SIGNED, 12},
                            Case{VK_FORMAT_A2B10G10R10_UNORM_PACK32, GN_NORMAL_UNSIGNED, 24},
                            Case{VK_FORMAT_R8G8B8A8_SNORM, GN_NORMAL_SIGNED, 60},
                            Case{VK_FORMAT_R8G8B8A8_UNORM, GN_NORMAL_UNSIGNED, 60}}) {
        CAPTURE(static_cast<int>(one.format));
        if (!drawable(one.format)) {
            MESSAGE("format " << static_cast<int>(one.format) << " is not drawable here");
            continue;
        }
        Host host(scene, {.extent = kSize, .target = {.normals = one.format, .encoding = one.encoding}});
        pinServed(host, methods[0]);
        const size_t off = farApart(drawn(host, {}), truth);
        const auto misread = [&](GnFrameInfo&, std::vector<GnViewFrame>& views) {
            views[0].normalEncoding = static_cast<GnNormalEncoding>(one.encoding ^ 1); // signed or not
        };
        const size_t misled = farApart(drawn(host, {.adjust = misread}), truth);
        MESSAGE("format " << static_cast<int>(one.format) << ": " << off << " texels off, " << misled << " misread");
        CHECK(off <= one.bound);
        CHECK(misled > 200);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "normals of shading are not read, by any method, with a perspective and without")
{
    const auto bend = [](GnFrameInfo&, std::vector<GnViewFrame>& views) { views[0].shadingNormals = VK_TRUE; };
    const auto leaveOut = [](GnFrameInfo&, std::vector<GnViewFrame>& views) {
        views[0].normalImage = VK_NULL_HANDLE;
        views[0].normalView = VK_NULL_HANDLE;
    };
    Host host(targetScene(kReversed), {.extent = kSize});
    for (const size_t which : {size_t{0}, size_t{4}}) {
        const Lens lens = lensesFor(kReversed)[which];
        CAPTURE(std::string(lens.name));
        host.pinAll("ray_traced");
        const std::vector<Image8> truth = drawn(host, through(lens, {.adjust = bend}));
        CHECK(farApart(drawn(host, through(lens)), truth) < 2000); // of 43200: what faces away is traced
        for (const GnMethodInfo& method : hardMethods(host)) {
            CAPTURE(std::string(method.pName));
            pinServed(host, method);
            const std::vector<Image8> bent = drawn(host, through(lens, {.adjust = bend}));
            CHECK(differences(bent, drawn(host, through(lens, {.adjust = leaveOut}))) == 0);
            if (method.traits & GN_TRAIT_EXACT_BIT) CHECK(farApart(bent, truth) <= 60);
        }
    }
}

// --- visibility ---

TEST_CASE_FIXTURE(DeviceTest, "packed visibility holds what layers hold, four lights a texel")
{
    Scene scene = targetScene(kReversed);
    scene.lights.push_back(pointLight("lantern", {-3.0, 3.0, 2.0}, true));
    scene.lights.push_back(pointLight("candle", {0.5, 2.0, 1.5}, false));
    Host packed(scene, {.extent = kSize, .target = {.depth = VK_FORMAT_D16_UNORM}, .maxLights = 6, .packed = true}),
        layers(scene, {.extent = kSize, .target = {.depth = VK_FORMAT_D16_UNORM}});
    for (const GnMethodInfo& method : hardMethods(layers)) {
        CAPTURE(std::string(method.pName));
        pinServed(packed, method);
        pinServed(layers, method);
        CHECK(differences(drawn(packed, {}), drawn(layers, {})) == 0);
    }
    packed.draw(12, {});
    CHECK(packed.stats().deviceAllocations == 0);
    CHECK(packed.stats().pipelinesCreated == 0);
    GnVisibility visibility{};
    packed.require(gnGetVisibility(packed.context, packed.views[0], &visibility));
    CHECK(visibility.format == VK_FORMAT_R8G8B8A8_UNORM);
    CHECK(visibility.lightsPerTexel == 4);
    CHECK(visibility.layerCount == 2);
    layers.require(gnGetVisibility(layers.context, layers.views[0], &visibility));
    CHECK(visibility.format == VK_FORMAT_R8_UNORM);
    CHECK(visibility.lightsPerTexel == 1);
}

// --- mirrors ---

TEST_CASE_FIXTURE(DeviceTest, "casters that mirror, and those wound the other way, cast the same, by every method")
{
    // The ball's triangles are symmetrical about its planes x = 0 and z = 0, as the box's are: mirrored each covers
    // what it covered.
    const Scene scene = targetScene(kReversed);
    Scene mirrored = scene, turned = scene;
    for (demo::Instance& instance : mirrored.instances)
        instance.pose.scale.x *= -1.0f;
    for (demo::Mesh& mesh : turned.meshes)
        for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
            std::swap(mesh.indices[i], mesh.indices[i + 1]);
    Host plain(scene, {.extent = kSize}), mirror(mirrored, {.extent = kSize}), wound(turned, {.extent = kSize});
    for (const GnMethodInfo& method : hardMethods(plain)) {
        CAPTURE(std::string(method.pName));
        for (Host* host : {&plain, &mirror, &wound})
            pinServed(*host, method);
        const std::vector<Image8> truth = drawn(plain, {});
        const size_t mirrors = farApart(drawn(mirror, {}), truth), winds = farApart(drawn(wound, {}), truth);
        MESSAGE(std::string(method.pName)
                << ": " << mirrors << " texels differ mirrored, " << winds << " wound the other way");
        CHECK(mirrors <= 12);
        // mccool asks receivers where it meets solids that are inside out, and is off along their edges.
        CHECK(winds <= (method.traits & GN_TRAIT_EXACT_BIT ? 12 : 400));
    }
}
