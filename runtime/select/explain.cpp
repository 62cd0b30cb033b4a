// Text for decisions, made only when somebody asks.
#include <cmath>

#include "rules/engine/explain.hpp"
#include "rules/engine/number_text.hpp"
#include "runtime/select/selector.hpp"

namespace gnomon {

namespace {

std::string fixed(double value, int digits)
{
    return std::isnan(value) ? "unknown" : rules::fixedText(value, digits);
}

const char* reasonText(GnReason reason)
{
    switch (reason) {
    case GN_REASON_RULES:
        return "highest suitability";
    case GN_REASON_PINNED:
        return "pinned by the host";
    case GN_REASON_INCUMBENT:
        return "a tie, the method already running stays";
    case GN_REASON_FALLBACK:
        return "fallback while the wanted method is not ready";
    case GN_REASON_NOTHING_READY:
        return "nothing can serve, visibility is 1";
    case GN_REASON_NO_OPINION:
        return "no rule has an opinion, fallback";
    case GN_REASON_BUDGET:
        return "the plan: better ones do not fit the budget";
    case GN_REASON_HELD:
        return "held by the plan's hysteresis";
    case GN_REASON_MAX_ENUM:
        break;
    }
    return "unknown";
}

} // namespace

std::string Selector::exclusionText(const Method& method, const Candidate& candidate) const
{
    const std::string detail = std::to_string(candidate.detail);
    switch (candidate.exclusion) {
    case Exclusion::none:
        return {};
    case Exclusion::device:
        return method.unavailable;
    case Exclusion::lightKind:
        return "does not serve this kind of light";
    case Exclusion::notReady:
        return "not ready: its pipelines have not run yet";
    case Exclusion::roundTrips:
        return "needs the CPU between passes (" + detail + " round trips), but the frame is recorded";
    case Exclusion::hostDrawn:
        return detail + " host-drawn casters in range";
    case Exclusion::topology:
        return detail + " casters without topology yet";
    case Exclusion::trees:
        return detail + " casters without a ray-tracing tree yet";
    case Exclusion::memory:
        return "memory: needs " + fixed(static_cast<double>(candidate.detail) / (1 << 20), 1) +
               " MiB, more than is left";
    case Exclusion::refused:
        return candidate.refusal;
    case Exclusion::vetoed:
        return "never, says rule " +
               std::string(engine_ ? engine_->ruleId(static_cast<std::uint32_t>(candidate.detail)) : "");
    }
    return {};
}

std::string Selector::explain(const LightDecision& decision) const
{
    std::string text = "method: ";
    text += decision.method == UINT32_MAX ? "none" : methods_[decision.method].name;
    text += " (";
    text += reasonText(decision.reason);
    if (decision.reason == GN_REASON_FALLBACK) text += ": " + methods_[decision.wanted].name;
    text += ")\n";
    if (decision.switched && decision.incumbent != UINT32_MAX)
        text += "before: " + methods_[decision.incumbent].name + "\n";
    if (decision.outgoing != UINT32_MAX)
        text += "fade: " + fixed(double{decision.fade}, 2) + ", the rest is " + methods_[decision.outgoing].name + "'s\n";
    if (decision.noFade) text += "no fade: " + std::string(decision.noFade) + "\n";
    text += "facts:";
    for (std::size_t i = 0; i < kFactCount; ++i)
        text += (i ? ", " : " ") + std::string(kFactNames[i].name) + " " + fixed(decision.facts[i], 2);
    text += decision.distanceMeasured ? "\n" : " (viewerDistance: lower bound)\n";
    if (engine_) {
        rules::Inference inference = engine_->makeInference();
        engine_->evaluate(decision.facts, inference);
        text += "rules:\n" + rules::explain(*engine_, inference, {.rulesPerOutput = 2, .because = false});
        if (!text.empty() && text.back() != '\n') text += '\n';
    }
    text += "candidates:\n";
    for (std::uint32_t i = 0; i < methods_.size(); ++i) {
        const Candidate& candidate = decision.candidates[i];
        text += "  " + methods_[i].name + ": ";
        if (i == decision.method)
            text += "chosen, " + fixed(decision.predictedMs, 2) + " ms";
        else if (candidate.exclusion != Exclusion::none)
            text += "out, " + exclusionText(methods_[i], candidate);
        else if (candidate.quantised < 0)
            text += "no opinion";
        else
            text += "outscored";
        text += '\n';
    }
    return text;
}

} // namespace gnomon
