#include "runtime/passes/pass_executor.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "runtime/passes/frame_slot.hpp"

namespace gnomon {

namespace {

float elapsedMs(std::chrono::steady_clock::time_point since)
{
    return std::chrono::duration<float, std::milli>(std::chrono::steady_clock::now() - since).count();
}

} // namespace

PassExecutor::PassExecutor(const DeviceTable& vk, DeviceMemory& memory, PipelineStore& pipelines,
                           const SamplerSet& samplers, JobSystem& jobs, ResourcePool& pool, PassGraph& graph,
                           const GnContextCreateInfo& info)
    : vk_(vk), memory_(memory), pipelines_(pipelines), samplers_(samplers), jobs_(jobs), pool_(pool), graph_(graph),
      timeline_(vk, info), barriers_(vk), clock_(vk.timestampValidBits)
{
}

PassExecutor::~PassExecutor()
{
    for (auto& slot : slots_) {
        for (GpuBuffer& chunk : slot->constants)
            memory_.destroy(chunk);
        memory_.destroy(slot->transforms);
        slot->marks.destroy(memory_);
    }
}

Result<void> PassExecutor::create(std::uint32_t framesInFlight)
{
    if (Result<void> made = timeline_.create(); !made) return made;
    for (std::uint32_t i = 0; i < framesInFlight; ++i) {
        auto slot = std::make_unique<Slot>(vk_);
        const VkCommandPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                               .queueFamilyIndex = vk_.queueFamily};
        VkCommandPool pool = VK_NULL_HANDLE;
        if (VkResult r = vk_.vkCreateCommandPool(vk_.device, &poolInfo, vk_.hostAllocator, &pool); r != VK_SUCCESS)
            return vulkanError(r, "vkCreateCommandPool");
        slot->pool = {vk_, pool};
        if (Result<void> made = makeQueries(*slot, kQueriesPerPool); !made) return made;
        if (Result<void> made = slot->marks.create(memory_, "frame.progress"); !made) return made;
        slots_.push_back(std::move(slot));
    }
    return {};
}

Result<void> PassExecutor::checkSlot(std::uint64_t frame, std::uint64_t completedFrame) const
{
    const std::uint64_t last = slots_[frame % slots_.size()]->frame;
    if (last <= completedFrame) return {};
    return Error{GN_ERROR_FRAME_ORDER, "FrameInFlight",
                 "frame " + std::to_string(frame) + " reuses the memory of frame " + std::to_string(last) +
                     ", but completedFrame is " + std::to_string(completedFrame)};
}

Result<void> PassExecutor::begin(const ExecutorFrame& frame)
{
    for (auto& slot : slots_)
        if (slot->timingsPending && slot->frame <= frame.completedFrame) collect(*slot);

    Slot& slot = *slots_[frame.frame % slots_.size()];
    if (Result<void> free = checkSlot(frame.frame, frame.completedFrame); !free) return free;
    if (VkResult r = vk_.vkResetCommandPool(vk_.device, slot.pool.get(), 0); r != VK_SUCCESS)
        return vulkanError(r, "vkResetCommandPool");
    slot.frame = frame.frame;
    slot.timed = frame.timed;
    slot.timingsPending = false;
    slot.descriptors.begin();
    slot.chunk = 0;
    slot.chunkUsed = 0;
    slot.queriesUsed = 0;
    slot.entries.clear();
    slot.rounds.clear();
    slot.marks.clear();
    slot_ = &slot;
    frame_ = frame;
    waits_.assign(frame.waits.begin(), frame.waits.end());
    signals_.assign(frame.signals.begin(), frame.signals.end());
    visibilities_.assign(frame.visibilities, frame.visibilities + frame.visibilityCount);
    imports_.assign(frame.imports, frame.imports + frame.importCount);
    lightMaps_.assign(frame.lightMaps.begin(), frame.lightMaps.end());
    warmupsBefore_ = pipelines_.warmupMarks().begun();
    counters_.submits = counters_.hostWaits = counters_.passesRun = 0;
    counters_.indexListsBuilt = 0;
    counters_.rays = 0;
    counters_.cpuMs = 0.0f;
    later_.clear();
    warmupError_.reset();
    barriers_.clear(); // what a failed frame left
    round_ = 0;

    const std::span<const InstanceTransform> transforms = frame.scene->transforms;
    const VkDeviceSize wanted = std::max<VkDeviceSize>(transforms.size_bytes(), sizeof(InstanceTransform));
    if (slot.transforms.size < wanted) {
        memory_.destroy(slot.transforms);
        constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
        Result<GpuBuffer> made =
            memory_.createBuffer(std::bit_ceil(wanted), kUsage, MemoryUse::upload, "frame.transforms");
        if (!made) return made.error();
        slot.transforms = *made;
        slot.transformsRevision = 0;
    }
    if (slot.transformsRevision != frame.scene->revision) {
        if (!transforms.empty()) std::memcpy(slot.transforms.mapped, transforms.data(), transforms.size_bytes());
        slot.transformsRevision = frame.scene->revision;
    }
    return {};
}

bool PassExecutor::roundHas(std::uint32_t round, PassKind kind) const
{
    return std::any_of(order_.begin(), order_.end(), [&](std::uint32_t i) {
        const Pass& pass = graph_.passes()[i];
        return pass.round == round && pass.kind == kind && pass.fn;
    });
}

Result<void> PassExecutor::record(VkCommandBuffer cmd)
{
    order_ = graph_.order();
    if (Result<void> rays = updateRays(); !rays) return rays;
    runCpuPasses(0, PassKind::prepare);
    Result<void> recorded = recordRound(cmd, 0, true);
    slot_->timingsPending = true;
    return recorded;
}

void PassExecutor::drop(std::uint64_t frame)
{
    for (auto& slot : slots_) { // not the newest one's where a frame after it has failed
        if (slot->frame != frame) continue;
        slot->timingsPending = false;
        slot->frame = 0; // nothing of it is in flight
    }
}

Result<void> PassExecutor::start(bool inlineHost)
{
    order_ = graph_.order();
    inlineHost_ = inlineHost || jobs_.threadCount() < 2;
    if (Result<void> rays = updateRays(); !rays) return rays;
    Result<void> submitted = submitRound(0, !roundHas(0, PassKind::host));
    underway_ = bool(submitted);
    return submitted;
}

Result<GnResult> PassExecutor::finish(std::uint64_t timeoutNs)
{
    try {
        Result<GnResult> finished = finishRounds(timeoutNs);
        underway_ = finished && *finished == GN_TIMEOUT;
        if (!finished) giveUp();
        return finished;
    } catch (...) {
        giveUp();
        throw;
    }
}

/// Ends the frame under way where it is.
void PassExecutor::giveUp() noexcept
{
    underway_ = false;
    if (hung()) return;                       // the device may still touch it
    if (hostWait_ != VK_SUCCESS) waitQueue(); // else what was submitted was waited for, before its host passes
    if (hung()) return;
    pool_.abandon(frame_.frame);
    drop(frame_.frame);
}

/// Host passes of the round under way; then, while there are more, the next round.
Result<GnResult> PassExecutor::finishRounds(std::uint64_t timeoutNs)
{
    constexpr std::uint64_t kCentury = 1ull << 61; // ns; what clocks count in is signed
    if (timeoutNs > kCentury) timeoutNs = UINT64_MAX;
    while (roundHas(round_, PassKind::host)) {
        if (inlineHost_) {
            if (Result<void> waited = hostRound(timeoutNs); !waited) return waited.error();
            if (hostWait_ == VK_TIMEOUT) return GN_TIMEOUT;
        } else if (timeoutNs == UINT64_MAX) {
            jobs_.wait(hostJob_);
        } else {
            const auto until = std::chrono::steady_clock::now() + std::chrono::nanoseconds(timeoutNs);
            while (!hostJob_.done()) {
                if (std::chrono::steady_clock::now() >= until) return GN_TIMEOUT;
                std::this_thread::sleep_for(std::chrono::microseconds(50));
            }
        }
        if (hostThrown_) std::rethrow_exception(std::exchange(hostThrown_, nullptr));
        if (hostWait_ != VK_SUCCESS) return waitError(hostWait_);
        declareLater();
        order_ = graph_.order();
        ++round_;
        if (Result<void> submitted = submitRound(round_, !roundHas(round_, PassKind::host)); !submitted)
            return submitted.error();
    }
    return GN_SUCCESS;
}

/// Waits for the round's GPU work and runs its host passes.
Result<void> PassExecutor::hostRound(std::uint64_t timeoutNs)
{
    hostWait_ = timeline_.wait(timeoutNs, &progress, this);
    if (hostWait_ == VK_TIMEOUT) return {};
    ++counters_.hostWaits;
    if (hostWait_ != VK_SUCCESS) return waitError(hostWait_);
    runCpuPasses(round_, PassKind::host);
    return {};
}

/// hostRound() on a worker, where nobody catches anything.
void PassExecutor::hostJob() noexcept
{
    try {
        (void)hostRound(UINT64_MAX); // hostWait_ says how it went
    } catch (...) {
        hostThrown_ = std::current_exception();
    }
}

void PassExecutor::declareLater()
{
    std::sort(later_.begin(), later_.end(), [](const Later& a, const Later& b) { return a.pass < b.pass; });
    for (const Later& later : later_) {
        graph_.setFirstRound(round_ + 1);
        graph_.resumeTask(graph_.passes()[later.pass].task);
        PassBuilder builder(graph_);
        later.fn(later.body, builder);
        graph_.endTask();
    }
    later_.clear();
}

Result<void> PassExecutor::submitRound(std::uint32_t round, bool last)
{
    runCpuPasses(round, PassKind::prepare);
    Result<VkCommandBuffer> cmd = commandBuffer(*slot_, round);
    if (!cmd) return cmd.error();
    const VkCommandBufferBeginInfo beginInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                             .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    if (VkResult r = vk_.vkBeginCommandBuffer(*cmd, &beginInfo); r != VK_SUCCESS)
        return vulkanError(r, "vkBeginCommandBuffer");
    if (Result<void> recorded = recordRound(*cmd, round, last); !recorded) return recorded;
    if (VkResult r = vk_.vkEndCommandBuffer(*cmd); r != VK_SUCCESS) return vulkanError(r, "vkEndCommandBuffer");

    const VkCommandBufferSubmitInfo cmdInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                            .commandBuffer = *cmd};
    const VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                               .waitSemaphoreInfoCount = round == 0 ? static_cast<std::uint32_t>(waits_.size()) : 0,
                               .pWaitSemaphoreInfos = waits_.data(),
                               .commandBufferInfoCount = 1,
                               .pCommandBufferInfos = &cmdInfo};
    // The host's signals belong to the last submit; ours marks every round.
    const std::span<const VkSemaphoreSubmitInfo> hostSignals =
        last ? std::span(signals_) : std::span(signals_).first(0);
    if (Result<void> submitted = timeline_.submit(submit, hostSignals); !submitted) return submitted;
    ++counters_.submits;
    slot_->timingsPending = true;

    if (!last && !inlineHost_) {
        hostJob_.data = this;
        hostJob_.run = [](void* self) { static_cast<PassExecutor*>(self)->hostJob(); };
        jobs_.submit(hostJob_);
    }
    return {};
}

/// The casters of the frame for those who trace, before any pass.
Result<void> PassExecutor::updateRays()
{
    if (!frame_.raysNeeded || !frame_.rays) return {};
    const auto start = std::chrono::steady_clock::now();
    const bool whole = frame_.rays->update(frame_.scene->casters);
    const float ms = elapsedMs(start);
    counters_.cpuMs += ms;
    slot_->entries.push_back({.timing = {.name = "rays.update", .cpuMs = ms}});
    if (whole) return {};
    return Error{GN_ERROR_OUT_OF_HOST_MEMORY, "OutOfHostMemory",
                 "the ray tracer found no memory for this frame's casters"};
}

/// Runs the round's prepare or host passes: batches in order, the passes of a batch side by side.
void PassExecutor::runCpuPasses(std::uint32_t round, PassKind kind)
{
    for (std::size_t i = 0; i < order_.size();) {
        const Pass& head = graph_.passes()[order_[i]];
        std::size_t end = i + 1;
        while (end < order_.size()) {
            const Pass& next = graph_.passes()[order_[end]];
            if (next.round != head.round || next.kind != head.kind || next.batch != head.batch) break;
            ++end;
        }
        if (head.round == round && head.kind == kind) {
            runBatch(std::span(order_).subspan(i, end - i));
        }
        i = end;
    }
}

/// Passes side by side take each other's threads, and each looks as slow as all of them. A timed frame runs them one
/// after the other, as it does on the GPU; in others they share the time that the batch took.
void PassExecutor::runBatch(std::span<const std::uint32_t> batch)
{
    const auto start = std::chrono::steady_clock::now();
    if (slot_->timed) {
        for (const std::uint32_t index : batch)
            runPass(index);
    } else {
        jobs_.parallelFor(batch.size(), 1, [&](std::size_t begin, std::size_t end, std::uint32_t) {
            for (std::size_t k = begin; k < end; ++k)
                runPass(batch[k]);
        });
    }
    const float wallMs = elapsedMs(start);
    float sumMs = 0.0f;
    for (const std::uint32_t index : batch)
        sumMs += graph_.passes()[index].cpuMs;
    const float share = sumMs > wallMs ? wallMs / sumMs : 1.0f;
    for (const std::uint32_t index : batch) {
        const Pass& pass = graph_.passes()[index];
        if (!pass.fn) continue;
        const float ms = share * pass.cpuMs;
        ++counters_.passesRun;
        counters_.cpuMs += ms;
        slot_->entries.push_back(
            {.timing = {.name = pass.name, .owner = pass.owner, .round = pass.round, .cpuMs = ms}});
    }
}

void PassExecutor::runPass(std::uint32_t index)
{
    Pass& pass = graph_.passes()[index];
    if (!pass.fn) return;
    const auto start = std::chrono::steady_clock::now();
    HostContext host;
    host.jobs = &jobs_;
    host.rays = frame_.rays;
    host.arena = &graph_.arena();
    host.executor_ = this;
    host.pass_ = index;
    pass.fn(pass.body, nullptr, &host);
    pass.cpuMs = elapsedMs(start);
}

Result<VkCommandBuffer> PassExecutor::commandBuffer(Slot& slot, std::uint32_t round)
{
    while (slot.cmds.size() <= round) {
        const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                               .commandPool = slot.pool.get(),
                                               .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                               .commandBufferCount = 1};
        VkCommandBuffer cmd = VK_NULL_HANDLE;
        if (VkResult r = vk_.vkAllocateCommandBuffers(vk_.device, &info, &cmd); r != VK_SUCCESS)
            return vulkanError(r, "vkAllocateCommandBuffers");
        ++vk_.objectsMade;
        slot.cmds.push_back(cmd);
    }
    return slot.cmds[round];
}

Result<VkCommandBuffer> PassExecutor::beginOnce()
{
    // Warm-up comes between frames; the newest submit may still use any slot's pool, so it has one of its own.
    const VkCommandPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                           .queueFamilyIndex = vk_.queueFamily};
    VkCommandPool pool = VK_NULL_HANDLE;
    if (VkResult r = vk_.vkCreateCommandPool(vk_.device, &poolInfo, vk_.hostAllocator, &pool); r != VK_SUCCESS)
        return vulkanError(r, "vkCreateCommandPool");
    oncePool_ = {vk_, pool};
    warmupsBefore_ = pipelines_.warmupMarks().begun();
    const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                           .commandPool = pool,
                                           .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                           .commandBufferCount = 1};
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    if (VkResult r = vk_.vkAllocateCommandBuffers(vk_.device, &info, &cmd); r != VK_SUCCESS)
        return vulkanError(r, "vkAllocateCommandBuffers");
    const VkCommandBufferBeginInfo beginInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                             .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    if (VkResult r = vk_.vkBeginCommandBuffer(cmd, &beginInfo); r != VK_SUCCESS)
        return vulkanError(r, "vkBeginCommandBuffer");
    return cmd;
}

Result<void> PassExecutor::endOnce(VkCommandBuffer cmd)
{
    if (VkResult r = vk_.vkEndCommandBuffer(cmd); r != VK_SUCCESS) return vulkanError(r, "vkEndCommandBuffer");
    const VkCommandBufferSubmitInfo cmdInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                            .commandBuffer = cmd};
    const VkSubmitInfo2 submit{
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &cmdInfo};
    if (Result<void> submitted = timeline_.submit(submit, {}); !submitted) return submitted;
    const VkResult waited = timeline_.wait(UINT64_MAX, &progress, this, DeviceTimeline::Work::once);
    if (waited != VK_SUCCESS) return waitError(waited);
    oncePool_ = {};
    return {};
}

void PassExecutor::waitQueue() noexcept
{
    if (!slot_ && !timeline_.used()) return;                 // nothing of ours was ever on the queue
    static_cast<void>(timeline_.waitQueue(&progress, this)); // a lost device is as good as an idle one
}

std::uint64_t PassExecutor::progress(const void* self) noexcept
{
    const auto& executor = *static_cast<const PassExecutor*>(self);
    const std::uint64_t passes = executor.slot_ ? executor.slot_->marks.begun() : 0;
    return passes << 32 | executor.pipelines_.warmupMarks().begun();
}

Error PassExecutor::waitError(VkResult waited) const
{
    if (!hung()) return vulkanError(waited, "vkWaitSemaphores");
    return {GN_ERROR_DEVICE_LOST, "DeviceHung",
            "the device made no progress for " + std::to_string(timeline_.limitMs()) +
                " ms (GnContextCreateInfo::waitLimitMs); " + lastBegun() + "; the context counts as lost"};
}

/// What the device began last. Where passes of a round are not marked one by one, those that it may have been.
std::string PassExecutor::lastBegun() const
{
    const std::uint32_t begun = oncePool_ || !slot_ ? 0 : slot_->marks.begun();
    if (begun == 0 && pipelines_.warmupMarks().begun() > warmupsBefore_)
        return "last begun: the first run of pipeline '" + pipelines_.lastWarmup() + "'";
    if (begun == 0) return "nothing that it waits for has begun";
    const std::vector<Slot::Entry>& entries = slot_->entries;
    const PassTiming& first = entries[begun - 1].timing;
    std::string text = "last begun in frame " + std::to_string(slot_->frame) + ": pass '" + first.name + "'";
    for (std::size_t i = begun; !marksPasses() && i < entries.size(); ++i)
        text += std::string(i == begun ? ", or after it '" : ", '") + entries[i].timing.name + "'";
    return text;
}

} // namespace gnomon
