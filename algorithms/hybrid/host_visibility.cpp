#include "algorithms/hybrid/host_visibility.hpp"

namespace gnomon {

namespace {

void copyToLayer(PassContext& gpu, BufferId from, ImageId to, std::uint32_t layer, const VkRect2D& area)
{
    const VkBufferImageCopy2 region{.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
                                    .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, layer, 1},
                                    .imageOffset = {area.offset.x, area.offset.y, 0},
                                    .imageExtent = {area.extent.width, area.extent.height, 1}};
    const VkCopyBufferToImageInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_BUFFER_TO_IMAGE_INFO_2,
                                        .srcBuffer = gpu.buffer(from),
                                        .dstImage = gpu.image(to),
                                        .dstImageLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                        .regionCount = 1,
                                        .pRegions = &region};
    gpu.vk->vkCmdCopyBufferToImage2(gpu.cmd, &copy);
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

BlockReader blocksOf(const CameraView& view, const LightView& light, const HostVisibility& buffers,
                     const HostContext& host)
{
    return BlockReader(widestKernels(), view, light, host.read<float>(buffers.depth),
                       buffers.normals ? host.read<std::byte>(buffers.normals) : std::span<const std::byte>());
}

void declareVisibilityCopy(PassBuilder& passes, const ShadowTask& task, const HostVisibility& buffers, const char* name)
{
    const ImageId target = task.visibility;
    const std::uint32_t layer = task.layer;
    passes.transfer(name)
        .reads(buffers.rows)
        .writes(target, {.layer = layer})
        .record([rows = buffers.rows, target, layer, area = task.view->area](PassContext& gpu) {
            copyToLayer(gpu, rows, target, layer, area);
        });
}

} // namespace gnomon
