#pragma once
// First executions. A software device compiles shaders when they first run, once per set of bound formats; a draw runs
// a pipeline on tiny stand-ins of what it will meet, so that the first real frame does not wait for the compiler.
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "runtime/vk/pipeline_create.hpp"
#include "runtime/vk/progress_marks.hpp"

namespace gnomon {

class WarmupDraws {
public:
    WarmupDraws(const DeviceTable& vk, DeviceMemory& memory, const SamplerSet& samplers);
    ~WarmupDraws();
    WarmupDraws(const WarmupDraws&) = delete;
    WarmupDraws& operator=(const WarmupDraws&) = delete;

    struct Candidate {
        const PipelineDescription* description = nullptr;
        const Pipeline* pipeline = nullptr;
    };
    /// Records each candidate's draw or dispatch with barriers of its own. Stand-ins are made on demand and kept, for
    /// the recording may run any time later. On failure nothing has been recorded.
    Result<void> record(VkCommandBuffer cmd, std::span<const Candidate> candidates, float slopeBias);
    const ProgressMarks& marks() const noexcept { return marks_; } ///< Of all draws recorded so far.
    std::string lastBegun() const;                                 ///< Its pipeline's name; empty: none has.

private:
    struct StandIn {
        bool powerOfTwo = false;
        bool target = false; ///< Attachment; otherwise shader input or output.
        GpuImage image;
    };
    struct WarmupDraw {
        Candidate candidate;
        VkDescriptorSet set = VK_NULL_HANDLE;
        const GpuImage* color = nullptr;
        const GpuImage* depth = nullptr;
        std::uint32_t constants = 0; ///< Dynamic offsets to give.
    };

    Result<void> makeBuffers();
    Result<WarmupDraw> prepare(const Candidate& candidate);
    Result<VkDescriptorSet> makeSet(const Candidate& candidate, WarmupDraw& draw);
    Result<const GpuImage*> standIn(VkFormat format, VkImageUsageFlags usage, bool powerOfTwo, bool target);
    Result<VkBuffer> storage(std::size_t index);
    Result<VkAccelerationStructureKHR> structure();
    void buildStructure(VkCommandBuffer cmd) const;
    void clearStandIns(VkCommandBuffer cmd) const;
    void clearStorage(VkCommandBuffer cmd) const;
    void recordDispatch(VkCommandBuffer cmd, const WarmupDraw& draw) const;
    void recordDraw(VkCommandBuffer cmd, const WarmupDraw& draw, float slopeBias) const;
    void bind(VkCommandBuffer cmd, const WarmupDraw& draw) const;

    const DeviceTable& vk_;
    DeviceMemory& memory_;
    const SamplerSet& samplers_;
    DescriptorRing sets_;
    GpuBuffer zeros_;                ///< Constants, vertices and indices; never written.
    std::vector<GpuBuffer> storage_; ///< One per storage binding: shaders may write, and an alias would feed it back.
    std::vector<std::unique_ptr<StandIn>> standIns_;
    GpuBuffer structure_, scratch_; ///< Of nothing, and what it is built with; made on demand.
    ProgressMarks marks_;
    std::vector<const char*> names_; ///< By mark.
};

} // namespace gnomon
