#include "demo/host/vulkan.hpp"

#include "demo/host/device.hpp"

namespace gnomon::demo {

void vkCheck(VkResult result, const char* call)
{
    if (result < 0)
        throw HostError(std::string(call) + " failed with VkResult " + std::to_string(static_cast<int>(result)));
}

Buffer makeBuffer(const Device& device, VkDeviceSize size, VkBufferUsageFlags usage, bool cached)
{
    Buffer out;
    out.size = size == 0 ? 4 : size; // Vulkan knows no empty buffers
    const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = out.size, .usage = usage};
    VkBuffer buffer = VK_NULL_HANDLE;
    vkCheck(vkCreateBuffer(device.handle, &info, nullptr, &buffer), "vkCreateBuffer");
    out.buffer = {device.handle, buffer};

    VkMemoryRequirements needs{};
    vkGetBufferMemoryRequirements(device.handle, buffer, &needs);
    const VkMemoryAllocateInfo allocation{
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = needs.size,
        .memoryTypeIndex = device.memoryType(
            needs.memoryTypeBits, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
            cached ? VK_MEMORY_PROPERTY_HOST_CACHED_BIT : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)};
    VkDeviceMemory memory = VK_NULL_HANDLE;
    vkCheck(vkAllocateMemory(device.handle, &allocation, nullptr, &memory), "vkAllocateMemory");
    out.memory = {device.handle, memory};
    vkCheck(vkBindBufferMemory(device.handle, buffer, memory, 0), "vkBindBufferMemory");
    vkCheck(vkMapMemory(device.handle, memory, 0, VK_WHOLE_SIZE, 0, &out.mapped), "vkMapMemory");
    return out;
}

Image makeImage(const Device& device, const ImageDescription& description)
{
    Image out;
    out.format = description.format;
    out.extent = description.extent;
    out.layers = description.layers;
    const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                 .imageType = VK_IMAGE_TYPE_2D,
                                 .format = description.format,
                                 .extent = {description.extent.width, description.extent.height, 1},
                                 .mipLevels = 1,
                                 .arrayLayers = description.layers,
                                 .samples = static_cast<VkSampleCountFlagBits>(description.samples),
                                 .tiling = VK_IMAGE_TILING_OPTIMAL,
                                 .usage = description.usage};
    VkImage image = VK_NULL_HANDLE;
    vkCheck(vkCreateImage(device.handle, &info, nullptr, &image), "vkCreateImage");
    out.image = {device.handle, image};

    VkMemoryRequirements needs{};
    vkGetImageMemoryRequirements(device.handle, image, &needs);
    const VkMemoryAllocateInfo allocation{
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = needs.size,
        .memoryTypeIndex = device.memoryType(needs.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)};
    VkDeviceMemory memory = VK_NULL_HANDLE;
    vkCheck(vkAllocateMemory(device.handle, &allocation, nullptr, &memory), "vkAllocateMemory");
    out.memory = {device.handle, memory};
    vkCheck(vkBindImageMemory(device.handle, image, memory, 0), "vkBindImageMemory");

    const bool array = description.arrayView || description.layers > 1;
    const VkImageViewCreateInfo viewInfo{
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = image,
        .viewType = array ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D,
        .format = description.format,
        .subresourceRange = {aspectOf(description.format) & ~VkImageAspectFlags{VK_IMAGE_ASPECT_STENCIL_BIT}, 0, 1, 0,
                             description.layers}};
    VkImageView view = VK_NULL_HANDLE;
    vkCheck(vkCreateImageView(device.handle, &viewInfo, nullptr, &view), "vkCreateImageView");
    out.view = {device.handle, view};
    return out;
}

VkImageAspectFlags aspectOf(VkFormat format) noexcept
{
    if (format == VK_FORMAT_D24_UNORM_S8_UINT || format == VK_FORMAT_D32_SFLOAT_S8_UINT ||
        format == VK_FORMAT_D16_UNORM_S8_UINT)
        return VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT;
    const bool depth =
        format == VK_FORMAT_D32_SFLOAT || format == VK_FORMAT_D16_UNORM || format == VK_FORMAT_X8_D24_UNORM_PACK32;
    return depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

VkImageMemoryBarrier2 imageBarrier(VkImage image, VkImageAspectFlags aspect, const Access& before, const Access& after)
{
    return {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
            .srcStageMask = before.stages,
            .srcAccessMask = before.access,
            .dstStageMask = after.stages,
            .dstAccessMask = after.access,
            .oldLayout = before.layout,
            .newLayout = after.layout,
            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .image = image,
            .subresourceRange = {aspect, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS}};
}

void cmdBarrier(VkCommandBuffer cmd, std::span<const VkImageMemoryBarrier2> images)
{
    const VkDependencyInfo info{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                .imageMemoryBarrierCount = static_cast<uint32_t>(images.size()),
                                .pImageMemoryBarriers = images.data()};
    vkCmdPipelineBarrier2(cmd, &info);
}

void cmdMemoryBarrier(VkCommandBuffer cmd, const Access& before, const Access& after)
{
    const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                   .srcStageMask = before.stages,
                                   .srcAccessMask = before.access,
                                   .dstStageMask = after.stages,
                                   .dstAccessMask = after.access};
    const VkDependencyInfo info{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(cmd, &info);
}

void cmdSetArea(VkCommandBuffer cmd, VkExtent2D extent)
{
    const VkViewport viewport{0.0f, 0.0f, static_cast<float>(extent.width), static_cast<float>(extent.height),
                              0.0f, 1.0f};
    const VkRect2D scissor{{0, 0}, extent};
    vkCmdSetViewport(cmd, 0, 1, &viewport);
    vkCmdSetScissor(cmd, 0, 1, &scissor);
}

} // namespace gnomon::demo
