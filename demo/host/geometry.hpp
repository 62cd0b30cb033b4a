#pragma once
// A scene's meshes on the device, and where everything stands at one time.

#include <vector>

#include "demo/host/vulkan.hpp"
#include "demo/scene/scene.hpp"

namespace gnomon::demo {

/// A mesh's part of the shared buffers.
struct MeshRange {
    uint32_t firstIndex = 0;
    uint32_t indexCount = 0;
    int32_t vertexOffset = 0;
    uint32_t firstTriangle = 0;         ///< In the table of normals.
    bool closed = false;                ///< Every edge is used once in each direction: back faces cannot be seen.
    glm::vec3 lower{0.0f}, upper{0.0f}; ///< Object space.
};

struct SceneGeometry {
    SceneGeometry(const Device& device, const Scene& scene);

    Buffer positions; ///< 12 bytes each.
    Buffer indices;   ///< uint32, relative to the mesh's vertexOffset.
    Buffer normals;   ///< vec4 per triangle: object space, unit, computed in double.
    std::vector<MeshRange> meshes;
};

/// The scene at one time.
struct SceneState {
    std::vector<Transform> instances;
    std::vector<LightState> lights;
    std::vector<uint32_t> present; ///< Indices of the lights that are there, in order: layer i is present[i].
};

SceneState stateAt(const Scene& scene, double time);

/// Camera matrices in the forms that Vulkan, the shaders and gnomon want. Relative to the eye.
struct CameraMatrices {
    glm::dvec3 eye{0.0};
    glm::mat3 viewFromWorld{1.0f}; ///< Rotation.
    glm::mat4 projection{1.0f};    ///< clipFromView.
    glm::mat4 clipFromEye{1.0f};   ///< World axes, origin at the eye.
    float depthScale = 0.0f;       ///< Linear depth = depthScale / (depth + depthAdd).
    float depthAdd = 0.0f;
    float skyDepth = 0.0f;
    glm::vec3 rayCorner{0.0f}, rayDx{0.0f}, rayDy{0.0f}; ///< View ray of linear depth 1 per pixel coordinate.
};

CameraMatrices cameraMatrices(const Scene& scene, const CameraState& camera, VkExtent2D extent);

/// Whether the host draws both sides of an instance. Through the holes of an alpha-tested mesh its back is seen.
bool drawsBothSides(const Instance& instance, const MeshRange& mesh);

/// Triangles of an instance that mirrors go round the other way; their fronts stay fronts.
VkFrontFace frontFaceOf(const Transform& transform);

/// Conservative: false only where no point of the box can be on the screen.
bool onScreen(const CameraMatrices& camera, const MeshRange& mesh, const Transform& transform);

} // namespace gnomon::demo
