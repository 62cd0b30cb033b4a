#include "algorithms/volumes/view_stencil.hpp"

#include "runtime/passes/area_copy.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "shaders/volumes/receiver_tile.h"

#include "shaders/volumes_receiver_strips_comp.h"
#include "shaders/volumes_receiver_tiles_comp.h"

namespace gnomon {

namespace {

/// Block of receiver_strips.comp, std140.
struct StripConstants {
    gpu::ViewConstants view;
    glm::uvec4 area;
    glm::uvec4 sizes;
};

std::uint32_t roundedUp(std::uint32_t value, std::uint32_t unit)
{
    return (value + unit - 1) / unit * unit;
}

/// Pixels in a row of the buffer: strips are read and written whole.
std::uint32_t bufferWidth(VkExtent2D extent)
{
    return roundedUp(extent.width, gpu::FOUR);
}

VkDeviceSize depthsSize(VkExtent2D extent)
{
    return VkDeviceSize{4} * bufferWidth(extent) * extent.height;
}

/// The depths of what the view draws, each where it lies in the whole buffer.
VkBufferImageCopy2 drawnDepths(const CameraView& view)
{
    return areaCopy(view.area, VK_IMAGE_ASPECT_DEPTH_BIT, bufferWidth(view.extent), sizeof(float));
}

void recordDepthOut(const PassContext& gpu, ImageId depth, BufferId buffer, BufferId bounds,
                    const VkBufferImageCopy2& region)
{
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

void recordDepthIn(const PassContext& gpu, BufferId buffer, ImageId image, const VkBufferImageCopy2& region)
{
    const VkCopyBufferToImageInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_BUFFER_TO_IMAGE_INFO_2,
                                        .srcBuffer = gpu.buffer(buffer),
                                        .dstImage = gpu.image(image),
                                        .dstImageLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                        .regionCount = 1,
                                        .pRegions = &region};
    gpu.vk->vkCmdCopyBufferToImage2(gpu.cmd, &copy);
}

/// Column where the first strip of a row begins.
std::uint32_t firstColumn(const VkRect2D& area)
{
    return static_cast<std::uint32_t>(area.offset.x) / gpu::FOUR * gpu::FOUR;
}

/// Tiles in a row of an area, and rows of strips.
VkExtent2D stripExtent(const VkRect2D& area)
{
    const std::uint32_t columns = static_cast<std::uint32_t>(area.offset.x) + area.extent.width - firstColumn(area);
    return {roundedUp(columns, gpu::TILE_COLUMNS) / gpu::TILE_COLUMNS,
            roundedUp(area.extent.height, gpu::STRIP_ROWS) / gpu::STRIP_ROWS};
}

VkDeviceSize sizeOf(VkExtent2D tiles)
{
    return VkDeviceSize{sizeof(gpu::ReceiverTile)} * tiles.width * tiles.height;
}

std::uint32_t groups(std::uint32_t invocations)
{
    return (invocations + gpu::STRIP_GROUP - 1) / gpu::STRIP_GROUP;
}

void declareStrips(PassBuilder& passes, PipelineId pipeline, const ShadowTask& task, BufferId depths, BufferId strips)
{
    const CameraView* view = task.view;
    // Without normals the shader does not use them; something must be bound.
    const ImageId normals = task.normals ? task.normals : task.depth;
    PassRef pass = passes.compute("volumes.receiver_strips", Scope::view);
    pass.samples(normals).updates(depths).writes(strips).record([=](PassContext& gpu) {
        const VkRect2D& area = view->area;
        const VkExtent2D count = stripExtent(area);
        const StripConstants block{.view = view->constants,
                                   .area = {area.offset.x, area.offset.y, area.extent.width, area.extent.height},
                                   .sizes = {firstColumn(area), count.width, count.width * count.height,
                                             bufferWidth(view->extent) / gpu::FOUR}};
        gpu.bind(pipeline, {gpu.constants(0, block), gpu.storage(1, depths),
                            gpu.sampled(2, normals, SamplerKind::nearest, 0), gpu.storage(3, strips)});
        gpu.vk->vkCmdDispatch(gpu.cmd, groups(block.sizes.z), 1, 1);
    });
}

void declareTiles(PassBuilder& passes, PipelineId pipeline, const CameraView* view, BufferId strips, BufferId tiles,
                  BufferId bounds)
{
    PassRef pass = passes.compute("volumes.receiver_tiles", Scope::view);
    pass.reads(strips).writes(tiles).updates(bounds).record([=](PassContext& gpu) {
        const VkExtent2D extent = tileExtent(view->area);
        const glm::uvec4 size(extent.width, stripExtent(view->area).height, extent.width * extent.height, 0);
        gpu.bind(pipeline,
                 {gpu.constants(0, size), gpu.storage(1, strips), gpu.storage(2, tiles), gpu.storage(3, bounds)});
        gpu.vk->vkCmdDispatch(gpu.cmd, groups(size.z), 1, 1);
    });
}

} // namespace

const char* missingForStencil(const DeviceTable& vk)
{
    constexpr VkFormatFeatureFlags used = VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT |
                                          VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_TRANSFER_DST_BIT;
    return supports(vk, kStencilFormat, used) ? nullptr : "needs D32_SFLOAT_S8_UINT";
}

ViewStencilPipelines makeViewStencilPipelines(const AlgorithmServices& services)
{
    return {.strips = services.pipelines->compute(
                "volumes.receiver_strips", {k_volumes_receiver_strips_comp},
                {constantsAt(0), bufferAt(1), sampledAt(2, VK_FORMAT_R16G16B16A16_SFLOAT), bufferAt(3)}),
            .tiles = services.pipelines->compute("volumes.receiver_tiles", {k_volumes_receiver_tiles_comp},
                                                 {constantsAt(0), bufferAt(1), bufferAt(2), bufferAt(3)})};
}

const char* refusesView(const DeviceTable& vk, const CameraView& view)
{
    // The largest of its buffers, bound up to a power of two; strips take 64 bytes for 128 pixels.
    return fitsBinding(vk, depthsSize(view.extent)) ? nullptr : "the view has more pixels than a storage buffer holds";
}

VkExtent2D tileExtent(const VkRect2D& area)
{
    const VkExtent2D strips = stripExtent(area);
    return {strips.width, roundedUp(strips.height, gpu::STRIPS_A_TILE) / gpu::STRIPS_A_TILE};
}

ViewStencil declareViewStencil(PassBuilder& passes, const ViewStencilPipelines& pipelines, const ShadowTask& task)
{
    const VkExtent2D extent = task.view->extent;
    const VkRect2D& area = task.view->area;
    const auto buffer = [&](const char* name, VkDeviceSize size) {
        return passes.transient(BufferInfo{.name = name, .scope = Scope::view, .size = size});
    };
    // Depth and depth-stencil images cannot be copied to each other directly; through a buffer the bits survive.
    const BufferId depths = buffer("volumes.depths", depthsSize(extent));
    const BufferId bounds = buffer("volumes.bounds", sizeof(gpu::ReceiverBounds));
    const BufferId strips = buffer("volumes.strips", sizeOf(stripExtent(area)));
    const BufferId tiles = buffer("volumes.receiver_tiles", sizeOf(tileExtent(area)));
    const ImageId image = passes.transient(
        ImageInfo{.name = "volumes.depth_stencil", .scope = Scope::view, .format = kStencilFormat, .extent = extent});

    const ImageId depth = task.depth;
    const VkBufferImageCopy2 drawn = drawnDepths(*task.view);
    passes.transfer("volumes.depth_out", Scope::view)
        .copies(depth)
        .writes(depths)
        .writes(bounds)
        .record([=](PassContext& gpu) { recordDepthOut(gpu, depth, depths, bounds, drawn); });
    declareStrips(passes, pipelines.strips, task, depths, strips);
    declareTiles(passes, pipelines.tiles, task.view, strips, tiles, bounds);
    passes.transfer("volumes.depth_in", Scope::view).reads(depths).writes(image).record([=](PassContext& gpu) {
        recordDepthIn(gpu, depths, image, drawn);
    });
    return {.image = image,
            .depths = depths,
            .depthColumns = bufferWidth(extent),
            .receiverBounds = bounds,
            .tiles = tiles};
}

glm::mat4 clipFromEye(const CameraView& view)
{
    return glm::mat4(glm::dmat4(view.projection) * glm::dmat4(glm::dmat3(view.viewFromWorld)));
}

bool mirrors(const CameraView& view)
{
    // Of the way from world to clip x, y and w the determinant; skew does not enter it. Clip y grows downwards, linear
    // depth away from the eye: a plain view's is positive.
    const glm::mat4& p = view.projection;
    return p[0][0] * p[1][1] * view.ahead() * glm::determinant(view.viewFromWorld) < 0.0f;
}

/// w of the far corners of a volume without an end. 0 is infinity, which a perspective shows as any other place.
/// Parallel rays all meet it at one point, and what ends there would be missed by every pixel: 2^20 times as far as the
/// light is behind all receivers of a scene of a kilometre from a millimetre on.
float farW(const CameraView& view)
{
    return gpu::isOrthographic(view.constants) ? 0x1p-20f : 0.0f;
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
    block.nearUpperEs = glm::vec4(nearBounds.upper - view.eye, farW(view));
    block.rangeLowerEs = glm::vec4(range.lower - view.eye, 0.0f);
    block.rangeUpperEs = glm::vec4(range.upper - view.eye, 0.0f);
    return block;
}

VkDeviceSize viewStencilMemory(VkExtent2D extent)
{
    // Depth and stencil take 8 bytes a pixel on many devices.
    const VkRect2D whole{{0, 0}, extent};
    return storedImageSize(extent, 8) + pooledSize(depthsSize(extent)) + pooledSize(sizeof(gpu::ReceiverBounds)) +
           pooledSize(sizeOf(stripExtent(whole))) + pooledSize(sizeOf(tileExtent(whole)));
}

} // namespace gnomon
