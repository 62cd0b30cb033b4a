#pragma once
// A host that looks shadows up in its own shader, through gnomon/sample_shadow.h.
#include <array>
#include <span>
#include <vector>

#include "demo/host/pipelines.hpp"
#include "device/fixture.hpp"

namespace gnomon::test {

/// What the shader is asked about a light.
struct SampledPoint {
    glm::vec4 position; ///< xyz; w is written.
    glm::vec4 normal;   ///< xyz; 0: of no surface.
};

class Sampler {
public:
    static constexpr uint32_t kLights = 3; ///< As in the shaders.

    explicit Sampler(std::span<const uint32_t> code);

    /// Visibility of light `light` of view 0, at every point. \param origin The zero of the positions; null: the
    /// world's.
    std::vector<float> sample(const Host& host, uint32_t light, std::vector<SampledPoint> points,
                              const double* origin = nullptr);
    GnSampledShadows last{}; ///< As gnomon gave it. Its arrays live until the next frame call.

private:
    void writeSet(const Host& host, uint32_t light, const std::vector<SampledPoint>& points, const double* origin);

    demo::UniqueSetLayout setLayout_;
    demo::UniquePipelineLayout layout_;
    demo::UniquePipeline pipeline_;
    demo::UniqueDescriptorPool descriptors_;
    demo::UniqueCommandPool commands_;
    demo::UniqueSemaphore timeline_;
    demo::Buffer constants_, question_, points_;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
    uint64_t submitted_ = 0, revision_ = 0;
    std::vector<VkImageView> bound_;
};

} // namespace gnomon::test
