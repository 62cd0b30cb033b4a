#include "device/target_support.hpp"

#include <cmath>
#include <cstdlib>

namespace gnomon::test {

namespace {

using demo::CameraMatrices;
using demo::DepthConvention;

/// Reversed, with a far plane at 60 m.
void reverseFinite(CameraMatrices& camera)
{
    constexpr float nearPlane = 0.1f, farPlane = 60.0f;
    camera.projection[2][2] = nearPlane / (farPlane - nearPlane);
    camera.projection[3][2] = nearPlane * farPlane / (farPlane - nearPlane);
}

/// Standard, without a far plane.
void standardInfinite(CameraMatrices& camera)
{
    camera.projection[2][2] = -1.0f;
    camera.projection[3][2] = -0.1f;
}

/// One eye's part of a headset's view, and a shake of a third of a pixel.
void asymmetric(CameraMatrices& camera)
{
    camera.projection[2][0] = 0.23f;
    camera.projection[2][1] = -0.17f + 2.0f / 3.0f / 180.0f;
}

/// 11 m high, from 1 to 30 m before the eye.
void orthographic(CameraMatrices& camera, bool reversed)
{
    constexpr float nearPlane = 1.0f, farPlane = 30.0f;
    const float aspect = camera.projection[1][1] / camera.projection[0][0]; // -width / height
    glm::mat4& p = camera.projection;
    p = glm::mat4(0.0f);
    p[1][1] = -2.0f / 11.0f;
    p[0][0] = 2.0f / 11.0f / std::abs(aspect);
    p[2][2] = (reversed ? 1.0f : -1.0f) / (farPlane - nearPlane);
    p[3][2] = (reversed ? farPlane : -nearPlane) / (farPlane - nearPlane);
    p[3][0] = 0.05f; // off centre, and shaken
    p[3][3] = 1.0f;
}

/// What is seen is drawn from a plane on that is turned against the view; Lengyel 2005, JGD 1(2), for depths of 0 to 1.
/// It cuts the box and the ball.
void oblique(CameraMatrices& camera, bool reversed)
{
    const glm::vec4 plane(0.35f, -0.1f, -1.0f, -7.6f); // view space, positive beyond
    glm::mat4& p = camera.projection;
    // The corner of the far plane opposite to it: view space, of the standard matrix. Its depth becomes 1.
    const glm::vec4 corner((plane.x > 0.0f ? 1.0f : -1.0f) / p[0][0],
                           (plane.y > 0.0f ? 1.0f : -1.0f) / std::abs(p[1][1]), -1.0f, 1.0f / 60.0f);
    const float scale = 1.0f / glm::dot(plane, corner); // clip w there is 1
    for (int column = 0; column < 4; ++column) {
        const float depth = plane[column] * scale;
        p[column][2] = reversed ? p[column][3] - depth : depth;
    }
}

/// Cabinet projection: what is deeper is drawn farther right and up.
void sheared(CameraMatrices& camera)
{
    orthographic(camera, true);
    camera.projection[2][0] = -0.03f;
    camera.projection[2][1] = 0.04f;
}

} // namespace

Scene targetScene(DepthConvention convention, float radius)
{
    Scene scene = smallScene();
    scene.depth = {.convention = convention, .nearPlane = 0.1f, .farPlane = 60.0f};
    scene.lights.push_back(pointLight("bulb", {2.0, 5.0, -0.25}, true));
    scene.lights.push_back(scene.lights[0]);
    scene.lights[2].name = "sun";
    scene.lights[2].kind = demo::LightKind::Directional;
    for (size_t i = 0; i < 2; ++i)
        scene.lights[i].radius = radius;
    return scene;
}

FrameOptions through(const Lens& lens, const FrameOptions& rest)
{
    FrameOptions options = rest;
    options.lens = [lens](CameraMatrices& camera) {
        lens.bend(camera);
        camera.clipFromEye = camera.projection * glm::mat4(camera.viewFromWorld);
    };
    options.adjust = [lens, rest](GnFrameInfo& info, std::vector<GnViewFrame>& views) {
        for (GnViewFrame& view : views)
            view.depthConvention = lens.convention;
        if (rest.adjust) rest.adjust(info, views);
    };
    return options;
}

std::vector<Lens> lensesFor(DepthConvention convention)
{
    if (convention == DepthConvention::Standard)
        return {{"standard", [](CameraMatrices&) {}, GN_DEPTH_STANDARD},
                {"standard, infinite", &standardInfinite, GN_DEPTH_STANDARD},
                {"standard, asymmetric", &asymmetric, GN_DEPTH_STANDARD},
                {"standard, oblique", [](CameraMatrices& c) { oblique(c, false); }, GN_DEPTH_STANDARD},
                {"standard, orthographic", [](CameraMatrices& c) { orthographic(c, false); }, GN_DEPTH_STANDARD}};
    return {{"reversed, infinite", [](CameraMatrices&) {}, GN_DEPTH_REVERSED_INFINITE},
            {"reversed, finite", &reverseFinite, GN_DEPTH_REVERSED},
            {"reversed, asymmetric", &asymmetric, GN_DEPTH_REVERSED_INFINITE},
            {"reversed, oblique", [](CameraMatrices& c) { oblique(c, true); }, GN_DEPTH_REVERSED},
            {"reversed, orthographic", [](CameraMatrices& c) { orthographic(c, true); }, GN_DEPTH_REVERSED},
            {"reversed, sheared", &sheared, GN_DEPTH_REVERSED}};
}

brute::View bruteView(const Host& host, const Lens& lens, double step)
{
    demo::CameraMatrices camera = demo::cameraMatrices(host.scene, demo::cameraAt(host.scene, 0.0), host.extent());
    lens.bend(camera);
    brute::View view;
    view.eye = camera.eye;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            view.viewFromWorld[size_t(3 * row + column)] = camera.viewFromWorld[column][row];
    for (int i = 0; i < 16; ++i)
        view.projection[size_t(i)] = camera.projection[i / 4][i % 4];
    view.width = static_cast<int>(host.extent().width);
    view.height = static_cast<int>(host.extent().height);
    view.convention = lens.convention;
    view.step = step;
    return view;
}

brute::Light bruteLight(const Host& host, size_t light)
{
    const GnLightInfo info = demo::toGnLight(host.scene.lights[light], demo::lightAt(host.scene.lights[light], 0.0));
    brute::Light out;
    out.type = info.type;
    out.position = {info.position[0], info.position[1], info.position[2]};
    out.direction = {info.direction[0], info.direction[1], info.direction[2]};
    out.range = static_cast<double>(info.range);
    out.coneAngle = static_cast<double>(info.coneAngle);
    return out;
}

std::vector<brute::Triangle> bruteTriangles(const Host& host)
{
    std::vector<brute::Triangle> triangles;
    for (const demo::Instance& instance : host.scene.instances) {
        const demo::Transform transform = demo::instanceAt(instance, 0.0);
        const demo::Mesh& mesh = host.scene.meshes[instance.mesh];
        const auto world = [&](uint32_t index) {
            return transform.linear * glm::dvec3(mesh.positions[index]) + transform.translation;
        };
        for (size_t k = 0; k < mesh.indices.size(); k += 3)
            triangles.push_back({world(mesh.indices[k]), world(mesh.indices[k + 1]), world(mesh.indices[k + 2])});
    }
    return triangles;
}

double stepOf(VkFormat format)
{
    if (format == VK_FORMAT_D16_UNORM || format == VK_FORMAT_D16_UNORM_S8_UINT) return 1.0 / 65535.0;
    return format == VK_FORMAT_D24_UNORM_S8_UINT || format == VK_FORMAT_X8_D24_UNORM_PACK32 ? 1.0 / 16777215.0 : 0.0;
}

bool drawable(VkFormat format, uint32_t samples)
{
    const bool depth = (demo::aspectOf(format) & VK_IMAGE_ASPECT_DEPTH_BIT) != 0;
    VkImageFormatProperties properties{};
    const VkResult result = vkGetPhysicalDeviceImageFormatProperties(
        device().physicalDevice, format, VK_IMAGE_TYPE_2D, VK_IMAGE_TILING_OPTIMAL,
        VK_IMAGE_USAGE_SAMPLED_BIT |
            (depth ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT),
        0, &properties);
    return result == VK_SUCCESS && (properties.sampleCounts & samples) != 0;
}

size_t pinServed(Host& host, const GnMethodInfo& method)
{
    size_t served = 0;
    for (size_t i = 0; i < host.lights.size(); ++i) {
        const bool serves = test::serves(method, host.scene.lights[i].kind);
        host.pin(i, serves ? method.pName : "ray_traced");
        served += serves;
    }
    return served;
}

size_t farApart(const Image8& a, const Image8& b)
{
    REQUIRE(a.texels.size() == b.texels.size());
    size_t count = 0;
    for (size_t i = 0; i < a.texels.size(); ++i)
        count += std::abs(a.texels[i] - b.texels[i]) > 64;
    return count;
}

} // namespace gnomon::test
