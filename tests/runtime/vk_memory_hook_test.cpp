// Blocks of the host's own memory, which it may get wrong.
#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "runtime/vk/memory.hpp"
#include "runtime/vk_stub.hpp"

using namespace gnomon;
using test::StubVulkan;

namespace {

constexpr VkDeviceSize kMiB = 1u << 20, kHeapSize = 8 * kMiB, kGrain = 4096;

/// A host with one VkDeviceMemory for everything, which it cuts into blocks from the front.
struct OneHeap {
    VkDeviceMemory memory = VK_NULL_HANDLE;
    std::byte* bytes = nullptr;
    VkDeviceSize next = 1; ///< Nothing is aligned by chance.
    std::vector<GnMemoryBlock> given;
    // What it gets wrong.
    bool noMemory = false, noMapping = false, badOffset = false;

    OneHeap(StubVulkan& stub)
    {
        stub.table.properties.limits.bufferImageGranularity = kGrain;
        stub.table.hostAllocateMemory = &give;
        stub.table.hostFreeMemory = &take;
        stub.table.hostUserData = this;
        const VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, kHeapSize, 0};
        void* mapped = nullptr;
        REQUIRE(stub.table.vkAllocateMemory(VK_NULL_HANDLE, &info, nullptr, &memory) == VK_SUCCESS);
        REQUIRE(stub.table.vkMapMemory(VK_NULL_HANDLE, memory, 0, VK_WHOLE_SIZE, 0, &mapped) == VK_SUCCESS);
        bytes = static_cast<std::byte*>(mapped);
    }

    static VkResult GN_CALL give(const GnMemoryRequest* request, GnMemoryBlock* block, void* user)
    {
        auto& self = *static_cast<OneHeap*>(user);
        const VkDeviceSize offset = (self.next + request->alignment - 1) / request->alignment * request->alignment;
        if (offset + request->size > kHeapSize) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
        block->memory = self.noMemory ? VkDeviceMemory(VK_NULL_HANDLE) : self.memory;
        block->offset = offset + (self.badOffset ? 4 : 0);
        if (request->mapped && !self.noMapping) block->pMapped = self.bytes + offset;
        if (block->memory) self.given.push_back(*block);
        self.next = offset + request->size + 1;
        return VK_SUCCESS;
    }
    static void GN_CALL take(const GnMemoryBlock* block, void* user)
    {
        auto& self = *static_cast<OneHeap*>(user);
        const auto known = std::find_if(self.given.begin(), self.given.end(), [block](const GnMemoryBlock& each) {
            return each.memory == block->memory && each.offset == block->offset && each.pMapped == block->pMapped;
        });
        REQUIRE(known != self.given.end());
        self.given.erase(known);
    }
};

Result<GpuBuffer> uploadBuffer(DeviceMemory& memory, VkDeviceSize size)
{
    return memory.createBuffer(size, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, MemoryUse::upload, "test.buffer");
}

} // namespace

TEST_CASE("blocks of the host's lie apart, slices in them are aligned and mapped where they are")
{
    StubVulkan stub;
    OneHeap heap(stub);
    {
        DeviceMemory memory(stub.table, 8 * kMiB, {});
        std::vector<GpuBuffer> buffers;
        for (const VkDeviceSize size : {1000u, 70000u, 900000u, 12u}) {
            Result<GpuBuffer> made = uploadBuffer(memory, size);
            REQUIRE(made);
            CHECK(made->memory.offset % stub.alignment == 0);
            CHECK(made->mapped == heap.bytes + made->memory.offset);
            CHECK(stub.memoryOf(made->buffer) == heap.memory);
            buffers.push_back(*made);
        }
        Result<GpuImage> image = memory.createImage(
            {.format = VK_FORMAT_R8_UNORM, .extent = {64, 64}, .usage = VK_IMAGE_USAGE_SAMPLED_BIT, .name = "image"});
        REQUIRE(image);
        CHECK(image->memory.offset / kGrain > (buffers[0].memory.offset + 1000) / kGrain);
        CHECK(stub.counts["vkAllocateMemory"] == 1); // the heap
        memory.destroy(*image);
        for (GpuBuffer& buffer : buffers)
            memory.destroy(buffer);
    }
    CHECK(heap.given.empty());
    CHECK(stub.faults.empty());
}

TEST_CASE("a limit that is no multiple of the host's grain is kept")
{
    StubVulkan stub;
    OneHeap heap(stub);
    DeviceMemory memory(stub.table, 10 * kGrain + 100, {});
    std::vector<GpuBuffer> buffers;
    for (int i = 0; i < 20; ++i) {
        if (const Result<GpuBuffer> made = uploadBuffer(memory, kGrain - 1)) buffers.push_back(*made);
        REQUIRE(memory.held() <= memory.limit());
    }
    CHECK(buffers.size() >= 5);
    for (GpuBuffer& buffer : buffers)
        memory.destroy(buffer);
}

TEST_CASE("a block that cannot serve is given back, and the error says what is wrong with it")
{
    struct Fault {
        bool OneHeap::*which;
        const char* words;
    };
    for (const Fault& fault :
         {Fault{&OneHeap::noMemory, "memory is null"}, Fault{&OneHeap::noMapping, "pMapped is null"},
          Fault{&OneHeap::badOffset, "offset is 1056772, no multiple of 4096"}}) {
        StubVulkan stub;
        OneHeap heap(stub);
        heap.*fault.which = true;
        DeviceMemory memory(stub.table, 8 * kMiB, {});
        const Result<GpuBuffer> made = uploadBuffer(memory, 1000);
        REQUIRE(!made);
        CHECK(made.error().result == GN_ERROR_OUT_OF_DEVICE_MEMORY);
        CHECK(made.error().id == std::string("MemoryHook"));
        CAPTURE(made.error().text);
        CHECK(made.error().text.find(std::string("pfnAllocateMemory: ") + fault.words) == 0);
        CHECK(heap.given.empty());
        CHECK(memory.held() == 0);
        CHECK(stub.live() == 1); // the heap
    }
}

TEST_CASE("where the host has no room for a reserve, it is asked for what is needed")
{
    StubVulkan stub;
    OneHeap heap(stub);
    heap.next = 8 * kMiB - 3 * kGrain;
    DeviceMemory memory(stub.table, 512 * kMiB, {});
    Result<GpuBuffer> made = uploadBuffer(memory, kGrain);
    REQUIRE(made);
    CHECK(memory.held() == kGrain);
    memory.destroy(*made);
}
