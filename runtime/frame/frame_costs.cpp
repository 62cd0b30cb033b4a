#include "runtime/frame/frame_costs.hpp"

#include <algorithm>
#include <string_view>

#include "runtime/frame/frame.hpp"

namespace gnomon {

void FrameTotals::take(std::uint64_t frame, float gpuMs, const PastFrames& past)
{
    gpuMs_ = gpuMs;
    frame_ = frame;
    cpuMs_ = past.at(frame).cpuMs;
}

void FrameTotals::note(const FrameTimings* whole, const FrameTimings* timed, const PastFrames& past)
{
    if (whole && whole->frame > frame_) take(whole->frame, whole->totalGpuMs, past);
    // A host that has begun to time every frame leaves none untimed.
    if (frame_ != 0 && timed && timed->frame > frame_ + 2 * kTimedPeriod)
        take(timed->frame, timed->totalGpuMs * scale_, past);
}

void FrameTotals::noteScale(const FrameTimings& timed, const PastFrames& past)
{
    const PastFrame &there = past.at(timed.frame), &here = past.at(frame_);
    if (!known() || frame_ == timed.frame || there.methods != here.methods) return;
    if (there.disturbed || here.disturbed) return;
    const float ratio = timed.totalGpuMs > gpuMs_ ? gpuMs_ / timed.totalGpuMs : 1.0f;
    // By the lesser one: a hitch in either must not outweigh the four others.
    ratios_.add(ratio, std::min(timed.totalGpuMs, gpuMs_));
    scale_ = ratios_.get();
}

void SharedCosts::note(const FrameTimings& timings, const PastFrame& then, float scale)
{
    if (then.disturbed || !then.timedUnasked) return;
    float sum = 0.0f, unasked = 0.0f;
    MethodSet ran;
    for (const PassTiming& pass : timings.passes) {
        ran |= pass.owner.declarers;
        if (pass.owner.light != UINT32_MAX) continue;
        if (pass.owner.view == UINT32_MAX && pass.owner.declarer != UINT32_MAX) continue;
        const float ms = pass.gpuMs * scale + pass.cpuMs;
        sum += ms;
        if (!pass.owner.declarers.empty())
            parts_.note(pass.name, pass.owner.declarers, ms);
        else
            unasked += ms;
    }
    all_.add(sum);
    unasked_.add(unasked);
    parts_.endFrame(ran, then.pixels);
}

void SharedCosts::noteMixes(const FrameTimings& timings, float scale)
{
    for (const PassTiming& pass : timings.passes)
        if (std::string_view(pass.name) == kFadePass) mix_.add(pass.gpuMs * scale);
}

} // namespace gnomon
