#pragma once
// A Vulkan that does nothing but keep books: what was made and not destroyed, which slices of memory are bound, and a
// failure at any chosen call. One at a time.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "runtime/vk/device_table.hpp"

namespace gnomon::test {

class StubVulkan {
public:
    StubVulkan();
    ~StubVulkan();
    StubVulkan(const StubVulkan&) = delete;
    StubVulkan& operator=(const StubVulkan&) = delete;

    DeviceTable table; ///< Filled with the stubs; one memory type, as a software device has.

    // What the stubs pretend.
    std::size_t failAt = std::numeric_limits<std::size_t>::max(); ///< Index of the fallible call that fails.
    VkResult failure = VK_ERROR_OUT_OF_HOST_MEMORY;
    VkDeviceSize heapSize = std::numeric_limits<VkDeviceSize>::max(); ///< vkAllocateMemory fails beyond it.
    std::uint32_t fullTypes = 0; ///< Bits of memory types of which vkAllocateMemory gives none.
    VkDeviceSize alignment = 256;
    VkFormat absentFormat = VK_FORMAT_UNDEFINED; ///< Of which the device has no images.
    std::string absentFunction;                  ///< Name that the loader does not know.
    std::uint32_t deviceVersion = VK_API_VERSION_1_3;
    VkQueueFlags queueFlags = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT | VK_QUEUE_TRANSFER_BIT;
    bool hasDynamicRendering = true;
    VkPhysicalDeviceFeatures deviceFeatures{};
    std::vector<const char*> deviceExtensions;
    bool hasRayQueries = true; ///< Where it lists the extensions: all features of theirs.
    bool hasBufferDeviceAddress = true;
    std::uint64_t compactSize = 0; ///< Of every structure, as queries tell it; 0: they are not ready.

    // What happened.
    std::size_t fallibleCalls = 0;
    std::map<std::string, std::size_t> counts; ///< Calls by name.
    std::vector<std::string> faults;           ///< Misuse; must stay empty.
    std::set<std::string> loaded;              ///< Names asked of the instance.
    VkImageCreateInfo lastImage{};
    std::vector<std::uint32_t> lastImageFamilies;
    VkPipelineCache lastPipelineCache = VK_NULL_HANDLE;

    std::size_t live() const; ///< Objects and memory alive.
    std::size_t live(const std::string& kind) const;
    VkDeviceSize liveBytes() const; ///< Of device memory.
    void setMemoryTypes(const std::vector<VkMemoryPropertyFlags>& types, const std::vector<VkDeviceSize>& heaps,
                        const std::vector<std::uint32_t>& heapOfType);
    void addRays(); ///< Acceleration structures, of 64 bytes a primitive and as much to build.
    std::uint32_t typeOf(VkDeviceMemory memory) const;
    VkDeviceMemory memoryOf(VkBuffer buffer) const;
    VkDeviceMemory memoryOf(VkImage image) const;

    static PFN_vkVoidFunction VKAPI_PTR getInstanceProcAddr(VkInstance instance, const char* name);

    // For the stub functions.
    struct Memory {
        VkDeviceSize size;
        std::uint32_t type;
        void* bytes;
    };
    struct Binding {
        std::uint64_t memory;
        VkDeviceSize begin, end;
    };
    static StubVulkan& current();
    bool fails(const char* call);
    std::uint64_t make(const char* kind);
    void destroy(std::uint64_t handle, const char* kind);
    void bind(std::uint64_t object, std::uint64_t memory, VkDeviceSize offset, VkDeviceSize size);
    void count(const char* call);
    mutable std::mutex mutex;
    std::map<std::uint64_t, std::string> objects;
    std::map<std::uint64_t, Memory> memories;
    std::map<std::uint64_t, Binding> bindings;
    std::map<std::uint64_t, VkDeviceSize> sizes;
    std::uint64_t nextHandle = 0x1000;
};

} // namespace gnomon::test
