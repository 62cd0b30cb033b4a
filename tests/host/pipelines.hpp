// The two pipelines of the stranger's renderer.
#ifndef GNOMON_TESTS_HOST_PIPELINES_HPP
#define GNOMON_TESTS_HOST_PIPELINES_HPP

#include "vulkan_device.hpp"

namespace stranger {

struct Vertex {
    float position[3], normal[3], colour[3];
};

/// Triangles from both sides, nearest first: reversed depth.
VkPipeline createSurfacePipeline(const Device& device, VkPipelineLayout layout, VkExtent2D size, VkFormat albedo,
                                 VkFormat normals, VkFormat depth);
VkPipeline createLightingPipeline(const Device& device, VkPipelineLayout layout, VkExtent2D size, VkFormat picture);

} // namespace stranger
#endif
