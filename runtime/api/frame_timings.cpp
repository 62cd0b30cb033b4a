// What completed frames took: published, charged to lights, learned from.
#include <algorithm>

#include "runtime/api/context.hpp"

namespace gnomon {

namespace {

// What no frame of the last ten seconds (at 60 Hz) asked for is forgotten.
constexpr std::uint64_t kForgetFrames = 600;

} // namespace

void Context::takeTimings()
{
    if (const FrameTimings* whole = executor_->newest()) untimedGpuMs_ = whole->totalGpuMs;
    const FrameTimings* timed = executor_->newestTimed();
    stats_.gpuMs = untimedGpuMs_ > 0.0f ? untimedGpuMs_ : timed ? timed->totalGpuMs : 0.0f;
    if (!timed || timed->frame <= timingsTaken_) return;
    timingsTaken_ = timed->frame;
    chargeLights(*timed);
}

/// What each light's own passes cost, scaled from the timed frame (whose barriers slow it down) to the untimed total.
void Context::chargeLights(const FrameTimings& timings)
{
    const float scale =
        untimedGpuMs_ > 0.0f && timings.totalGpuMs > untimedGpuMs_ ? untimedGpuMs_ / timings.totalGpuMs : 1.0f;
    const bool disturbed = std::find(disturbed_.begin(), disturbed_.end(), timings.frame) != disturbed_.end();
    for (ViewFrame& viewFrame : viewFrames_) {
        View& view = *viewFrame.view;
        for (auto& [id, memory] : view.lights) {
            LightTiming light;
            std::uint32_t method = UINT32_MAX;
            for (const PassTiming& pass : timings.passes) {
                if (pass.owner.light != id) continue;
                if (pass.owner.view != UINT32_MAX && pass.owner.view != view.id) continue;
                const bool update = pass.owner.view == UINT32_MAX; // light scope
                if (!update) method = pass.owner.method;
                light.updated |= update;
                (update ? light.updateGpuMs : light.resolveGpuMs) += pass.gpuMs * scale;
                (update ? light.updateCpuMs : light.resolveCpuMs) += pass.cpuMs;
            }
            if (method >= methods_->size()) continue;
            memory.measuredMs[method] = light.updateGpuMs + light.updateCpuMs + light.resolveGpuMs + light.resolveCpuMs;
            plan_->observe(memory, method, light, disturbed);
        }
    }
    plan_->endFrame();
}

/// While host passes run on a worker the counters are its; they are read when the frame is finished.
void Context::finishStats()
{
    if (executor_->underway()) return;
    const ExecutorCounters& counters = executor_->counters();
    stats_.levels = graph_->levels();
    stats_.submits = counters.submits;
    stats_.hostWaits = counters.hostWaits;
    stats_.passesRun = counters.passesRun;
    stats_.passesKept = graph_->keptPasses();
    stats_.indexListsBuilt = counters.indexListsBuilt;
    stats_.rays = counters.rays;
    stats_.cpuMs = counters.cpuMs;
    stats_.deviceAllocations = static_cast<std::uint32_t>(vk_->objectsMade - objectsBefore_);
    stats_.pipelinesCreated = static_cast<std::uint32_t>(vk_->pipelinesMade - pipelinesBefore_);
    stats_.memory = memory_->used();
    lastPredictedMs_ = predictedMs_;
    lastCpuMs_ = counters.cpuMs;
    forgetOldLights();
}

void Context::forgetOldLights()
{
    if (frame_ % kForgetFrames != 0) return;
    std::erase_if(lights_, [&](const auto& entry) {
        return entry.second.lastFrame + kForgetFrames < frame_ && entry.second.pinned == UINT32_MAX;
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

} // namespace gnomon
