#pragma once
// A scene of one mesh, seen by a camera and lit by one light, as tests of hybrids ask it without a device: what the
// host would hand over, and what the brute force is told of the same.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "algorithms/shared/receivers.hpp"
#include "runtime/brute_force.hpp"
#include "runtime/frame/camera_view.hpp"
#include "runtime/ray_fixture.hpp"

namespace gnomon::test {

constexpr int kWidth = 160, kHeight = 120;

inline void addBox(std::vector<glm::vec3>& corners, std::vector<std::uint32_t>& indices, const glm::mat4& worldFromBox)
{
    const auto base = static_cast<std::uint32_t>(corners.size());
    for (unsigned i = 0; i < 8; ++i)
        corners.emplace_back(worldFromBox *
                             glm::vec4(i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f, 1.0f));
    for (const std::uint32_t v :
         {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5})
        indices.push_back(base + v);
}

/// Bumpy ground, a wall of one centimetre, tilted boxes, and loose triangles in the air.
inline TracedMesh makeScene(RayScene& rays)
{
    std::vector<glm::vec3> corners;
    std::vector<std::uint32_t> indices;
    constexpr std::uint32_t side = 16;
    for (std::uint32_t z = 0; z <= side; ++z) {
        for (std::uint32_t x = 0; x <= side; ++x)
            corners.emplace_back(2.0f * static_cast<float>(x) - 16.0f, 0.3f * std::sin(static_cast<float>(x * z)),
                                 2.0f * static_cast<float>(z) - 16.0f);
    }
    for (std::uint32_t z = 0; z < side; ++z) {
        for (std::uint32_t x = 0; x < side; ++x) {
            const std::uint32_t a = z * (side + 1) + x, b = a + 1, c = a + side + 1, d = c + 1;
            indices.insert(indices.end(), {a, c, b, b, c, d});
        }
    }
    const glm::mat4 one(1.0f);
    addBox(corners, indices, glm::scale(glm::translate(one, {-3, 1.5f, 0}), {0.005f, 1.5f, 3.0f}));
    for (int i = 0; i < 4; ++i) {
        const auto f = static_cast<float>(i);
        addBox(corners, indices,
               glm::rotate(glm::translate(one, {3.0f * f - 4.0f, 0.9f, f - 5.0f}), 0.7f * f + 0.2f, {1, 2, 0.5f}));
    }
    std::mt19937 random(11);
    for (const glm::vec3& corner : randomTriangles(random, 150, 7.0f, 1.2f)) {
        indices.push_back(static_cast<std::uint32_t>(corners.size()));
        corners.push_back(corner + glm::vec3(0, 9.5f, 0));
    }
    return TracedMesh(rays, std::move(corners), std::move(indices));
}

struct Camera {
    GnDepthConvention convention = GN_DEPTH_REVERSED_INFINITE;
    glm::dvec3 eye{0.0, 5.0, 14.0}; ///< Relative to the scene.
    double place[3]{};              ///< World position of the scene's zero.
    bool normals = true;
};

/// What the host would hand over and what the brute force is told, of the same camera. The frame's origin is the
/// scene's zero, so that both speak of the same coordinates.
struct Seen {
    brute::View truth;
    CameraView view;
    std::vector<float> depth;
    std::vector<glm::vec4> normals;

    std::span<const std::byte> normalBytes() const { return std::as_bytes(std::span<const glm::vec4>(normals)); }
};

inline Seen look(const Camera& camera, std::span<const brute::Triangle> triangles)
{
    GnViewFrame frame{};
    const glm::mat4 viewFromWorld = glm::lookAt(glm::vec3(camera.eye), glm::vec3(0, 1, 0), glm::vec3(0, 1, 0));
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            frame.viewFromWorld[3 * row + column] = viewFromWorld[column][row];
    }
    constexpr float focal = 1.4f, near = 0.1f, far = 200.0f;
    frame.projection[0] = focal * kHeight / kWidth;
    frame.projection[5] = -focal;
    frame.projection[8] = 0.013f; // jitter
    frame.projection[11] = -1.0f;
    const bool standard = camera.convention == GN_DEPTH_STANDARD;
    frame.projection[10] = standard ? far / (near - far) : 0.0f;
    frame.projection[14] = standard ? far * near / (near - far) : near;
    frame.depthConvention = camera.convention;
    frame.depthFormat = VK_FORMAT_D32_SFLOAT;
    frame.imageExtent = {kWidth, kHeight};
    frame.normalFormat = VK_FORMAT_R32G32B32A32_SFLOAT;
    if (camera.normals) frame.normalImage = reinterpret_cast<VkImage>(std::uintptr_t{1});
    const std::array<double, 3> origin{camera.place[0], camera.place[1], camera.place[2]};
    for (int i = 0; i < 3; ++i)
        frame.eye[i] = camera.eye[i] + camera.place[i];

    Seen seen;
    seen.view = makeCameraView(frame, origin, 0);
    for (int i = 0; i < 3; ++i)
        seen.truth.eye[i] = frame.eye[i] - origin[std::size_t(i)];
    std::copy(std::begin(frame.viewFromWorld), std::end(frame.viewFromWorld), seen.truth.viewFromWorld.begin());
    std::copy(std::begin(frame.projection), std::end(frame.projection), seen.truth.projection.begin());
    seen.truth.width = kWidth;
    seen.truth.height = kHeight;
    seen.truth.convention = camera.convention;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const brute::Surface surface = brute::surfaceAt(seen.truth, triangles, x, y);
            seen.depth.push_back(surface.depth);
            seen.normals.emplace_back(surface.normal, 0.0f);
        }
    }
    return seen;
}

struct LightPair {
    brute::Light truth;
    LightView view;
};

inline LightPair makeLight(GnLightType type, glm::dvec3 position, glm::dvec3 direction, double range, double cone)
{
    LightPair light;
    light.truth = {type, position, direction, range, cone};
    light.view.type = type;
    light.view.coneAngle = static_cast<float>(cone);
    light.view.constants.positionWs = glm::vec4(glm::vec3(position), type == GN_LIGHT_TYPE_DIRECTIONAL ? 0.0f : 1.0f);
    light.view.constants.directionWs = glm::vec4(
        glm::vec3(glm::normalize(direction)), type == GN_LIGHT_TYPE_SPOT ? static_cast<float>(std::cos(cone)) : -2.0f);
    light.view.constants.range = range > 0.0 ? static_cast<float>(range) : std::numeric_limits<float>::max();
    light.view.constants.type = static_cast<gpu::uint>(type);
    return light;
}

} // namespace gnomon::test
