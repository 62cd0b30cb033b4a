// The passes of one light by the method that was decided.
#include "runtime/api/context.hpp"

namespace gnomon {

void Context::declareLight(const PendingLight& pending, FrameMode mode)
{
    LightDecision& decision = *pending.decision;
    if (decision.method == UINT32_MAX) return declareLit(pending.viewIndex, pending.layer);
    const ImageId pair = declareBeside(pending, mode);
    const bool fades = decision.outgoing != UINT32_MAX;
    const ImageId visibility = fades ? pair : viewFrames_[pending.viewIndex].visibility;
    const std::uint32_t layer = fades ? kIncomingLayer : pending.layer;
    const std::optional<Error> error = declareMethod(pending, decision.method, visibility, layer, mode);
    if (!error) {
        pending.memory->failures[decision.method].noteServed(frame_);
        if (fades) declareMix(pending, pair);
        return;
    }
    noteFailure(pending, *error);
    declareLight(pending, mode); // each turn has a candidate less
}

/// The method's passes cannot be made: it is left alone for a while, and another one serves the light if one can.
void Context::noteFailure(const PendingLight& pending, const Error& error)
{
    LightDecision& decision = *pending.decision;
    const Method& failed = (*methods_)[decision.method];
    const bool memory = error.result == GN_ERROR_OUT_OF_DEVICE_MEMORY;
    Candidate& candidate = decision.candidates[failed.index];
    candidate.exclusion = memory ? Exclusion::memory : Exclusion::refused;
    candidate.refusal = memory ? nullptr : kPassesFailed;
    if (memory)
        candidate.detail = failed.entry->memoryFor(failed.settings, viewFrames_[pending.viewIndex].view->camera.extent,
                                                   pending.light->type);
    pending.memory->failures[failed.index].note(frame_, memory);
    pending.memory->fade.lose();
    predictedMs_ -= decision.predictedMs;
    selector_->substitute(decision);
    selector_->commit(decision, *pending.memory, frame_);
    predictedMs_ += decision.predictedMs;
    messages_.warn(error.id,
                   "light '" + std::string(pending.light->name) + "', method '" + failed.name + "': " + error.text +
                       (decision.method == UINT32_MAX ? "; lit in this frame"
                                                      : "; '" + (*methods_)[decision.method].name + "' serves it"));
}

/// One method's passes for a light. @return why it cannot run.
std::optional<Error> Context::declareMethod(const PendingLight& pending, std::uint32_t index, ImageId visibility,
                                            std::uint32_t layer, FrameMode mode)
{
    ViewFrame& viewFrame = viewFrames_[pending.viewIndex];
    Method& method = (*methods_)[index];
    const ShadowTask task{.view = &viewFrame.view->camera,
                          .light = pending.light,
                          .casters = pending.casters,
                          .settings = method.settings,
                          .layer = layer,
                          .visibility = visibility,
                          .depth = viewFrame.depth,
                          .normals = viewFrame.normals,
                          .recorded = mode == FrameMode::recorded};
    graph_->beginTask({.view = viewFrame.view->id, .light = pending.light->id, .method = index}, task.view, task.depth,
                      task.normals);
    PassBuilder builder(*graph_);
    method.algorithm->declare(builder, task);
    if (std::optional<Error> error = graph_->endTask()) return error;
    raysNeeded_ |= method.has(GN_TRAIT_RAYS_BIT);
    const ShadowAlgorithm::Map* const map = method.algorithm->lightMap();
    if (map && index == pending.decision->method) maps_.push_back({pending.light->id, *map});
    return std::nullopt;
}

/// A light that nothing can serve is lit.
void Context::declareLit(std::uint32_t viewIndex, std::uint32_t layer)
{
    ViewFrame& viewFrame = viewFrames_[viewIndex];
    graph_->beginTask({.view = viewFrame.view->id}, &viewFrame.view->camera, viewFrame.depth, viewFrame.normals);
    PassBuilder(*graph_)
        .raster("view.lit", Scope::view, layer)
        .writes(viewFrame.visibility, {.layer = layer, .clear = true, .value = {.color = {.float32 = {1, 1, 1, 1}}}})
        .record([](PassContext&) {});
    graph_->endTask();
}

} // namespace gnomon
