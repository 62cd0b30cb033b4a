#include "device/memory_books.hpp"

#include <cstring>
#include <map>
#include <utility>

namespace gnomon::test {
namespace {

struct Object {
    std::string name;
    VkDeviceSize bytes = 0;
};
struct Books {
    std::mutex mutex; ///< Meshes and pipelines come from workers.
    std::map<std::pair<VkObjectType, uint64_t>, Object> objects;
};
Books books;

template <typename Handle>
uint64_t bitsOf(Handle handle)
{
    uint64_t bits = 0; // handles are pointers or 64-bit integers, by platform
    std::memcpy(&bits, &handle, sizeof handle);
    return bits;
}

void book(VkObjectType type, uint64_t handle, VkDeviceSize bytes)
{
    const std::lock_guard lock(books.mutex);
    books.objects[{type, handle}].bytes = bytes;
}

void strike(VkObjectType type, uint64_t handle)
{
    const std::lock_guard lock(books.mutex);
    books.objects.erase({type, handle});
}

VKAPI_ATTR VkResult VKAPI_CALL bookedCreateBuffer(VkDevice handle, const VkBufferCreateInfo* info,
                                                  const VkAllocationCallbacks* allocator, VkBuffer* buffer)
{
    const VkResult result = vkCreateBuffer(handle, info, allocator, buffer);
    if (result == VK_SUCCESS) book(VK_OBJECT_TYPE_BUFFER, bitsOf(*buffer), info->size);
    return result;
}

VKAPI_ATTR void VKAPI_CALL bookedDestroyBuffer(VkDevice handle, VkBuffer buffer, const VkAllocationCallbacks* allocator)
{
    strike(VK_OBJECT_TYPE_BUFFER, bitsOf(buffer));
    vkDestroyBuffer(handle, buffer, allocator);
}

VKAPI_ATTR VkResult VKAPI_CALL bookedCreateImage(VkDevice handle, const VkImageCreateInfo* info,
                                                 const VkAllocationCallbacks* allocator, VkImage* image)
{
    const VkResult result = vkCreateImage(handle, info, allocator, image);
    if (result != VK_SUCCESS) return result;
    VkMemoryRequirements needs{};
    vkGetImageMemoryRequirements(handle, *image, &needs);
    book(VK_OBJECT_TYPE_IMAGE, bitsOf(*image), needs.size);
    return result;
}

VKAPI_ATTR void VKAPI_CALL bookedDestroyImage(VkDevice handle, VkImage image, const VkAllocationCallbacks* allocator)
{
    strike(VK_OBJECT_TYPE_IMAGE, bitsOf(image));
    vkDestroyImage(handle, image, allocator);
}

PFN_vkSetDebugUtilsObjectNameEXT setObjectName = nullptr;

VKAPI_ATTR VkResult VKAPI_CALL bookedSetObjectName(VkDevice handle, const VkDebugUtilsObjectNameInfoEXT* info)
{
    {
        const std::lock_guard lock(books.mutex);
        const auto found = books.objects.find({info->objectType, info->objectHandle});
        if (found != books.objects.end()) found->second.name = info->pObjectName;
    }
    return setObjectName ? setObjectName(handle, info) : VK_SUCCESS;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL hookedGetDeviceProcAddr(VkDevice handle, const char* name)
{
    const std::pair<const char*, PFN_vkVoidFunction> hooks[] = {
        {"vkCreateBuffer", reinterpret_cast<PFN_vkVoidFunction>(&bookedCreateBuffer)},
        {"vkDestroyBuffer", reinterpret_cast<PFN_vkVoidFunction>(&bookedDestroyBuffer)},
        {"vkCreateImage", reinterpret_cast<PFN_vkVoidFunction>(&bookedCreateImage)},
        {"vkDestroyImage", reinterpret_cast<PFN_vkVoidFunction>(&bookedDestroyImage)}};
    for (const std::pair<const char*, PFN_vkVoidFunction>& hook : hooks)
        if (std::strcmp(name, hook.first) == 0) return hook.second;
    return vkGetDeviceProcAddr(handle, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL hookedGetInstanceProcAddr(VkInstance instance, const char* name)
{
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
        return reinterpret_cast<PFN_vkVoidFunction>(&hookedGetDeviceProcAddr);
    const PFN_vkVoidFunction real = vkGetInstanceProcAddr(instance, name);
    if (std::strcmp(name, "vkSetDebugUtilsObjectNameEXT") != 0) return real;
    setObjectName = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(real);
    return reinterpret_cast<PFN_vkVoidFunction>(&bookedSetObjectName);
}

} // namespace

MemoryBooks::MemoryBooks()
{
    books.objects.clear();
}

MemoryBooks::~MemoryBooks()
{
    books.objects.clear();
}

HostOptions MemoryBooks::options(HostOptions base) const
{
    base.context = [](GnContextCreateInfo& info) {
        static std::vector<const char*> extensions; // read while the context is made
        extensions.assign(info.ppEnabledExtensionNames, info.ppEnabledExtensionNames + info.enabledExtensionCount);
        extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME); // validation has switched it on
        info.ppEnabledExtensionNames = extensions.data();
        info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
        info.pfnGetInstanceProcAddr = &hookedGetInstanceProcAddr;
    };
    return base;
}

MemoryBooks::Entry MemoryBooks::held(const std::string& prefix) const
{
    const std::lock_guard lock(books.mutex);
    Entry sum;
    for (const auto& [key, object] : books.objects) {
        if (!object.name.starts_with(prefix)) continue;
        sum.bytes += object.bytes;
        ++sum.count;
    }
    return sum;
}

std::string MemoryBooks::list() const
{
    const std::lock_guard lock(books.mutex);
    std::map<std::string, Entry> names;
    for (const auto& [key, object] : books.objects) {
        names[object.name].bytes += object.bytes;
        ++names[object.name].count;
    }
    std::string text;
    for (const auto& [name, entry] : names)
        text += name + " " + std::to_string(entry.count) + " x, " + std::to_string(entry.bytes) + " bytes\n";
    return text;
}

} // namespace gnomon::test
