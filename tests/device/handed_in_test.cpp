// What a host hands in to be used in its place: an allocator for every Vulkan object, and a pipeline cache.
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <utility>

#include "device/hooks.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// Blocks behind a header: memory that is handed to another allocator, or comes from one, does not pass unseen.
struct BlockHeader {
    uint64_t mark;
    void* block;
    size_t size;
};
constexpr uint64_t kMark = 0x676e6f6d6f6e616cull;
std::atomic<int64_t> blocksAlive{0}, blocksMade{0};
std::atomic<uint32_t> strangers{0}; ///< Blocks given back that were never given out.

void* VKAPI_PTR allocate(void*, size_t size, size_t alignment, VkSystemAllocationScope)
{
    alignment = std::max(alignment, alignof(BlockHeader));
    auto* const block = static_cast<std::byte*>(std::malloc(size + sizeof(BlockHeader) + alignment));
    if (!block) return nullptr;
    const auto first = reinterpret_cast<uintptr_t>(block + sizeof(BlockHeader));
    std::byte* const memory = block + sizeof(BlockHeader) + (alignment - first % alignment) % alignment;
    const BlockHeader header{kMark, block, size};
    std::memcpy(memory - sizeof header, &header, sizeof header);
    ++blocksAlive;
    ++blocksMade;
    return memory;
}

BlockHeader headerOf(const void* memory)
{
    BlockHeader header;
    std::memcpy(&header, static_cast<const std::byte*>(memory) - sizeof header, sizeof header);
    return header;
}

void VKAPI_PTR release(void*, void* memory)
{
    if (!memory) return;
    const BlockHeader header = headerOf(memory);
    if (header.mark != kMark) {
        ++strangers;
        return;
    }
    std::memset(static_cast<std::byte*>(memory) - sizeof header, 0, sizeof header);
    --blocksAlive;
    std::free(header.block);
}

void* VKAPI_PTR reallocate(void* user, void* memory, size_t size, size_t alignment, VkSystemAllocationScope scope)
{
    if (size == 0) {
        release(user, memory);
        return nullptr;
    }
    void* const grown = allocate(user, size, alignment, scope);
    if (!grown || !memory) return grown;
    std::memcpy(grown, memory, std::min(size, headerOf(memory).size));
    release(user, memory);
    return grown;
}

constexpr VkAllocationCallbacks kAllocator = {nullptr, &allocate, &reallocate, &release, nullptr, nullptr};

std::atomic<VkPipelineCache> cacheWanted{VK_NULL_HANDLE};
std::atomic<uint32_t> pipelinesMade{0}, madeOtherwise{0}; ///< madeOtherwise: with another cache, or without one.

VKAPI_ATTR VkResult VKAPI_CALL watchedGraphics(VkDevice device, VkPipelineCache cache, uint32_t count,
                                               const VkGraphicsPipelineCreateInfo* infos,
                                               const VkAllocationCallbacks* allocator, VkPipeline* pipelines)
{
    pipelinesMade += count;
    if (cache != cacheWanted) ++madeOtherwise;
    return vkCreateGraphicsPipelines(device, cache, count, infos, allocator, pipelines);
}

VKAPI_ATTR VkResult VKAPI_CALL watchedCompute(VkDevice device, VkPipelineCache cache, uint32_t count,
                                              const VkComputePipelineCreateInfo* infos,
                                              const VkAllocationCallbacks* allocator, VkPipeline* pipelines)
{
    pipelinesMade += count;
    if (cache != cacheWanted) ++madeOtherwise;
    return vkCreateComputePipelines(device, cache, count, infos, allocator, pipelines);
}

} // namespace

TEST_CASE("every object is made and destroyed with the host's allocator")
{
    const DeviceTest test;
    blocksAlive = blocksMade = strangers = 0;
    HostOptions options{.extent = {96, 54}};
    VkAllocationCallbacks given = kAllocator;
    options.context = [&given](GnContextCreateInfo& info) { info.pAllocationCallbacks = &given; };
    {
        Scene scene = smallScene();
        scene.lights.push_back(pointLight("bulb", {1.0, 3.0, 1.0}, true));
        Host host(std::move(scene), options);
        given = {}; // copied
        for (const GnMethodInfo& method : availableMethods(host.context)) {
            CAPTURE(method.pName);
            for (size_t light = 0; light < host.lights.size(); ++light)
                if (serves(method, host.scene.lights[light].kind)) host.pin(light, method.pName);
            host.draw(2, {});
        }
        host.resize({64, 64});
        host.draw(2, {.call = Call::record});
        CHECK(blocksAlive > 0);
    }
    CHECK(blocksMade > 100); // an object or two a pipeline alone
    CHECK(blocksAlive == 0);
    CHECK(strangers == 0);
}

TEST_CASE("every pipeline is made with the host's cache, which outlives the context")
{
    const DeviceTest test;
    VkPipelineCache cache = VK_NULL_HANDLE;
    const VkPipelineCacheCreateInfo empty{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO, nullptr, 0, 0, nullptr};
    REQUIRE(vkCreatePipelineCache(device().handle, &empty, nullptr, &cache) == VK_SUCCESS);
    cacheWanted = cache;
    pipelinesMade = madeOtherwise = 0;
    HostOptions base{.extent = {96, 54}, .flags = 0, .warmAll = true}; // on worker threads
    base.context = [cache](GnContextCreateInfo& info) { info.pipelineCache = cache; };
    const HostOptions options = hooked(std::move(base), {hook("vkCreateGraphicsPipelines", &watchedGraphics),
                                                         hook("vkCreateComputePipelines", &watchedCompute)});
    size_t methods = 0;
    {
        Host host(smallScene(), options);
        host.draw(); // warms up every method
        methods = availableMethods(host.context).size();
    }
    CHECK(pipelinesMade >= methods);
    CHECK(madeOtherwise == 0);
    size_t size = 0;
    CHECK(vkGetPipelineCacheData(device().handle, cache, &size, nullptr) == VK_SUCCESS);
    CHECK(size >= 32); // its header
    vkDestroyPipelineCache(device().handle, cache, nullptr);
}

TEST_CASE("with one thread to work on, all work is done in the calls: meshes, pipelines and frames")
{
    const DeviceTest test;
    static std::atomic<int> started, elsewhere;
    static std::thread::id caller;
    started = elsewhere = 0;
    caller = std::this_thread::get_id();
    HostOptions options{.extent = {96, 54}, .flags = 0, .warmUp = false};
    options.context = [](GnContextCreateInfo& info) {
        info.jobThreadCount = 1;
        info.pfnThreadStarted = [](uint32_t, void*) { ++started; };
        info.pfnMessage = [](const GnMessage*, void*) { elsewhere += std::this_thread::get_id() != caller; };
    };
    Host host(smallScene(), options); // its floor is open: whoever makes the topology says so
    host.pin(0, "ray_traced");
    std::string serves;
    for (int frame = 0; frame < 100 && serves != "ray_traced"; ++frame) { // once its turn has come
        host.require(host.draw());
        serves = host.decision(0).pMethod ? host.decision(0).pMethod : "";
    }
    CHECK(serves == "ray_traced");
    CHECK(started == 0);
    CHECK(elsewhere == 0);
}
