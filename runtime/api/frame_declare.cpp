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
        if (fades) declareMix(pending, pair);
        return;
    }
    const Method& method = (*methods_)[decision.method];
    messages_.warn(error->id, "light '" + std::string(pending.light->name) + "', method '" + method.name +
                                  "': " + error->text + "; lit in this frame");
    Candidate& candidate = decision.candidates[decision.method];
    if (error->result == GN_ERROR_OUT_OF_DEVICE_MEMORY) {
        candidate.exclusion = Exclusion::memory;
        candidate.detail = method.entry->memoryFor(method.settings, viewFrames_[pending.viewIndex].view->camera.extent,
                                                   pending.light->type);
    } else {
        candidate.exclusion = Exclusion::refused;
        candidate.refusal = "its passes could not be made in this frame; a message says why";
    }
    decision.method = decision.outgoing = decision.probed = UINT32_MAX;
    decision.fade = 1.0f;
    decision.reason = GN_REASON_NOTHING_READY;
    pending.memory->fade.lose();
    declareLit(pending.viewIndex, pending.layer);
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
