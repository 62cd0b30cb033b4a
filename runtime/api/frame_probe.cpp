// Under a budget with time to spare, a method that may be cheaper than predicted runs beside the one that serves, for
// as long as it takes to time it. Nobody sees it: exploring must not flicker. Policy::Probing says how often.
#include "runtime/api/context.hpp"

namespace gnomon {

bool Context::wantsProbe(const rules::RuleBase* base) const
{
    if (!base || base->policy.probing.everyFrames == 0 || probe_.method != UINT32_MAX || !gridReady_) return false;
    // Predictions are made anew about once in a grid's period; looking more often finds the same.
    return frame_ % kGridPeriod == 0 && frame_ >= probe_.since + base->policy.probing.everyFrames;
}

/// Goes on with the probe that runs, or begins the one that the plan step named. Fades go before.
void Context::settleProbe()
{
    if (probe_.method == UINT32_MAX && plan_->probe().light < pending_.size()) {
        const PendingLight& pending = pending_[plan_->probe().light];
        probe_ = {.view = viewFrames_[pending.viewIndex].view->id,
                  .light = pending.light->id,
                  .method = plan_->probe().method,
                  .since = frame_};
    }
    if (probe_.method == UINT32_MAX) return;
    if (frame_ >= probe_.since + cost::kLearnFrames) {
        probe_.method = UINT32_MAX;
        return;
    }
    for (const PendingLight& pending : pending_) {
        LightDecision& decision = *pending.decision;
        const View& view = *viewFrames_[pending.viewIndex].view;
        if (view.id != probe_.view || pending.light->id != probe_.light) continue;
        const bool steady = !decision.switched && decision.outgoing == UINT32_MAX && !view.camera.cut &&
                            decision.method < methods_->size() && decision.method != probe_.method;
        const float ms = decision.candidates[probe_.method].predictedMs;
        const double usableMs = planReport_.usableMs - planReport_.partsMs;
        const bool tooMuch = frame_ > probe_.since && budgetMs_ > 0.0 && measuredMs() > budgetMs_; // in a frame with it
        if (!steady || tooMuch || !canShareLayer(decision, probe_.method) ||
            !(double{stats_.predictedMs} + double{ms} <= usableMs))
            break;
        decision.probed = probe_.method;
        pending.memory->probed = probe_.method;
        pending.memory->probedSince = probe_.since;
        stats_.predictedMs += ms;
        return;
    }
    probe_.method = UINT32_MAX; // the light is gone, or what the probe stood on is
}

} // namespace gnomon
