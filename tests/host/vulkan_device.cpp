#include "vulkan_device.hpp"

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include <gnomon/gnomon.h>

namespace stranger {

void check(int result, const char* call)
{
    if (result < 0) throw std::runtime_error(std::string(call) + ": " + std::to_string(result));
}

Device::Device()
{
    const VkApplicationInfo app{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo instanceInfo{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &app};
    uint32_t count = 1;
    if (vkCreateInstance(&instanceInfo, nullptr, &instance) < 0) return;
    if (vkEnumeratePhysicalDevices(instance, &count, &gpu) < 0 || count == 0) return;
    GnDeviceNeeds needs{};
    if (gnQueryDeviceNeeds(instance, gpu, vkGetInstanceProcAddr, &needs) < 0) return;

    features13_ = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                   .synchronization2 = VK_TRUE,
                   .dynamicRendering = VK_TRUE};
    features12_ = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                   .pNext = &features13_,
                   .timelineSemaphore = VK_TRUE};
    features = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &features12_, .features = needs.optional};
    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queueInfo{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                            .queueCount = 1, // of family 0, which draws on desktop devices
                                            .pQueuePriorities = &priority};
    const VkDeviceCreateInfo deviceInfo{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                        .pNext = &features,
                                        .queueCreateInfoCount = 1,
                                        .pQueueCreateInfos = &queueInfo};
    STRANGER_CHECK(vkCreateDevice(gpu, &deviceInfo, nullptr, &device));
    vkGetDeviceQueue(device, 0, 0, &queue);
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(gpu, &properties);
    timestampMs = static_cast<double>(properties.limits.timestampPeriod) * 1e-6;
    std::memcpy(name, properties.deviceName, sizeof name);
}

Device::~Device()
{
    if (device) vkDestroyDevice(device, nullptr);
    if (instance) vkDestroyInstance(instance, nullptr);
}

VkDeviceMemory Device::allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags wanted) const
{
    VkPhysicalDeviceMemoryProperties types;
    vkGetPhysicalDeviceMemoryProperties(gpu, &types);
    for (uint32_t type = 0; type < types.memoryTypeCount; ++type) {
        if (!(needs.memoryTypeBits >> type & 1) || (types.memoryTypes[type].propertyFlags & wanted) != wanted) continue;
        const VkMemoryAllocateInfo info{
            .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size, .memoryTypeIndex = type};
        VkDeviceMemory memory = VK_NULL_HANDLE;
        STRANGER_CHECK(vkAllocateMemory(device, &info, nullptr, &memory));
        return memory;
    }
    throw std::runtime_error("no memory type for an image or a buffer");
}

Image Device::createImage(VkFormat format, VkExtent2D size, VkImageUsageFlags usage) const
{
    const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                 .imageType = VK_IMAGE_TYPE_2D,
                                 .format = format,
                                 .extent = {size.width, size.height, 1},
                                 .mipLevels = 1,
                                 .arrayLayers = 1,
                                 .samples = VK_SAMPLE_COUNT_1_BIT,
                                 .tiling = VK_IMAGE_TILING_OPTIMAL,
                                 .usage = usage};
    Image result{.format = format};
    STRANGER_CHECK(vkCreateImage(device, &info, nullptr, &result.image));
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device, result.image, &needs);
    result.memory = allocate(needs, 0);
    STRANGER_CHECK(vkBindImageMemory(device, result.image, result.memory, 0));
    const bool depth = format == VK_FORMAT_D32_SFLOAT;
    const VkImageAspectFlags aspect = depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
    const VkImageViewCreateInfo viewInfo{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                         .image = result.image,
                                         .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                         .format = format,
                                         .subresourceRange = {aspect, 0, 1, 0, 1}};
    STRANGER_CHECK(vkCreateImageView(device, &viewInfo, nullptr, &result.view));
    return result;
}

Buffer Device::createBuffer(size_t bytes, VkBufferUsageFlags usage) const
{
    const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes, .usage = usage};
    Buffer result;
    STRANGER_CHECK(vkCreateBuffer(device, &info, nullptr, &result.buffer));
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device, result.buffer, &needs);
    result.memory = allocate(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    STRANGER_CHECK(vkBindBufferMemory(device, result.buffer, result.memory, 0));
    STRANGER_CHECK(vkMapMemory(device, result.memory, 0, VK_WHOLE_SIZE, 0, &result.mapped));
    return result;
}

void Device::destroy(Image& image) const noexcept
{
    vkDestroyImageView(device, image.view, nullptr);
    vkDestroyImage(device, image.image, nullptr);
    vkFreeMemory(device, image.memory, nullptr);
    image = {};
}

void Device::destroy(Buffer& buffer) const noexcept
{
    vkDestroyBuffer(device, buffer.buffer, nullptr);
    vkFreeMemory(device, buffer.memory, nullptr);
    buffer = {};
}

VkShaderModule Device::createShader(const uint32_t* pCode, size_t bytes) const
{
    const VkShaderModuleCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = bytes, .pCode = pCode};
    VkShaderModule module = VK_NULL_HANDLE;
    STRANGER_CHECK(vkCreateShaderModule(device, &info, nullptr, &module));
    return module;
}

void barrier(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect, VkImageLayout from, VkImageLayout to,
             uint32_t layers)
{
    const VkAccessFlags2 all = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    const VkImageMemoryBarrier2 one{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                    .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                    .srcAccessMask = all,
                                    .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                    .dstAccessMask = all,
                                    .oldLayout = from,
                                    .newLayout = to,
                                    .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .image = image,
                                    .subresourceRange = {aspect, 0, 1, 0, layers}};
    const VkDependencyInfo info{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &one};
    vkCmdPipelineBarrier2(commands, &info);
}
} // namespace stranger
