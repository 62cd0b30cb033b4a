#pragma once
// Copies between an image and a buffer that has a place for every pixel of it, of the pixels that a view draws.
#include <cstdint>

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan_core.h>

namespace gnomon {

/// The pixels of `area`, in a buffer of `rowTexels` texels a row: a pixel lies where it would if all were copied, and
/// what is beside the area stays as it is.
///     texelBytes  a multiple of 4: depth texels must begin at one
inline VkBufferImageCopy2 areaCopy(const VkRect2D& area, VkImageAspectFlags aspect, std::uint32_t rowTexels,
                                   VkDeviceSize texelBytes)
{
    const VkDeviceSize x = static_cast<std::uint32_t>(area.offset.x), y = static_cast<std::uint32_t>(area.offset.y);
    return {.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
            .bufferOffset = texelBytes * (y * rowTexels + x),
            .bufferRowLength = rowTexels,
            .imageSubresource = {aspect, 0, 0, 1},
            .imageOffset = {area.offset.x, area.offset.y, 0},
            .imageExtent = {area.extent.width, area.extent.height, 1}};
}

} // namespace gnomon
