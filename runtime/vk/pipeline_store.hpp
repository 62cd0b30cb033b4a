#pragma once
// The library behind PipelineLibrary: descriptions, background creation, trial execution, readiness.
#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "runtime/core/jobs.hpp"
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
    std::vector<BindingInfo> bindings;
};

/// Life of a pipeline: described -> created (background) -> tried (executed once on tiny dummies) -> ready.
class PipelineStore final : public PipelineLibrary {
public:
    PipelineStore(const DeviceTable& vk, DeviceMemory& memory, const SamplerSet& samplers);
    ~PipelineStore() override;

    PipelineId graphics(const GraphicsPipelineInfo& info) override;
    PipelineId compute(const ComputePipelineInfo& info) override;

    /// Pipelines described from now on belong to `owner` (a method's index); a shared one belongs to all who asked.
    void setOwner(std::uint32_t owner);

    /// Creates one described pipeline of `owner`; thread-safe against the rest. False: none left to create.
    /// A failure marks the pipeline failed (see failure()).
    bool createNext(std::uint32_t owner);
    /// Whether all of the owner's pipelines are created (not yet tried).
    bool created(std::uint32_t owner) const;
    /// Records the first execution of every created, untried pipeline of `owner` on 1x1-sized dummies (own rendering
    /// scopes and barriers) and marks them tried. Outside a rendering scope.
    Result<void> recordTrials(VkCommandBuffer cmd, std::uint32_t owner);
    /// Created and tried: usable without a hitch.
    bool ready(std::uint32_t owner) const;
    /// Why the owner's pipelines cannot be made, or empty.
    std::string failure(std::uint32_t owner) const;

    const Pipeline& get(PipelineId id) const; ///< Must be created.

private:
    struct Item;
    struct Dummies;
    const DeviceTable& vk_;
    DeviceMemory& memory_;
    const SamplerSet& samplers_;
    mutable std::mutex mutex_;
    std::deque<Item> items_; // stable addresses
    std::unique_ptr<Dummies> dummies_;
    std::uint32_t owner_ = 0;
};

} // namespace gnomon
