#include "algorithms/shared/host_visibility.hpp"

namespace gnomon {

namespace {

VkBufferImageCopy2 regionOf(std::uint32_t layer, const VkRect2D& pixels)
{
    return {.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
            .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, layer, 1},
            .imageOffset = {pixels.offset.x, pixels.offset.y, 0},
            .imageExtent = {pixels.extent.width, pixels.extent.height, 1}};
}

void copyToLayer(PassContext& gpu, BufferId from, ImageId to, const VkBufferImageCopy2& region)
{
    const VkCopyBufferToImageInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_BUFFER_TO_IMAGE_INFO_2,
                                        .srcBuffer = gpu.buffer(from),
                                        .dstImage = gpu.image(to),
                                        .dstImageLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                        .regionCount = 1,
                                        .pRegions = &region};
    gpu.vk->vkCmdCopyBufferToImage2(gpu.cmd, &copy);
}

void copyFromLayer(PassContext& gpu, ImageId from, BufferId to, const VkBufferImageCopy2& region)
{
    const VkCopyImageToBufferInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_IMAGE_TO_BUFFER_INFO_2,
                                        .srcImage = gpu.image(from),
                                        .srcImageLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                        .dstBuffer = gpu.buffer(to),
                                        .regionCount = 1,
                                        .pRegions = &region};
    gpu.vk->vkCmdCopyImageToBuffer2(gpu.cmd, &copy);
}

} // namespace

VkDeviceSize hostVisibilityMemory(VkExtent2D extent)
{
    return pooledSize(VkDeviceSize(extent.width) * extent.height);
}

HostVisibility declareHostVisibility(PassBuilder& passes, const ShadowTask& task, const char* name)
{
    const VkExtent2D extent = task.view->area.extent;
    return {.depth = passes.depthOnHost(),
            .normals = passes.normalsOnHost(),
            .rows = passes.transient(BufferInfo{
                .name = name, .size = VkDeviceSize(extent.width) * extent.height, .place = BufferPlace::upload})};
}

void useHostVisibility(PassRef& pass, const HostVisibility& buffers)
{
    pass.reads(buffers.depth).writes(buffers.rows);
    if (buffers.normals) pass.reads(buffers.normals);
}

Receivers receiversOf(const CameraView& view, const LightView& light, const HostVisibility& buffers,
                      const HostContext& host)
{
    return Receivers(view, light, host.read<float>(buffers.depth),
                     buffers.normals ? host.read<std::byte>(buffers.normals) : std::span<const std::byte>());
}

void declareVisibilityCopy(PassBuilder& passes, const ShadowTask& task, const HostVisibility& buffers, const char* name)
{
    declareVisibilityCopy(passes, task, buffers.rows, task.view->area, name);
}

void declareVisibilityCopy(PassBuilder& passes, const ShadowTask& task, BufferId bytes, const VkRect2D& pixels,
                           const char* name)
{
    const ImageId target = task.visibility;
    passes.transfer(name)
        .reads(bytes)
        .writes(target, {.layer = task.layer})
        .record(
            [=, region = regionOf(task.layer, pixels)](PassContext& gpu) { copyToLayer(gpu, bytes, target, region); });
}

void declareVisibilityReadback(PassBuilder& passes, const ShadowTask& task, BufferId bytes, const VkRect2D& pixels,
                               const char* name)
{
    const ImageId source = task.visibility;
    passes.transfer(name)
        .copies(source, {.layer = task.layer})
        .writes(bytes)
        .record([=, region = regionOf(task.layer, pixels)](PassContext& gpu) {
            copyFromLayer(gpu, source, bytes, region);
        });
}

} // namespace gnomon
