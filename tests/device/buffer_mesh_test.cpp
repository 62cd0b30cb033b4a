// Meshes in the host's buffers against the same meshes in arrays, by every method there is.
#include <algorithm>
#include <cstring>
#include <limits>

#include "device/buffer_support.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr size_t kBall = 1;
// Frames until a copy for the CPU is there: one reads the buffers and copies, one finds that frame completed, and the
// next one sees what was made of it.
constexpr int kFramesToCopy = 3;

demo::Mesh ring()
{
    return demo::makeTorus({.radius = 0.7f, .tube = 0.25f, .ringSegments = 24, .tubeSegments = 12});
}

/// After a camera cut: some methods average what they see over frames.
std::vector<Image8> picturesOf(Host& host)
{
    host.require(
        host.draw({.adjust = [](GnFrameInfo&, std::vector<GnViewFrame>& views) { views[0].cameraCut = VK_TRUE; }}));
    return host.pictures(); // waits, so that the next frame finds this one completed
}

std::vector<Image8> picturesOf(Host& host, GnMesh mesh)
{
    replaceMesh(host, kBall, mesh);
    return picturesOf(host);
}

bool served(const Host& host, const std::string& method)
{
    return host.decision(0).pMethod && method == host.decision(0).pMethod;
}

/// Of the mesh, when its copy is there.
std::vector<Image8> picturesOfCopied(Host& host, GnMesh mesh, const std::string& method)
{
    replaceMesh(host, kBall, mesh);
    std::vector<Image8> pictures;
    for (int i = 0; i < kFramesToCopy; ++i)
        pictures = picturesOf(host);
    CHECK_MESSAGE(served(host, method), host.explanation(0));
    return pictures;
}

bool said(const std::vector<std::string>& messages, const std::string& words)
{
    return std::ranges::any_of(messages, [&](const std::string& text) { return text.find(words) != text.npos; });
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a mesh in buffers casts as one in arrays, in every format")
{
    constexpr VkFormat kHalf = VK_FORMAT_R16G16B16A16_SFLOAT, kSnorm = VK_FORMAT_R16G16B16A16_SNORM;
    const BufferFormat formats[] = {{.name = "floats"},
                                    {.name = "floats of a pool", .stride = 28, .vertexOffset = -77},
                                    {.name = "halves", .positions = kHalf, .stride = 8},
                                    {.name = "snorms", .positions = kSnorm, .stride = 20},
                                    {.name = "short indices", .indices = VK_INDEX_TYPE_UINT16, .vertexOffset = -5},
                                    {.name = "clockwise", .frontFace = VK_FRONT_FACE_CLOCKWISE}};
    Host host(smallScene());
    host.hide(kBall);
    for (const BufferFormat& format : formats) {
        CAPTURE(std::string(format.name));
        BufferMeshData data(ring(), format);
        const GnMesh arrays = createOfArrays(host, data.decoded), buffers = data.create(host, 0);
        for (const std::string method : {"shadow_map", "stencil_volume", "ray_traced"}) {
            CAPTURE(method);
            host.pinAll(method.c_str());
            const std::vector<Image8> expected = picturesOf(host, arrays);
            const std::vector<Image8> got = picturesOfCopied(host, buffers, method);
            MESSAGE(std::string(format.name) << ", " << method << ": " << differences(expected, got) << " differ");
            // Of snorm, Vulkan allows the last places to differ.
            CHECK(differences(expected, got) <= (format.positions == kSnorm ? 4 : 0));
            CHECK(dark(got[0]) > 300);
        }
        gnDestroyMesh(host.context, buffers);
        gnDestroyMesh(host.context, arrays);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a pool may be larger than what the device binds of a buffer at once")
{
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(device().physicalDevice, &properties);
    const VkDeviceSize size = VkDeviceSize{properties.limits.maxStorageBufferRange} + (1 << 20);
    if (size > (VkDeviceSize{1} << 29)) return; // of a device that binds all there is
    BufferMeshData data(ring(), {.name = "ring"});
    const demo::Buffer pool = demo::makeBuffer(device(), size, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    const VkDeviceSize from = size - (1 << 19);
    std::memcpy(static_cast<std::byte*>(pool.mapped) + 4, data.indices.as<std::byte>().data() + kBytesBefore,
                data.indices.size - kBytesBefore);
    std::memcpy(static_cast<std::byte*>(pool.mapped) + from, data.positions.as<std::byte>().data() + kBytesBefore,
                data.positions.size - kBytesBefore);
    data.buffers.indices = {pool.get(), 4, size - 4};
    data.buffers.positions = {pool.get(), from, size - from};
    Host host(smallScene());
    host.hide(kBall);
    host.pinAll("shadow_map");
    const std::vector<Image8> expected = picturesOf(host, createOfArrays(host, data.decoded));
    CHECK(differences(expected, picturesOf(host, data.create(host, GN_MESH_CLOSED_BIT))) == 0);
    CHECK(dark(expected[0]) > 300);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "every method shows a mesh in buffers as one in arrays, or says that the CPU may not see it")
{
    Host probe(smallScene(), {.warmUp = false});
    uint32_t onGpu = 0;
    for (const GnMethodInfo& method : availableMethods(probe.context)) {
        const std::string name = method.pName;
        CAPTURE(name);
        Scene scene = sceneFor(method);
        scene.instances[kBall].pose.scale = {-1.0, 1.1, 0.9}; // mirrored
        Host host(scene);
        host.hide(kBall);
        host.pinAll(name.c_str());
        BufferMeshData data(ring(), {.name = "ring"});
        const std::vector<Image8> expected = picturesOf(host, createOfArrays(host, data.decoded));
        REQUIRE(served(host, name));
        CHECK(dark(expected[0]) > 300);

        const GnMesh closed = data.create(host, GN_MESH_NO_CPU_COPY_BIT | GN_MESH_CLOSED_BIT);
        const std::vector<Image8> ofGpu = picturesOf(host, closed);
        if (readsTriangles(method)) {
            host.draw(kFramesToCopy, {});
            CHECK_FALSE(served(host, name));
            CHECK_MESSAGE(host.explanation(0).find("1 casters that only the GPU may read") != std::string::npos,
                          host.explanation(0));
        } else {
            ++onGpu;
            CHECK(served(host, name));
            MESSAGE(name << ": " << differences(expected, ofGpu) << " differ on the GPU alone");
            CHECK(differences(expected, ofGpu) <= 2); // receivers are rounded by the longest edge, which is not known
        }
        CHECK(differences(expected, picturesOfCopied(host, data.create(host, 0), name)) == 0);
        const GnMesh turned = createOfArrays(host, clockwise(data.decoded), VK_FRONT_FACE_CLOCKWISE);
        CHECK(differences(expected, picturesOf(host, turned)) == 0);
    }
    CHECK(onGpu >= 5);
}

TEST_CASE_FIXTURE(DeviceTest, "what is wrong in buffers is reported once, and the rest of the mesh casts")
{
    Host host(smallScene());
    host.hide(kBall);
    host.pinAll("shadow_map");
    for (const VkIndexType type : {VK_INDEX_TYPE_UINT32, VK_INDEX_TYPE_UINT16}) {
        BufferMeshData data(ring(), {.name = "torn", .indices = type});
        // The second and the last triangle, and a vertex of the third.
        const size_t size = type == VK_INDEX_TYPE_UINT16 ? 2 : 4, last = data.decoded.indices.size() - 1;
        auto* const indices = static_cast<std::byte*>(data.indices.mapped) + kBytesBefore;
        const uint32_t wrong = type == VK_INDEX_TYPE_UINT16 ? 0xffff : 0xfffffffe;
        for (const size_t corner : {size_t(4), last})
            std::memcpy(indices + corner * size, &wrong, size);
        const uint32_t vertex = data.decoded.indices[7];
        const float nan = std::numeric_limits<float>::quiet_NaN();
        std::memcpy(static_cast<std::byte*>(data.positions.mapped) + kBytesBefore + 12 * vertex, &nan, sizeof nan);

        demo::Mesh expected = data.decoded;
        expected.positions[vertex] = glm::vec3(0.0f);
        for (const size_t corner : {last - last % 3, size_t(3)})
            expected.indices.erase(expected.indices.begin() + corner, expected.indices.begin() + corner + 3);
        const std::vector<Image8> whole = picturesOf(host, createOfArrays(host, expected));
        const GnMesh torn = data.create(host, GN_MESH_NO_CPU_COPY_BIT);
        host.takeMessages();
        const std::vector<Image8> shown = picturesOf(host, torn);
        CHECK(differences(whole, shown) <= 2);
        CHECK(dark(shown[0]) > 300);
        host.draw(3, {});
        const std::vector<std::string> messages = host.takeMessages();
        CHECK(said(messages, "mesh 'torn': the index at position 4 of its buffer is not one of the 288 vertices"));
        CHECK(said(messages, "mesh 'torn': vertex " + std::to_string(vertex) + " of its buffer is not finite"));
        CHECK(messages.size() == 2);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "descriptions of meshes in buffers that cannot be read are errors that name the value")
{
    Host host(smallScene());
    const BufferMeshData data(ring(), {.name = "ring"});
    const auto refused = [&](GnResult result, const std::string& words, const auto& change, GnMeshFlags flags = 0) {
        GnMeshBuffers buffers = data.buffers;
        GnMeshCreateInfo info = data.info(flags);
        info.pBuffers = &buffers;
        change(info, buffers);
        GnMesh mesh = host.meshes[0];
        CHECK(gnCreateMesh(host.context, &info, &mesh) == result);
        CHECK(mesh == VK_NULL_HANDLE);
        CHECK_MESSAGE(host.lastError().find(words) != std::string::npos, host.lastError());
    };
    using Info = GnMeshCreateInfo;
    using Buffers = GnMeshBuffers;
    constexpr GnResult kRange = GN_ERROR_OUT_OF_RANGE, kUnsupported = GN_ERROR_UNSUPPORTED;
    refused(kRange, "positions.range is 3455; 3456 bytes are needed",
            [](Info&, Buffers& b) { b.positions.range = 3455; });
    refused(kRange, "indices.range is VK_WHOLE_SIZE; 6912 bytes",
            [](Info&, Buffers& b) { b.indices.range = VK_WHOLE_SIZE; });
    refused(kRange, "indices.range is 6908; 6912 bytes are needed", [](Info&, Buffers& b) { b.indices.range = 6908; });
    refused(kRange, "indices.range is 3454; 3456 bytes are needed", [](Info&, Buffers& b) {
        b.indexType = VK_INDEX_TYPE_UINT16;
        b.indices.range = 3454;
    });
    refused(kRange, "indices.range is 4; 6 bytes are needed", [](Info& info, Buffers& b) { // half a word before
        info.indexCount = 3;
        b.indexType = VK_INDEX_TYPE_UINT16;
        b.indices.offset = 2;
        b.indices.range = 4;
    });
    refused(kRange, "positions.offset is 6, not a multiple of 4", [](Info&, Buffers& b) { b.positions.offset = 6; });
    refused(kRange, "indices.offset is 2, not a multiple of 4", [](Info&, Buffers& b) { b.indices.offset = 2; });
    refused(kRange, "positionStride 10 is not", [](Info& info, Buffers&) { info.positionStride = 10; });
    refused(kRange, "boundsMin[1] is 4, above boundsMax[1]", [](Info&, Buffers& b) { b.boundsMin[1] = 4.0f; });
    refused(GN_ERROR_NOT_A_NUMBER, "positionScale[2] is NaN",
            [](Info&, Buffers& b) { b.positionScale[2] = std::numeric_limits<float>::quiet_NaN(); });
    refused(kUnsupported, "positionFormat 109 is none of",
            [](Info&, Buffers& b) { b.positionFormat = VK_FORMAT_R32G32B32A32_SFLOAT; });
    refused(kUnsupported, "indexType 1000265000 is neither",
            [](Info&, Buffers& b) { b.indexType = VK_INDEX_TYPE_UINT8_EXT; });
    refused(GN_ERROR_NULL_ARGUMENT, "positions.buffer is null",
            [](Info&, Buffers& b) { b.positions.buffer = VK_NULL_HANDLE; });
    refused(kRange, "indexCount is 1728 without indices, past the 288 vertices",
            [](Info&, Buffers& b) { b.indices.buffer = VK_NULL_HANDLE; });
    refused(kRange, "1727 indices are not a multiple of 3", [](Info& info, Buffers&) { info.indexCount = 1727; });
    refused(kRange, "pPositions and pBuffers are both given",
            [&](Info& info, Buffers& b) { info.pPositions = b.boundsMin; });
    refused(
        kRange, "flags has 8", [](Info&, Buffers&) {}, 8);
    refused(kRange, "frontFace is 2", [](Info& info, Buffers&) { info.frontFace = static_cast<VkFrontFace>(2); });
    refused(kRange, "GnMeshBuffers::structSize is 3", [](Info&, Buffers& b) { b.structSize = 3; });
    host.require(host.draw());
}
