#pragma once
// Graphics pipelines from a short description; everything else is what the demo always wants.

#include <span>

#include "demo/host/device.hpp"

namespace gnomon::demo {

struct GraphicsDescription {
    std::span<const uint32_t> vertex, fragment; ///< An empty fragment shader: depth only.
    VkPipelineLayout layout = VK_NULL_HANDLE;
    bool readsPositions = false; ///< Location 0: a vec3 from a tightly packed buffer.
    VkFormat colour = VK_FORMAT_UNDEFINED;
    VkFormat depth = VK_FORMAT_UNDEFINED;
    VkCompareOp depthCompare = VK_COMPARE_OP_LESS_OR_EQUAL;
    VkCullModeFlags cull = VK_CULL_MODE_NONE;
    bool dynamicDepthBias = false;
    bool dynamicFrontFace = false; ///< Else counter-clockwise.
    uint32_t samples = 1;
    bool constant0 = false;        ///< Value of specialization constant 0 in the fragment shader.
};

UniquePipeline makeGraphicsPipeline(const Device& device, const GraphicsDescription& description);
UniquePipeline makeComputePipeline(const Device& device, std::span<const uint32_t> code, VkPipelineLayout layout);
UniqueSetLayout makeSetLayout(const Device& device, std::span<const VkDescriptorSetLayoutBinding> bindings);
UniquePipelineLayout makePipelineLayout(const Device& device, std::span<const VkDescriptorSetLayout> sets,
                                        uint32_t pushBytes, VkShaderStageFlags pushStages);

} // namespace gnomon::demo
