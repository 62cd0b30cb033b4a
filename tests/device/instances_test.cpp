// Instances by the array, and meshes whose fronts are clockwise.
#include <algorithm>
#include <limits>

#include "device/buffer_support.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr uint32_t kCount = 40;

/// A field of stones over the floor, out of the camera's sight but for their shadows.
std::vector<GnTransform> field(double shift)
{
    std::vector<GnTransform> out(kCount);
    for (uint32_t i = 0; i < kCount; ++i) {
        GnTransform& transform = out[i];
        const float size = 0.1f + 0.01f * static_cast<float>(i % 7);
        transform.basis[0] = i % 3 == 0 ? -size : size; // some are mirrored
        transform.basis[4] = transform.basis[8] = size;
        transform.translation[0] = -3.0 + 0.8 * (i % 8) + shift;
        transform.translation[1] = 2.0;
        transform.translation[2] = -2.0 + 0.9 * (i / 8);
    }
    return out;
}

GnInstanceCreateInfo stone(const Host& host)
{
    GnInstanceCreateInfo info{};
    info.pName = "stone";
    info.mesh = host.meshes[1];
    return info;
}

std::vector<Image8> drawn(Host& host)
{
    host.require(host.draw());
    return host.pictures();
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "instances made and moved by the array are those made and moved one by one")
{
    for (const char* method : {"shadow_map", "ray_traced", "stencil_volume"}) {
        CAPTURE(method);
        Host single(smallScene()), many(smallScene());
        std::vector<GnInstance> ones(kCount), all(kCount);
        const std::vector<GnTransform> places = field(0.0), moved = field(0.5);
        GnInstanceCreateInfo info = stone(single);
        for (uint32_t i = 0; i < kCount; ++i) {
            info.transform = places[i];
            single.require(gnCreateInstance(single.context, &info, &ones[i]));
        }
        info = stone(many);
        many.require(gnCreateInstances(many.context, &info, kCount, places.data(), all.data()));
        for (Host* host : {&single, &many})
            host->pinAll(method);
        const std::vector<Image8> before = drawn(many);
        CHECK(differences(drawn(single), before) == 0);

        for (uint32_t i = 0; i < kCount; ++i)
            single.require(gnSetInstanceTransform(single.context, ones[i], &moved[i]));
        std::ranges::reverse(all); // in any order
        std::vector<GnTransform> backwards(moved.rbegin(), moved.rend());
        many.require(gnSetInstanceTransforms(many.context, kCount, all.data(), backwards.data()));
        const std::vector<Image8> after = drawn(many);
        CHECK(differences(drawn(single), after) == 0);
        CHECK(differences(before, after) > 200);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "one wrong element of an array leaves everything as it was, and is named")
{
    Host host(smallScene());
    host.pinAll("shadow_map");
    const std::vector<Image8> empty = drawn(host);
    std::vector<GnTransform> places = field(0.0);
    places[17].basis[4] = 0.0f;
    std::vector<GnInstance> all(kCount, host.instances[0]);
    GnInstanceCreateInfo info = stone(host);
    CHECK(gnCreateInstances(host.context, &info, kCount, places.data(), all.data()) == GN_ERROR_OUT_OF_RANGE);
    CHECK(host.lastError().find("pTransforms[17]: instance 'stone'") != std::string::npos);
    CHECK(std::ranges::count(all, GnInstance(VK_NULL_HANDLE)) == kCount);
    CHECK(differences(drawn(host), empty) == 0);
    info.mesh = VK_NULL_HANDLE;
    CHECK(gnCreateInstances(host.context, &info, kCount, field(0.0).data(), all.data()) == GN_ERROR_INVALID_HANDLE);
    CHECK(std::ranges::count(all, GnInstance(VK_NULL_HANDLE)) == kCount);

    info = stone(host);
    host.require(gnCreateInstances(host.context, &info, kCount, field(0.0).data(), all.data()));
    const std::vector<Image8> placed = drawn(host);
    CHECK(differences(placed, empty) > 200);
    std::vector<GnTransform> moved = field(0.5);
    moved[kCount - 1].translation[1] = std::numeric_limits<double>::infinity();
    CHECK(gnSetInstanceTransforms(host.context, kCount, all.data(), moved.data()) == GN_ERROR_INFINITE);
    CHECK(host.lastError().find("pTransforms[39]: instance 'stone': translation[1]") != std::string::npos);
    moved = field(0.5);
    gnDestroyInstance(host.context, all[3]);
    const std::vector<Image8> fewer = drawn(host);
    CHECK(gnSetInstanceTransforms(host.context, kCount, all.data(), moved.data()) == GN_ERROR_INVALID_HANDLE);
    CHECK(host.lastError().find("pInstances[3]") != std::string::npos);
    CHECK(differences(drawn(host), fewer) == 0);
    CHECK(gnSetInstanceTransforms(host.context, kCount, nullptr, moved.data()) == GN_ERROR_NULL_ARGUMENT);
    CHECK(gnCreateInstances(host.context, &info, kCount, nullptr, all.data()) == GN_ERROR_NULL_ARGUMENT);
}

TEST_CASE_FIXTURE(DeviceTest, "opacity is asked about the corners as the host gave them, clockwise or not")
{
    Host host(smallScene());
    host.pinAll("ray_traced");
    const demo::Mesh plate = demo::makeBox({.size = {2.0f, 0.1f, 2.0f}});
    const auto picture = [&](GnMesh mesh, PFN_gnOpacity opacity) {
        GnInstanceCreateInfo info{};
        info.flags = GN_INSTANCE_ALPHA_TESTED_BIT;
        info.mesh = mesh;
        info.transform.translation[1] = 3.0;
        info.pfnOpacity = opacity;
        GnInstance instance = VK_NULL_HANDLE;
        host.require(gnCreateInstance(host.context, &info, &instance));
        std::vector<Image8> out = drawn(host);
        gnDestroyInstance(host.context, instance);
        return out;
    };
    const GnMesh plain = createOfArrays(host, plate);
    const GnMesh turned = createOfArrays(host, clockwise(plate), VK_FRONT_FACE_CLOCKWISE);
    const PFN_gnOpacity second = [](uint32_t, float u, float v, void*) { return u > v ? 1.0f : 0.0f; };
    const PFN_gnOpacity third = [](uint32_t, float u, float v, void*) { return v > u ? 1.0f : 0.0f; };
    const std::vector<Image8> half = picture(plain, second);
    CHECK(differences(half, picture(turned, third)) <= 4); // ties
    CHECK(differences(half, picture(plain, third)) > 100);
}

TEST_CASE_FIXTURE(DeviceTest, "a closed mesh whose fronts are not those that the host says is reported by name")
{
    const demo::Mesh box = demo::makeBox({.size = {1.0f, 1.0f, 1.0f}});
    const auto remarks = [](const demo::Mesh& mesh, VkFrontFace frontFace) {
        Host host(smallScene());
        createOfArrays(host, mesh, frontFace);
        return host.takeMessages();
    };
    CHECK(remarks(box, VK_FRONT_FACE_COUNTER_CLOCKWISE).empty());
    CHECK(remarks(clockwise(box), VK_FRONT_FACE_CLOCKWISE).empty());
    for (const bool turned : {false, true}) {
        const std::vector<std::string> said =
            turned ? remarks(clockwise(box), VK_FRONT_FACE_COUNTER_CLOCKWISE) : remarks(box, VK_FRONT_FACE_CLOCKWISE);
        REQUIRE(said.size() == 1);
        CHECK(said[0].find("MeshInsideOut: mesh 'arrays' is inside out") == 0);
        CHECK(said[0].find("the other way than frontFace says") != std::string::npos);
    }
}
