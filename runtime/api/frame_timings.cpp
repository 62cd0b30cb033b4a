// What completed frames took: published, charged to lights, learned from.
#include <algorithm>
#include <utility>

#include "runtime/api/context.hpp"

namespace gnomon {

namespace {

// What no frame of the last ten seconds (at 60 Hz) asked for is forgotten.
constexpr std::uint64_t kForgetFrames = 600;

} // namespace

/// A frame in which a light's method changed; one while the last one's timings are still to come is passed over, so
/// that of frames that all bring changes four in seven are timed.
void Context::noteChanges(std::uint64_t frame)
{
    const bool changed = std::any_of(pending_.begin(), pending_.end(), [frame](const PendingLight& pending) {
        return pending.memory->methodSince == frame;
    });
    if (changed && frame >= changedAt_ + cost::kLearnFrames) changedAt_ = frame;
}

/// What has just been switched on is known least: its first settled frames are timed.
bool Context::learnsFrom(std::uint64_t frame) const
{
    const auto settled = [frame](std::uint64_t since) {
        return since != 0 && frame >= since + cost::kSettleFrames && frame < since + cost::kLearnFrames;
    };
    return settled(changedAt_) || (probe_.method != UINT32_MAX && settled(probe_.since));
}

const Context::PastFrame& Context::past(std::uint64_t frame) const
{
    static const PastFrame gone;
    const PastFrame& note = past_[frame % past_.size()];
    return note.frame == frame ? note : gone;
}

void Context::takeTimings()
{
    if (const FrameTimings* whole = executor_->newest(); whole && whole->frame > untimedFrame_) {
        untimedGpuMs_ = whole->totalGpuMs;
        untimedFrame_ = whole->frame;
        untimedCpuMs_ = past(untimedFrame_).cpuMs;
    }
    const FrameTimings* timed = executor_->newestTimed();
    // A host that has begun to time every frame leaves none untimed.
    if (untimedFrame_ != 0 && timed && timed->frame > untimedFrame_ + 2 * kTimedPeriod) {
        untimedGpuMs_ = timed->totalGpuMs * timedScale_;
        untimedFrame_ = timed->frame;
        untimedCpuMs_ = past(untimedFrame_).cpuMs;
    }
    if (untimedGpuMs_ > 0.0f) {
        stats_.gpuMs = untimedGpuMs_, stats_.gpuFrame = untimedFrame_, stats_.gpuFrameCpuMs = untimedCpuMs_;
    } else if (timed) {
        stats_.gpuMs = timed->totalGpuMs, stats_.gpuFrame = timed->frame;
        stats_.gpuFrameCpuMs = past(timed->frame).cpuMs;
    }
    if (!timed || timed->frame <= timingsTaken_) return;
    timingsTaken_ = timed->frame;
    noteTimedScale(*timed);
    chargeLights(*timed);
    noteMixes(*timed);
    noteShared(*timed);
    noteMeasured(*timed);
}

/// The barriers of a timed frame slow it down; an untimed one with the same methods at work says by how much. The
/// middle of five such pairs, since either frame may have been disturbed; by weight, since barriers are a third of a
/// millisecond of copies and next to nothing of twenty of drawing.
void Context::noteTimedScale(const FrameTimings& timed)
{
    const PastFrame &there = past(timed.frame), &here = past(untimedFrame_);
    if (!(untimedGpuMs_ > 0.0f) || untimedFrame_ == timed.frame || there.methods != here.methods) return;
    if (there.disturbed || here.disturbed) return;
    const float ratio = timed.totalGpuMs > untimedGpuMs_ ? untimedGpuMs_ / timed.totalGpuMs : 1.0f;
    // By the lesser one: a hitch in either must not outweigh the four others.
    timedRatios_.add(ratio, std::min(timed.totalGpuMs, untimedGpuMs_));
    timedScale_ = timedRatios_.get();
}

/// The depth grid and moved instances are there whatever the methods, so that lights may spend what they leave of a
/// budget; copies for the CPU and whatever else methods share within a view, with the first of them. What a method
/// makes once for a mesh is its first frame's. Of frames that the host has timed seven in eight bring no grid.
void Context::noteShared(const FrameTimings& timings)
{
    const PastFrame& then = past(timings.frame);
    if (then.disturbed || !then.timedUnasked) return;
    float sum = 0.0f, unasked = 0.0f;
    MethodSet ran;
    for (const PassTiming& pass : timings.passes) {
        ran |= pass.owner.declarers;
        if (pass.owner.light != UINT32_MAX) continue;
        if (pass.owner.view == UINT32_MAX && pass.owner.declarer != UINT32_MAX) continue;
        const float ms = pass.gpuMs * timedScale_ + pass.cpuMs;
        sum += ms;
        if (!pass.owner.declarers.empty())
            sharedParts_.note(pass.name, pass.owner.declarers, ms);
        else
            unasked += ms;
    }
    sharedMs_.add(sum);
    unaskedMs_.add(unasked);
    sharedParts_.endFrame(ran, then.pixels);
}

/// What each light's own passes cost, scaled from the timed frame to the untimed total.
void Context::chargeLights(const FrameTimings& timings)
{
    const bool disturbed = past(timings.frame).disturbed;
    for (ViewFrame& viewFrame : viewFrames_)
        for (auto& [id, memory] : viewFrame.view->lights)
            chargeLight(timings, *viewFrame.view, id, memory, disturbed);
    plan_->endFrame();
}

/// Of a light that faded in that frame there are two methods: each is charged with the passes it declared.
void Context::chargeLight(const FrameTimings& timings, const View& view, std::uint32_t id, LightMemory& memory,
                          bool disturbed)
{
    std::array<std::uint32_t, 2> methods{UINT32_MAX, UINT32_MAX};
    for (const PassTiming& pass : timings.passes) {
        const std::uint32_t method = pass.owner.method;
        if (pass.owner.light != id || pass.owner.view != view.id || method >= methods_->size()) continue;
        if (methods[0] == UINT32_MAX) methods[0] = method;
        if (method != methods[0]) methods[1] = method;
    }
    if (methods[0] == memory.incumbent) std::swap(methods[0], methods[1]); // who serves has the last word
    for (const std::uint32_t method : methods) {
        if (method == UINT32_MAX) continue;
        LightTiming light{.frame = timings.frame};
        for (const PassTiming& pass : timings.passes) {
            if (pass.owner.light != id || pass.owner.declarer != method) continue;
            if (pass.owner.view != UINT32_MAX && pass.owner.view != view.id) continue;
            const bool update = pass.owner.view == UINT32_MAX; // light scope
            light.updated |= update;
            (update ? light.updateGpuMs : light.resolveGpuMs) += pass.gpuMs * timedScale_;
            (update ? light.updateCpuMs : light.resolveCpuMs) += pass.cpuMs;
        }
        memory.measuredMs[method] = light.updateGpuMs + light.updateCpuMs + light.resolveGpuMs + light.resolveCpuMs;
        plan_->observe(memory, method, light, disturbed);
    }
}

/// While host passes run on a worker the counters are its; they are read when the frame is finished.
void Context::finishStats()
{
    if (executor_->underway()) return;
    const ExecutorCounters& counters = executor_->counters();
    stats_.rounds = graph_->rounds();
    stats_.submits = counters.submits;
    stats_.hostWaits = counters.hostWaits;
    stats_.passesRun = counters.passesRun;
    stats_.passesKept = graph_->keptPasses();
    stats_.indexListsBuilt = counters.indexListsBuilt;
    stats_.rays = counters.rays;
    if (rays_) stats_.raysMs = 1e-6f * static_cast<float>(rays_->queryNanoseconds() - queriesBefore_);
    stats_.cpuMs = counters.cpuMs;
    stats_.deviceAllocations = static_cast<std::uint32_t>(vk_->objectsMade - objectsBefore_);
    stats_.pipelinesCreated = static_cast<std::uint32_t>(vk_->pipelinesMade - pipelinesBefore_);
    stats_.memory = memory_->used();
    lastPredictedMs_ = predictedMs_;
    present().cpuMs = counters.cpuMs;
    forgetOldLights();
}

void Context::forgetOldLights()
{
    if (frame_ % kForgetFrames != 0) return;
    std::erase_if(lights_, [&](const auto& entry) {
        if (entry.second.lastFrame + kForgetFrames >= frame_) return false;
        return entry.second.pinned == UINT32_MAX || !scene_->validLight(entry.second.handle); // a pin outlasts a pause
    });
    views_.forEach([&](std::unique_ptr<View>& view) {
        for (auto it = view->lights.begin(); it != view->lights.end();) {
            if (it->second.lastFrame + kForgetFrames >= frame_) {
                ++it;
                continue;
            }
            plan_->forget(it->second);
            it = view->lights.erase(it);
        }
    });
}

GnPassTiming Context::publicTiming(const PassTiming& timing) const
{
    const bool shared =
        timing.owner.view != UINT32_MAX && timing.owner.light == UINT32_MAX && !timing.owner.declarers.empty();
    GnPassTiming out{.pName = timing.name,
                     .round = timing.round,
                     .gpuMs = timing.gpuMs,
                     .cpuMs = timing.cpuMs,
                     .shared = shared ? VK_TRUE : VK_FALSE};
    for (const ViewFrame& viewFrame : viewFrames_)
        if (viewFrame.view->id == timing.owner.view) out.view = viewFrame.view->handle;
    for (const LightFrame& light : lightFrames_)
        if (light.id == timing.owner.light) out.light = light.handle;
    return out;
}

std::uint32_t Context::passTimings(std::uint64_t& frame, std::span<GnPassTiming> out)
{
    const FrameTimings* timings = executor_->newestTimed();
    frame = timings ? timings->frame : 0;
    if (!timings) return 0;
    for (std::size_t i = 0; i < std::min(timings->passes.size(), out.size()); ++i)
        out[i] = publicTiming(timings->passes[i]);
    return static_cast<std::uint32_t>(timings->passes.size());
}

Result<std::uint32_t> Context::framePasses(std::span<GnPassTiming> out)
{
    // A worker runs the host passes in this order, and they may declare others.
    if (executor_->underway())
        return Error{GN_ERROR_FRAME_ORDER, "FrameUnderway", "gnGetFramePasses before gnFinishShadows"};
    std::uint32_t count = 0;
    for (const std::uint32_t index : graph_->order()) {
        const Pass& pass = graph_->passes()[index];
        if (!pass.fn) continue;
        if (count < out.size())
            out[count] = publicTiming({.name = pass.name, .owner = pass.owner, .round = pass.round});
        ++count;
    }
    return count;
}

} // namespace gnomon
