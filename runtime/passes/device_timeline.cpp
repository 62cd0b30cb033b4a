#include "runtime/passes/device_timeline.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

namespace gnomon {
namespace {

// Five times what Windows gives a GPU before it resets it (TdrDelay, 2 s: Microsoft, "TDR Registry Keys").
constexpr std::uint64_t kDefaultLimitMs = 10'000;
// Lavapipe compiled one shader of ours for more than the 10 s above, on two cores at a load of 15 to 25.
constexpr std::uint64_t kDefaultOnceLimitMs = 60'000;
// Progress is looked at this often. Waits are counted by such pieces, not by the clock: a process that a debugger stops
// for an hour has waited for one of them.
constexpr std::uint64_t kPieceNs = 100'000'000;
constexpr std::uint64_t kRetryNs = 1'000'000;

} // namespace

DeviceTimeline::DeviceTimeline(const DeviceTable& vk, const GnContextCreateInfo& info)
    : vk_(vk), lock_(info.pfnLockQueue), unlock_(info.pfnUnlockQueue), userData_(info.pUserData),
      frameLimitNs_((info.waitLimitMs ? info.waitLimitMs : kDefaultLimitMs) * 1'000'000),
      onceLimitNs_((info.waitLimitMs ? info.waitLimitMs : kDefaultOnceLimitMs) * 1'000'000), limitNs_(frameLimitNs_)
{
}

Result<void> DeviceTimeline::create()
{
    const VkSemaphoreTypeCreateInfo type{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                         .semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE};
    const VkSemaphoreCreateInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
    VkSemaphore semaphore = VK_NULL_HANDLE;
    if (VkResult r = vk_.vkCreateSemaphore(vk_.device, &info, vk_.hostAllocator, &semaphore); r != VK_SUCCESS)
        return vulkanError(r, "vkCreateSemaphore");
    semaphore_ = {vk_, semaphore};
    return {};
}

/// The next value counts only once it is sure to come.
Result<void> DeviceTimeline::submit(VkSubmitInfo2 submit, std::span<const VkSemaphoreSubmitInfo> hostSignals)
{
    signals_.assign(hostSignals.begin(), hostSignals.end());
    signals_.push_back({.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                        .semaphore = semaphore_.get(),
                        .value = value_ + 1,
                        .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT});
    submit.signalSemaphoreInfoCount = static_cast<std::uint32_t>(signals_.size());
    submit.pSignalSemaphoreInfos = signals_.data();
    if (lock_) lock_(vk_.queue, userData_);
    const VkResult result = vk_.vkQueueSubmit2(vk_.queue, 1, &submit, VK_NULL_HANDLE);
    if (unlock_) unlock_(vk_.queue, userData_);
    if (result != VK_SUCCESS) return vulkanError(result, "vkQueueSubmit2");
    ++value_;
    stalledNs_ = 0;
    return {};
}

VkResult DeviceTimeline::wait(std::uint64_t timeoutNs, Progress progress, const void* self, Work work) noexcept
{
    limitNs_ = work == Work::frame ? frameLimitNs_ : onceLimitNs_;
    if (!semaphore_ || !used()) return VK_SUCCESS;
    const VkSemaphore semaphore = semaphore_.get();
    const VkSemaphoreWaitInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                                   .semaphoreCount = 1,
                                   .pSemaphores = &semaphore,
                                   .pValues = &value_};
    for (;;) {
        std::uint64_t piece = std::min({timeoutNs, kPieceNs, limitNs_});
        const VkResult result = vk_.vkWaitSemaphores(vk_.device, &info, piece);
        if (result == VK_SUCCESS || result == VK_ERROR_DEVICE_LOST) return result;
        if (result != VK_TIMEOUT) { // no memory to wait with, while the device still works
            piece = std::min(piece, kRetryNs);
            std::this_thread::sleep_for(std::chrono::nanoseconds(piece));
        }
        if (stalls(piece, progress(self))) return VK_ERROR_DEVICE_LOST;
        if (timeoutNs != UINT64_MAX) timeoutNs -= piece;
        if (timeoutNs == 0) return VK_TIMEOUT;
    }
}

VkResult DeviceTimeline::waitQueue(Progress progress, const void* self) noexcept
{
    hung_ = false; // it may have come back since
    stalledNs_ = 0;
    limitNs_ = frameLimitNs_;
    for (;;) {
        try {
            // A signal comes after all that was submitted to the queue before it. To wait for an idle device, every
            // queue of the host's would have to be locked.
            const Result<void> submitted = submit({.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2}, {});
            if (submitted) return wait(UINT64_MAX, progress, self);
            if (submitted.error().result == GN_ERROR_DEVICE_LOST) return VK_ERROR_DEVICE_LOST;
            // No memory for the driver: there may be later.
        } catch (...) { // no memory
        }
        std::this_thread::sleep_for(std::chrono::nanoseconds(kRetryNs));
        if (stalls(kRetryNs, progress(self))) return VK_ERROR_DEVICE_LOST;
    }
}

/// Adds to the time without progress. @return whether the limit is reached
bool DeviceTimeline::stalls(std::uint64_t waitedNs, std::uint64_t progress) noexcept
{
    stalledNs_ = progress == progress_ ? stalledNs_ + waitedNs : 0;
    progress_ = progress;
    hung_ = hung_ || stalledNs_ >= limitNs_;
    return hung_;
}

} // namespace gnomon
