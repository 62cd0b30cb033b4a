#pragma once
// Meshes of a scene in buffers of the host, in the layouts that engines have, beside the same in arrays.
#include <glm/gtc/packing.hpp>

#include "demo/host/pipelines.hpp"
#include "device/fixture.hpp"

namespace gnomon::test {

/// What lies before the mesh in its buffers, so that offsets count.
inline constexpr VkDeviceSize kBytesBefore = 20;

struct BufferFormat {
    const char* name;
    VkFormat positions = VK_FORMAT_R32G32B32_SFLOAT;
    uint32_t stride = 12;
    VkIndexType indices = VK_INDEX_TYPE_UINT32;
    int32_t vertexOffset = 0; ///< What is added to the indices has been subtracted from them.
    VkFrontFace frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
};

/// A mesh in two buffers, and the positions that these stand for.
class BufferMeshData {
public:
    BufferMeshData(const demo::Mesh& mesh, const BufferFormat& format);

    /// @param flags of GnMeshFlagBits
    GnMesh create(const Host& host, GnMeshFlags flags);
    GnMeshCreateInfo info(GnMeshFlags flags) const;
    VkDescriptorBufferInfo positionRange() const;

    demo::Mesh decoded; ///< In floats, corners counter-clockwise.
    demo::Buffer positions, indices;
    GnMeshBuffers buffers{};

private:
    void writePosition(std::byte* to, const glm::vec3& value, size_t vertex);

    BufferFormat format_;
    glm::vec3 scale_{1.0f}, bias_{0.0f};
};

/// The same triangles, their second and third corners exchanged.
demo::Mesh clockwise(demo::Mesh mesh);
/// Another mesh for one of the host's instances.
void replaceMesh(const Host& host, size_t instance, GnMesh mesh);
/// The mesh in arrays.
GnMesh createOfArrays(const Host& host, const demo::Mesh& mesh, VkFrontFace frontFace = {});
/// Whether the method reads triangles on the CPU.
bool readsTriangles(const GnMethodInfo& method);
/// Its lights are of that kind, with a surface if the method wants one.
Scene sceneFor(const GnMethodInfo& method);

} // namespace gnomon::test
