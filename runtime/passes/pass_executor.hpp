#pragma once
// Turns a PassGraph into command buffers, submits and host work.
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "runtime/passes/barriers.hpp"
#include "runtime/passes/device_clock.hpp"
#include "runtime/passes/device_timeline.hpp"
#include "runtime/passes/pass_context.hpp"
#include "runtime/passes/pass_graph.hpp"
#include "runtime/store/scene_registry.hpp"
#include "runtime/vk/descriptor_ring.hpp"
#include "runtime/vk/pipeline_store.hpp"
#include "runtime/vk/unique.hpp"

namespace gnomon {

/// What a pass cost, once known.
struct PassTiming {
    const char* name = "";
    PassOwner owner;
    std::uint32_t round = 0;
    float gpuMs = 0.0f;
    float cpuMs = 0.0f;
};

/// Timings of one completed frame.
struct FrameTimings {
    std::uint64_t frame = 0;
    bool timed = false;      ///< Every pass, with full barriers between; otherwise only the total.
    float totalGpuMs = 0.0f; ///< From the first command to the last, gaps between rounds left out.
    std::vector<PassTiming> passes;
};

struct ExecutorCounters {
    std::uint32_t submits = 0;
    std::uint32_t hostWaits = 0;
    std::uint32_t passesRun = 0;
    std::atomic<std::uint32_t> indexListsBuilt{0};
    std::atomic<std::uint64_t> rays{0};
    float cpuMs = 0.0f;
};

/// What one frame brings along.
struct ExecutorFrame {
    std::uint64_t frame = 0;
    std::uint64_t completedFrame = 0;
    bool timed = false;
    const SceneRegistry::Snapshot* scene = nullptr;
    SceneRegistry* uploads = nullptr;       ///< Its pending uploads go first; null: none.
    RayScene* rays = nullptr;               ///< Null without Embree.
    bool raysNeeded = false;                ///< Some task traces: the ray scene is brought up to date.
    std::uint32_t warmupOwner = UINT32_MAX; ///< A method whose pipelines are executed for the first time.
    std::span<const VkSemaphoreSubmitInfo> waits, signals;
    PooledImage* const* visibilities = nullptr; ///< Left in SHADER_READ_ONLY at the end.
    std::uint32_t visibilityCount = 0;
    PooledImage* const* imports = nullptr; ///< The host's images, left as they came.
    std::uint32_t importCount = 0;
    std::span<PooledImage* const> lightMaps; ///< Which the host may sample afterwards, like visibility.
};

class PassExecutor {
public:
    PassExecutor(const DeviceTable& vk, DeviceMemory& memory, PipelineStore& pipelines, const SamplerSet& samplers,
                 JobSystem& jobs, ResourcePool& pool, PassGraph& graph, const GnContextCreateInfo& info);
    ~PassExecutor();

    Result<void> create(std::uint32_t framesInFlight);

    /// The frame's slot must be done with: GN_ERROR_FRAME_ORDER otherwise. Nothing is changed.
    Result<void> checkSlot(std::uint64_t frame, std::uint64_t completedFrame) const;
    /// Claims the frame's slot; its last frame must be completed. Publishes timings of completed frames.
    Result<void> begin(const ExecutorFrame& frame);
    /// Records everything into the host's command buffer.
    Result<void> record(VkCommandBuffer cmd);
    /// Submits round 0 and, unless `inlineHost`, starts its host passes on a worker.
    Result<void> start(bool inlineHost);
    /// Runs to the end, or until the time is up (#GN_TIMEOUT). What fails or throws ends the frame: its later rounds
    /// never run, the GPU has done with the others, and nothing that they touched is kept.
    Result<GnResult> finish(std::uint64_t timeoutNs);
    bool underway() const { return underway_; }
    /// The frame will not run: its timings never come. Does nothing if it has claimed no slot.
    void drop(std::uint64_t frame);

    /// Submits `body`'s commands on their own and waits for them: warm-up only. GN_ERROR_DEVICE_LOST where the device
    /// hangs; hung() then says so.
    template <typename Body>
    Result<void> once(Body&& body)
    {
        Result<VkCommandBuffer> cmd = beginOnce();
        if (!cmd) return cmd.error();
        if (Result<void> recorded = body(*cmd); !recorded) return recorded;
        return endOnce(*cmd);
    }
    /// Blocks until all that was submitted to the queue is done, recorded frames of the host's submits included, or
    /// the device hangs: destruction only.
    void waitQueue() noexcept;
    /// A wait ended without the device's work being done: nothing that it touches may be destroyed.
    bool hung() const noexcept { return timeline_.hung(); }

    /// Why the pipelines of ExecutorFrame::warmupOwner could not be tried; null: they were. The frame goes on without.
    const Error* warmupError() const { return warmupError_ ? &*warmupError_ : nullptr; }
    const FrameTimings* newest() const { return published_.frame ? &published_ : nullptr; }
    const FrameTimings* newestTimed() const { return publishedTimed_.frame ? &publishedTimed_ : nullptr; }
    /// False: the queue has no timestamps, or they do not tell the time, and GPU times are unknown.
    bool hasClock() const { return clock_.usable(); }
    ExecutorCounters& counters() { return counters_; }

private:
    friend class PassContext;
    friend class HostContext;

    struct Later {
        void (*fn)(const void*, PassBuilder&);
        const void* body;
        std::uint32_t pass;
    };
    struct Slot;
    /// Thrown out of a pass that finds no memory for what it binds: what it would draw next must not be recorded.
    struct RecordingFailed {
        Error error;
    };

    Result<void> updateRays();
    Result<void> recordRound(VkCommandBuffer cmd, std::uint32_t round, bool last);
    void recordBatches(VkCommandBuffer cmd, std::uint32_t round);
    void recordPass(VkCommandBuffer cmd, Pass& pass);
    VkRect2D beginRendering(VkCommandBuffer cmd, const Pass& pass); ///< @return the area of its viewport and scissor
    void handBack();
    void handBackImports();
    void showReadbacks(std::uint32_t round);
    void runCpuPasses(std::uint32_t round, PassKind kind);
    void runBatch(std::span<const std::uint32_t> batch);
    void runPass(std::uint32_t index);
    Result<void> submitRound(std::uint32_t round, bool last);
    static std::uint64_t progress(const void* self) noexcept;
    Error waitError(VkResult waited) const;
    std::string lastBegun() const;
    bool marksPasses() const;
    void markBegun(VkCommandBuffer cmd);
    Result<GnResult> finishRounds(std::uint64_t timeoutNs);
    void giveUp() noexcept;
    Result<void> hostRound(std::uint64_t timeoutNs);
    void hostJob() noexcept;
    void declareLater();
    Result<void> makeQueries(Slot& slot, std::uint32_t count);
    Result<void> resetQueries(VkCommandBuffer cmd, std::uint32_t round);
    void stamp(VkCommandBuffer cmd);
    bool believes(const Slot& slot);
    void collect(Slot& slot);
    Result<VkCommandBuffer> commandBuffer(Slot& slot, std::uint32_t round);
    Result<VkCommandBuffer> beginOnce();
    Result<void> endOnce(VkCommandBuffer cmd);
    bool roundHas(std::uint32_t round, PassKind kind) const;

    const DeviceTable& vk_;
    DeviceMemory& memory_;
    PipelineStore& pipelines_;
    const SamplerSet& samplers_;
    JobSystem& jobs_;
    ResourcePool& pool_;
    PassGraph& graph_;

    DeviceTimeline timeline_;
    UniqueCommandPool oncePool_;      ///< Of the one-off submit under way.
    std::uint32_t warmupsBefore_ = 0; ///< Warmups begun before the submits that are waited for.
    std::vector<std::unique_ptr<Slot>> slots_;
    Slot* slot_ = nullptr;
    ExecutorFrame frame_;
    std::vector<VkSemaphoreSubmitInfo> waits_, signals_;
    std::vector<PooledImage*> visibilities_, imports_, lightMaps_;
    BarrierBatch barriers_;
    std::span<const std::uint32_t> order_;
    std::uint32_t round_ = 0;
    bool underway_ = false;
    bool inlineHost_ = true;
    JobSystem::Job hostJob_;
    std::optional<Error> warmupError_;
    VkResult hostWait_ = VK_SUCCESS;
    std::exception_ptr hostThrown_; ///< By a host pass on a worker.
    std::mutex laterMutex_;
    std::vector<Later> later_;
    ExecutorCounters counters_;
    FrameTimings published_, publishedTimed_;
    DeviceClock clock_;
};

} // namespace gnomon
