// What the cameras of a device test's host see: its images, and how they are drawn.
#include <cmath>
#include <utility>

#include "device/fixture.hpp"

namespace gnomon::test {
namespace {

using namespace demo;

struct SurfacePush { // as in surface.vert
    glm::mat4 clipFromObject;
    glm::vec4 eyeFromObject[3];
    glm::vec4 looking; // surface.frag
};

static_assert(sizeof(SurfacePush) == 128);

constexpr Access kAnyEarlierUse{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_NONE, VK_IMAGE_LAYOUT_UNDEFINED};
constexpr Access kAnyRead{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT,
                          VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
constexpr Access kDepthAttachment{
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
    VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
constexpr Access kColourAttachment{VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                                   VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
                                   VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};

VkRenderingAttachmentInfo attachment(VkImageView view, VkImageLayout layout, VkClearValue clear)
{
    return {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
            .imageView = view,
            .imageLayout = layout,
            .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
            .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
            .clearValue = clear};
}

/// One layer of an image as an attachment.
UniqueImageView layerOf(const Image& image, uint32_t layer)
{
    const VkImageViewCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                     .image = image.get(),
                                     .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                     .format = image.format,
                                     .subresourceRange = {aspectOf(image.format), 0, 1, layer, 1}};
    VkImageView view = VK_NULL_HANDLE;
    vkCheck(vkCreateImageView(device().handle, &info, nullptr, &view), "vkCreateImageView");
    return {device().handle, view};
}

} // namespace

void Host::createSurfaces()
{
    constexpr VkImageUsageFlags read = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    const uint32_t layers = target_.layered ? static_cast<uint32_t>(surfaces_.size()) + 1 : 1;
    const auto make = [&](VkFormat format, VkImageUsageFlags usage) {
        return makeImage(
            device(),
            {.format = format, .extent = extent_, .layers = layers, .usage = read | usage, .samples = target_.samples});
    };
    for (uint32_t view = 0; view < surfaces_.size(); ++view) {
        if (!target_.layered || view == 0) {
            surfaces_[view].depth = make(target_.depth, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT);
            surfaces_[view].normals = make(target_.normals, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
        }
        surfaces_[view].depthTarget = layerOf(imagesOf(view).depth, target_.layered ? view : 0);
        surfaces_[view].normalTarget = layerOf(imagesOf(view).normals, target_.layered ? view : 0);
    }
}

void Host::resize(VkExtent2D extent)
{
    retired_.push_back({submission_, std::exchange(surfaces_, std::vector<Surface>(surfaces_.size()))});
    extent_ = extent;
    createSurfaces();
}

void Host::drawSurface(VkCommandBuffer cmd, uint32_t view, const CameraMatrices& camera, const SceneState& state,
                       const FrameOptions& options)
{
    const Surface& surface = imagesOf(view);
    const VkImageAspectFlags aspects = aspectOf(target_.depth);
    const VkImageMemoryBarrier2 before[] = {
        imageBarrier(surface.depth.get(), aspects, kAnyEarlierUse, kDepthAttachment),
        imageBarrier(surface.normals.get(), VK_IMAGE_ASPECT_COLOR_BIT, kAnyEarlierUse, kColourAttachment)};
    if (!target_.layered || view == 0) cmdBarrier(cmd, before);
    const VkRenderingAttachmentInfo colour = attachment(surfaces_[view].normalTarget.get(), kColourAttachment.layout,
                                                        {.color = {{options.outside ? NAN : 0.0f, 0.0f, 0.0f, 0.0f}}});
    const VkRenderingAttachmentInfo depth =
        attachment(surfaces_[view].depthTarget.get(), kDepthAttachment.layout,
                   {.depthStencil = {options.outside.value_or(camera.skyDepth), 0}});
    const bool stencil = target_.depth == VK_FORMAT_D32_SFLOAT_S8_UINT; // as makeGraphicsPipeline() has it
    const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                    .renderArea = {{0, 0}, extent_},
                                    .layerCount = 1,
                                    .colorAttachmentCount = 1,
                                    .pColorAttachments = &colour,
                                    .pDepthAttachment = &depth,
                                    .pStencilAttachment = stencil ? &depth : nullptr};
    vkCmdBeginRendering(cmd, &rendering);
    cmdSetArea(cmd, extent_);
    if (area_.extent.width != 0) {
        const VkViewport viewport{static_cast<float>(area_.offset.x),
                                  static_cast<float>(area_.offset.y),
                                  static_cast<float>(area_.extent.width),
                                  static_cast<float>(area_.extent.height),
                                  0.0f,
                                  1.0f};
        vkCmdSetViewport(cmd, 0, 1, &viewport);
        vkCmdSetScissor(cmd, 0, 1, &area_);
        const VkClearAttachment clear[] = {
            {.aspectMask = VK_IMAGE_ASPECT_DEPTH_BIT, .clearValue = {.depthStencil = {camera.skyDepth, 0}}},
            {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .colorAttachment = 0, .clearValue = {}}};
        const VkClearRect rect{area_, 0, 1};
        if (options.outside) vkCmdClearAttachments(cmd, 2, clear, 1, &rect);
    }
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_.get());
    const VkBuffer positions = geometry_.positions.get();
    const VkDeviceSize offset = 0;
    vkCmdBindVertexBuffers(cmd, 0, 1, &positions, &offset);
    vkCmdBindIndexBuffer(cmd, geometry_.indices.get(), 0, VK_INDEX_TYPE_UINT32);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        if (hidden_[i] || scene.instances[i].hostDrawn) continue; // what the host draws itself only casts here
        const glm::dmat3& m = state.instances[i].linear;
        const glm::dvec3 t = state.instances[i].translation - camera.eye;
        SurfacePush push{};
        push.clipFromObject = camera.clipFromEye * glm::mat4(glm::vec4(m[0], 0.0f), glm::vec4(m[1], 0.0f),
                                                             glm::vec4(m[2], 0.0f), glm::vec4(glm::vec3(t), 1.0f));
        for (int row = 0; row < 3; ++row)
            push.eyeFromObject[row] = glm::vec4(m[0][row], m[1][row], m[2][row], t[row]);
        const bool orthographic = camera.projection[2][3] == 0.0f;
        push.looking = glm::vec4(orthographic ? glm::inverse(glm::mat3(camera.clipFromEye))[2] *
                                                    (camera.skyDepth == 0.0f ? -1.0f : 1.0f)
                                              : glm::vec3(0.0f),
                                 static_cast<float>(target_.encoding));
        vkCmdPushConstants(cmd, layout_.get(), VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                           sizeof push, &push);
        const MeshRange& mesh = geometry_.meshes[scene.instances[i].mesh];
        vkCmdDrawIndexed(cmd, mesh.indexCount, 1, mesh.firstIndex, mesh.vertexOffset, 0);
    }
    if (options.normals) {
        const float is = options.normals->second;
        const VkClearAttachment normals{
            .aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .colorAttachment = 0, .clearValue = {.color = {{is, is, is, is}}}};
        const VkClearRect rect{options.normals->first, 0, 1};
        vkCmdClearAttachments(cmd, 1, &normals, 1, &rect);
    }
    vkCmdEndRendering(cmd);
    const VkImageMemoryBarrier2 after[] = {
        imageBarrier(surface.depth.get(), aspects, kDepthAttachment, kAnyRead),
        imageBarrier(surface.normals.get(), VK_IMAGE_ASPECT_COLOR_BIT, kColourAttachment, kAnyRead)};
    if (!target_.layered || view + 1 == surfaces_.size()) cmdBarrier(cmd, after);
}

GnViewFrame Host::viewFrame(uint32_t view, const CameraMatrices& camera, const std::vector<GnLight>& lit) const
{
    const Surface& surface = imagesOf(view);
    GnViewFrame out{};
    out.view = views[view];
    for (int i = 0; i < 3; ++i)
        out.eye[i] = camera.eye[i];
    for (int i = 0; i < 9; ++i)
        out.viewFromWorld[i] = camera.viewFromWorld[i % 3][i / 3];
    for (int i = 0; i < 16; ++i)
        out.projection[i] = camera.projection[i / 4][i % 4];
    out.depthConvention =
        scene.depth.convention == DepthConvention::Standard ? GN_DEPTH_STANDARD : GN_DEPTH_REVERSED_INFINITE;
    out.depthImage = surface.depth.get();
    out.depthView = surface.depth.view.get();
    out.depthFormat = target_.depth;
    out.imageExtent = extent_;
    out.renderArea = area_;
    out.normalImage = surface.normals.get();
    out.normalView = surface.normals.view.get();
    out.normalFormat = target_.normals;
    out.normalEncoding = target_.encoding;
    out.imageSamples = target_.samples;
    if (target_.layered) {
        out.imageLayers = static_cast<uint32_t>(surfaces_.size()) + 1;
        out.imageLayer = view;
    }
    out.lightCount = static_cast<uint32_t>(lit.size());
    out.pLights = lit.data();
    return out;
}

} // namespace gnomon::test
