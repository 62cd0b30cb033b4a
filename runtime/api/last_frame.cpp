// What hosts ask of the last frame: its decisions and passes, in numbers; words about any frame on record are
// explain.cpp's.
#include <algorithm>

#include "runtime/api/context.hpp"

namespace gnomon {

namespace {

GnElimination eliminationOf(const Candidate& candidate, bool chosen)
{
    if (chosen) return GN_ELIMINATION_NONE;
    if (candidate.exclusion == Exclusion::notReady) return GN_ELIMINATION_NOT_READY;
    if (candidate.exclusion == Exclusion::vetoed) return GN_ELIMINATION_NEVER;
    if (candidate.exclusion != Exclusion::none) return GN_ELIMINATION_UNABLE;
    switch (candidate.why) {
    case plan::Why::trait:
        return GN_ELIMINATION_UNABLE;
    case plan::Why::pinned:
        return GN_ELIMINATION_PINNED;
    case plan::Why::never:
        return GN_ELIMINATION_NEVER;
    case plan::Why::noOpinion:
        return GN_ELIMINATION_NO_OPINION;
    case plan::Why::floor:
        return GN_ELIMINATION_FLOOR;
    case plan::Why::budget:
        return GN_ELIMINATION_BUDGET;
    case plan::Why::hysteresis:
        return GN_ELIMINATION_HYSTERESIS;
    case plan::Why::price:
        return GN_ELIMINATION_PRICE;
    case plan::Why::chosen: // by the plan, but the fallback had to serve
    case plan::Why::outscored:
        break;
    }
    return GN_ELIMINATION_OUTSCORED;
}

GnCandidate publicCandidate(const char* name, const Candidate& candidate, bool chosen, bool hasRules)
{
    const bool able = candidate.exclusion == Exclusion::none || candidate.exclusion == Exclusion::vetoed;
    return {.pMethod = name,
            .suitability = !able                                      ? GN_SUITABILITY_UNABLE
                           : candidate.exclusion == Exclusion::vetoed ? GN_SUITABILITY_NEVER
                           : hasRules                                 ? candidate.quantised
                                                                      : GN_SUITABILITY_NO_OPINION,
            .elimination = eliminationOf(candidate, chosen),
            .quality = candidate.quality,
            .predictedMs = candidate.predictedMs,
            .sureMs = candidate.sureMs,
            .sharedMs = candidate.sharedMs};
}

} // namespace

Result<const LightDecision*> Context::findDecision(GnView viewHandle, GnLight light)
{
    const View* view = views_.find(viewHandle);
    if (!view) return invalidHandle("view");
    for (const LightDecision& d : view->decisions)
        if (d.light == light) return &d;
    return Error{GN_ERROR_INVALID_HANDLE, "LightNotInFrame",
                 "the light was not in the last frame of view '" + view->name + "'"};
}

Result<GnDecision> Context::decision(GnView view, GnLight light)
{
    const Result<const LightDecision*> found = findDecision(view, light);
    if (!found) return found.error();
    const LightDecision& d = **found;
    return GnDecision{.pMethod = d.method == UINT32_MAX ? nullptr : (*methods_)[d.method].name.c_str(),
                      .reason = d.reason,
                      .suitability = d.suitability,
                      .predictedMs = d.predictedMs,
                      .measuredMs = d.measuredMs,
                      .viewerDistance = d.viewerDistance,
                      .viewerDistanceMeasured = d.distanceMeasured ? VK_TRUE : VK_FALSE,
                      .switched = d.switched ? VK_TRUE : VK_FALSE,
                      .pRule = ruleBehind(*views_.find(view), d),
                      .pOutgoing = d.outgoing == UINT32_MAX ? nullptr : (*methods_)[d.outgoing].name.c_str(),
                      .fade = d.fade,
                      .pProbed = d.probed == UINT32_MAX ? nullptr : (*methods_)[d.probed].name.c_str(),
                      .mapSide = static_cast<std::uint32_t>(d.mapSide),
                      .wantedMapSide = static_cast<std::uint32_t>(d.wantedSide),
                      .redrawEvery = d.redrawEvery,
                      .mapAge = d.mapAge};
}

/// @param frame the newest, which 0 means
Result<std::string> Context::explanation(GnView viewHandle, GnLight light, std::uint64_t frame)
{
    const Result<const LightDecision*> found = findDecision(viewHandle, light);
    if (!found) return found.error();
    const View& view = *views_.find(viewHandle);
    const std::uint64_t newest = view.records.newest();
    if (frame != 0 && frame != newest)
        return Error{GN_ERROR_OUT_OF_RANGE, "FrameNotOnRecord",
                     "frame " + std::to_string(frame) + ": the whole decision is known of the newest frame of view '" +
                         view.name + "' alone, " + std::to_string(newest)};
    return selector_->explain(**found, view.records.rules(newest).get());
}

Result<std::uint32_t> Context::facts(GnView view, GnLight light, const StructArray<GnFact>& out)
{
    const Result<const LightDecision*> found = findDecision(view, light);
    if (!found) return found.error();
    for (std::size_t i = 0; i < std::min<std::size_t>(out.size(), kFactCount); ++i)
        out.put(i, {.pName = kFactNames[i].name, .pUnit = kFactNames[i].unit, .value = (*found)->facts[i]});
    return static_cast<std::uint32_t>(kFactCount);
}

Result<std::uint32_t> Context::candidates(GnView view, GnLight light, const StructArray<GnCandidate>& out)
{
    const Result<const LightDecision*> found = findDecision(view, light);
    if (!found) return found.error();
    const RecordRing& records = views_.find(view)->records;
    const bool ruled = records.rules(records.newest()) != nullptr; // by those in force when it was decided
    const Candidate later{.exclusion = Exclusion::notReady};       // it was no candidate then
    for (std::uint32_t i = 0; i < std::min(out.size(), methods_->size()); ++i) {
        const Candidate& candidate = i < (*found)->candidates.size() ? (*found)->candidates[i] : later;
        out.put(i, publicCandidate((*methods_)[i].name.c_str(), candidate, i == (*found)->method, ruled));
    }
    return methods_->size();
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
    for (const ViewFrame& viewFrame : frame_.views)
        if (viewFrame.view->id == timing.owner.view) out.view = viewFrame.view->handle;
    for (const LightFrame& light : frame_.casters)
        if (light.id == timing.owner.light) out.light = light.handle;
    return out;
}

std::uint32_t Context::passTimings(std::uint64_t& frame, const StructArray<GnPassTiming>& out)
{
    const FrameTimings* timings = executor_->newestTimed();
    frame = timings ? timings->frame : 0;
    if (!timings) return 0;
    for (std::size_t i = 0; i < std::min<std::size_t>(timings->passes.size(), out.size()); ++i)
        out.put(i, publicTiming(timings->passes[i]));
    return static_cast<std::uint32_t>(timings->passes.size());
}

Result<std::uint32_t> Context::framePasses(const StructArray<GnPassTiming>& out)
{
    // A worker runs the host passes in this order, and they may declare others.
    if (executor_->underway())
        return Error{GN_ERROR_FRAME_ORDER, "FrameUnderway", "gnGetFramePasses before gnFinishShadows"};
    std::uint32_t count = 0;
    for (const std::uint32_t index : graph_->order()) {
        const Pass& pass = graph_->passes()[index];
        if (!pass.fn) continue;
        if (count < out.size())
            out.put(count, publicTiming({.name = pass.name, .owner = pass.owner, .round = pass.round}));
        ++count;
    }
    return count;
}

} // namespace gnomon
