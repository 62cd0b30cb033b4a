// A host that serves device memory from a heap of its own.
#include <algorithm>
#include <map>

#include "device/hooks.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

struct Heap {
    std::mutex mutex;
    std::map<const void*, VkDeviceSize> given; ///< Bytes by pAllocation.
    VkDeviceSize bytes = 0;
    uint32_t blocks = 0, faults = 0,
             past = 0;             ///< Blocks given; requests that break their promises; Vulkan's own calls.
    VkResult failure = VK_SUCCESS; ///< What it says from now on.
};
Heap heap;

struct Piece {
    VkDeviceMemory memory = VK_NULL_HANDLE;
};

VkResult GN_CALL giveMemory(const GnMemoryRequest* request, GnMemoryBlock* block, void*)
{
    const std::lock_guard lock(heap.mutex);
    const VkDeviceSize grain = device().properties.limits.bufferImageGranularity;
    const bool whole = request->size % grain == 0 && request->alignment % grain == 0;
    const bool zero = !block->memory && !block->offset && !block->pMapped && !block->pAllocation;
    if (!whole || !zero || (request->allocateFlags & ~VkFlags{VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT})) ++heap.faults;
    if (heap.failure != VK_SUCCESS) return heap.failure;
    const VkMemoryAllocateFlagsInfo flags{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                          .flags = request->allocateFlags};
    const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                    .pNext = request->allocateFlags ? &flags : nullptr,
                                    .allocationSize = request->alignment + request->size,
                                    .memoryTypeIndex = request->memoryTypeIndex};
    auto piece = std::make_unique<Piece>();
    if (const VkResult made = vkAllocateMemory(device().handle, &info, nullptr, &piece->memory); made < 0) return made;
    block->memory = piece->memory;
    block->offset = request->alignment;
    void* first = nullptr;
    if (request->mapped) {
        const VkResult result = vkMapMemory(device().handle, piece->memory, 0, VK_WHOLE_SIZE, 0, &first);
        if (result < 0) return result;
        block->pMapped = static_cast<std::byte*>(first) + block->offset;
    }
    ++heap.blocks;
    heap.bytes += request->size;
    heap.given[piece.get()] = request->size;
    block->pAllocation = piece.release();
    return VK_SUCCESS;
}

void GN_CALL takeMemory(const GnMemoryBlock* block, void*)
{
    const std::lock_guard lock(heap.mutex);
    const auto known = heap.given.find(block->pAllocation);
    const auto* piece = static_cast<const Piece*>(block->pAllocation);
    if (known == heap.given.end() || piece->memory != block->memory) {
        ++heap.faults;
        return;
    }
    heap.bytes -= known->second;
    heap.given.erase(known);
    vkFreeMemory(device().handle, piece->memory, nullptr);
    delete piece;
}

VKAPI_ATTR VkResult VKAPI_CALL allocatePast(VkDevice handle, const VkMemoryAllocateInfo* info,
                                            const VkAllocationCallbacks* allocator, VkDeviceMemory* memory)
{
    ++heap.past;
    return vkAllocateMemory(handle, info, allocator, memory);
}

HostOptions onHeap(HostOptions base = {})
{
    heap.blocks = heap.faults = heap.past = 0;
    heap.failure = VK_SUCCESS;
    base.context = [](GnContextCreateInfo& info) {
        info.pfnAllocateMemory = &giveMemory;
        info.pfnFreeMemory = &takeMemory;
    };
    return hooked(std::move(base), {hook("vkAllocateMemory", &allocatePast)});
}

Scene twoLights()
{
    Scene scene = smallScene();
    scene.lights.push_back(pointLight("bulb", {1.0, 3.0, 1.0}, true));
    return scene;
}

/// Pictures of every method, two frames each.
std::vector<Image8> everyMethod(Host& host)
{
    std::vector<Image8> all;
    for (const GnMethodInfo& method : availableMethods(host.context)) {
        for (size_t light = 0; light < host.lights.size(); ++light)
            if (serves(method, host.scene.lights[light].kind)) host.pin(light, method.pName);
        host.draw(2, {});
        for (Image8& picture : host.pictures())
            all.push_back(std::move(picture));
    }
    return all;
}

bool anySays(const std::vector<std::string>& messages, const char* words)
{
    return std::any_of(messages.begin(), messages.end(),
                       [words](const std::string& message) { return message.find(words) != std::string::npos; });
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest,
                  "all device memory comes from the host's heap and goes back to it, and pictures are the same")
{
    std::vector<Image8> expected;
    {
        Host host(twoLights(), {.extent = {96, 54}});
        expected = everyMethod(host);
    }
    {
        Host host(twoLights(), onHeap({.extent = {96, 54}}));
        CHECK(differences(everyMethod(host), expected) == 0);
        CHECK(heap.blocks > 1);
        CHECK(heap.bytes >= host.stats().memory); // of whole blocks, parts are in use
        const uint32_t blocks = heap.blocks;
        host.draw(8, {});
        CHECK(heap.blocks == blocks); // what stands still asks for nothing
    }
    CHECK(heap.given.empty());
    CHECK(heap.bytes == 0);
    CHECK(heap.past == 0);
    CHECK(heap.faults == 0);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "where the host's heap gives nothing, it is said, another method serves, and later the wanted")
{
    Host host(smallScene(), onHeap());
    host.pinAll("rbsm");
    host.draw(2, {});
    host.takeMessages();
    const uint64_t before = heap.bytes;
    heap.failure = VK_ERROR_TOO_MANY_OBJECTS;
    host.require(gnSetMethodSetting(host.context, "rbsm", "resolution", 4096.0)); // a block of its own
    CHECK(host.draw() == GN_SUCCESS);
    CHECK(anySays(host.takeMessages(), "pfnAllocateMemory: VkResult -10, asked for "));
    CHECK(heap.bytes == before);
    CHECK(std::string(host.decision(0).pMethod) == "shadow_map"); // what serves in its place
    CHECK(dark(host.pictures()[0]) > 100);
    heap.failure = VK_SUCCESS;
    host.draw(8, {});
    CHECK(host.decision(0).mapSide == 4096);
    CHECK(std::string(host.decision(0).pMethod) == "rbsm");
}

TEST_CASE("a context that gets no memory, or half of the hooks, is refused")
{
    const DeviceTest test;
    std::string told;
    GnContextCreateInfo info = device().contextInfo();
    info.pUserData = &told;
    info.pfnMessage = [](const GnMessage* message, void* user) { *static_cast<std::string*>(user) = message->pText; };
    info.pfnAllocateMemory = &giveMemory;
    GnContext context = VK_NULL_HANDLE;
    CHECK(gnCreateContext(&info, &context) == GN_ERROR_NULL_ARGUMENT);
    CHECK(told == "pfnAllocateMemory and pfnFreeMemory go together");
    info.pfnFreeMemory = &takeMemory;
    heap.failure = VK_ERROR_OUT_OF_DEVICE_MEMORY;
    CHECK(gnCreateContext(&info, &context) == GN_ERROR_OUT_OF_DEVICE_MEMORY);
    CHECK(told.find("pfnAllocateMemory: VkResult -2") != std::string::npos);
    CHECK(context == nullptr);
    heap.failure = VK_SUCCESS;
    CHECK(heap.given.empty());
}
