#include "demo/host/geometry.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "demo/host/device.hpp"

namespace gnomon::demo {
namespace {

// Each directed edge must appear once, and so must its opposite.
bool isClosed(const Mesh& mesh)
{
    std::vector<uint64_t> edges;
    edges.reserve(mesh.indices.size());
    for (size_t i = 0; i < mesh.indices.size(); i += 3)
        for (size_t k = 0; k < 3; ++k)
            edges.push_back(uint64_t(mesh.indices[i + k]) << 32 | mesh.indices[i + (k + 1) % 3]);
    std::sort(edges.begin(), edges.end());
    if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return false;
    return std::all_of(edges.begin(), edges.end(),
                       [&](uint64_t e) { return std::binary_search(edges.begin(), edges.end(), e << 32 | e >> 32); });
}

glm::vec4 triangleNormal(const Mesh& mesh, size_t firstIndex)
{
    const glm::dvec3 a(mesh.positions[mesh.indices[firstIndex]]);
    const glm::dvec3 b(mesh.positions[mesh.indices[firstIndex + 1]]);
    const glm::dvec3 c(mesh.positions[mesh.indices[firstIndex + 2]]);
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double length = glm::length(n);
    return length > 0.0 ? glm::vec4(glm::vec3(n / length), 0.0f) : glm::vec4(0.0f, 1.0f, 0.0f, 0.0f);
}

} // namespace

SceneGeometry::SceneGeometry(const Device& device, const Scene& scene)
{
    size_t vertexCount = 0, indexCount = 0;
    for (const Mesh& mesh : scene.meshes) {
        vertexCount += mesh.positions.size();
        indexCount += mesh.indices.size();
    }
    positions = makeBuffer(device, vertexCount * sizeof(glm::vec3), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
    indices = makeBuffer(device, indexCount * sizeof(uint32_t), VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    normals = makeBuffer(device, indexCount / 3 * sizeof(glm::vec4), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);

    size_t vertex = 0, index = 0;
    for (const Mesh& mesh : scene.meshes) {
        MeshRange range{.firstIndex = static_cast<uint32_t>(index),
                        .indexCount = static_cast<uint32_t>(mesh.indices.size()),
                        .vertexOffset = static_cast<int32_t>(vertex),
                        .firstTriangle = static_cast<uint32_t>(index / 3),
                        .closed = isClosed(mesh)};
        range.lower = glm::vec3(std::numeric_limits<float>::max());
        range.upper = -range.lower;
        for (const glm::vec3& p : mesh.positions) {
            range.lower = glm::min(range.lower, p);
            range.upper = glm::max(range.upper, p);
        }
        std::copy(mesh.positions.begin(), mesh.positions.end(), positions.as<glm::vec3>().begin() + vertex);
        std::copy(mesh.indices.begin(), mesh.indices.end(), indices.as<uint32_t>().begin() + index);
        for (size_t i = 0; i < mesh.indices.size(); i += 3)
            normals.as<glm::vec4>()[(index + i) / 3] = triangleNormal(mesh, i);
        vertex += mesh.positions.size();
        index += mesh.indices.size();
        meshes.push_back(range);
    }
}

SceneState stateAt(const Scene& scene, double time)
{
    SceneState state;
    for (const Instance& instance : scene.instances)
        state.instances.push_back(instanceAt(instance, time));
    for (size_t i = 0; i < scene.lights.size(); ++i) {
        state.lights.push_back(lightAt(scene.lights[i], time));
        if (state.lights.back().present) state.present.push_back(static_cast<uint32_t>(i));
    }
    return state;
}

CameraMatrices cameraMatrices(const Scene& scene, const CameraState& camera, VkExtent2D extent)
{
    const double aspect = double(extent.width) / double(extent.height);
    const glm::dmat3 rotation(viewFromWorld(camera));
    const glm::dmat4 projection = clipFromView(scene.depth, camera.verticalFov, aspect);

    CameraMatrices out;
    out.eye = camera.eye;
    out.viewFromWorld = glm::mat3(rotation);
    out.projection = glm::mat4(projection);
    out.clipFromEye = glm::mat4(projection * glm::dmat4(rotation));
    // depth = (a z + b) / w with w = -z: depth = b / w - a.
    out.depthScale = static_cast<float>(projection[3][2]);
    out.depthAdd = static_cast<float>(projection[2][2]);
    out.skyDepth = scene.depth.convention == DepthConvention::Standard ? 1.0f : 0.0f;

    const glm::dmat3 worldFromView = glm::transpose(rotation);
    const auto ray = [&](double pixelX, double pixelY) {
        const double ndcX = 2.0 * pixelX / extent.width - 1.0, ndcY = 2.0 * pixelY / extent.height - 1.0;
        return worldFromView * glm::dvec3((ndcX + projection[2][0]) / projection[0][0],
                                          (ndcY + projection[2][1]) / projection[1][1], -1.0);
    };
    out.rayCorner = ray(0.0, 0.0);
    out.rayDx = ray(1.0, 0.0) - ray(0.0, 0.0);
    out.rayDy = ray(0.0, 1.0) - ray(0.0, 0.0);
    return out;
}

bool drawsBothSides(const Instance& instance, const MeshRange& mesh)
{
    if (instance.sides == Sides::ByMesh) return !mesh.closed || instance.alphaTested;
    return instance.sides == Sides::Both;
}

VkFrontFace frontFaceOf(const Transform& transform)
{
    return transform.mirrors() ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE;
}

bool onScreen(const CameraMatrices& camera, const MeshRange& mesh, const Transform& transform)
{
    glm::bvec4 outsideAll(true); // left, right, top, bottom
    bool behindAll = true;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 os(corner & 1 ? mesh.upper.x : mesh.lower.x, corner & 2 ? mesh.upper.y : mesh.lower.y,
                           corner & 4 ? mesh.upper.z : mesh.lower.z);
        const glm::dvec4 clip = glm::dmat4(camera.clipFromEye) * glm::dvec4(transform.apply(os) - camera.eye, 1.0);
        outsideAll[0] = outsideAll[0] && clip.x < -clip.w;
        outsideAll[1] = outsideAll[1] && clip.x > clip.w;
        outsideAll[2] = outsideAll[2] && clip.y < -clip.w;
        outsideAll[3] = outsideAll[3] && clip.y > clip.w;
        behindAll = behindAll && clip.w < 0.0;
    }
    return !behindAll && !glm::any(outsideAll);
}

} // namespace gnomon::demo
