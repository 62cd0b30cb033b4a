#include "algorithms/volumes/view_stencil.hpp"

#include "runtime/scene/light_pixels.hpp"
#include "shaders/volumes/cull.h"

#include "shaders/volumes_receiver_bounds_comp.h"
#include "shaders/volumes_receiver_strips_comp.h"

namespace gnomon {

namespace {

/// Block of receiver_bounds.comp, std140.
struct BoundsConstants {
    gpu::ViewConstants view;
    glm::uvec4 area;
    std::uint32_t stride;
    std::uint32_t padding[3];
};

VkBufferImageCopy2 wholeDepth(VkExtent2D extent)
{
    return {.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
            .imageSubresource = {VK_IMAGE_ASPECT_DEPTH_BIT, 0, 0, 1},
            .imageExtent = {extent.width, extent.height, 1}};
}

void recordDepthOut(const PassContext& gpu, ImageId depth, BufferId buffer, BufferId bounds, VkExtent2D extent)
{
    const VkBufferImageCopy2 region = wholeDepth(extent);
    const VkCopyImageToBufferInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_IMAGE_TO_BUFFER_INFO_2,
                                        .srcImage = gpu.image(depth),
                                        .srcImageLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                        .dstBuffer = gpu.buffer(buffer),
                                        .regionCount = 1,
                                        .pRegions = &region};
    gpu.vk->vkCmdCopyImageToBuffer2(gpu.cmd, &copy);

    gpu::ReceiverBounds empty;
    for (int axis = 0; axis < 3; ++axis) {
        empty.lower[axis] = gpu::EMPTY_LOWER;
        empty.upper[axis] = gpu::EMPTY_UPPER;
    }
    gpu.vk->vkCmdUpdateBuffer(gpu.cmd, gpu.buffer(bounds), 0, sizeof(empty), &empty);
}

void recordDepthIn(const PassContext& gpu, BufferId buffer, ImageId image, VkExtent2D extent)
{
    const VkBufferImageCopy2 region = wholeDepth(extent);
    const VkCopyBufferToImageInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_BUFFER_TO_IMAGE_INFO_2,
                                        .srcBuffer = gpu.buffer(buffer),
                                        .dstImage = gpu.image(image),
                                        .dstImageLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                        .regionCount = 1,
                                        .pRegions = &region};
    gpu.vk->vkCmdCopyBufferToImage2(gpu.cmd, &copy);
}

constexpr BindingInfo kBindings[] = {{.binding = 0, .kind = BindingKind::constants},
                                     {.binding = 1, .kind = BindingKind::storageBuffer},
                                     {.binding = 2, .kind = BindingKind::storageBuffer},
                                     {.binding = 3, .kind = BindingKind::storageBuffer}}; // strips

/// @param strips null id: bounds of the whole only.
void declareBounds(PassBuilder& passes, PipelineId pipeline, const ShadowTask& task, BufferId depths, BufferId bounds,
                   BufferId strips)
{
    const CameraView* view = task.view;
    // Two passes, and each once a view: where some lights ask for strips and others do not, both run.
    PassRef pass = passes.compute(strips ? "volumes.receiver_strips" : "volumes.receiver_bounds", Scope::view);
    pass.reads(depths).updates(bounds);
    if (strips) pass.writes(strips);
    pass.record([=](PassContext& gpu) {
        const BoundsConstants block{
            .view = view->constants,
            .area = {view->area.offset.x, view->area.offset.y, view->area.extent.width, view->area.extent.height},
            .stride = view->extent.width,
            .padding = {}};
        const Bound bound[] = {gpu.constants(0, block), gpu.storage(1, depths), gpu.storage(2, bounds),
                               gpu.storage(3, strips ? strips : bounds)};
        gpu.bind(pipeline, std::span(bound).first(strips ? 4 : 3));
        gpu.vk->vkCmdDispatch(gpu.cmd, (block.area.z + gpu::BOUNDS_COLUMNS - 1) / gpu::BOUNDS_COLUMNS,
                              (block.area.w + gpu::BOUNDS_ROWS - 1) / gpu::BOUNDS_ROWS, 1);
    });
}

} // namespace

ViewStencilPipelines makeViewStencilPipelines(const AlgorithmServices& services)
{
    return {.bounds = services.pipelines->compute({.name = "volumes.receiver_bounds",
                                                   .compute = {.code = k_volumes_receiver_bounds_comp},
                                                   .bindings = std::span(kBindings).first(3)}),
            .strips = {}};
}

PipelineId makeViewStripsPipeline(const AlgorithmServices& services)
{
    return services.pipelines->compute({.name = "volumes.receiver_strips",
                                        .compute = {.code = k_volumes_receiver_strips_comp},
                                        .bindings = kBindings});
}

VkExtent2D stripExtent(VkExtent2D area)
{
    return {area.width, (area.height + gpu::BOUNDS_ROWS - 1) / gpu::BOUNDS_ROWS};
}

ViewStencil declareViewStencil(PassBuilder& passes, const ViewStencilPipelines& pipelines, const ShadowTask& task,
                               bool strips)
{
    const VkExtent2D extent = task.view->extent;
    // Depth and depth-stencil images cannot be copied to each other directly; through a buffer the bits survive.
    const BufferId depths = passes.transient(BufferInfo{
        .name = "volumes.depths", .scope = Scope::view, .size = VkDeviceSize{4} * extent.width * extent.height});
    const BufferId bounds = passes.transient(
        BufferInfo{.name = "volumes.bounds", .scope = Scope::view, .size = sizeof(gpu::ReceiverBounds)});
    const ImageId image = passes.transient(
        ImageInfo{.name = "volumes.depth_stencil", .scope = Scope::view, .format = kStencilFormat, .extent = extent});

    const ImageId depth = task.depth;
    passes.transfer("volumes.depth_out", Scope::view)
        .copies(depth)
        .writes(depths)
        .writes(bounds)
        .record([=](PassContext& gpu) { recordDepthOut(gpu, depth, depths, bounds, extent); });
    passes.transfer("volumes.depth_in", Scope::view).reads(depths).writes(image).record([=](PassContext& gpu) {
        recordDepthIn(gpu, depths, image, extent);
    });

    BufferId stripBoxes;
    if (strips && pipelines.strips) {
        const VkExtent2D count = stripExtent(task.view->area.extent);
        stripBoxes =
            passes.transient(BufferInfo{.name = "volumes.strips",
                                        .scope = Scope::view,
                                        .size = VkDeviceSize{sizeof(gpu::ReceiverBox)} * count.width * count.height});
    }
    declareBounds(passes, stripBoxes ? pipelines.strips : pipelines.bounds, task, depths, bounds, stripBoxes);
    return {.image = image, .receiverBounds = bounds, .strips = stripBoxes};
}

glm::mat4 clipFromEye(const CameraView& view)
{
    return glm::mat4(glm::dmat4(view.projection) * glm::dmat4(glm::dmat3(view.viewFromWorld)));
}

gpu::VolumeConstants volumeConstants(const CameraView& view, const LightView& light, bool bounded)
{
    const bool directional = light.type == GN_LIGHT_TYPE_DIRECTIONAL;
    Aabb nearBounds{view.nearCorners[0], view.nearCorners[0]};
    for (const glm::vec3& corner : view.nearCorners) {
        nearBounds.lower = glm::min(nearBounds.lower, corner);
        nearBounds.upper = glm::max(nearBounds.upper, corner);
    }
    const Aabb range = lightBounds(light);
    gpu::VolumeConstants block;
    block.clipFromEye = clipFromEye(view);
    block.lightEs = directional ? glm::vec4(light.direction(), 0.0f) : glm::vec4(light.position() - view.eye, 1.0f);
    block.nearLowerEs = glm::vec4(nearBounds.lower - view.eye, bounded ? 1.0f : 0.0f);
    block.nearUpperEs = glm::vec4(nearBounds.upper - view.eye, 0.0f);
    block.rangeLowerEs = glm::vec4(range.lower - view.eye, 0.0f);
    block.rangeUpperEs = glm::vec4(range.upper - view.eye, 0.0f);
    return block;
}

VkDeviceSize viewStencilMemory(VkExtent2D extent)
{
    // Depth and stencil take 8 bytes a pixel on many devices, the buffer 4.
    const VkDeviceSize pixels = VkDeviceSize{extent.width} * extent.height;
    return 8 * pixels + pooledSize(4 * pixels) + pooledSize(sizeof(gpu::ReceiverBounds));
}

VkDeviceSize stripMemory(VkExtent2D extent)
{
    const VkExtent2D count = stripExtent(extent);
    return pooledSize(VkDeviceSize{sizeof(gpu::ReceiverBox)} * count.width * count.height);
}

} // namespace gnomon
