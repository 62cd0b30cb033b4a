// One frame: what Renderer records and submits.
#include <algorithm>

#include "demo/host/renderer.hpp"

namespace gnomon::demo {
namespace {

constexpr Access kAnyRead{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT,
                          VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
// Last frame's readers, ours and gnomon's, must be through before we overwrite; the content itself is not kept.
constexpr Access kAnyEarlierUse{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_NONE, VK_IMAGE_LAYOUT_UNDEFINED};
constexpr Access kDepthAttachment{
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
    VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL};
constexpr Access kColourAttachment{VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                                   VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
                                   VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};

VkRenderingAttachmentInfo attachment(VkImageView view, VkImageLayout layout, VkAttachmentLoadOp load,
                                     VkClearValue clear = {})
{
    return {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
            .imageView = view,
            .imageLayout = layout,
            .loadOp = load,
            .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
            .clearValue = clear};
}

GnViewFrame viewFrame(const Scene& scene, const CameraMatrices& camera, const Image& depth, const Image& normals,
                      GnView view, const std::vector<GnLight>& lights, bool cameraCut)
{
    GnViewFrame out{};
    out.view = view;
    for (int i = 0; i < 3; ++i)
        out.eye[i] = camera.eye[i];
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            out.viewFromWorld[row * 3 + column] = camera.viewFromWorld[column][row];
    for (int i = 0; i < 16; ++i)
        out.projection[i] = camera.projection[i / 4][i % 4];
    out.depthConvention =
        scene.depth.convention == DepthConvention::Standard ? GN_DEPTH_STANDARD : GN_DEPTH_REVERSED_INFINITE;
    out.depthImage = depth.get();
    out.depthView = depth.view.get();
    out.depthFormat = depth.format;
    out.imageExtent = depth.extent;
    out.normalImage = normals.get();
    out.normalView = normals.view.get();
    out.normalFormat = normals.format;
    out.lightCount = static_cast<uint32_t>(lights.size());
    out.pLights = lights.data();
    out.cameraCut = cameraCut;
    return out;
}

} // namespace

void Renderer::draw(const FrameRequest& request)
{
    if (request.cameras.size() != views_.size()) throw HostError("one camera per view is needed");
    SceneState state = stateAt(scene_, request.time);
    if (state.present.size() > options_.maxLights)
        throw HostError(std::to_string(state.present.size()) + " lights are present, the view holds " +
                        std::to_string(options_.maxLights));
    state_ = std::move(state);
    ++frame_;
    if (frame_ > options_.framesInFlight) waitForFrame(frame_ - options_.framesInFlight);
    retire();

    for (uint32_t view = 0; view < views_.size(); ++view)
        writeFrameData(view, request);

    Slot& slot = slots_[frame_ % options_.framesInFlight];
    vkCheck(vkResetCommandPool(device_.handle, slot.pool.get(), 0), "vkResetCommandPool");
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    vkCheck(vkBeginCommandBuffer(slot.before, &begin), "vkBeginCommandBuffer");
    for (uint32_t view = 0; view < views_.size(); ++view)
        recordPrepass(slot.before, view);
    if (!request.shadows) clearOnes(slot.before);

    // With gnSubmitShadows the frame is three submissions: ours, gnomon's, ours. Otherwise two of ours suffice, and the
    // frame without any shadows keeps the same two, so that differences are gnomon's alone.
    VkImageView otherVisibility = VK_NULL_HANDLE;
    if (request.other) {
        const SlotOfView& data = views_[0].slots[frame_ % options_.framesInFlight];
        request.other->record(slot.before,
                              {data.frameSet, views_[0].images.depth.view.get(), extent_, &views_[0].camera, &state_});
        otherVisibility = request.other->visibility();
    }
    if (request.shadows && request.recorded) callGnomon(request, slot.before);
    vkCheck(vkEndCommandBuffer(slot.before), "vkEndCommandBuffer");
    submit(slot.before, nullptr, false);
    if (request.shadows && !request.recorded) callGnomon(request, VK_NULL_HANDLE);

    vkCheck(vkBeginCommandBuffer(slot.after, &begin), "vkBeginCommandBuffer");
    for (uint32_t view = 0; view < views_.size(); ++view) {
        VkImageView visibility = otherVisibility && view == 0 ? otherVisibility : ones_.view.get();
        if (request.shadows) {
            GnVisibility found{};
            if (gnGetVisibility(request.shadows->context(), request.shadows->view(view), &found) < 0)
                throw HostError(gnGetLastError(request.shadows->context()));
            visibility = found.imageView;
        }
        recordLighting(slot.after, view, visibility);
    }
    if (request.overlay) request.overlay(slot.after, views_[0].images.colour);
    if (request.present) recordPresent(slot.after, *request.present);
    vkCheck(vkEndCommandBuffer(slot.after), "vkEndCommandBuffer");
    submit(slot.after, request.present, true);
}

void Renderer::callGnomon(const FrameRequest& request, VkCommandBuffer cmd)
{
    ShadowHost& shadows = *request.shadows;
    shadows.update(state_);
    const std::vector<GnLight> lights = shadows.present(state_);
    std::vector<GnViewFrame> frames;
    for (uint32_t i = 0; i < views_.size(); ++i)
        frames.push_back(viewFrame(scene_, views_[i].camera, views_[i].images.depth, views_[i].images.normals,
                                   shadows.view(i), lights, request.cameraCut));
    GnFrameInfo info{};
    info.frame = gnomonFrame_ + 1;
    info.completedFrame = gnomonCompleted_;
    info.flags = request.flags;
    info.budgetMs = request.budgetMs;
    info.viewCount = static_cast<uint32_t>(frames.size());
    info.pViews = frames.data();
    const GnResult result =
        cmd ? gnCmdRenderShadows(shadows.context(), cmd, &info) : gnSubmitShadows(shadows.context(), &info);
    if (result < 0)
        throw HostError(std::string(cmd ? "gnCmdRenderShadows: " : "gnSubmitShadows: ") +
                        gnGetLastError(shadows.context()));
    gnomonFrames_.emplace_back(frame_, ++gnomonFrame_);
}

void Renderer::recordPrepass(VkCommandBuffer cmd, uint32_t index)
{
    View& view = views_[index];
    const VkImageMemoryBarrier2 before[] = {
        imageBarrier(view.images.depth.get(), VK_IMAGE_ASPECT_DEPTH_BIT, kAnyEarlierUse, kDepthAttachment),
        imageBarrier(view.images.normals.get(), VK_IMAGE_ASPECT_COLOR_BIT, kAnyEarlierUse, kColourAttachment)};
    cmdBarrier(cmd, before);

    const VkClearValue sky{.depthStencil = {view.camera.skyDepth, 0}};
    const VkRenderingAttachmentInfo colour =
        attachment(view.images.normals.view.get(), kColourAttachment.layout, VK_ATTACHMENT_LOAD_OP_CLEAR);
    const VkRenderingAttachmentInfo depth =
        attachment(view.images.depth.view.get(), kDepthAttachment.layout, VK_ATTACHMENT_LOAD_OP_CLEAR, sky);
    const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                    .renderArea = {{0, 0}, extent_},
                                    .layerCount = 1,
                                    .colorAttachmentCount = 1,
                                    .pColorAttachments = &colour,
                                    .pDepthAttachment = &depth};
    vkCmdBeginRendering(cmd, &rendering);
    cmdSetArea(cmd, extent_);
    drawInstances(cmd, view);
    vkCmdEndRendering(cmd);

    const VkImageMemoryBarrier2 after[] = {
        imageBarrier(view.images.depth.get(), VK_IMAGE_ASPECT_DEPTH_BIT, kDepthAttachment, kAnyRead),
        imageBarrier(view.images.normals.get(), VK_IMAGE_ASPECT_COLOR_BIT, kColourAttachment, kAnyRead)};
    cmdBarrier(cmd, after);
}

void Renderer::drawInstances(VkCommandBuffer cmd, const View& view)
{
    const SlotOfView& slot = view.slots[frame_ % options_.framesInFlight];
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, prepassLayout_.get(), 0, 1, &slot.frameSet, 0,
                            nullptr);
    const VkBuffer positions = geometry_.positions.get();
    const VkDeviceSize offset = 0;
    vkCmdBindVertexBuffers(cmd, 0, 1, &positions, &offset);
    vkCmdBindIndexBuffer(cmd, geometry_.indices.get(), 0, VK_INDEX_TYPE_UINT32);
    for (uint32_t pipeline = 0; pipeline < prepass_.size(); ++pipeline) {
        bool bound = false;
        for (uint32_t i = 0; i < scene_.instances.size(); ++i) {
            const Instance& instance = scene_.instances[i];
            const MeshRange& mesh = geometry_.meshes[instance.mesh];
            const uint32_t wanted = (drawsBothSides(instance, mesh) ? 1u : 0u) | (instance.alphaTested ? 2u : 0u);
            if (wanted != pipeline || !onScreen(view.camera, mesh, state_.instances[i])) continue;
            if (!std::exchange(bound, true))
                vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, prepass_[pipeline].get());
            vkCmdSetFrontFace(cmd, frontFaceOf(state_.instances[i]));
            vkCmdDrawIndexed(cmd, mesh.indexCount, 1, mesh.firstIndex, mesh.vertexOffset, i);
        }
    }
}

void Renderer::clearOnes(VkCommandBuffer cmd)
{
    if (std::exchange(onesCleared_, true)) return;
    const Access clear{VK_PIPELINE_STAGE_2_CLEAR_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL};
    const VkImageMemoryBarrier2 before[] = {
        imageBarrier(ones_.get(), VK_IMAGE_ASPECT_COLOR_BIT, {.layout = VK_IMAGE_LAYOUT_UNDEFINED}, clear)};
    cmdBarrier(cmd, before);
    const VkClearColorValue one{.float32 = {1.0f, 1.0f, 1.0f, 1.0f}};
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, VK_REMAINING_ARRAY_LAYERS};
    vkCmdClearColorImage(cmd, ones_.get(), clear.layout, &one, 1, &all);
    const VkImageMemoryBarrier2 after[] = {imageBarrier(ones_.get(), VK_IMAGE_ASPECT_COLOR_BIT, clear, kAnyRead)};
    cmdBarrier(cmd, after);
}

void Renderer::recordLighting(VkCommandBuffer cmd, uint32_t index, VkImageView visibility)
{
    View& view = views_[index];
    view.visibility = visibility;
    view.layers = static_cast<uint32_t>(state_.present.size());
    SlotOfView& slot = view.slots[frame_ % options_.framesInFlight];
    const std::array<VkImageView, 3> wanted = {view.images.depth.view.get(), view.images.normals.view.get(),
                                               visibility};
    if (slot.bound != wanted) { // the set's last frame has been waited for
        VkDescriptorImageInfo images[3];
        for (size_t i = 0; i < 3; ++i)
            images[i] = {sampler_.get(), wanted[i], VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
        const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                         .dstSet = slot.imageSet,
                                         .descriptorCount = 3,
                                         .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                         .pImageInfo = images};
        vkUpdateDescriptorSets(device_.handle, 1, &write, 0, nullptr);
        slot.bound = wanted;
    }

    const VkImageMemoryBarrier2 before[] = {
        imageBarrier(view.images.colour.get(), VK_IMAGE_ASPECT_COLOR_BIT, kAnyEarlierUse, kColourAttachment)};
    cmdBarrier(cmd, before);
    const VkRenderingAttachmentInfo colour =
        attachment(view.images.colour.view.get(), kColourAttachment.layout, VK_ATTACHMENT_LOAD_OP_DONT_CARE);
    const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                    .renderArea = {{0, 0}, extent_},
                                    .layerCount = 1,
                                    .colorAttachmentCount = 1,
                                    .pColorAttachments = &colour};
    vkCmdBeginRendering(cmd, &rendering);
    cmdSetArea(cmd, extent_);
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, lighting_.get());
    const VkDescriptorSet sets[] = {slot.frameSet, slot.imageSet};
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, lightingLayout_.get(), 0, 2, sets, 0, nullptr);
    vkCmdDraw(cmd, 3, 1, 0, 0);
    vkCmdEndRendering(cmd);
    const Access copied{VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                        VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    const VkImageMemoryBarrier2 after[] = {
        imageBarrier(view.images.colour.get(), VK_IMAGE_ASPECT_COLOR_BIT, kColourAttachment, copied)};
    cmdBarrier(cmd, after);
}

void Renderer::recordPresent(VkCommandBuffer cmd, const PresentTarget& target)
{
    // The stage is the one the acquire semaphore is waited in (submit), which orders the layout change after it.
    const Access blit{VK_PIPELINE_STAGE_2_BLIT_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                      VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL};
    const VkImageMemoryBarrier2 before[] = {
        imageBarrier(target.image, VK_IMAGE_ASPECT_COLOR_BIT,
                     {VK_PIPELINE_STAGE_2_BLIT_BIT, VK_ACCESS_2_NONE, VK_IMAGE_LAYOUT_UNDEFINED}, blit)};
    cmdBarrier(cmd, before);
    const auto corner = [](VkExtent2D e) { return VkOffset3D{int32_t(e.width), int32_t(e.height), 1}; };
    const VkImageBlit region{.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                             .srcOffsets = {{0, 0, 0}, corner(extent_)},
                             .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                             .dstOffsets = {{0, 0, 0}, corner(target.extent)}};
    vkCmdBlitImage(cmd, views_[0].images.colour.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target.image, blit.layout,
                   1, &region, VK_FILTER_NEAREST);
    const VkImageMemoryBarrier2 after[] = {
        imageBarrier(target.image, VK_IMAGE_ASPECT_COLOR_BIT, blit,
                     // The stage chains the layout change to the semaphore that presentation waits for.
                     {VK_PIPELINE_STAGE_2_BLIT_BIT, VK_ACCESS_2_NONE, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR})};
    cmdBarrier(cmd, after);
}

void Renderer::submit(VkCommandBuffer cmd, const PresentTarget* present, bool last)
{
    const VkCommandBufferSubmitInfo command{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                            .commandBuffer = cmd};
    VkSemaphoreSubmitInfo wait{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                               .stageMask = VK_PIPELINE_STAGE_2_BLIT_BIT};
    VkSemaphoreSubmitInfo signals[2] = {
        {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
         .semaphore = timeline_.get(),
         .value = frame_,
         .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT},
        {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT}};
    if (present) {
        wait.semaphore = present->acquired;
        signals[1].semaphore = present->drawn;
    }
    const VkSubmitInfo2 info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                             .waitSemaphoreInfoCount = present ? 1u : 0u,
                             .pWaitSemaphoreInfos = &wait,
                             .commandBufferInfoCount = 1,
                             .pCommandBufferInfos = &command,
                             .signalSemaphoreInfoCount = !last     ? 0u
                                                         : present ? 2u
                                                                   : 1u,
                             .pSignalSemaphoreInfos = signals};
    vkCheck(vkQueueSubmit2(device_.queue, 1, &info, VK_NULL_HANDLE), "vkQueueSubmit2");
    if (last) submitted_ = frame_;
}

} // namespace gnomon::demo
