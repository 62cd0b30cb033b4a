#pragma once
// The context's submits to the host's queue, and waiting for them. Every wait ends: a device that makes no progress for
// the context's limit counts as lost.
#include <cstdint>
#include <span>
#include <vector>

#include "gnomon/gnomon.h"
#include "runtime/base/result.hpp"
#include "runtime/vk/unique.hpp"

namespace gnomon {

class DeviceTimeline {
public:
    DeviceTimeline(const DeviceTable& vk, const GnContextCreateInfo& info);
    Result<void> create();

    /// Under the queue lock. The submit signals `hostSignals` and the timeline's next value.
    Result<void> submit(VkSubmitInfo2 submit, std::span<const VkSemaphoreSubmitInfo> hostSignals);

    /// A wait for work outside of frames, such as first runs of pipelines, where software devices compile: on a busy
    /// processor longer than any frame may take.
    enum class Work { frame, once };
    /// What the device has reached of its present work: any number that changes as it advances.
    using Progress = std::uint64_t (*)(const void* self) noexcept;
    /// Until all that was submitted here is done.
    /// @return VK_TIMEOUT after `timeoutNs`; VK_ERROR_DEVICE_LOST also where hung() holds afterwards
    VkResult wait(std::uint64_t timeoutNs, Progress progress, const void* self, Work work = Work::frame) noexcept;
    /// wait(), after a submit that comes behind all that the host submitted to the queue.
    VkResult waitQueue(Progress progress, const void* self) noexcept;

    bool used() const noexcept { return value_ != 0; }
    /// A wait ended at the limit: the device may still work on what was submitted.
    bool hung() const noexcept { return hung_; }
    /// That the newest wait had.
    std::uint32_t limitMs() const noexcept { return static_cast<std::uint32_t>(limitNs_ / 1'000'000); }

private:
    bool stalls(std::uint64_t waitedNs, std::uint64_t progress) noexcept;

    const DeviceTable& vk_;
    PFN_gnQueueLock lock_, unlock_;
    void* userData_;
    UniqueSemaphore semaphore_;
    std::uint64_t value_ = 0; ///< That the newest submit signals.
    std::vector<VkSemaphoreSubmitInfo> signals_;
    std::uint64_t frameLimitNs_, onceLimitNs_;
    std::uint64_t limitNs_;       ///< Of the newest wait.
    std::uint64_t stalledNs_ = 0; ///< Waited for without progress.
    std::uint64_t progress_ = 0;
    bool hung_ = false;
};

} // namespace gnomon
