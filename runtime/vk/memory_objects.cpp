// Images and buffers: what DeviceMemory makes in the memory it allocates.
#include <algorithm>

#include "runtime/vk/memory.hpp"
#include "runtime/vk/structures.hpp"

namespace gnomon {
namespace {

constexpr VkImageUsageFlags kViewable =
    VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
    VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_INPUT_ATTACHMENT_BIT;

struct ViewPart {
    VkImageViewType type = VK_IMAGE_VIEW_TYPE_2D;
    VkImageAspectFlags aspects = 0;
    std::uint32_t layer = 0;
    std::uint32_t layers = 1;
};

Result<VkImageView> createView(const DeviceTable& vk, const GpuImage& image, const ViewPart& part, const char* name)
{
    const VkImageViewCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = image.image,
        .viewType = part.type,
        .format = image.format,
        .subresourceRange = {
            .aspectMask = part.aspects, .levelCount = 1, .baseArrayLayer = part.layer, .layerCount = part.layers}};
    VkImageView view = VK_NULL_HANDLE;
    const VkResult result = vk.vkCreateImageView(vk.device, &info, vk.hostAllocator, &view);
    if (result != VK_SUCCESS) return vulkanError(result, "vkCreateImageView");
    ++vk.objectsMade;
    nameObject(vk, VK_OBJECT_TYPE_IMAGE_VIEW, view, name);
    return view;
}

/// Makes `out` the view of `part`, or returns why not.
Result<void> addView(const DeviceTable& vk, const GpuImage& image, const ViewPart& part, const char* name,
                     VkImageView& out)
{
    Result<VkImageView> view = createView(vk, image, part, name);
    if (!view) return view.error();
    out = *view;
    return {};
}

Result<void> createViews(const DeviceTable& vk, GpuImage& image, const char* name)
{
    const VkImageAspectFlags all = aspectsOf(image.format);
    const VkImageAspectFlags depth = all & VK_IMAGE_ASPECT_DEPTH_BIT;
    const VkImageAspectFlags main = depth ? depth : all;
    Result<void> made = addView(vk, image, {VK_IMAGE_VIEW_TYPE_2D_ARRAY, main, 0, image.layers}, name, image.view);
    if (!made) return made;
    if (all != main && image.layers == 1) {
        made = addView(vk, image, {.aspects = VK_IMAGE_ASPECT_STENCIL_BIT}, name, image.stencilView);
        if (!made) return made;
    }
    image.layerViews.resize(image.layers, VK_NULL_HANDLE);
    image.layerSampled.resize(image.layers, VK_NULL_HANDLE);
    for (std::uint32_t layer = 0; layer < image.layers; ++layer) {
        made = addView(vk, image, {.aspects = all, .layer = layer}, name, image.layerViews[layer]);
        if (!made) return made;
        if (all == main) {
            image.layerSampled[layer] = image.layerViews[layer];
            continue;
        }
        made = addView(vk, image, {.aspects = main, .layer = layer}, name, image.layerSampled[layer]);
        if (!made) return made;
    }
    return {};
}

/// What a format must be able to do to be used so.
VkFormatFeatureFlags featuresFor(VkImageUsageFlags usage)
{
    struct Need {
        VkImageUsageFlags usage;
        VkFormatFeatureFlags feature;
    };
    constexpr Need needs[] = {
        {VK_IMAGE_USAGE_TRANSFER_SRC_BIT, VK_FORMAT_FEATURE_TRANSFER_SRC_BIT},
        {VK_IMAGE_USAGE_TRANSFER_DST_BIT, VK_FORMAT_FEATURE_TRANSFER_DST_BIT},
        {VK_IMAGE_USAGE_SAMPLED_BIT, VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT},
        {VK_IMAGE_USAGE_STORAGE_BIT, VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT},
        {VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT},
        {VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT}};
    VkFormatFeatureFlags features = 0;
    for (const Need& need : needs)
        if (usage & need.usage) features |= need.feature;
    return features;
}

/// What would be undefined behaviour in Vulkan is an answer here.
Result<void> checkImage(const DeviceTable& vk, const ImageCreate& info)
{
    const VkPhysicalDeviceLimits& limits = vk.properties.limits;
    const std::uint32_t side = std::max(info.extent.width, info.extent.height);
    if (info.format == VK_FORMAT_UNDEFINED || !supports(vk, info.format, featuresFor(info.usage)))
        return Error{GN_ERROR_FEATURE_MISSING, "ImageFormat",
                     std::string(info.name) + ": the device has no images of VkFormat " + std::to_string(info.format) +
                         " for this use"};
    if (side <= limits.maxImageDimension2D && info.layers <= limits.maxImageArrayLayers && info.extent.width &&
        info.extent.height && info.layers)
        return {};
    return Error{GN_ERROR_OUT_OF_RANGE, "ImageExtent",
                 std::string(info.name) + ": " + std::to_string(info.extent.width) + " x " +
                     std::to_string(info.extent.height) + " x " + std::to_string(info.layers) +
                     " layers; the device takes 1 to " + std::to_string(limits.maxImageDimension2D) +
                     " a side and 1 to " + std::to_string(limits.maxImageArrayLayers) + " layers"};
}

} // namespace

VkImageAspectFlags aspectsOf(VkFormat format) noexcept
{
    switch (format) {
    case VK_FORMAT_D16_UNORM:
    case VK_FORMAT_X8_D24_UNORM_PACK32:
    case VK_FORMAT_D32_SFLOAT:
        return VK_IMAGE_ASPECT_DEPTH_BIT;
    case VK_FORMAT_S8_UINT:
        return VK_IMAGE_ASPECT_STENCIL_BIT;
    case VK_FORMAT_D16_UNORM_S8_UINT:
    case VK_FORMAT_D24_UNORM_S8_UINT:
    case VK_FORMAT_D32_SFLOAT_S8_UINT:
        return VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT;
    default:
        return VK_IMAGE_ASPECT_COLOR_BIT;
    }
}

Result<GpuImage> DeviceMemory::createImage(const ImageCreate& info)
{
    if (Result<void> fits = checkImage(vk_, info); !fits) return fits.error();
    GpuImage image;
    image.format = info.format;
    image.extent = info.extent;
    image.layers = info.layers;
    image.usage = info.usage;
    Result<void> made;
    try {
        made = fillImage(image, info);
    } catch (...) {
        destroy(image);
        throw;
    }
    if (made) return image;
    destroy(image);
    return made.error();
}

Result<void> DeviceMemory::fillImage(GpuImage& image, const ImageCreate& info)
{
    const bool shared = info.concurrent && families_.size() > 1;
    const VkImageCreateInfo create{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                   .imageType = VK_IMAGE_TYPE_2D,
                                   .format = info.format,
                                   .extent = {info.extent.width, info.extent.height, 1},
                                   .mipLevels = 1,
                                   .arrayLayers = info.layers,
                                   .samples = VK_SAMPLE_COUNT_1_BIT,
                                   .tiling = VK_IMAGE_TILING_OPTIMAL,
                                   .usage = info.usage,
                                   .sharingMode = shared ? VK_SHARING_MODE_CONCURRENT : VK_SHARING_MODE_EXCLUSIVE,
                                   .queueFamilyIndexCount = shared ? static_cast<std::uint32_t>(families_.size()) : 0,
                                   .pQueueFamilyIndices = shared ? families_.data() : nullptr,
                                   .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED};
    VkResult result = vk_.vkCreateImage(vk_.device, &create, vk_.hostAllocator, &image.image);
    if (result != VK_SUCCESS) {
        image.image = VK_NULL_HANDLE;
        return vulkanError(result, "vkCreateImage");
    }
    ++vk_.objectsMade;
    nameObject(vk_, VK_OBJECT_TYPE_IMAGE, image.image, info.name);

    const VkImageMemoryRequirementsInfo2 ask{VK_STRUCTURE_TYPE_IMAGE_MEMORY_REQUIREMENTS_INFO_2, nullptr, image.image};
    VkMemoryRequirements2 needs{VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2, nullptr, {}};
    vk_.vkGetImageMemoryRequirements2(vk_.device, &ask, &needs);
    Result<MemorySlice> slice = allocate(needs.memoryRequirements, MemoryUse::device, false);
    if (!slice) return slice.error();
    image.memory = *slice;
    const VkBindImageMemoryInfo bind{VK_STRUCTURE_TYPE_BIND_IMAGE_MEMORY_INFO, nullptr, image.image,
                                     memoryOf(image.memory, nullptr), image.memory.offset};
    result = vk_.vkBindImageMemory2(vk_.device, 1, &bind);
    if (result != VK_SUCCESS) return vulkanError(result, "vkBindImageMemory2");
    // An image that is only copied has nothing a view could be made for.
    return info.usage & kViewable ? createViews(vk_, image, info.name) : Result<void>();
}

Result<GpuBuffer> DeviceMemory::createBuffer(VkDeviceSize size, VkBufferUsageFlags usage, MemoryUse use,
                                             const char* name)
{
    GpuBuffer buffer;
    buffer.size = std::max<VkDeviceSize>(size, 4);
    Result<void> made;
    try {
        made = fillBuffer(buffer, usage, use, name);
    } catch (...) {
        destroy(buffer);
        throw;
    }
    if (made) return buffer;
    destroy(buffer);
    return made.error();
}

Result<void> DeviceMemory::fillBuffer(GpuBuffer& buffer, VkBufferUsageFlags usage, MemoryUse use, const char* name)
{
    const VkBufferCreateInfo create{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                    .size = buffer.size,
                                    .usage = usage,
                                    .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
                                    .pQueueFamilyIndices = nullptr};
    VkResult result = vk_.vkCreateBuffer(vk_.device, &create, vk_.hostAllocator, &buffer.buffer);
    if (result != VK_SUCCESS) {
        buffer.buffer = VK_NULL_HANDLE;
        return vulkanError(result, "vkCreateBuffer");
    }
    ++vk_.objectsMade;
    nameObject(vk_, VK_OBJECT_TYPE_BUFFER, buffer.buffer, name);

    const VkBufferMemoryRequirementsInfo2 ask{VK_STRUCTURE_TYPE_BUFFER_MEMORY_REQUIREMENTS_INFO_2, nullptr,
                                              buffer.buffer};
    VkMemoryRequirements2 needs{VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2, nullptr, {}};
    vk_.vkGetBufferMemoryRequirements2(vk_.device, &ask, &needs);
    if (usage & VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR) {
        // Instances: VUID-vkCmdBuildAccelerationStructuresKHR-pInfos-03715.
        VkDeviceSize& alignment = needs.memoryRequirements.alignment;
        alignment = std::max<VkDeviceSize>(alignment, 16);
    }
    Result<MemorySlice> slice = allocate(needs.memoryRequirements, use, true);
    if (!slice) return slice.error();
    buffer.memory = *slice;
    std::byte* mapped = nullptr;
    const VkBindBufferMemoryInfo bind{VK_STRUCTURE_TYPE_BIND_BUFFER_MEMORY_INFO, nullptr, buffer.buffer,
                                      memoryOf(buffer.memory, &mapped), buffer.memory.offset};
    result = vk_.vkBindBufferMemory2(vk_.device, 1, &bind);
    if (result != VK_SUCCESS) return vulkanError(result, "vkBindBufferMemory2");
    if (use != MemoryUse::device || vk_.memory.memoryTypeCount == 1) buffer.mapped = mapped;
    if (usage & VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT) {
        const VkBufferDeviceAddressInfo where{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, nullptr, buffer.buffer};
        buffer.address = vk_.vkGetBufferDeviceAddress(vk_.device, &where);
    }
    return {};
}

Result<GpuBuffer> DeviceMemory::createStructure(VkDeviceSize size, VkAccelerationStructureTypeKHR type,
                                                const char* name)
{
    Result<GpuBuffer> made = createBuffer(size, kBuildResult, MemoryUse::device, name);
    if (!made) return made;
    Result<void> filled = fillStructure(*made, type, name);
    if (filled) return made;
    destroy(*made);
    return filled.error();
}

Result<void> DeviceMemory::fillStructure(GpuBuffer& buffer, VkAccelerationStructureTypeKHR type, const char* name)
{
    const VkAccelerationStructureCreateInfoKHR create{.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR,
                                                      .buffer = buffer.buffer,
                                                      .offset = 0,
                                                      .size = buffer.size,
                                                      .type = type,
                                                      .deviceAddress = 0};
    const VkResult result =
        vk_.vkCreateAccelerationStructureKHR(vk_.device, &create, vk_.hostAllocator, &buffer.structure);
    if (result != VK_SUCCESS) {
        buffer.structure = VK_NULL_HANDLE;
        return vulkanError(result, "vkCreateAccelerationStructureKHR");
    }
    ++vk_.objectsMade;
    nameObject(vk_, VK_OBJECT_TYPE_ACCELERATION_STRUCTURE_KHR, buffer.structure, name);
    const VkAccelerationStructureDeviceAddressInfoKHR where{
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR, nullptr, buffer.structure};
    buffer.address = vk_.vkGetAccelerationStructureDeviceAddressKHR(vk_.device, &where);
    return {};
}

void DeviceMemory::destroy(GpuImage& image) noexcept
{
    const auto destroyView = [this](VkImageView view) {
        if (view) vk_.vkDestroyImageView(vk_.device, view, vk_.hostAllocator);
    };
    destroyView(image.view);
    destroyView(image.stencilView);
    for (std::size_t i = 0; i < image.layerSampled.size(); ++i)
        if (image.layerSampled[i] != image.layerViews[i]) destroyView(image.layerSampled[i]);
    for (VkImageView view : image.layerViews)
        destroyView(view);
    if (image.image) vk_.vkDestroyImage(vk_.device, image.image, vk_.hostAllocator);
    release(image.memory);
    image = {};
}

void DeviceMemory::destroy(GpuBuffer& buffer) noexcept
{
    if (buffer.structure) vk_.vkDestroyAccelerationStructureKHR(vk_.device, buffer.structure, vk_.hostAllocator);
    if (buffer.buffer) vk_.vkDestroyBuffer(vk_.device, buffer.buffer, vk_.hostAllocator);
    release(buffer.memory);
    buffer = {};
}

} // namespace gnomon
