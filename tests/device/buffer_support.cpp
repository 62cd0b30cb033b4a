#include "device/buffer_support.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>
#include <utility>

namespace gnomon::test {

using namespace demo;

namespace {

constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;

Buffer filled(const std::vector<std::byte>& content)
{
    Buffer buffer = makeBuffer(device(), content.size(), kUsage);
    std::memcpy(buffer.mapped, content.data(), content.size());
    return buffer;
}

std::pair<glm::vec3, glm::vec3> boundsOf(const Mesh& mesh)
{
    glm::vec3 lower = mesh.positions.front(), upper = lower;
    for (const glm::vec3& p : mesh.positions) {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    return {lower, upper};
}

/// As Vulkan defines the format ("Fixed-Point Data Conversions").
float snorm(float value, int16_t& stored)
{
    stored = static_cast<int16_t>(std::lround(value * 32767.0f));
    return std::max(static_cast<float>(stored) / 32767.0f, -1.0f);
}

} // namespace

BufferMeshData::BufferMeshData(const Mesh& mesh, const BufferFormat& format) : decoded(mesh), format_(format)
{
    auto [lower, upper] = boundsOf(mesh);
    if (format.positions == VK_FORMAT_R16G16B16A16_SNORM) {
        bias_ = 0.5f * (lower + upper);
        scale_ = 0.5f * (upper - lower);
    }
    const size_t vertices = mesh.positions.size(), corners = mesh.indices.size();
    std::vector<std::byte> content(kBytesBefore + vertices * format.stride, std::byte{0x7f});
    for (size_t i = 0; i < vertices; ++i)
        writePosition(&content[kBytesBefore + i * format.stride], mesh.positions[i], i);
    positions = filled(content);
    std::tie(lower, upper) = boundsOf(decoded);

    const size_t size = format.indices == VK_INDEX_TYPE_UINT16 ? 2 : 4;
    std::vector<std::byte> list(kBytesBefore + (corners * size + 3) / 4 * 4, std::byte{0x7f});
    const Mesh given = format.frontFace == VK_FRONT_FACE_CLOCKWISE ? clockwise(mesh) : mesh;
    for (size_t i = 0; i < corners; ++i) {
        const auto index = static_cast<uint32_t>(static_cast<int64_t>(given.indices[i]) - format.vertexOffset);
        std::memcpy(&list[kBytesBefore + i * size], &index, size); // little-endian, as all that Vulkan runs on
    }
    indices = filled(list);

    buffers = {.positionFormat = format.positions,
               .positions = positionRange(),
               .indices = {indices.get(), kBytesBefore, list.size() - kBytesBefore},
               .indexType = format.indices,
               .vertexOffset = format.vertexOffset};
    for (int i = 0; i < 3; ++i) {
        buffers.positionScale[i] = scale_[i];
        buffers.positionBias[i] = bias_[i];
        buffers.boundsMin[i] = lower[i];
        buffers.boundsMax[i] = upper[i];
    }
}

VkDescriptorBufferInfo BufferMeshData::positionRange() const
{
    return {positions.get(), kBytesBefore, positions.size - kBytesBefore};
}

void BufferMeshData::writePosition(std::byte* to, const glm::vec3& value, size_t vertex)
{
    for (int axis = 0; axis < 3; ++axis) {
        float& kept = decoded.positions[vertex][axis];
        if (format_.positions == VK_FORMAT_R32G32B32_SFLOAT) {
            std::memcpy(to + 4 * axis, &value[axis], 4);
        } else if (format_.positions == VK_FORMAT_R16G16B16A16_SFLOAT) {
            const glm::uint16 half = glm::packHalf1x16(value[axis]);
            std::memcpy(to + 2 * axis, &half, 2);
            kept = glm::unpackHalf1x16(half);
        } else {
            int16_t stored = 0;
            const float ratio = snorm((value[axis] - bias_[axis]) / scale_[axis], stored);
            std::memcpy(to + 2 * axis, &stored, 2);
            kept = ratio * scale_[axis] + bias_[axis];
        }
    }
}

GnMeshCreateInfo BufferMeshData::info(GnMeshFlags flags) const
{
    GnMeshCreateInfo info{};
    info.pName = format_.name;
    info.positionCount = static_cast<uint32_t>(decoded.positions.size());
    info.positionStride = format_.stride;
    info.indexCount = static_cast<uint32_t>(decoded.indices.size());
    info.pBuffers = &buffers;
    info.frontFace = format_.frontFace;
    info.flags = flags;
    return info;
}

GnMesh BufferMeshData::create(const Host& host, GnMeshFlags flags)
{
    const GnMeshCreateInfo described = info(flags);
    GnMesh mesh = VK_NULL_HANDLE;
    host.require(gnCreateMesh(host.context, &described, &mesh));
    return mesh;
}

Mesh clockwise(Mesh mesh)
{
    for (size_t i = 0; i < mesh.indices.size(); i += 3)
        std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
    return mesh;
}

void replaceMesh(const Host& host, size_t instance, GnMesh mesh)
{
    host.require(gnSetInstanceMesh(host.context, host.instances[instance], mesh));
}

GnMesh createOfArrays(const Host& host, const Mesh& mesh, VkFrontFace frontFace)
{
    GnMeshCreateInfo info{};
    info.pName = "arrays";
    info.pPositions = &mesh.positions[0].x;
    info.positionCount = static_cast<uint32_t>(mesh.positions.size());
    info.indexCount = static_cast<uint32_t>(mesh.indices.size());
    info.pIndices = mesh.indices.data();
    info.frontFace = frontFace;
    GnMesh out = VK_NULL_HANDLE;
    host.require(gnCreateMesh(host.context, &info, &out));
    return out;
}

bool readsTriangles(const GnMethodInfo& method)
{
    if (method.traits & (GN_TRAIT_TOPOLOGY_BIT | GN_TRAIT_RAYS_BIT)) return true;
    return (method.traits & GN_TRAIT_CPU_GEOMETRY_BIT) &&
           !(method.traits & (GN_TRAIT_DEVICE_RAYS_BIT | GN_TRAIT_GPU_POSITIONS_BIT));
}

Scene sceneFor(const GnMethodInfo& method)
{
    Scene scene = smallScene();
    Light& lamp = scene.lights[0];
    lamp.isStatic = false;
    lamp.kind = servedKind(method);
    if (lamp.kind == LightKind::Directional) lamp.range = 0.0f;
    if (method.traits & GN_TRAIT_SOFT_PENUMBRA_BIT) lamp.radius = 0.2f;
    return scene;
}

} // namespace gnomon::test
