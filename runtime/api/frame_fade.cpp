// A light whose method changes: for some frames both methods run, and what is shown goes from one to the other.
#include <algorithm>
#include <limits>

#include "runtime/api/context.hpp"
#include "runtime/passes/pass_context.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "shaders/runtime_fade_mix_frag.h"
#include "shaders/shared_fullscreen_vert.h"

namespace gnomon {

namespace {

constexpr BindingInfo kMixBindings[] = {
    {.binding = 0, .kind = BindingKind::sampledImage, .format = VK_FORMAT_R8_UNORM, .array = true}};

constexpr const char* kMixPass = "view.fade";
constexpr const char* kCannotServe = "the method before can no longer serve";

} // namespace

PipelineId fadeMixPipeline(PipelineLibrary& library)
{
    return library.graphics({.name = "view.fade",
                             .vertex = {.code = k_shared_fullscreen_vert},
                             .fragment = {.code = k_runtime_fade_mix_frag},
                             .bindings = kMixBindings,
                             .pushBytes = sizeof(float),
                             .colorFormat = VK_FORMAT_R8_UNORM});
}

/// Whether two methods give the same picture: both answer by geometry, and no caster is there for one of them alone.
bool Context::showTheSame(const PendingLight& pending, std::uint32_t a, std::uint32_t b) const
{
    return (*methods_)[a].isExact() && (*methods_)[b].isExact() && pending.casters->missable == 0;
}

/// Whether a method may run beside another for a light. What a host pass declares comes after the mix.
bool Context::canShareLayer(const LightDecision& decision, std::uint32_t method) const
{
    return decision.candidates[method].exclusion == Exclusion::none && (*methods_)[method].entry->maxRounds == 0;
}

/// Where the light's fade stands in this frame, before commit(): what it would cost beside the plan.
FadeRequest Context::nextFade(const PendingLight& pending, const rules::RuleBase* base)
{
    const View& view = *viewFrames_[pending.viewIndex].view;
    LightDecision& decision = *pending.decision;
    LightMemory& memory = *pending.memory;
    const std::uint32_t length = base && gridReady_ ? base->policy.hysteresis.crossFadeFrames : 0;
    const char* obstacle = length == 0                           ? "the rules ask for none"
                           : view.camera.cut                     ? "the camera was cut"
                           : decision.reason == GN_REASON_PINNED ? "the host pinned the method"
                           : memory.lastFrame != view.lastFrame  ? "the light was not in the frame before"
                                                                 : nullptr;
    const bool begun = memory.fade.running();
    Fade::Step step = memory.fade.advance(frame_, decision.method, length, obstacle != nullptr);
    if (step.outgoing != Fade::kNone &&
        !(canShareLayer(decision, step.outgoing) && canShareLayer(decision, decision.method))) {
        memory.fade.skip();
        step = {};
        obstacle = kCannotServe;
    }
    if (step.outgoing != Fade::kNone && !step.begun && showTheSame(pending, step.outgoing, decision.method)) {
        memory.fade.skip();
        step = {};
        obstacle = "both methods are exact, there is nothing to see";
    }
    const bool changed = decision.incumbent != UINT32_MAX && decision.method != decision.incumbent;
    if (obstacle && (begun || changed)) decision.noFade = obstacle;
    decision.outgoing = step.outgoing;
    decision.fade = step.share;
    if (step.outgoing == Fade::kNone) return {};
    return {.outgoingMs = decision.candidates[step.outgoing].predictedMs + mixMs_.get(), .begun = step.begun};
}

/// The plan has no say in fades, nor they in the plan: what does not fit beside it is shown at once.
void Context::settleFades()
{
    const double usableMs = planReport_.usableMs > 0.0 ? std::max(planReport_.usableMs - planReport_.partsMs, 0.0)
                                                       : std::numeric_limits<double>::infinity();
    stats_.predictedMs = static_cast<float>(admitFades(fades_, predictedMs_, usableMs));
    for (std::size_t i = 0; i < pending_.size(); ++i) {
        LightDecision& decision = *pending_[i].decision;
        if (decision.outgoing == UINT32_MAX || fades_[i].admitted) continue;
        pending_[i].memory->fade.skip();
        decision.outgoing = UINT32_MAX;
        decision.fade = 1.0f;
        decision.noFade = "both methods do not fit the budget";
    }
}

/// The outgoing method of a fading light, or the one that is probed, which nobody sees. @return the image of two layers
/// that it writes one of, the other being for what it is mixed with; null: only one method runs.
ImageId Context::declareBeside(const PendingLight& pending, FrameMode mode)
{
    LightDecision& decision = *pending.decision;
    const std::uint32_t beside = decision.outgoing != UINT32_MAX ? decision.outgoing : decision.probed;
    if (beside == UINT32_MAX) return {};
    const ViewFrame& viewFrame = viewFrames_[pending.viewIndex];
    const CameraView& camera = viewFrame.view->camera;
    graph_->beginTask({.view = camera.id, .light = pending.light->id}, &camera, viewFrame.depth, viewFrame.normals);
    const ImageId pair = PassBuilder(*graph_).transient(
        ImageInfo{.name = "view.fade", .format = VK_FORMAT_R8_UNORM, .extent = camera.extent, .layers = 2});
    std::optional<Error> error = graph_->endTask();
    if (!error) error = declareMethod(pending, beside, pair, kOutgoingLayer, mode);
    if (!error) return pair;
    pending.memory->fade.skip();
    pending.memory->failures[beside].note(frame_, error->result == GN_ERROR_OUT_OF_DEVICE_MEMORY);
    if (decision.outgoing != UINT32_MAX) decision.noFade = kCannotServe;
    decision.outgoing = decision.probed = UINT32_MAX;
    decision.fade = 1.0f;
    return {};
}

void Context::declareMix(const PendingLight& pending, ImageId pair)
{
    const ViewFrame& viewFrame = viewFrames_[pending.viewIndex];
    const CameraView& camera = viewFrame.view->camera;
    const float incomingShare = pending.decision->fade;
    const PipelineId pipeline = mixPipeline_;
    const VkRect2D pixels = lightPixels(*pending.light, camera); // in all others both methods say 1
    graph_->beginTask({.view = camera.id, .light = pending.light->id}, &camera, viewFrame.depth, viewFrame.normals);
    PassBuilder(*graph_)
        .raster(kMixPass)
        .samples(pair)
        .writes(viewFrame.visibility, visibilityIn(camera, pending.layer, pixels))
        .record([=](PassContext& gpu) {
            if (pixels.extent.width == 0) return;
            gpu.vk->vkCmdSetScissor(gpu.cmd, 0, 1, &pixels);
            gpu.bind(pipeline, {gpu.sampled(0, pair)});
            gpu.push(incomingShare);
            gpu.drawFullscreen();
        });
    (void)graph_->endTask(); // makes nothing, so nothing can fail
    ++stats_.fading;
}

/// What showing two methods takes beside them: a pass that neither of them is charged with.
void Context::noteMixes(const FrameTimings& timings)
{
    for (const PassTiming& pass : timings.passes)
        if (pass.name == kMixPass) mixMs_.add(pass.gpuMs * timedScale_);
}

void Context::withdrawFades(std::uint64_t frame)
{
    for (const ViewFrame& viewFrame : viewFrames_)
        for (auto& [id, memory] : viewFrame.view->lights)
            memory.fade.withdraw(frame);
}

} // namespace gnomon
