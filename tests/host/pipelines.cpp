#include "pipelines.hpp"

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>

#include "shaders/stranger_lighting_frag.h"
#include "shaders/stranger_lighting_vert.h"
#include "shaders/stranger_surface_frag.h"
#include "shaders/stranger_surface_vert.h"

namespace stranger {
namespace {

/// What differs between the two pipelines.
struct Description {
    std::span<const uint32_t> vertexCode, fragmentCode;
    VkPipelineVertexInputStateCreateInfo vertices{.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    std::span<const VkFormat> colours;
    VkFormat depth = VK_FORMAT_UNDEFINED; ///< Undefined: neither tested nor written.
};

VkPipeline create(const Device& device, VkPipelineLayout layout, VkExtent2D size, const Description& what)
{
    const VkShaderModule modules[] = {device.createShader(what.vertexCode.data(), what.vertexCode.size_bytes()),
                                      device.createShader(what.fragmentCode.data(), what.fragmentCode.size_bytes())};
    const VkPipelineShaderStageCreateInfo stages[] = {{.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                       .stage = VK_SHADER_STAGE_VERTEX_BIT,
                                                       .module = modules[0],
                                                       .pName = "main"},
                                                      {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                       .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
                                                       .module = modules[1],
                                                       .pName = "main"}};
    const VkPipelineInputAssemblyStateCreateInfo assembly{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkViewport viewport{0.0f, 0.0f, static_cast<float>(size.width), static_cast<float>(size.height), 0.0f, 1.0f};
    const VkRect2D scissor{{0, 0}, size};
    const VkPipelineViewportStateCreateInfo viewports{.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
                                                      .viewportCount = 1,
                                                      .pViewports = &viewport,
                                                      .scissorCount = 1,
                                                      .pScissors = &scissor};
    const VkPipelineRasterizationStateCreateInfo raster{.sType =
                                                            VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
                                                        .cullMode = VK_CULL_MODE_NONE,
                                                        .lineWidth = 1.0f};
    const VkPipelineMultisampleStateCreateInfo samples{.sType =
                                                           VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
                                                       .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    const VkBool32 tested = what.depth != VK_FORMAT_UNDEFINED;
    const VkPipelineDepthStencilStateCreateInfo depth{.sType =
                                                          VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
                                                      .depthTestEnable = tested,
                                                      .depthWriteEnable = tested,
                                                      .depthCompareOp = VK_COMPARE_OP_GREATER};
    const VkPipelineColorBlendAttachmentState opaque{.colorWriteMask = 0xF};
    const VkPipelineColorBlendAttachmentState attachments[] = {opaque, opaque};
    const uint32_t colourCount = static_cast<uint32_t>(what.colours.size());
    const VkPipelineColorBlendStateCreateInfo blend{.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                    .attachmentCount = colourCount,
                                                    .pAttachments = attachments};
    const VkPipelineRenderingCreateInfo rendering{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                  .colorAttachmentCount = colourCount,
                                                  .pColorAttachmentFormats = what.colours.data(),
                                                  .depthAttachmentFormat = what.depth};
    const VkGraphicsPipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                            .pNext = &rendering,
                                            .stageCount = 2,
                                            .pStages = stages,
                                            .pVertexInputState = &what.vertices,
                                            .pInputAssemblyState = &assembly,
                                            .pViewportState = &viewports,
                                            .pRasterizationState = &raster,
                                            .pMultisampleState = &samples,
                                            .pDepthStencilState = &depth,
                                            .pColorBlendState = &blend,
                                            .layout = layout};
    VkPipeline pipeline = VK_NULL_HANDLE;
    STRANGER_CHECK(vkCreateGraphicsPipelines(device.device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline));
    for (VkShaderModule module : modules)
        vkDestroyShaderModule(device.device, module, nullptr);
    return pipeline;
}
} // namespace

VkPipeline createSurfacePipeline(const Device& device, VkPipelineLayout layout, VkExtent2D size, VkFormat albedo,
                                 VkFormat normals, VkFormat depth)
{
    const VkVertexInputBindingDescription binding{0, sizeof(Vertex), VK_VERTEX_INPUT_RATE_VERTEX};
    const VkVertexInputAttributeDescription attributes[] = {
        {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, position)},
        {1, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, normal)},
        {2, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, colour)}};
    const VkFormat colours[] = {albedo, normals};
    Description what{.vertexCode = k_stranger_surface_vert,
                     .fragmentCode = k_stranger_surface_frag,
                     .colours = colours,
                     .depth = depth};
    what.vertices.vertexBindingDescriptionCount = 1;
    what.vertices.pVertexBindingDescriptions = &binding;
    what.vertices.vertexAttributeDescriptionCount = static_cast<uint32_t>(std::size(attributes));
    what.vertices.pVertexAttributeDescriptions = attributes;
    return create(device, layout, size, what);
}

VkPipeline createLightingPipeline(const Device& device, VkPipelineLayout layout, VkExtent2D size, VkFormat picture)
{
    return create(
        device, layout, size,
        {.vertexCode = k_stranger_lighting_vert, .fragmentCode = k_stranger_lighting_frag, .colours = {&picture, 1}});
}
} // namespace stranger
