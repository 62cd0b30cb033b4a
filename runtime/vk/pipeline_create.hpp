#pragma once
// From a description to Vulkan objects.
#include <vector>

#include "runtime/vk/descriptors.hpp"

namespace gnomon {

/// A pipeline and what binding it needs.
struct Pipeline {
    VkPipeline pipeline = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkDescriptorSetLayout setLayout = VK_NULL_HANDLE;
    VkPipelineBindPoint bindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    std::uint32_t pushBytes = 0;
    VkShaderStageFlags pushStages = 0;
    bool casters = false;
    const char* name = "";
    std::vector<BindingInfo> bindings; ///< By binding number: the order of dynamic offsets.
};

/// A description kept: as given, but with bindings of its own. One of `graphics` and `compute` is in use.
struct PipelineDescription {
    explicit PipelineDescription(const GraphicsPipelineInfo& info);
    explicit PipelineDescription(const ComputePipelineInfo& info);

    bool isCompute = false;
    GraphicsPipelineInfo graphics;
    ComputePipelineInfo compute;
    std::vector<BindingInfo> bindings; ///< By binding number.

    const char* name() const noexcept { return isCompute ? compute.name : graphics.name; }
    /// The same shaders, states and bindings under the same name.
    bool operator==(const PipelineDescription& other) const noexcept;
};

/// Vertex binding of the transforms, one per instance, in every caster pipeline (shaders/shared/casters.glsl), and
/// bytes of one: three rows of vec4, at locations 1 to 3.
inline constexpr std::uint32_t kTransformsBinding = 1, kTransformBytes = 48;

/// Bytes of a uniform block that `constants` bindings of warmups see: what every device allows a block (Vulkan 1.3,
/// table of required limits, maxUniformBufferRange), so that none is larger.
inline constexpr VkDeviceSize kConstantsRange = 16384;

Result<Pipeline> createPipeline(const DeviceTable& vk, VkPipelineCache cache, const PipelineDescription& description);
void destroyPipeline(const DeviceTable& vk, Pipeline& pipeline) noexcept;

} // namespace gnomon
