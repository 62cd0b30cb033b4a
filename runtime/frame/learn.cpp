#include "runtime/frame/learn.hpp"

#include <array>
#include <utility>

namespace gnomon {

namespace {

/// What one method's passes for a light took.
LightTiming timingOf(const FrameTimings& timings, std::uint32_t view, std::uint32_t light, std::uint32_t method,
                     float scale)
{
    LightTiming out{.frame = timings.frame};
    for (const PassTiming& pass : timings.passes) {
        if (pass.owner.light != light || pass.owner.declarer != method) continue;
        if (pass.owner.view != UINT32_MAX && pass.owner.view != view) continue;
        const bool update = pass.owner.isUpdate();
        out.updated |= update;
        (update ? out.updateGpuMs : out.resolveGpuMs) += pass.gpuMs * scale;
        (update ? out.updateCpuMs : out.resolveCpuMs) += pass.cpuMs;
    }
    return out;
}

/// Of a light that faded in that frame there are two methods: each is charged with the passes it declared.
void chargeLight(const FrameTimings& timings, std::uint32_t view, std::uint32_t id, LightMemory& memory,
                 const LearnParts& parts)
{
    std::array<std::uint32_t, 2> methods{UINT32_MAX, UINT32_MAX};
    for (const PassTiming& pass : timings.passes) {
        const std::uint32_t method = pass.owner.method;
        if (pass.owner.light != id || pass.owner.view != view || method >= parts.methods) continue;
        if (methods[0] == UINT32_MAX) methods[0] = method;
        if (method != methods[0]) methods[1] = method;
    }
    if (methods[0] == memory.incumbent) std::swap(methods[0], methods[1]); // who serves has the last word
    const bool disturbed = parts.history.past.at(timings.frame).disturbed || !parts.hasClock;
    for (const std::uint32_t method : methods) {
        if (method == UINT32_MAX) continue;
        const LightTiming light = timingOf(timings, view, id, method, parts.history.totals.scale());
        memory.measuredMs[method] = light.updateGpuMs + light.updateCpuMs + light.resolveGpuMs + light.resolveCpuMs;
        parts.plan.observe(memory, method, light, disturbed);
    }
}

/// What each light's own passes cost, scaled from the timed frame to the untimed total.
void chargeLights(const FrameTimings& timings, const Frame& frame, const LearnParts& parts)
{
    for (const ViewFrame& viewFrame : frame.views)
        for (auto& [id, memory] : viewFrame.view->lights)
            chargeLight(timings, viewFrame.view->id, id, memory, parts);
    parts.plan.endFrame();
}

/// What a timed frame's lights were charged with finds its way into their records.
void noteMeasured(const FrameTimings& timings, const Frame& frame, std::uint32_t methods)
{
    for (const ViewFrame& viewFrame : frame.views)
        for (const PassTiming& pass : timings.passes) {
            const std::uint32_t method = pass.owner.method;
            if (pass.owner.view != viewFrame.view->id || method >= methods) continue;
            const auto memory = viewFrame.view->lights.find(pass.owner.light);
            if (memory == viewFrame.view->lights.end()) continue;
            viewFrame.view->records.noteMeasured(timings.frame, pass.owner.light, method,
                                                 memory->second.measuredMs[method]);
        }
}

/// The newest frame that is known whole, for the host.
void publish(GnFrameStats& stats, const FrameHistory& history, const FrameTimings* timed)
{
    if (history.totals.known()) {
        stats.gpuMs = history.totals.gpuMs();
        stats.gpuFrame = history.totals.frame();
        stats.gpuFrameCpuMs = history.totals.cpuMs();
    } else if (timed) {
        stats.gpuMs = timed->totalGpuMs;
        stats.gpuFrame = timed->frame;
        stats.gpuFrameCpuMs = history.past.at(timed->frame).cpuMs;
    }
}

} // namespace

void learn(Frame& frame, const LearnParts& parts)
{
    FrameHistory& history = parts.history;
    const FrameTimings* const timed = parts.newestTimed;
    history.totals.note(parts.newest, timed, history.past);
    publish(frame.stats, history, timed);
    if (!timed || timed->frame <= history.learnedFrom) return;
    history.learnedFrom = timed->frame;
    history.totals.noteScale(*timed, history.past);
    chargeLights(*timed, frame, parts);
    if (parts.hasClock) {
        history.shared.noteMixes(*timed, history.totals.scale());
        history.shared.note(*timed, history.past.at(timed->frame), history.totals.scale());
    }
    noteMeasured(*timed, frame, parts.methods);
}

void recordDecisions(const Frame& frame, const ChooseParts& parts)
{
    const rules::RuleBase* base = ruleBaseOf(parts.selector);
    const FrameBudget& budget = parts.budget;
    const bool hasBudget = budget.measuring() || budget.ms() > 0.0;
    FrameRecord record{.frame = frame.number,
                       .knowledge = parts.plan.knowledgeRevision(),
                       .methods = parts.methods.size(),
                       .fallbacks = parts.methods.fallbacks(),
                       .base = base,
                       .budgeted = countsTime(base) && hasBudget,
                       .priced = countsTime(base) && !hasBudget,
                       .cut = frame.cameraCut(),
                       .measuring = budget.measuring(),
                       .budgetMs = budget.ms(),
                       .report = frame.plan};
    for (const ViewFrame& viewFrame : frame.views) {
        const auto lights = static_cast<std::uint32_t>(viewFrame.view->decisions.size());
        viewFrame.view->records.begin(frame.number, lights, parts.methods.size(), parts.selector.sharedEngine());
    }
    for (const ViewLight& light : frame.lights)
        frame.views[light.viewIndex].view->records.add(makeRecord(*light.decision, record, light.memory->measuredAt),
                                                       light.decision->candidates);
}

} // namespace gnomon
