#include "device/discrete.hpp"

#include <map>

namespace gnomon::test {
namespace {

constexpr uint32_t kTypes = 3;

std::mutex mutex; // meshes and pipelines get their memory on other threads
std::map<VkDeviceMemory, uint32_t> typeOfMemory;
std::map<VkBuffer, uint32_t> typeOfBuffer;

VKAPI_ATTR void VKAPI_CALL threeTypes(VkPhysicalDevice device, VkPhysicalDeviceMemoryProperties2* out)
{
    vkGetPhysicalDeviceMemoryProperties2(device, out);
    constexpr VkMemoryPropertyFlags kHost = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    VkPhysicalDeviceMemoryProperties& memory = out->memoryProperties;
    const VkDeviceSize size = memory.memoryHeaps[0].size;
    memory.memoryHeapCount = 2;
    memory.memoryHeaps[0] = {size, VK_MEMORY_HEAP_DEVICE_LOCAL_BIT};
    memory.memoryHeaps[1] = {size, 0};
    memory.memoryTypeCount = kTypes;
    memory.memoryTypes[kDeviceType] = {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0};
    memory.memoryTypes[kUploadType] = {kHost, 1};
    memory.memoryTypes[kReadbackType] = {kHost | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, 1};
}

VKAPI_ATTR void VKAPI_CALL anyTypeForBuffers(VkDevice device, const VkBufferMemoryRequirementsInfo2* info,
                                             VkMemoryRequirements2* out)
{
    vkGetBufferMemoryRequirements2(device, info, out);
    out->memoryRequirements.memoryTypeBits = (1u << kTypes) - 1;
}

VKAPI_ATTR void VKAPI_CALL anyTypeForImages(VkDevice device, const VkImageMemoryRequirementsInfo2* info,
                                            VkMemoryRequirements2* out)
{
    vkGetImageMemoryRequirements2(device, info, out);
    out->memoryRequirements.memoryTypeBits = (1u << kTypes) - 1;
}

VKAPI_ATTR VkResult VKAPI_CALL allocateOnlyType(VkDevice device, const VkMemoryAllocateInfo* info,
                                                const VkAllocationCallbacks* allocator, VkDeviceMemory* memory)
{
    VkMemoryAllocateInfo real = *info;
    real.memoryTypeIndex = 0;
    const VkResult result = vkAllocateMemory(device, &real, allocator, memory);
    if (result != VK_SUCCESS) return result;
    const std::lock_guard lock(mutex);
    typeOfMemory[*memory] = info->memoryTypeIndex;
    return result;
}

VKAPI_ATTR VkResult VKAPI_CALL mapHostMemory(VkDevice device, VkDeviceMemory memory, VkDeviceSize offset,
                                             VkDeviceSize size, VkMemoryMapFlags flags, void** data)
{
    {
        const std::lock_guard lock(mutex);
        if (typeOfMemory.at(memory) == kDeviceType) {
            ++discreteBooks().mapped;
            return VK_ERROR_MEMORY_MAP_FAILED;
        }
    }
    return vkMapMemory(device, memory, offset, size, flags, data);
}

VKAPI_ATTR VkResult VKAPI_CALL bindAndNote(VkDevice device, uint32_t count, const VkBindBufferMemoryInfo* infos)
{
    {
        const std::lock_guard lock(mutex);
        for (uint32_t i = 0; i < count; ++i)
            typeOfBuffer[infos[i].buffer] = typeOfMemory.at(infos[i].memory);
    }
    return vkBindBufferMemory2(device, count, infos);
}

VKAPI_ATTR void VKAPI_CALL countedCopy(VkCommandBuffer cmd, const VkCopyBufferInfo2* info)
{
    ++discreteBooks().copies;
    vkCmdCopyBuffer2(cmd, info);
}

VKAPI_ATTR void VKAPI_CALL notedIndexBuffer(VkCommandBuffer cmd, VkBuffer buffer, VkDeviceSize offset, VkIndexType type)
{
    ++discreteBooks().indexLists;
    discreteBooks().hostIndexes += memoryTypeOf(buffer) != kDeviceType;
    vkCmdBindIndexBuffer(cmd, buffer, offset, type);
}

} // namespace

DiscreteBooks& discreteBooks()
{
    static DiscreteBooks books;
    return books;
}

bool canShowDiscrete()
{
    const VkPhysicalDeviceMemoryProperties& memory = device().memory;
    return memory.memoryTypeCount == 1 && (memory.memoryTypes[0].propertyFlags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT);
}

HostOptions discrete(HostOptions base)
{
    return hooked(std::move(base), {hook("vkGetPhysicalDeviceMemoryProperties2", &threeTypes),
                                    hook("vkGetBufferMemoryRequirements2", &anyTypeForBuffers),
                                    hook("vkGetImageMemoryRequirements2", &anyTypeForImages),
                                    hook("vkAllocateMemory", &allocateOnlyType), hook("vkMapMemory", &mapHostMemory),
                                    hook("vkBindBufferMemory2", &bindAndNote), hook("vkCmdCopyBuffer2", &countedCopy),
                                    hook("vkCmdBindIndexBuffer", &notedIndexBuffer)});
}

uint32_t memoryTypeOf(VkBuffer buffer)
{
    const std::lock_guard lock(mutex);
    return typeOfBuffer.at(buffer);
}

} // namespace gnomon::test
