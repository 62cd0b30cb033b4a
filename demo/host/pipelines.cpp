#include "demo/host/pipelines.hpp"

namespace gnomon::demo {
namespace {

using UniqueShaderModule = Unique<VkShaderModule, &vkDestroyShaderModule>;

UniqueShaderModule makeModule(const Device& device, std::span<const uint32_t> code)
{
    const VkShaderModuleCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = code.size_bytes(), .pCode = code.data()};
    VkShaderModule module = VK_NULL_HANDLE;
    vkCheck(vkCreateShaderModule(device.handle, &info, nullptr, &module), "vkCreateShaderModule");
    return {device.handle, module};
}

} // namespace

UniquePipeline makeGraphicsPipeline(const Device& device, const GraphicsDescription& description)
{
    const UniqueShaderModule vertex = makeModule(device, description.vertex);
    const VkBool32 constant0 = description.constant0;
    const VkSpecializationMapEntry entry{0, 0, sizeof constant0};
    const VkSpecializationInfo specialization{1, &entry, sizeof constant0, &constant0};
    UniqueShaderModule fragment;
    if (!description.fragment.empty()) fragment = makeModule(device, description.fragment);
    const VkPipelineShaderStageCreateInfo stages[2] = {{.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                        .stage = VK_SHADER_STAGE_VERTEX_BIT,
                                                        .module = vertex.get(),
                                                        .pName = "main"},
                                                       {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                        .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
                                                        .module = fragment.get(),
                                                        .pName = "main",
                                                        .pSpecializationInfo = &specialization}};

    const VkVertexInputBindingDescription binding{0, 3 * sizeof(float), VK_VERTEX_INPUT_RATE_VERTEX};
    const VkVertexInputAttributeDescription attribute{0, 0, VK_FORMAT_R32G32B32_SFLOAT, 0};
    VkPipelineVertexInputStateCreateInfo vertexInput{.sType =
                                                         VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    if (description.readsPositions) {
        vertexInput.vertexBindingDescriptionCount = vertexInput.vertexAttributeDescriptionCount = 1;
        vertexInput.pVertexBindingDescriptions = &binding;
        vertexInput.pVertexAttributeDescriptions = &attribute;
    }
    const VkPipelineInputAssemblyStateCreateInfo assembly{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkPipelineViewportStateCreateInfo viewport{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
    const VkPipelineRasterizationStateCreateInfo raster{.sType =
                                                            VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
                                                        .cullMode = description.cull,
                                                        .frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE,
                                                        .depthBiasEnable = description.dynamicDepthBias,
                                                        .lineWidth = 1.0f};
    const VkPipelineMultisampleStateCreateInfo multisample{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = static_cast<VkSampleCountFlagBits>(description.samples)};
    const bool hasDepth = description.depth != VK_FORMAT_UNDEFINED,
               hasColour = description.colour != VK_FORMAT_UNDEFINED;
    const VkPipelineDepthStencilStateCreateInfo depth{.sType =
                                                          VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
                                                      .depthTestEnable = hasDepth,
                                                      .depthWriteEnable = hasDepth,
                                                      .depthCompareOp = description.depthCompare};
    const VkPipelineColorBlendAttachmentState attachment{.colorWriteMask = 0xf};
    const VkPipelineColorBlendStateCreateInfo blend{.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                    .attachmentCount = hasColour ? 1u : 0u,
                                                    .pAttachments = &attachment};
    VkDynamicState dynamics[4] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    uint32_t dynamicCount = 2;
    if (description.dynamicDepthBias) dynamics[dynamicCount++] = VK_DYNAMIC_STATE_DEPTH_BIAS;
    if (description.dynamicFrontFace) dynamics[dynamicCount++] = VK_DYNAMIC_STATE_FRONT_FACE;
    const VkPipelineDynamicStateCreateInfo dynamic{.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
                                                   .dynamicStateCount = dynamicCount,
                                                   .pDynamicStates = dynamics};
    const bool stencilToo = description.depth == VK_FORMAT_D32_SFLOAT_S8_UINT;
    const VkPipelineRenderingCreateInfo rendering{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                  .colorAttachmentCount = hasColour ? 1u : 0u,
                                                  .pColorAttachmentFormats = &description.colour,
                                                  .depthAttachmentFormat = description.depth,
                                                  .stencilAttachmentFormat =
                                                      stencilToo ? description.depth : VK_FORMAT_UNDEFINED};
    const VkGraphicsPipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                            .pNext = &rendering,
                                            .stageCount = description.fragment.empty() ? 1u : 2u,
                                            .pStages = stages,
                                            .pVertexInputState = &vertexInput,
                                            .pInputAssemblyState = &assembly,
                                            .pViewportState = &viewport,
                                            .pRasterizationState = &raster,
                                            .pMultisampleState = &multisample,
                                            .pDepthStencilState = &depth,
                                            .pColorBlendState = &blend,
                                            .pDynamicState = &dynamic,
                                            .layout = description.layout};
    VkPipeline pipeline = VK_NULL_HANDLE;
    vkCheck(vkCreateGraphicsPipelines(device.handle, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
            "vkCreateGraphicsPipelines");
    return {device.handle, pipeline};
}

UniquePipeline makeComputePipeline(const Device& device, std::span<const uint32_t> code, VkPipelineLayout layout)
{
    const UniqueShaderModule module = makeModule(device, code);
    const VkComputePipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                           .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                     .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                                                     .module = module.get(),
                                                     .pName = "main"},
                                           .layout = layout};
    VkPipeline pipeline = VK_NULL_HANDLE;
    vkCheck(vkCreateComputePipelines(device.handle, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
            "vkCreateComputePipelines");
    return {device.handle, pipeline};
}

UniqueSetLayout makeSetLayout(const Device& device, std::span<const VkDescriptorSetLayoutBinding> bindings)
{
    const VkDescriptorSetLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                               .bindingCount = static_cast<uint32_t>(bindings.size()),
                                               .pBindings = bindings.data()};
    VkDescriptorSetLayout layout = VK_NULL_HANDLE;
    vkCheck(vkCreateDescriptorSetLayout(device.handle, &info, nullptr, &layout), "vkCreateDescriptorSetLayout");
    return {device.handle, layout};
}

UniquePipelineLayout makePipelineLayout(const Device& device, std::span<const VkDescriptorSetLayout> sets,
                                        uint32_t pushBytes, VkShaderStageFlags pushStages)
{
    const VkPushConstantRange range{pushStages, 0, pushBytes};
    const VkPipelineLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                          .setLayoutCount = static_cast<uint32_t>(sets.size()),
                                          .pSetLayouts = sets.data(),
                                          .pushConstantRangeCount = pushBytes > 0 ? 1u : 0u,
                                          .pPushConstantRanges = &range};
    VkPipelineLayout layout = VK_NULL_HANDLE;
    vkCheck(vkCreatePipelineLayout(device.handle, &info, nullptr, &layout), "vkCreatePipelineLayout");
    return {device.handle, layout};
}

} // namespace gnomon::demo
