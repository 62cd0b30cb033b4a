#include "demo/program/bench_bare.hpp"

#include <cmath>

#include "demo/host/pipelines.hpp"
#include "shaders/demo_bare_map_vert.h"
#include "shaders/demo_bare_resolve_frag.h"
#include "shaders/demo_bare_resolve_vert.h"

namespace gnomon::demo {
namespace {

constexpr VkFormat kMapFormat = VK_FORMAT_D32_SFLOAT;
constexpr float kMapNear = 0.1f; // metres; no shipped caster is nearer to its light

// Slope-scaled bias for open casters, in the units of vkCmdSetDepthBias; back faces of closed ones need none.
constexpr float kOpenConstantBias = 2.0f, kOpenSlopeBias = 2.0f;

constexpr Access kMapWritten{VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
                             VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                                 VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
                             VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL};
constexpr Access kSampled{VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                          VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
constexpr Access kSampledBefore{VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_ACCESS_2_NONE, VK_IMAGE_LAYOUT_UNDEFINED};
constexpr Access kWritten{VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
                          VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};

glm::mat4 spotClipFromEye(const Light& light, const LightState& state, const glm::dvec3& eye)
{
    const glm::dvec3 forward = state.direction;
    const glm::dvec3 helper = std::abs(forward.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, helper)), down = glm::cross(forward, right);
    const glm::dmat3 lightFromWorld = glm::transpose(glm::dmat3(right, down, forward));
    glm::dmat4 view(lightFromWorld);
    view[3] = glm::dvec4(lightFromWorld * -(state.position - eye), 1.0);
    const double scale = 1.0 / std::tan(double(light.outerAngle)), n = double(kMapNear), f = double(light.range);
    glm::dmat4 projection(0.0); // depth 0 at the near plane, 1 at the range
    projection[0][0] = projection[1][1] = scale;
    projection[2][2] = f / (f - n);
    projection[2][3] = 1.0;
    projection[3][2] = -n * f / (f - n);
    return glm::mat4(projection * view);
}

} // namespace

BareShadowMap::BareShadowMap(const Device& device, const Scene& scene, const SceneGeometry& geometry,
                             const Renderer& renderer, uint32_t resolution)
    : device_(device), scene_(scene), geometry_(geometry), sampler_(makeNearestSampler(device))
{
    map_ = makeImage(device, {.format = kMapFormat,
                              .extent = {resolution, resolution},
                              .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT});
    visibility_ = makeImage(device, {.format = VK_FORMAT_R8_UNORM,
                                     .extent = renderer.extent(),
                                     .arrayView = true,
                                     .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT});
    const VkDescriptorSetLayoutBinding bindings[] = {
        {0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr},
        {1, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr}};
    imageLayout_ = makeSetLayout(device, bindings);
    const VkDescriptorSetLayout layouts[] = {renderer.frameSetLayout(), imageLayout_.get()};
    mapLayout_ = makePipelineLayout(device, std::span(layouts).first(1), sizeof(glm::mat4), VK_SHADER_STAGE_VERTEX_BIT);
    resolveLayout_ = makePipelineLayout(device, layouts, sizeof(glm::mat4),
                                        VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT);
    GraphicsDescription map{.vertex = k_demo_bare_map_vert,
                            .fragment = {},
                            .layout = mapLayout_.get(),
                            .readsPositions = true,
                            .depth = kMapFormat,
                            .depthCompare = VK_COMPARE_OP_LESS,
                            .dynamicDepthBias = true};
    open_ = makeGraphicsPipeline(device, map);
    // The light's image keeps left and right as a camera's does, so front faces stay counter-clockwise.
    map.cull = VK_CULL_MODE_FRONT_BIT;
    map.dynamicFrontFace = true;
    closed_ = makeGraphicsPipeline(device, map);
    resolve_ = makeGraphicsPipeline(device, {.vertex = k_demo_bare_resolve_vert,
                                             .fragment = k_demo_bare_resolve_frag,
                                             .layout = resolveLayout_.get(),
                                             .colour = VK_FORMAT_R8_UNORM});
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 2};
    const VkDescriptorPoolCreateInfo poolInfo{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 1, .poolSizeCount = 1, .pPoolSizes = &size};
    VkDescriptorPool pool = VK_NULL_HANDLE;
    vkCheck(vkCreateDescriptorPool(device.handle, &poolInfo, nullptr, &pool), "vkCreateDescriptorPool");
    descriptors_ = {device.handle, pool};
    const VkDescriptorSetAllocateInfo setInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                              .descriptorPool = pool,
                                              .descriptorSetCount = 1,
                                              .pSetLayouts = &layouts[1]};
    vkCheck(vkAllocateDescriptorSets(device.handle, &setInfo, &set_), "vkAllocateDescriptorSets");
}

void BareShadowMap::record(VkCommandBuffer cmd, const ViewInputs& inputs)
{
    if (boundDepth_ != inputs.depthView) { // once: the benchmark never resizes
        const VkDescriptorImageInfo images[] = {{sampler_.get(), inputs.depthView, kSampled.layout},
                                                {sampler_.get(), map_.view.get(), kSampled.layout}};
        const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                         .dstSet = set_,
                                         .descriptorCount = 2,
                                         .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                         .pImageInfo = images};
        vkUpdateDescriptorSets(device_.handle, 1, &write, 0, nullptr);
        boundDepth_ = inputs.depthView;
    }
    const uint32_t light = inputs.state->present.at(0);
    const glm::mat4 lightClipFromEye =
        spotClipFromEye(scene_.lights[light], inputs.state->lights[light], inputs.camera->eye);
    drawMap(cmd, inputs, lightClipFromEye);
    resolve(cmd, inputs, lightClipFromEye);
}

void BareShadowMap::drawMap(VkCommandBuffer cmd, const ViewInputs& inputs, const glm::mat4& lightClipFromEye)
{
    const VkImageMemoryBarrier2 before[] = {
        imageBarrier(map_.get(), VK_IMAGE_ASPECT_DEPTH_BIT, kSampledBefore, kMapWritten),
        imageBarrier(visibility_.get(), VK_IMAGE_ASPECT_COLOR_BIT, kSampledBefore, kWritten)};
    cmdBarrier(cmd, before);
    const VkRenderingAttachmentInfo depth{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                          .imageView = map_.view.get(),
                                          .imageLayout = kMapWritten.layout,
                                          .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                          .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                          .clearValue = {.depthStencil = {1.0f, 0}}};
    const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                    .renderArea = {{0, 0}, map_.extent},
                                    .layerCount = 1,
                                    .pDepthAttachment = &depth};
    vkCmdBeginRendering(cmd, &rendering);
    cmdSetArea(cmd, map_.extent);
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, mapLayout_.get(), 0, 1, &inputs.frameSet, 0, nullptr);
    vkCmdPushConstants(cmd, mapLayout_.get(), VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof lightClipFromEye,
                       &lightClipFromEye);
    const VkBuffer positions = geometry_.positions.get();
    const VkDeviceSize offset = 0;
    vkCmdBindVertexBuffers(cmd, 0, 1, &positions, &offset);
    vkCmdBindIndexBuffer(cmd, geometry_.indices.get(), 0, VK_INDEX_TYPE_UINT32);
    for (const bool closed : {true, false}) {
        vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, closed ? closed_.get() : open_.get());
        vkCmdSetDepthBias(cmd, closed ? 0.0f : kOpenConstantBias, 0.0f, closed ? 0.0f : kOpenSlopeBias);
        CameraMatrices frustum; // for culling only: the light's clip space, seen from the eye's origin
        frustum.eye = inputs.camera->eye;
        frustum.clipFromEye = lightClipFromEye;
        for (uint32_t i = 0; i < scene_.instances.size(); ++i) {
            const MeshRange& mesh = geometry_.meshes[scene_.instances[i].mesh];
            if (mesh.closed != closed || !onScreen(frustum, mesh, inputs.state->instances[i])) continue;
            if (closed) vkCmdSetFrontFace(cmd, frontFaceOf(inputs.state->instances[i]));
            vkCmdDrawIndexed(cmd, mesh.indexCount, 1, mesh.firstIndex, mesh.vertexOffset, i);
        }
    }
    vkCmdEndRendering(cmd);
    const VkImageMemoryBarrier2 after[] = {imageBarrier(map_.get(), VK_IMAGE_ASPECT_DEPTH_BIT, kMapWritten, kSampled)};
    cmdBarrier(cmd, after);
}

void BareShadowMap::resolve(VkCommandBuffer cmd, const ViewInputs& inputs, const glm::mat4& lightClipFromEye)
{
    const VkRenderingAttachmentInfo colour{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                           .imageView = visibility_.view.get(),
                                           .imageLayout = kWritten.layout,
                                           .loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                           .storeOp = VK_ATTACHMENT_STORE_OP_STORE};
    const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                    .renderArea = {{0, 0}, inputs.extent},
                                    .layerCount = 1,
                                    .colorAttachmentCount = 1,
                                    .pColorAttachments = &colour};
    vkCmdBeginRendering(cmd, &rendering);
    cmdSetArea(cmd, inputs.extent);
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, resolve_.get());
    const VkDescriptorSet sets[] = {inputs.frameSet, set_};
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, resolveLayout_.get(), 0, 2, sets, 0, nullptr);
    vkCmdPushConstants(cmd, resolveLayout_.get(), VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                       sizeof lightClipFromEye, &lightClipFromEye);
    vkCmdDraw(cmd, 3, 1, 0, 0);
    vkCmdEndRendering(cmd);
    const VkImageMemoryBarrier2 after[] = {
        imageBarrier(visibility_.get(), VK_IMAGE_ASPECT_COLOR_BIT, kWritten, kSampled)};
    cmdBarrier(cmd, after);
}

} // namespace gnomon::demo
