#pragma once
// The baseline a shadow map is measured against: one depth pass from the light and one full-screen pass with one tap,
// written straight in Vulkan, without gnomon. The same culling (closed casters by their back faces, open ones from both
// sides) and the same casters, so that what remains is what the library adds.

#include "demo/host/renderer.hpp"

namespace gnomon::demo {

class BareShadowMap final : public OtherShadows {
public:
    /// For the first present light, which must be a spot light.
    BareShadowMap(const Device& device, const Scene& scene, const SceneGeometry& geometry, const Renderer& renderer,
                  uint32_t resolution);

    void record(VkCommandBuffer cmd, const ViewInputs& inputs) override;
    VkImageView visibility() const override { return visibility_.view.get(); }

private:
    void drawMap(VkCommandBuffer cmd, const ViewInputs& inputs, const glm::mat4& lightClipFromEye);
    void resolve(VkCommandBuffer cmd, const ViewInputs& inputs, const glm::mat4& lightClipFromEye);

    const Device& device_;
    const Scene& scene_;
    const SceneGeometry& geometry_;
    Image map_, visibility_;
    UniqueSetLayout imageLayout_;
    UniquePipelineLayout mapLayout_, resolveLayout_;
    UniquePipeline closed_, open_, resolve_;
    UniqueSampler sampler_;
    UniqueDescriptorPool descriptors_;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
    VkImageView boundDepth_ = VK_NULL_HANDLE;
};

} // namespace gnomon::demo
