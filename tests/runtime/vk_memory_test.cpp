// The allocator against a Vulkan that keeps books.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <thread>

#include "runtime/vk/memory.hpp"
#include "runtime/vk_stub.hpp"

using namespace gnomon;
using test::StubVulkan;

namespace {

constexpr VkDeviceSize kMiB = 1u << 20;
constexpr VkBufferUsageFlags kStorage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;

GpuBuffer makeBuffer(DeviceMemory& memory, VkDeviceSize size, MemoryUse use = MemoryUse::device)
{
    Result<GpuBuffer> made = memory.createBuffer(size, kStorage, use, "test.buffer");
    REQUIRE(made);
    return *made;
}

ImageCreate depthStencil(std::uint32_t layers)
{
    return {.format = VK_FORMAT_D32_SFLOAT_S8_UINT,
            .extent = {64, 64},
            .layers = layers,
            .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
            .name = "test.depth"};
}

/// A discrete GPU: its own memory, the host's in two types, and the window of its own that the host sees.
void setDiscrete(StubVulkan& stub, VkDeviceSize window)
{
    constexpr VkMemoryPropertyFlags kLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    constexpr VkMemoryPropertyFlags kHost = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    constexpr VkMemoryPropertyFlags kCached = kHost | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    stub.setMemoryTypes({kLocal, kHost, kCached, kLocal | kHost}, {8192 * kMiB, 16384 * kMiB, window}, {0, 1, 1, 2});
}

} // namespace

TEST_CASE("objects made and destroyed in any order never overlap and leave nothing behind")
{
    StubVulkan stub;
    {
        DeviceMemory memory(stub.table, 512 * kMiB, {});
        std::mt19937 random(7);
        std::vector<GpuBuffer> buffers;
        std::vector<GpuImage> images;
        VkDeviceSize expected = 0;
        for (int step = 0; step < 2000; ++step) {
            const std::uint32_t dice = static_cast<std::uint32_t>(random() % 4);
            if (dice == 0) {
                buffers.push_back(makeBuffer(memory, 1 + random() % (2 * kMiB)));
                expected += buffers.back().memory.size;
            } else if (dice == 1) {
                const std::uint32_t side = 1 + static_cast<std::uint32_t>(random() % 600);
                Result<GpuImage> image = memory.createImage(
                    {.format = VK_FORMAT_R8_UNORM, .extent = {side, side}, .usage = VK_IMAGE_USAGE_SAMPLED_BIT});
                REQUIRE(image);
                images.push_back(*image);
                expected += images.back().memory.size;
            } else if (dice == 2 && !buffers.empty()) {
                std::swap(buffers[random() % buffers.size()], buffers.back());
                expected -= buffers.back().memory.size;
                memory.destroy(buffers.back());
                buffers.pop_back();
            } else if (dice == 3 && !images.empty()) {
                std::swap(images[random() % images.size()], images.back());
                expected -= images.back().memory.size;
                memory.destroy(images.back());
                images.pop_back();
            }
            REQUIRE(memory.used() == expected);
            REQUIRE(memory.held() == stub.liveBytes());
        }
        for (GpuBuffer& buffer : buffers)
            memory.destroy(buffer);
        for (GpuImage& image : images)
            memory.destroy(image);
        CHECK(memory.used() == 0);
        CHECK(stub.live() == stub.live("memory"));
    }
    CHECK(stub.live() == 0);
    CHECK(stub.faults.empty());
}

TEST_CASE("a failure at any step of making an image leaves nothing behind")
{
    for (std::uint32_t layers : {1u, 3u}) {
        std::size_t step = 0;
        for (bool made = false; !made; ++step) {
            StubVulkan stub;
            stub.failAt = step;
            {
                DeviceMemory memory(stub.table, 512 * kMiB, {});
                Result<GpuImage> image = memory.createImage(depthStencil(layers));
                made = static_cast<bool>(image);
                if (made) {
                    memory.destroy(*image);
                } else {
                    CHECK(image.error().result == GN_ERROR_OUT_OF_HOST_MEMORY);
                    CHECK(image.error().text.find("failed") != std::string::npos);
                }
                CHECK(memory.used() == 0);
                CHECK(stub.live() == stub.live("memory"));
            }
            CHECK(stub.live() == 0);
            CHECK(stub.faults.empty());
        }
        // Image, memory, binding, array view, stencil view of a single layer, two views a layer.
        CHECK(step - 1 == 3 + 1 + (layers == 1 ? 1 : 0) + 2 * layers);
    }
}

TEST_CASE("a failure at any step of making a buffer leaves nothing behind")
{
    std::size_t step = 0;
    for (bool made = false; !made; ++step) {
        StubVulkan stub;
        stub.failAt = step;
        {
            DeviceMemory memory(stub.table, 512 * kMiB, {});
            Result<GpuBuffer> buffer = memory.createBuffer(1000, kStorage, MemoryUse::upload, "test.buffer");
            made = static_cast<bool>(buffer);
            if (made) memory.destroy(*buffer);
            CHECK(memory.used() == 0);
        }
        CHECK(stub.live() == 0);
        CHECK(stub.faults.empty());
    }
    CHECK(step - 1 == 4); // buffer, memory, mapping, binding
}

TEST_CASE("what exceeds the limit is refused with need, rest and limit")
{
    StubVulkan stub;
    DeviceMemory memory(stub.table, 512 * kMiB, {});
    GpuBuffer large = makeBuffer(memory, 503 * kMiB);
    Result<GpuBuffer> refused = memory.createBuffer(24 * kMiB, kStorage, MemoryUse::device, "test.buffer");
    REQUIRE(!refused);
    CHECK(refused.error().result == GN_ERROR_OUT_OF_DEVICE_MEMORY);
    CHECK(refused.error().id == std::string("MemoryLimit"));
    CHECK(refused.error().text == "memory: needs 24 MiB, 9 MiB left (limit 512 MiB)");
    CHECK(stub.live("buffer") == 1);
    GpuBuffer small = makeBuffer(memory, 9 * kMiB); // what was said to be left can be had
    memory.destroy(small);
    memory.destroy(large);
}

TEST_CASE("device memory never exceeds the limit, and an empty block makes way for another kind")
{
    for (VkDeviceSize limit : {VkDeviceSize(100 * 1024), kMiB, 10 * kMiB, 100 * kMiB, 700 * kMiB}) {
        StubVulkan stub;
        DeviceMemory memory(stub.table, limit, {});
        std::mt19937 random(11);
        std::vector<GpuBuffer> buffers;
        for (int i = 0; i < 300; ++i) {
            Result<GpuBuffer> made =
                memory.createBuffer(1 + random() % (limit / 3), kStorage, MemoryUse::device, "test.buffer");
            if (made) buffers.push_back(*made);
            REQUIRE(stub.liveBytes() <= limit);
        }
        CHECK(buffers.size() >= 3);
        for (GpuBuffer& buffer : buffers)
            memory.destroy(buffer);
        const auto side = static_cast<std::uint32_t>(std::min<VkDeviceSize>(limit / 4 / 128, 16384));
        Result<GpuImage> image = memory.createImage(
            {.format = VK_FORMAT_R32_SFLOAT, .extent = {side, 126}, .usage = VK_IMAGE_USAGE_SAMPLED_BIT});
        REQUIRE(image); // almost the whole limit for the smaller ones
        CHECK(stub.liveBytes() <= limit);
        memory.destroy(*image);
    }
}

TEST_CASE("under a small limit a small buffer leaves room for images, and for memory that the host reads")
{
    for (const VkDeviceSize limit : {kMiB, 4 * kMiB, 7 * kMiB}) {
        CAPTURE(limit);
        StubVulkan stub;
        setDiscrete(stub, 8192 * kMiB);
        DeviceMemory memory(stub.table, limit, {});
        GpuBuffer vertices = makeBuffer(memory, 1000), constants = makeBuffer(memory, 1000, MemoryUse::upload),
                  results = makeBuffer(memory, 1000, MemoryUse::readback);
        Result<GpuImage> map = memory.createImage(
            {.format = VK_FORMAT_R32_SFLOAT, .extent = {256, 256}, .usage = VK_IMAGE_USAGE_SAMPLED_BIT});
        REQUIRE(map); // 256 KiB
        CHECK(stub.liveBytes() <= limit);
        memory.destroy(*map);
        for (GpuBuffer* buffer : {&vertices, &constants, &results})
            memory.destroy(*buffer);
    }
}

TEST_CASE("a hole is filled again, without new memory and at the same place")
{
    StubVulkan stub;
    DeviceMemory memory(stub.table, 512 * kMiB, {});
    GpuBuffer a = makeBuffer(memory, kMiB), b = makeBuffer(memory, 3 * kMiB), c = makeBuffer(memory, kMiB);
    const VkDeviceSize hole = b.memory.offset;
    memory.destroy(b);
    GpuBuffer d = makeBuffer(memory, 3 * kMiB);
    CHECK(d.memory.offset == hole);
    CHECK(stub.counts["vkAllocateMemory"] == 1);
    for (GpuBuffer* buffer : {&a, &c, &d})
        memory.destroy(*buffer);
}

TEST_CASE("neighbouring holes become one, in whatever order they appear")
{
    std::vector<std::size_t> order{0, 1, 2, 3};
    do {
        StubVulkan stub;
        DeviceMemory memory(stub.table, 512 * kMiB, {});
        std::vector<GpuBuffer> buffers;
        for (int i = 0; i < 4; ++i)
            buffers.push_back(makeBuffer(memory, 8 * kMiB));
        GpuBuffer rest = makeBuffer(memory, 32 * kMiB); // the block is full
        for (std::size_t i : order)
            memory.destroy(buffers[i]);
        GpuBuffer all = makeBuffer(memory, 32 * kMiB);
        CHECK(all.memory.offset == 0);
        CHECK(stub.counts["vkAllocateMemory"] == 1);
        memory.destroy(all);
        memory.destroy(rest);
    } while (std::next_permutation(order.begin(), order.end()));
}

TEST_CASE("one empty block stays, the others and large single ones go at once")
{
    StubVulkan stub;
    DeviceMemory memory(stub.table, 1024 * kMiB, {});
    std::vector<GpuBuffer> buffers;
    for (int i = 0; i < 6; ++i) // two a block
        buffers.push_back(makeBuffer(memory, 32 * kMiB));
    CHECK(stub.live("memory") == 3);
    for (GpuBuffer& buffer : buffers)
        memory.destroy(buffer);
    CHECK(memory.held() == 64 * kMiB);
    GpuBuffer again = makeBuffer(memory, 32 * kMiB);
    CHECK(stub.counts["vkAllocateMemory"] == 3);
    memory.destroy(again);

    GpuBuffer large = makeBuffer(memory, 40 * kMiB);
    CHECK(memory.held() == 104 * kMiB);
    memory.destroy(large);
    CHECK(memory.held() == 64 * kMiB);
}

TEST_CASE("a nearly full heap still gives what is needed")
{
    StubVulkan stub;
    stub.heapSize = 10 * kMiB;
    DeviceMemory memory(stub.table, 512 * kMiB, {});
    GpuBuffer buffer = makeBuffer(memory, 6 * kMiB);
    CHECK(memory.held() == 6 * kMiB);
    Result<GpuBuffer> refused = memory.createBuffer(6 * kMiB, kStorage, MemoryUse::device, "test.buffer");
    REQUIRE(!refused);
    CHECK(refused.error().id == std::string("OutOfDeviceMemory"));
    memory.destroy(buffer);
}

TEST_CASE("buffers and images live in different blocks")
{
    StubVulkan stub;
    DeviceMemory memory(stub.table, 512 * kMiB, {});
    GpuBuffer buffer = makeBuffer(memory, 1000);
    Result<GpuImage> image = memory.createImage(depthStencil(1));
    REQUIRE(image);
    CHECK(stub.memoryOf(buffer.buffer) != stub.memoryOf(image->image));
    memory.destroy(*image);
    memory.destroy(buffer);
}

TEST_CASE("each use finds its memory type")
{
    struct Device {
        VkDeviceSize window; // of device-local memory that the host sees
        std::uint32_t upload;
    };
    for (const Device device : {Device{256 * kMiB, 1}, Device{8192 * kMiB, 3}}) {
        StubVulkan stub;
        setDiscrete(stub, device.window);
        DeviceMemory memory(stub.table, 512 * kMiB, {});
        GpuBuffer own = makeBuffer(memory, 100, MemoryUse::device);
        GpuBuffer up = makeBuffer(memory, 100, MemoryUse::upload);
        GpuBuffer down = makeBuffer(memory, 100, MemoryUse::readback);
        CHECK(stub.typeOf(stub.memoryOf(own.buffer)) == 0);
        CHECK(stub.typeOf(stub.memoryOf(up.buffer)) == device.upload);
        CHECK(stub.typeOf(stub.memoryOf(down.buffer)) == 2);
        CHECK(own.mapped == nullptr);
        CHECK(up.mapped != nullptr);
        CHECK(down.mapped != nullptr);
        for (GpuBuffer* buffer : {&own, &up, &down})
            memory.destroy(*buffer);
    }
}

TEST_CASE("where a heap is full, the next best memory type serves")
{
    StubVulkan stub;
    setDiscrete(stub, 8192 * kMiB);
    stub.fullTypes = 1u << 0 | 1u << 3; // all of the device's own
    DeviceMemory memory(stub.table, 512 * kMiB, {});
    GpuBuffer own = makeBuffer(memory, 100, MemoryUse::device);
    GpuBuffer up = makeBuffer(memory, 100, MemoryUse::upload);
    GpuBuffer large = makeBuffer(memory, 100 * kMiB, MemoryUse::upload);
    CHECK(stub.typeOf(stub.memoryOf(own.buffer)) != 0);
    CHECK(stub.typeOf(stub.memoryOf(up.buffer)) == 1);
    CHECK(stub.typeOf(stub.memoryOf(large.buffer)) == 1);
    CHECK(own.mapped == nullptr);
    CHECK(up.mapped != nullptr);
    stub.fullTypes = 0; // the heap has room again
    GpuBuffer later = makeBuffer(memory, 100, MemoryUse::device);
    CHECK(stub.typeOf(stub.memoryOf(later.buffer)) == 0);
    for (GpuBuffer* buffer : {&own, &up, &large, &later})
        memory.destroy(*buffer);
    CHECK(stub.faults.empty());
}

TEST_CASE("where every heap is full, the answer is the first, and nothing is left behind")
{
    StubVulkan stub;
    setDiscrete(stub, 8192 * kMiB);
    stub.fullTypes = 0xf;
    DeviceMemory memory(stub.table, 512 * kMiB, {});
    Result<GpuBuffer> refused = memory.createBuffer(100, kStorage, MemoryUse::upload, "test.buffer");
    REQUIRE(!refused);
    CHECK(refused.error().id == std::string("OutOfDeviceMemory"));
    CHECK(stub.live() == 0);
    CHECK(memory.held() == 0);
}

TEST_CASE("what our own limit refuses is not looked for in other memory types")
{
    StubVulkan stub;
    setDiscrete(stub, 8192 * kMiB);
    DeviceMemory memory(stub.table, 512 * kMiB, {});
    GpuBuffer up = makeBuffer(memory, 100, MemoryUse::upload), large = makeBuffer(memory, 440 * kMiB);
    const std::size_t before = stub.counts["vkAllocateMemory"];
    Result<GpuBuffer> refused = memory.createBuffer(20 * kMiB, kStorage, MemoryUse::device, "test.buffer");
    REQUIRE(!refused);
    CHECK(refused.error().id == std::string("MemoryLimit"));
    CHECK(stub.counts["vkAllocateMemory"] == before);
    memory.destroy(large);
    memory.destroy(up);
}

TEST_CASE("a device with one kind of memory maps every buffer, each at its own bytes")
{
    StubVulkan stub;
    DeviceMemory memory(stub.table, 512 * kMiB, {});
    GpuBuffer a = makeBuffer(memory, 1000, MemoryUse::device), b = makeBuffer(memory, 1000, MemoryUse::upload);
    REQUIRE(a.mapped != nullptr);
    CHECK(b.mapped - a.mapped == std::ptrdiff_t(b.memory.offset) - std::ptrdiff_t(a.memory.offset));
    CHECK(stub.counts["vkMapMemory"] == 1);
    memory.destroy(a);
    memory.destroy(b);
}

TEST_CASE("an image has the views its format and layers ask for")
{
    StubVulkan stub;
    DeviceMemory memory(stub.table, 512 * kMiB, {4, 4, 2});
    Result<GpuImage> depth = memory.createImage(depthStencil(1));
    REQUIRE(depth);
    CHECK(depth->stencilView != VK_NULL_HANDLE);
    CHECK(depth->layerSampled[0] != depth->layerViews[0]);
    CHECK(stub.lastImage.sharingMode == VK_SHARING_MODE_EXCLUSIVE);
    Result<GpuImage> shared = memory.createImage({.format = VK_FORMAT_R8_UNORM,
                                                  .extent = {8, 8},
                                                  .layers = 5,
                                                  .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                                                  .name = "test.shared",
                                                  .concurrent = true});
    REQUIRE(shared);
    CHECK(shared->stencilView == VK_NULL_HANDLE);
    CHECK(shared->layerViews.size() == 5);
    CHECK(shared->layerSampled == shared->layerViews);
    CHECK(stub.lastImageFamilies == std::vector<std::uint32_t>{0, 2, 4}); // ours, and each of the others once
    Result<GpuImage> copied =
        memory.createImage({.format = VK_FORMAT_R8_UNORM, .extent = {8, 8}, .usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT});
    REQUIRE(copied);
    CHECK(copied->view == VK_NULL_HANDLE); // nothing a view may be made for
    for (GpuImage* image : {&*depth, &*shared, &*copied})
        memory.destroy(*image);
    CHECK(stub.live() == stub.live("memory"));
    CHECK(stub.faults.empty());
}

TEST_CASE("an image the device cannot hold is refused by its size")
{
    StubVulkan stub;
    DeviceMemory memory(stub.table, 512 * kMiB, {});
    for (const VkExtent2D extent : {VkExtent2D{16385, 1}, VkExtent2D{0, 4}}) {
        Result<GpuImage> image = memory.createImage(
            {.format = VK_FORMAT_R8_UNORM, .extent = extent, .usage = VK_IMAGE_USAGE_SAMPLED_BIT, .name = "test.wide"});
        REQUIRE(!image);
        CHECK(image.error().result == GN_ERROR_OUT_OF_RANGE);
        CHECK(image.error().text.find("test.wide: " + std::to_string(extent.width)) == 0);
    }
    CHECK(stub.fallibleCalls == 0);
}

TEST_CASE("an image of a format that the device lacks is refused by name, and never made")
{
    StubVulkan stub;
    stub.absentFormat = VK_FORMAT_R32G32B32_SFLOAT;
    DeviceMemory memory(stub.table, 512 * kMiB, {});
    Result<GpuImage> image = memory.createImage({.format = VK_FORMAT_R32G32B32_SFLOAT,
                                                 .extent = {8, 8},
                                                 .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                                                 .name = "test.colours"});
    REQUIRE(!image);
    CHECK(image.error().result == GN_ERROR_FEATURE_MISSING);
    CHECK(image.error().text == "test.colours: the device has no images of VkFormat 106 for this use");
    CHECK(stub.fallibleCalls == 0);
}

TEST_CASE("threads that make and destroy at the same time share the blocks safely")
{
    StubVulkan stub;
    {
        DeviceMemory memory(stub.table, 512 * kMiB, {});
        const auto churn = [&memory](unsigned seed) {
            std::mt19937 random(seed);
            std::vector<GpuBuffer> buffers;
            for (int i = 0; i < 500; ++i) {
                Result<GpuBuffer> made =
                    memory.createBuffer(1 + random() % kMiB, kStorage, MemoryUse::device, "test.buffer");
                if (made) buffers.push_back(*made);
                if (buffers.size() > 8) {
                    memory.destroy(buffers[random() % 8]);
                    std::erase_if(buffers, [](const GpuBuffer& buffer) { return !buffer.buffer; });
                }
            }
            for (GpuBuffer& buffer : buffers)
                memory.destroy(buffer);
        };
        std::thread other(churn, 1u);
        churn(2u);
        other.join();
        CHECK(memory.used() == 0);
    }
    CHECK(stub.live() == 0);
    CHECK(stub.faults.empty());
}
