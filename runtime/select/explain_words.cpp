// Words for the parts of a decision.
#include <array>
#include <cmath>

#include "runtime/base/number_text.hpp"
#include "runtime/select/explain.hpp"

namespace gnomon {

namespace {

/// By the numbers of an enumeration.
template <std::size_t Count>
const char* wordOf(const std::array<const char*, Count>& texts, std::size_t number)
{
    return number < Count ? texts[number] : "unknown";
}

} // namespace

const char* reasonText(GnReason reason)
{
    constexpr std::array kTexts = {
        "highest suitability",
        "pinned by the host",
        "a tie, the method already running stays",
        "fallback while the wanted method is not ready",
        "nothing can serve, visibility is 1",
        "no rule has an opinion, fallback",
        "the plan: better ones do not fit the budget",
        "held by the plan's hysteresis",
        "shows as much as the best suited for less, or more for about the same",
        "what suits better is below the near floor",
        "the plan: what suits better is worth no more with its quality",
        "the pinned method cannot be recorded, the rules chose another",
        "no pixel can be in its range: nothing runs, visibility is 1",
        "on trial for a few frames, so that its time is known: it may be cheaper",
    };
    static_assert(kTexts.size() == GN_REASON_TRIAL + 1);
    return wordOf(kTexts, static_cast<std::size_t>(reason));
}

std::string exclusionText(const Candidate& candidate, std::string_view unavailable, const rules::Engine* engine)
{
    const std::string detail = std::to_string(candidate.detail);
    switch (candidate.exclusion) {
    case Exclusion::none:
        return {};
    case Exclusion::device:
        return std::string(unavailable);
    case Exclusion::lightKind:
        return "does not serve this kind of light";
    case Exclusion::notReady:
        return candidate.detail ? "not ready: " + detail + " casters that the device has not built yet"
                                : "not ready: its pipelines have not run yet";
    case Exclusion::roundTrips:
        return "needs the CPU between passes (" + detail + " round trips), but the frame is recorded";
    case Exclusion::hostDrawn:
        return detail + " host-drawn casters in range";
    case Exclusion::topology:
        return detail + " casters without topology yet";
    case Exclusion::trees:
        return detail + " casters without a ray-tracing tree yet";
    case Exclusion::memory:
        return "memory: needs " + fixedText(static_cast<double>(candidate.detail) / (1 << 20), 1) +
               " MiB, more than is left";
    case Exclusion::refused:
        return candidate.refusal ? candidate.refusal : "refused by the method";
    case Exclusion::vetoed:
        return "never, says rule " + (engine ? std::string(engine->ruleId(static_cast<std::uint32_t>(candidate.detail)))
                                             : "number " + detail + " of a rule base no longer loaded");
    case Exclusion::unseen:
        return "no pixel can be in the light's range";
    case Exclusion::gpuOnly:
        return detail + " casters that only the GPU may read (GN_MESH_NO_CPU_COPY_BIT)";
    case Exclusion::copies:
        return detail + " casters without a copy for the CPU yet";
    case Exclusion::gpuPlaced:
        return detail + " casters whose transforms only the GPU reads (GnTransformBuffer)";
    }
    return {};
}

const char* holdText(plan::Hold hold)
{
    constexpr std::array kTexts = {
        "not held",
        "the change would not gain enough",
        "there is time for it, but not with its first frame and a margin",
        "other lights change in this frame",
        "the plan has not been within its budget for long enough",
        "the light has just left it",
        "its first frame costs more than the stay would gain",
        "no light was timed with it yet, and lights try such methods one at a time",
    };
    static_assert(kTexts.size() == static_cast<std::size_t>(plan::Hold::trial) + 1);
    return wordOf(kTexts, static_cast<std::size_t>(hold));
}

const char* replanText(Replan replan)
{
    constexpr std::array kTexts = {
        "decided again, as in every frame without a budget",
        "the plan was kept",
        "the host pinned the method",
        "planned again after a camera cut",
        "the first plan",
        "planned for lights that were new or had lost their method",
        "the plan was over its budget and repaired",
        "a better plan was worth the change",
        "the cheapest plan runs while the budget is measured",
    };
    static_assert(kTexts.size() == static_cast<std::size_t>(Replan::count));
    return wordOf(kTexts, static_cast<std::size_t>(replan));
}

std::string factText(Fact fact, double value)
{
    if (std::isnan(value)) return "unknown";
    if (std::isinf(value)) return value > 0.0 ? "infinite" : "-infinite";
    const std::string_view unit = kFactNames[static_cast<std::size_t>(fact)].unit;
    if (unit == "count") return shortestText(value);
    std::string text = fixedText(value, 2);
    // Near zero two decimals say nothing, and what flips a choice must be given in full.
    if (const std::string full = shortestText(value); full.size() <= 8) text = full;
    text.append(" ").append(unit);
    if (unit == "log10" && value < 9.0) text += " (" + fixedText(std::pow(10.0, value), 0) + " triangles)";
    return text;
}

std::string_view methodText(std::uint32_t method, std::span<const MethodWords> methods)
{
    return method < methods.size() ? methods[method].name : "none";
}

std::string mapSideText(std::uint32_t side)
{
    return side == 0 ? std::string() : " at " + std::to_string(side);
}

void ExplanationLines::add(std::string line)
{
    if (left() == 0 || line.empty()) return;
    for (char& c : line) // a `because` may hold anything
        if (static_cast<unsigned char>(c) < ' ') c = ' ';
    text_ += line + "\n";
    ++count_;
}

std::string knownText(double value, int digits)
{
    return std::isnan(value) ? "unknown" : fixedText(value, digits);
}

std::string msText(double value)
{
    return knownText(value, value < 0.1 ? 4 : 2) + " ms";
}

std::string costText(const Candidate& candidate)
{
    std::string text = msText(double{candidate.predictedMs});
    if (candidate.sureMs > candidate.predictedMs)
        text += " (not timed here: up to " + msText(double{candidate.sureMs}) + ")";
    if (candidate.sharedMs > 0.0f) text += " and " + msText(double{candidate.sharedMs}) + " for its view";
    return text;
}

std::string changeCostText(const Candidate& candidate)
{
    std::string text = costText(candidate);
    if (candidate.firstMs > candidate.predictedMs)
        text += " (the change " + msText(double{candidate.firstMs}) + " more)";
    return text;
}

std::string priceText(const Candidate& chosen, const Candidate& candidate)
{
    const bool showsLess = chosen.quality > candidate.quality + plan::kSameQuality;
    return showsLess ? "shows less (quality " + knownText(double{candidate.quality}, 2) + " against " +
                           knownText(double{chosen.quality}, 2) + ") and takes " + changeCostText(candidate)
                     : "shows no more and takes " + changeCostText(candidate);
}

/// Where the "GPU" is the CPU, filling pixels takes the time that rays take elsewhere.
std::string softwareText(std::uint32_t chosen, const ExplainWords& words)
{
    const bool rays = words.software && chosen < words.methods.size() && words.methods[chosen].rays;
    return rays ? "; on a software device rays are the cheapest right answer here" : "";
}

} // namespace gnomon
