#pragma once
// The library behind PipelineLibrary: descriptions, background creation, warm-up draws, readiness.
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/vk/pipeline_create.hpp"
#include "runtime/vk/warmup_draws.hpp"

namespace gnomon {

/// Life of a pipeline: described -> created (background) -> tried (executed once on tiny stand-ins) -> ready.
class PipelineStore final : public PipelineLibrary {
public:
    PipelineStore(const DeviceTable& vk, DeviceMemory& memory, const SamplerSet& samplers);
    ~PipelineStore() override;
    PipelineStore(const PipelineStore&) = delete;
    PipelineStore& operator=(const PipelineStore&) = delete;

    PipelineId graphics(const GraphicsPipelineInfo& info) override;
    PipelineId compute(const ComputePipelineInfo& info) override;

    /// Begins a cache of our own with what cacheData() gave. @return why it begins empty instead
    Result<void> beginCache(std::string_view data);
    /// What our own cache holds, for beginCache() of a later run.
    Result<std::string> cacheData();

    /// Pipelines described from now on belong to `owner` (a method's index); a shared one belongs to all who asked.
    void setOwner(std::uint32_t owner);
    /// Slope factor of the bias of open casters: caster pipelines are tried with it as well as without.
    void setWarmupSlopeBias(float bias);

    /// Creates one described pipeline of `owner`; thread-safe against the rest. False: none left to create.
    /// A failure marks the pipeline failed (see failure()).
    bool createNext(std::uint32_t owner);
    /// Whether all of the owner's pipelines are created (not yet tried).
    bool created(std::uint32_t owner) const;
    /// Records the first execution of every created, untried pipeline of `owner` on tiny stand-ins (own rendering
    /// scopes and barriers) and marks them tried. Outside a rendering scope.
    Result<void> recordWarmupDraws(VkCommandBuffer cmd, std::uint32_t owner);
    /// Created and tried: usable without a hitch.
    bool ready(std::uint32_t owner) const;
    /// Why the owner's pipelines cannot be made, or empty.
    std::string failure(std::uint32_t owner) const;

    /// Of the warmups that the device has begun.
    const ProgressMarks& warmupMarks() const noexcept { return warmups_.marks(); }
    std::string lastWarmup() const { return warmups_.lastBegun(); }

    const Pipeline& get(PipelineId id) const; ///< Must be created. The reference lives as long as the store.

private:
    struct Item;
    PipelineId describe(PipelineDescription description);
    VkPipelineCache cache(std::string_view initial = {});

    const DeviceTable& vk_;
    mutable std::mutex mutex_;
    std::vector<std::unique_ptr<Item>> items_; ///< Stable addresses: workers create outside the lock.
    WarmupDraws warmups_;
    float warmupSlopeBias_ = 0.0f;
    VkPipelineCache ownCache_ = VK_NULL_HANDLE;
    bool cacheAsked_ = false;
    std::uint32_t owner_ = 0;
};

} // namespace gnomon
