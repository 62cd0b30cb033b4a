#include "demo/program/picture_views.hpp"

#include <algorithm>

#include "demo/host/pipelines.hpp"
#include "demo/program/aliasing.hpp"
#include "demo/program/pictures.hpp"
#include "shaders/demo/frame.h"
#include "shaders/demo_error_view_frag.h"
#include "shaders/demo_lighting_vert.h"
#include "shaders/demo_texel_widths_frag.h"

namespace gnomon::demo {
namespace {

constexpr Access kCopied{VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                         VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
constexpr Access kDrawn{VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
                        VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
constexpr Access kRead{VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_READ_BIT};
constexpr Access kAdded{VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                        VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};
constexpr Access kTransferred{VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};

UniqueDescriptorPool makeBufferPool(const Device& device)
{
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1};
    const VkDescriptorPoolCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 1, .poolSizeCount = 1, .pPoolSizes = &size};
    VkDescriptorPool pool = VK_NULL_HANDLE;
    vkCheck(vkCreateDescriptorPool(device.handle, &info, nullptr, &pool), "vkCreateDescriptorPool");
    return {device.handle, pool};
}

const Device& countsInFragments(const Device& device)
{
    if (!device.contextInfo().pEnabledFeatures->features.fragmentStoresAndAtomics)
        throw HostError("the view of errors needs fragmentStoresAndAtomics, which this device lacks");
    return device;
}

glm::vec4 colourOf(const Rgb8& colour)
{
    return glm::vec4(colour.r, colour.g, colour.b, 255.0f) / 255.0f;
}

} // namespace

PicturePass::PicturePass(const Device& device, const Renderer& renderer, const Description& description)
    : pushBytes_(description.pushBytes),
      buffer_(makeBuffer(device, description.bufferSize,
                         VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, true)),
      descriptors_(makeBufferPool(device))
{
    const VkDescriptorSetLayoutBinding binding[] = {
        {0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr}};
    setLayout_ = makeSetLayout(device, binding);
    std::vector<VkDescriptorSetLayout> layouts{renderer.frameSetLayout()};
    layouts.resize(1 + description.imageSets, renderer.imageSetLayout());
    layouts.push_back(setLayout_.get());
    layout_ = makePipelineLayout(device, layouts, pushBytes_, VK_SHADER_STAGE_FRAGMENT_BIT);
    pipeline_ = makeGraphicsPipeline(device, {.vertex = k_demo_lighting_vert,
                                              .fragment = description.fragment,
                                              .layout = layout_.get(),
                                              .colour = Renderer::kColourFormat});
    const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                           .descriptorPool = descriptors_.get(),
                                           .descriptorSetCount = 1,
                                           .pSetLayouts = &layouts.back()};
    vkCheck(vkAllocateDescriptorSets(device.handle, &info, &set_), "vkAllocateDescriptorSets");
    const VkDescriptorBufferInfo bufferInfo{buffer_.get(), 0, VK_WHOLE_SIZE};
    const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                     .dstSet = set_,
                                     .descriptorCount = 1,
                                     .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                     .pBufferInfo = &bufferInfo};
    vkUpdateDescriptorSets(device.handle, 1, &write, 0, nullptr);
}

void PicturePass::draw(VkCommandBuffer cmd, const Image& picture, std::span<const VkDescriptorSet> sets, uint32_t left,
                       const void* push) const
{
    const VkImageMemoryBarrier2 before[] = {imageBarrier(picture.get(), VK_IMAGE_ASPECT_COLOR_BIT, kCopied, kDrawn)};
    cmdBarrier(cmd, before);
    const VkRect2D area{{static_cast<int32_t>(left), 0}, {picture.extent.width - left, picture.extent.height}};
    const VkRenderingAttachmentInfo colour{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                           .imageView = picture.view.get(),
                                           .imageLayout = kDrawn.layout,
                                           .loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE, // all of the area is drawn
                                           .storeOp = VK_ATTACHMENT_STORE_OP_STORE};
    const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                    .renderArea = area,
                                    .layerCount = 1,
                                    .colorAttachmentCount = 1,
                                    .pColorAttachments = &colour};
    vkCmdBeginRendering(cmd, &rendering);
    cmdSetArea(cmd, picture.extent);
    vkCmdSetScissor(cmd, 0, 1, &area);
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_.get());
    const auto count = static_cast<uint32_t>(sets.size());
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), 0, count, sets.data(), 0, nullptr);
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), count, 1, &set_, 0, nullptr);
    if (pushBytes_ > 0) vkCmdPushConstants(cmd, layout_.get(), VK_SHADER_STAGE_FRAGMENT_BIT, 0, pushBytes_, push);
    vkCmdDraw(cmd, 3, 1, 0, 0);
    vkCmdEndRendering(cmd);
    const VkImageMemoryBarrier2 after[] = {imageBarrier(picture.get(), VK_IMAGE_ASPECT_COLOR_BIT, kDrawn, kCopied)};
    cmdBarrier(cmd, after);
}

ErrorView::ErrorView(const Device& device, const Renderer& renderer)
    : pass_(countsInFragments(device), renderer,
            {.fragment = k_demo_error_view_frag,
             .imageSets = 2,
             .bufferSize = gpu::ERROR_COUNTS * sizeof(glm::uvec2),
             .pushBytes = 2 * sizeof(glm::vec4)})
{
}

// The truth's images were made readable for fragment shaders by its own frame, earlier on the queue.
void ErrorView::record(VkCommandBuffer cmd, const Renderer& judged, const Renderer& truth, uint32_t left) const
{
    cmdMemoryBarrier(cmd, kAdded, kTransferred);
    vkCmdFillBuffer(cmd, pass_.buffer().get(), 0, VK_WHOLE_SIZE, 0);
    cmdMemoryBarrier(cmd, kTransferred, kAdded);
    const Renderer::NewestSets lit = truth.newestSets();
    const VkDescriptorSet sets[] = {lit.frame, lit.images, judged.newestSets().images};
    const glm::vec4 colours[] = {colourOf(kFalseLit), colourOf(kFalseShadow)};
    pass_.draw(cmd, judged.colour(), sets, left, colours);
    cmdMemoryBarrier(cmd, kAdded, {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT});
}

ErrorView::Counts ErrorView::counts() const
{
    Counts sum;
    for (const glm::uvec2& part : pass_.buffer().as<glm::uvec2>()) {
        sum.counted += part.x;
        sum.wrong += part.y;
    }
    return sum;
}

TexelView::TexelView(const Device& device, const Renderer& renderer)
    : pass_(device, renderer, {.fragment = k_demo_texel_widths_frag, .bufferSize = sizeof(gpu::DemoMap)})
{
}

void TexelView::record(VkCommandBuffer cmd, const Renderer& renderer, const GnLightMap& map, uint32_t layer) const
{
    gpu::DemoMap data{};
    data.extent = glm::vec2(map.extent.width, map.extent.height);
    data.light = layer;
    for (const glm::dmat4& clipFromEye : layersOf(map, renderer.camera().eye))
        data.clipFromEye[data.layers++] = glm::mat4(clipFromEye);
    cmdMemoryBarrier(cmd, kRead, kTransferred);
    vkCmdUpdateBuffer(cmd, pass_.buffer().get(), 0, sizeof data, &data);
    cmdMemoryBarrier(cmd, kTransferred, kRead);
    const Renderer::NewestSets sets = renderer.newestSets();
    const VkDescriptorSet bound[] = {sets.frame, sets.images};
    pass_.draw(cmd, renderer.colour(), bound, 0);
}

} // namespace gnomon::demo
