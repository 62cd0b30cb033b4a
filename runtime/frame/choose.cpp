#include "runtime/frame/choose.hpp"

#include <algorithm>
#include <limits>

#include "runtime/base/hash.hpp"

namespace gnomon {

namespace {

/// What the rules think of each light, view by view.
void askRules(Frame& frame, const ChooseParts& parts)
{
    auto light = frame.lights.begin();
    for (std::uint32_t i = 0; i < frame.views.size(); ++i) {
        const auto end =
            std::find_if(light, frame.lights.end(), [i](const ViewLight& each) { return each.viewIndex != i; });
        const auto lights = static_cast<std::size_t>(end - light), methods = std::size_t{parts.methods.size()};
        View& view = *frame.views[i].view;
        std::vector<LightDecision>& decisions = view.decisions;
        decisions.reserve(lights); // addresses stay
        view.candidates.assign(lights * methods, {});
        for (; light != end; ++light) {
            const auto candidates = std::span(view.candidates).subspan(decisions.size() * methods, methods);
            decisions.push_back(parts.selector.assess(light->facts, *light->memory, candidates));
            light->decision = &decisions.back();
            if (light->decision->reason == GN_REASON_UNSEEN) continue;
            frame.planned.push_back(static_cast<std::uint32_t>(light - frame.lights.begin()));
            parts.plan.add(*light->decision, *light->memory, light->facts);
        }
        parts.selector.choose(decisions);
    }
}

// --- fades ---

/// Whether two methods give the same picture: both answer by geometry, and no caster is there for one of them alone.
bool showTheSame(const ViewLight& light, const MethodTable& methods, std::uint32_t a, std::uint32_t b)
{
    return methods[a].isExact() && methods[b].isExact() && light.casters->missable == 0;
}

/// Whether a method may run beside another for a light. What a host pass declares comes after the mix.
bool canShareLayer(const LightDecision& decision, const MethodTable& methods, std::uint32_t method)
{
    return decision.candidates[method].exclusion == Exclusion::none && methods[method].entry->maxRounds == 0;
}

/// Where the light's fade stands in this frame, before commit(): what it would cost beside the plan.
FadeRequest nextFade(const Frame& frame, const ViewLight& light, const ChooseParts& parts)
{
    const View& view = *frame.views[light.viewIndex].view;
    const MethodTable& methods = parts.methods;
    const rules::RuleBase* base = ruleBaseOf(parts.selector);
    LightDecision& decision = *light.decision;
    LightMemory& memory = *light.memory;
    const std::uint32_t length = base && parts.ownReady ? base->policy.hysteresis.crossFadeFrames : 0;
    const char* obstacle = length == 0                           ? "the rules ask for none"
                           : view.camera.cut                     ? "the camera was cut"
                           : decision.reason == GN_REASON_PINNED ? "the host pinned the method"
                           : memory.lastFrame != view.lastFrame  ? "the light was not in the frame before"
                           : decision.guessed                    ? "what the light reaches was not measured before"
                                                                 : nullptr;
    const bool begun = memory.fade.running();
    Fade::Step step = memory.fade.advance(frame.number, decision.method, length, obstacle != nullptr);
    if (step.outgoing != Fade::kNone &&
        !(canShareLayer(decision, methods, step.outgoing) && canShareLayer(decision, methods, decision.method))) {
        memory.fade.skip();
        step = {};
        obstacle = kCannotServe;
    }
    if (step.outgoing != Fade::kNone && !step.begun && showTheSame(light, methods, step.outgoing, decision.method)) {
        memory.fade.skip();
        step = {};
        obstacle = "both methods are exact, there is nothing to see";
    }
    const bool changed = decision.incumbent != UINT32_MAX && decision.method != decision.incumbent;
    if (obstacle && (begun || changed)) decision.noFade = obstacle;
    decision.outgoing = step.outgoing;
    decision.fade = step.share;
    if (step.outgoing == Fade::kNone) return {};
    return {.outgoingMs = decision.candidates[step.outgoing].predictedMs + parts.history.shared.mixMs(),
            .begun = step.begun};
}

/// The plan has no say in fades, nor they in the plan: what does not fit beside it is shown at once.
void settleFades(Frame& frame)
{
    const double usableMs = frame.plan.usableMs > 0.0 ? std::max(frame.plan.usableMs - frame.plan.partsMs, 0.0)
                                                      : std::numeric_limits<double>::infinity();
    frame.stats.predictedMs = static_cast<float>(admitFades(frame.fades, frame.predictedMs, usableMs));
    for (std::size_t i = 0; i < frame.lights.size(); ++i) {
        LightDecision& decision = *frame.lights[i].decision;
        if (decision.outgoing == UINT32_MAX || frame.fades[i].admitted) continue;
        frame.lights[i].memory->fade.skip();
        decision.outgoing = UINT32_MAX;
        decision.fade = 1.0f;
        decision.noFade = "both methods do not fit the budget";
    }
}

// --- the probe ---

/// Whether the probe of this light may go on in this frame.
bool canProbe(const Frame& frame, const ViewLight& light, const ChooseParts& parts)
{
    const LightDecision& decision = *light.decision;
    const std::uint32_t probed = parts.probe.method();
    const bool steady = !decision.switched && decision.outgoing == UINT32_MAX &&
                        !frame.views[light.viewIndex].view->camera.cut && decision.method < parts.methods.size() &&
                        decision.method != probed;
    if (!steady || !canShareLayer(decision, parts.methods, probed)) return false;
    const bool ran = frame.number > parts.probe.since(); // the newest frame was one with it
    if (ran && parts.budget.ms() > 0.0 && parts.history.totals.ms() > parts.budget.ms()) return false;
    const double usableMs = frame.plan.usableMs - frame.plan.partsMs;
    return double{frame.stats.predictedMs} + double{decision.candidates[probed].predictedMs} <= usableMs;
}

/// Goes on with the probe that runs, or begins the one that the plan step named. Fades go before.
void settleProbe(Frame& frame, const ChooseParts& parts)
{
    ProbeRun& probe = parts.probe;
    const plan::Probe& named = parts.plan.probe();
    if (!probe.runs() && named.light < frame.planned.size()) {
        const ViewLight& light = frame.lights[frame.planned[named.light]];
        probe.begin(frame.views[light.viewIndex].view->id, light.light->id, named.method, frame.number);
    }
    if (!probe.runs()) return;
    if (probe.isDone(frame.number)) return probe.end();
    const auto light = std::find_if(frame.lights.begin(), frame.lights.end(), [&](const ViewLight& each) {
        return probe.isOf(frame.views[each.viewIndex].view->id, each.light->id);
    });
    // The light may be gone, or what the probe stood on is.
    if (light == frame.lights.end() || !canProbe(frame, *light, parts)) return probe.end();
    light->decision->probed = light->memory->probed = probe.method();
    light->memory->probedSince = probe.since();
    frame.stats.predictedMs += light->decision->candidates[probe.method()].predictedMs;
}

// --- the plan ---

/// A light that no pixel shows: nothing runs for it. Its method waits for it, and is not faded to.
void passOver(const ViewLight& light, Frame& frame)
{
    light.memory->fade.lose();
    light.memory->lastFrame = frame.number;
    frame.fades.push_back({});
}

/// All lights of all views together: within the budget where there is one, then settled.
void planLights(Frame& frame, const ChooseParts& parts)
{
    const FrameHistory& history = parts.history;
    const rules::RuleBase* base = ruleBaseOf(parts.selector);
    frame.plan = parts.plan.decide(base, {.ms = parts.budget.planMs(),
                                          .perCheapest = parts.budget.perCheapest(),
                                          .sharedMs = history.shared.unaskedMs(),
                                          .parts = parts.history.shared.parts(parts.history.past.present().pixels),
                                          .measuredMs = history.totals.ms(),
                                          // The cheapest plan was to be measured, not to be kept.
                                          .cut = frame.cameraCut() || parts.budget.begins(),
                                          .probe = parts.ownReady && parts.probe.isDue(base, frame.number),
                                          .lastSecondMs = std::max(history.totals.ms(), 0.0) * history.intervals.rate(),
                                          .frame = frame.number});
    parts.budget.take(frame.plan);
    frame.stats.budgetMs = static_cast<float>(parts.budget.ms());
    for (const ViewLight& light : frame.lights) {
        if (light.decision->reason == GN_REASON_UNSEEN) {
            passOver(light, frame);
            continue;
        }
        frame.fades.push_back(nextFade(frame, light, parts));
        parts.selector.commit(*light.decision, *light.memory, frame.number);
        frame.stats.switches += light.decision->switched;
        frame.predictedMs += light.decision->predictedMs;
    }
    settleFades(frame);
    settleProbe(frame, parts);
}

/// Whether a light has just changed to a method whose time it does not know. What it had before is known, and waits for
/// the frames that are timed anyway.
bool isNewToALight(const Frame& frame, const ChooseParts& parts)
{
    return std::any_of(frame.lights.begin(), frame.lights.end(), [&](const ViewLight& light) {
        return light.memory->methodSince == frame.number && !parts.plan.isTimed(*light.memory, light.decision->method);
    });
}

/// What the frame's timings will be compared by when they come.
void notePlan(const Frame& frame, PastFrame& present)
{
    present.plannedMs = frame.plan.predictedMs;
    present.cheapestMs = frame.plan.cheapestMs;
    present.methods = kEmptyHash;
    for (const ViewLight& light : frame.lights) {
        const LightDecision& decision = *light.decision;
        for (const std::uint32_t part :
             {light.viewIndex, light.light->id, decision.method, decision.outgoing, decision.probed})
            present.methods = hashWith(present.methods, part);
        present.beside |= decision.outgoing != UINT32_MAX || decision.probed != UINT32_MAX;
    }
}

} // namespace

void choose(Frame& frame, const ChooseParts& parts)
{
    parts.plan.begin();
    askRules(frame, parts);
    planLights(frame, parts);
    notePlan(frame, parts.history.past.present());
    if (countsTime(ruleBaseOf(parts.selector)) && isNewToALight(frame, parts))
        parts.history.timed.noteChange(frame.number);
    for (const ViewFrame& viewFrame : frame.views)
        viewFrame.view->lastFrame = frame.number;
}

} // namespace gnomon
