#include "runtime/vk/pipeline_create.hpp"

#include <algorithm>
#include <array>

#include "runtime/vk/unique.hpp"

namespace gnomon {
namespace {

/// A shader module and its specialization, alive while the pipeline is being made.
struct Stage {
    UniqueShaderModule module;
    std::array<VkSpecializationMapEntry, 4> entries{};
    VkSpecializationInfo specialization{};

    VkPipelineShaderStageCreateInfo info(VkShaderStageFlagBits stage) const
    {
        return {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                .stage = stage,
                .module = module.get(),
                .pName = "main",
                .pSpecializationInfo = specialization.mapEntryCount ? &specialization : nullptr};
    }
};

Result<void> openStage(const DeviceTable& vk, const ShaderInfo& shader, const char* name, Stage& stage)
{
    const VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, nullptr, 0,
                                        shader.code.size_bytes(), shader.code.data()};
    VkShaderModule module = VK_NULL_HANDLE;
    const VkResult result = vk.vkCreateShaderModule(vk.device, &info, vk.hostAllocator, &module);
    if (result != VK_SUCCESS) return vulkanError(result, "vkCreateShaderModule");
    ++vk.objectsMade;
    stage.module = UniqueShaderModule(vk, module);
    nameObject(vk, VK_OBJECT_TYPE_SHADER_MODULE, module, name);
    for (std::uint32_t i = 0; i < shader.specializationCount; ++i)
        stage.entries[i] = {.constantID = i, .offset = i * 4, .size = 4};
    stage.specialization = {shader.specializationCount, stage.entries.data(), shader.specializationCount * 4u,
                            shader.specialization};
    return {};
}

Result<void> createLayouts(const DeviceTable& vk, Pipeline& pipeline)
{
    const bool compute = pipeline.bindPoint == VK_PIPELINE_BIND_POINT_COMPUTE;
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    bindings.reserve(pipeline.bindings.size());
    for (const BindingInfo& binding : pipeline.bindings)
        bindings.push_back({.binding = binding.binding,
                            .descriptorType = descriptorTypeOf(binding.kind),
                            .descriptorCount = 1,
                            .stageFlags = compute ? VK_SHADER_STAGE_COMPUTE_BIT : VK_SHADER_STAGE_ALL_GRAPHICS,
                            .pImmutableSamplers = nullptr});
    const VkDescriptorSetLayoutCreateInfo setInfo{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, nullptr, 0,
                                                  static_cast<std::uint32_t>(bindings.size()), bindings.data()};
    VkResult result = vk.vkCreateDescriptorSetLayout(vk.device, &setInfo, vk.hostAllocator, &pipeline.setLayout);
    if (result != VK_SUCCESS) {
        pipeline.setLayout = VK_NULL_HANDLE;
        return vulkanError(result, "vkCreateDescriptorSetLayout");
    }
    ++vk.objectsMade;
    const VkPushConstantRange push{pipeline.pushStages, 0, pipeline.pushBytes};
    const VkPipelineLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                          .setLayoutCount = 1,
                                          .pSetLayouts = &pipeline.setLayout,
                                          .pushConstantRangeCount = pipeline.pushBytes ? 1u : 0u,
                                          .pPushConstantRanges = &push};
    result = vk.vkCreatePipelineLayout(vk.device, &info, vk.hostAllocator, &pipeline.layout);
    if (result != VK_SUCCESS) {
        pipeline.layout = VK_NULL_HANDLE;
        return vulkanError(result, "vkCreatePipelineLayout");
    }
    ++vk.objectsMade;
    return {};
}

/// Every structure a graphics pipeline points at, filled from the description and read by Vulkan once.
struct GraphicsState {
    explicit GraphicsState(const GraphicsPipelineInfo& of) : info(of) {}
    GraphicsState(const GraphicsState&) = delete;
    GraphicsState& operator=(const GraphicsState&) = delete;

    const GraphicsPipelineInfo& info;
    const bool colored = info.colorFormat != VK_FORMAT_UNDEFINED;

    const VkVertexInputBindingDescription vertexBuffers[2] = {
        {.binding = 0, .stride = info.vertexStride, .inputRate = VK_VERTEX_INPUT_RATE_VERTEX},
        {.binding = kTransformsBinding, .stride = kTransformBytes, .inputRate = VK_VERTEX_INPUT_RATE_INSTANCE}};
    const VkVertexInputAttributeDescription vertexInputs[4] = {
        {.location = 0,
         .binding = 0,
         .format = info.vertexStride == 16 ? VK_FORMAT_R32G32B32A32_SFLOAT : VK_FORMAT_R32G32B32_SFLOAT,
         .offset = 0},
        transformRow(0),
        transformRow(1),
        transformRow(2)};
    const VkPipelineVertexInputStateCreateInfo vertexInput{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = !info.vertexStride ? 0u
                                         : info.transforms  ? 2u
                                                            : 1u,
        .pVertexBindingDescriptions = vertexBuffers,
        .vertexAttributeDescriptionCount = !info.vertexStride ? 0u
                                           : info.transforms  ? 4u
                                                              : 1u,
        .pVertexAttributeDescriptions = vertexInputs};
    const VkPipelineInputAssemblyStateCreateInfo assembly{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO, .topology = info.topology};
    const VkPipelineViewportStateCreateInfo viewport{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
    const VkPipelineRasterizationStateCreateInfo raster{.sType =
                                                            VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
                                                        .depthClampEnable = info.depthClamp,
                                                        .polygonMode = VK_POLYGON_MODE_FILL,
                                                        .cullMode = info.cullMode,
                                                        .frontFace = info.frontFace,
                                                        .depthBiasEnable = info.casters,
                                                        .lineWidth = 1.0f};
    const VkPipelineMultisampleStateCreateInfo multisample{.sType =
                                                               VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
                                                           .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    const VkPipelineDepthStencilStateCreateInfo depthStencil{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = info.depthTest || info.depthWrite, // without the test nothing is written
        .depthWriteEnable = info.depthWrite,
        .depthCompareOp = info.depthTest ? info.depthCompare : VK_COMPARE_OP_ALWAYS,
        .stencilTestEnable = info.stencil.enable,
        .front = info.stencil.front,
        .back = info.stencil.back,
        .maxDepthBounds = 1.0f};
    const VkPipelineColorBlendAttachmentState blendAttachment{.blendEnable = info.blendScale,
                                                              .srcColorBlendFactor = VK_BLEND_FACTOR_ONE,
                                                              .dstColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA,
                                                              .srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
                                                              .dstAlphaBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA,
                                                              .colorWriteMask = info.colorMask};
    const VkPipelineColorBlendStateCreateInfo blend{.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                    .attachmentCount = colored,
                                                    .pAttachments = &blendAttachment};
    const VkDynamicState dynamicStates[5] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR,
                                             VK_DYNAMIC_STATE_CULL_MODE, VK_DYNAMIC_STATE_FRONT_FACE,
                                             VK_DYNAMIC_STATE_DEPTH_BIAS};
    const VkPipelineDynamicStateCreateInfo dynamic{.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
                                                   .dynamicStateCount = info.casters ? 5u : 2u,
                                                   .pDynamicStates = dynamicStates};
    // A format with both aspects is always attached with both, whatever the pipeline does with them.
    const VkPipelineRenderingCreateInfo rendering{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                  .colorAttachmentCount = colored,
                                                  .pColorAttachmentFormats = &info.colorFormat,
                                                  .depthAttachmentFormat = attached(VK_IMAGE_ASPECT_DEPTH_BIT),
                                                  .stencilAttachmentFormat = attached(VK_IMAGE_ASPECT_STENCIL_BIT)};

private:
    static constexpr VkVertexInputAttributeDescription transformRow(std::uint32_t row)
    {
        return {.location = 1 + row,
                .binding = kTransformsBinding,
                .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                .offset = 16 * row};
    }
    VkFormat attached(VkImageAspectFlags aspect) const
    {
        return aspectsOf(info.depthFormat) & aspect ? info.depthFormat : VK_FORMAT_UNDEFINED;
    }
};

Result<void> createGraphics(const DeviceTable& vk, VkPipelineCache cache, const GraphicsPipelineInfo& info,
                            Pipeline& pipeline)
{
    Stage vertex, fragment;
    if (Result<void> opened = openStage(vk, info.vertex, info.name, vertex); !opened) return opened;
    const bool shaded = !info.fragment.code.empty();
    if (shaded)
        if (Result<void> opened = openStage(vk, info.fragment, info.name, fragment); !opened) return opened;
    const std::array stages{vertex.info(VK_SHADER_STAGE_VERTEX_BIT), fragment.info(VK_SHADER_STAGE_FRAGMENT_BIT)};
    const GraphicsState state(info);
    const VkGraphicsPipelineCreateInfo create{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                              .pNext = &state.rendering,
                                              .stageCount = shaded ? 2u : 1u,
                                              .pStages = stages.data(),
                                              .pVertexInputState = &state.vertexInput,
                                              .pInputAssemblyState = &state.assembly,
                                              .pViewportState = &state.viewport,
                                              .pRasterizationState = &state.raster,
                                              .pMultisampleState = &state.multisample,
                                              .pDepthStencilState = &state.depthStencil,
                                              .pColorBlendState = &state.blend,
                                              .pDynamicState = &state.dynamic,
                                              .layout = pipeline.layout,
                                              .basePipelineIndex = -1};
    const VkResult result =
        vk.vkCreateGraphicsPipelines(vk.device, cache, 1, &create, vk.hostAllocator, &pipeline.pipeline);
    if (result != VK_SUCCESS) return vulkanError(result, "vkCreateGraphicsPipelines");
    return {};
}

Result<void> createCompute(const DeviceTable& vk, VkPipelineCache cache, const ComputePipelineInfo& info,
                           Pipeline& pipeline)
{
    Stage stage;
    if (Result<void> opened = openStage(vk, info.compute, info.name, stage); !opened) return opened;
    const VkComputePipelineCreateInfo create{.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                             .stage = stage.info(VK_SHADER_STAGE_COMPUTE_BIT),
                                             .layout = pipeline.layout,
                                             .basePipelineIndex = -1};
    const VkResult result =
        vk.vkCreateComputePipelines(vk.device, cache, 1, &create, vk.hostAllocator, &pipeline.pipeline);
    if (result != VK_SUCCESS) return vulkanError(result, "vkCreateComputePipelines");
    return {};
}

/// More bindings than a stage may have, in words; empty: none. Every binding is there for all stages of a pipeline.
std::string tooManyBindings(const VkPhysicalDeviceLimits& limits, const PipelineDescription& description)
{
    struct Bound {
        BindingKind kind;
        const char* what;
        std::uint32_t most;
    };
    const Bound bounds[] = {
        {BindingKind::constants, "uniform buffers",
         std::min(limits.maxPerStageDescriptorUniformBuffers, limits.maxDescriptorSetUniformBuffersDynamic)},
        {BindingKind::sampledImage, "sampled images",
         std::min(limits.maxPerStageDescriptorSampledImages, limits.maxPerStageDescriptorSamplers)},
        {BindingKind::storageImage, "storage images", limits.maxPerStageDescriptorStorageImages},
        {BindingKind::storageBuffer, "storage buffers", limits.maxPerStageDescriptorStorageBuffers}};
    const auto words = [](std::size_t count, const char* what, std::size_t most) {
        return std::to_string(count) + " " + what + "; at most " + std::to_string(most);
    };
    for (const Bound& bound : bounds) {
        const auto count =
            static_cast<std::size_t>(std::ranges::count(description.bindings, bound.kind, &BindingInfo::kind));
        if (count > bound.most) return words(count, bound.what, bound.most);
    }
    const bool attached = !description.isCompute && description.graphics.colorFormat != VK_FORMAT_UNDEFINED;
    const std::size_t resources = description.bindings.size() + (attached ? 1 : 0);
    if (resources > limits.maxPerStageResources)
        return words(resources, "bindings and attachments", limits.maxPerStageResources);
    if (description.bindings.size() > kMaxBindings) return words(description.bindings.size(), "bindings", kMaxBindings);
    return {};
}

/// What would be undefined behaviour in Vulkan is an answer here: an algorithm that forgot to check eligibility shows
/// up as a method that cannot be made, with the reason.
Result<void> checkDescription(const DeviceTable& vk, const PipelineDescription& description)
{
    const auto refused = [&description](const std::string& why) {
        return Error{GN_ERROR_FEATURE_MISSING, "PipelineRefused", std::string(description.name()) + ": " + why};
    };
    if (!description.isCompute && description.graphics.depthClamp && !vk.enabled.depthClamp)
        return refused("needs depthClamp");
    if (!vk.rayQuery() && std::ranges::count(description.bindings, BindingKind::structure, &BindingInfo::kind))
        return refused(vk.rayQueryMissing);
    const std::uint32_t pushBytes =
        description.isCompute ? description.compute.pushBytes : description.graphics.pushBytes;
    if (pushBytes > 128 || pushBytes % 4) // 128: what every device offers
        return refused(std::to_string(pushBytes) + " bytes of push constants; at most 128, in fours");
    for (const BindingInfo& binding : description.bindings) {
        const bool image = binding.kind == BindingKind::sampledImage || binding.kind == BindingKind::storageImage;
        if (image && binding.format == VK_FORMAT_UNDEFINED)
            return refused("binding " + std::to_string(binding.binding) + " names no image format");
    }
    if (const std::string tooMany = tooManyBindings(vk.properties.limits, description); !tooMany.empty())
        return refused(tooMany);
    return {};
}

Result<void> fillPipeline(const DeviceTable& vk, VkPipelineCache cache, const PipelineDescription& description,
                          Pipeline& pipeline)
{
    if (Result<void> checked = checkDescription(vk, description); !checked) return checked;
    if (Result<void> layouts = createLayouts(vk, pipeline); !layouts) return layouts;
    return description.isCompute ? createCompute(vk, cache, description.compute, pipeline)
                                 : createGraphics(vk, cache, description.graphics, pipeline);
}

} // namespace

Result<Pipeline> createPipeline(const DeviceTable& vk, VkPipelineCache cache, const PipelineDescription& description)
{
    Pipeline pipeline;
    pipeline.name = description.name();
    pipeline.bindings = description.bindings;
    if (description.isCompute) {
        pipeline.bindPoint = VK_PIPELINE_BIND_POINT_COMPUTE;
        pipeline.pushBytes = description.compute.pushBytes;
        pipeline.pushStages = VK_SHADER_STAGE_COMPUTE_BIT;
    } else {
        pipeline.pushBytes = description.graphics.pushBytes;
        pipeline.pushStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
        pipeline.casters = description.graphics.casters;
    }
    if (Result<void> made = fillPipeline(vk, cache, description, pipeline); !made) {
        destroyPipeline(vk, pipeline);
        return made.error();
    }
    ++vk.objectsMade;
    ++vk.pipelinesMade;
    nameObject(vk, VK_OBJECT_TYPE_PIPELINE, pipeline.pipeline, pipeline.name);
    return pipeline;
}

void destroyPipeline(const DeviceTable& vk, Pipeline& pipeline) noexcept
{
    if (pipeline.pipeline) vk.vkDestroyPipeline(vk.device, pipeline.pipeline, vk.hostAllocator);
    if (pipeline.layout) vk.vkDestroyPipelineLayout(vk.device, pipeline.layout, vk.hostAllocator);
    if (pipeline.setLayout) vk.vkDestroyDescriptorSetLayout(vk.device, pipeline.setLayout, vk.hostAllocator);
    pipeline.pipeline = VK_NULL_HANDLE;
    pipeline.layout = VK_NULL_HANDLE;
    pipeline.setLayout = VK_NULL_HANDLE;
}

} // namespace gnomon
