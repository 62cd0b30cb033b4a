// Why, and why not. Text for decisions, made only when somebody asks.
#include "runtime/select/explain.hpp"

#include <algorithm>
#include <cmath>

#include "rules/engine/explain.hpp"
#include "runtime/base/number_text.hpp"
#include "runtime/plan/utility.hpp"

namespace gnomon {

namespace {

std::string percent(double share)
{
    return knownText(100.0 * share, 1) + " %";
}

double suitabilityOf(const Candidate& candidate)
{
    return std::max(candidate.quantised, 0) / double{rules::kSuitabilitySteps};
}

std::string because(const rules::Engine& engine, std::uint32_t rule)
{
    const rules::Rule* found = engine.rule(rule);
    return found && !found->because.empty() ? "    because " + found->because : std::string{};
}

/// Inference of a record's facts by its own rules, or nothing to say.
struct Rules {
    Rules(const DecisionRecord& record, const ExplainWords& words) : engine(words.engine)
    {
        if (!engine) return;
        inference = engine->makeInference();
        engine->evaluate(record.facts, inference);
    }
    const rules::Engine* engine;
    rules::Inference inference;
};

/// Some methods trace on the CPU where the device cannot, or may not ask the host.
std::string_view raysText(bool deviceRays, bool asksHost)
{
    return deviceRays && !asksHost ? " by rays on the device" : "";
}

std::string headline(const DecisionRecord& record, const ExplainWords& words)
{
    std::string text =
        "light '" + std::string(words.light) + "', frame " + std::to_string(record.frame - words.frameOrigin) + ": ";
    text += methodText(record.method, words.methods);
    text += mapSideText(record.mapSide);
    if (record.method < words.methods.size())
        text += raysText(words.methods[record.method].deviceRays, record.asksHost);
    text += ", ";
    text += reasonText(record.reason);
    if (record.reason == GN_REASON_FALLBACK && record.wanted != UINT32_MAX)
        text += " (" + std::string(methodText(record.wanted, words.methods)) + ")";
    if (record.switched) text += "; was " + std::string(methodText(record.incumbent, words.methods));
    return text;
}

/// The recorded rules, where the base itself is gone.
void addNumbers(const DecisionRecord& record, ExplanationLines& lines)
{
    if (record.ruleHash == 0) {
        lines.add("no rules are loaded: exact methods first, then the fallback");
        return;
    }
    std::string text = "the rule base of that frame is no longer loaded; its strongest rules by number:";
    for (const FiredRule& fired : record.fired)
        if (fired.rule != rules::kNoRule)
            text.append(" ")
                .append(std::to_string(fired.rule + 1))
                .append(" (strength ")
                .append(knownText(double{fired.strength}, 2) + ")");
    lines.add(std::move(text));
}

void addRulesBehind(const Rules& rules, std::uint32_t method, std::size_t most, ExplanationLines& lines)
{
    const std::vector<std::uint32_t> behind = rulesBehind(*rules.engine, rules.inference, method);
    if (behind.empty()) lines.add("no rule that fires speaks of it");
    for (const std::uint32_t rule : std::span(behind).first(std::min(behind.size(), most))) {
        lines.add("  " + explainRuleFor(*rules.engine, rules.inference, rule, method) + " -> strength " +
                  knownText(rules.inference.rules[rule].strength, 2) +
                  yieldText(*rules.engine, rules.inference, rule, method));
        lines.add(because(*rules.engine, rule));
    }
}

std::string factsLine(const DecisionRecord& record, const Rules& rules)
{
    std::string text = "facts: ";
    std::string_view separator;
    for (std::uint32_t i = 0; i < kFactCount; ++i) {
        std::string one = rules.engine ? explainFact(*rules.engine, rules.inference, i) : std::string{};
        if (one.empty()) {
            if (rules.engine) continue; // the base does not ask for it
            one = std::string(kFactNames[i].name) + " " + factText(static_cast<Fact>(i), record.facts[i]);
        }
        text.append(separator).append(one);
        separator = "; ";
    }
    if (record.distanceAge == UINT32_MAX)
        text += "; viewerDistance is a lower bound, not measured yet";
    else if (record.distanceAge > 0)
        text += "; viewerDistance measured " + std::to_string(record.distanceAge) + " frames before";
    return text;
}

std::string costLine(const DecisionRecord& record)
{
    if (record.method >= record.methods) return {};
    const Candidate& chosen = record.candidates[record.method];
    std::string text = "cost: predicted " + costText(chosen);
    if (record.measuredMs > 0.0f) {
        text += ", measured " + msText(double{record.measuredMs});
        if (chosen.predictedMs > 0.0f)
            text += " (" + knownText(std::log2(double{record.measuredMs} / double{chosen.predictedMs}), 2) +
                    " octaves off)";
    } else {
        text += ", this frame was not timed";
    }
    return text + "; quality " + knownText(double{chosen.quality}, 2);
}

/// Of a light whose maps are smaller than its pixels could show.
std::string sideLine(const DecisionRecord& record)
{
    if (record.mapSide >= record.wantedSide) return {};
    return "maps at " + std::to_string(record.mapSide) + ": its pixels could show " +
           std::to_string(record.wantedSide) + ", but the memory for maps, or another light's turn, goes before";
}

/// Of a map that is not drawn in every frame although something in it moves.
std::string cadenceLine(const DecisionRecord& record)
{
    if (record.redrawEvery < 2) return {};
    const char* const th = record.redrawEvery == 2 ? "nd" : "th";
    return "its map is drawn in every " + std::to_string(record.redrawEvery) + th +
           " frame: shadows move by a texel at most meanwhile; this one is " +
           (record.mapAge == 0 ? std::string("new") : std::to_string(record.mapAge) + " frames old");
}

/// Of a flat source where the method knows spheres only.
std::string sourceLine(const DecisionRecord& record, const ExplainWords& words)
{
    if (!record.flatSource || record.method >= record.methods || !words.methods[record.method].discs) return {};
    return std::string(words.methods[record.method].name) +
           " counts the light's flat source as a sphere that covers the same area, " +
           factText(Fact::lightRadius, record.facts[static_cast<std::size_t>(Fact::lightRadius)]) + " in radius";
}

std::string planLine(const DecisionRecord& record)
{
    std::string text = replanText(record.replan);
    if (!record.budgeted) return text;
    text = "plan of all lights: " + msText(double{record.planMs}) + " of " + msText(double{record.usableMs}) +
           " usable (budget " + msText(double{record.budgetMs}) + "): " + text;
    if (record.leastMs > 0.0f && record.replan != Replan::measuring)
        text += "; nothing fits: the least possible is " + msText(double{record.leastMs});
    if (record.floor)
        text += "; near floor holds, quality >= " + knownText(double{record.minimumQuality}, 2) +
                (record.floorUnmet ? ", but nothing reaches it" : "");
    return text;
}

/// Of a method that is held.
std::string gainText(const DecisionRecord& record, std::uint32_t method)
{
    const double own = utilityOf(record, record.candidates, record.method);
    const double gain = own > 0.0 ? utilityOf(record, record.candidates, method) / own - 1.0 : 0.0;
    return "it is worth " + percent(gain) + " more, a change needs more than " + percent(double{record.threshold});
}

std::string heldText(const DecisionRecord& record, std::uint32_t method)
{
    return std::string("held: ") + holdText(record.hold) + (record.budgeted ? "; " + gainText(record, method) : "");
}

/// What the plan put aside that the rules like better, and why.
std::string passedOverLine(const DecisionRecord& record, const ExplainWords& words)
{
    if (record.wanted >= record.methods || record.wanted == record.method) return {};
    const Candidate& wanted = record.candidates[record.wanted];
    const std::string name(methodText(record.wanted, words.methods));
    const bool served = record.method < record.methods; // else the plan's choice could not be made after all
    switch (served ? wanted.why : plan::Why::chosen) {
    case plan::Why::budget:
        return name + " suits better (" + knownText(suitabilityOf(wanted), 2) + "), but needs " +
               changeCostText(wanted);
    case plan::Why::hysteresis:
        return name + " would be better, but is " + heldText(record, record.wanted);
    case plan::Why::floor:
        return name + " suits better (" + knownText(suitabilityOf(wanted), 2) + "), but its quality " +
               knownText(double{wanted.quality}, 2) + " is below the near floor";
    case plan::Why::price:
        return name + " suits better (" + knownText(suitabilityOf(wanted), 2) + "), but " +
               priceText(record.candidates[record.method], wanted) + softwareText(record.method, words);
    case plan::Why::outscored:
        if (record.budgeted)
            return name + " suits better (" + knownText(suitabilityOf(wanted), 2) + "), but with its quality " +
                   knownText(double{wanted.quality}, 2) + " is worth " +
                   knownText(utilityOf(record, record.candidates, record.wanted), 3) + " against " +
                   knownText(utilityOf(record, record.candidates, record.method), 3);
        break;
    default:
        break;
    }
    if (wanted.exclusion != Exclusion::none)
        return name + " is wanted: " + exclusionText(wanted, words.methods[record.wanted].unavailable, words.engine);
    return {};
}

/// The method that the host pinned, where something else serves, and why.
std::string pinnedLine(const DecisionRecord& record, const ExplainWords& words)
{
    if (record.pinned >= record.methods || record.pinned == record.method) return {};
    if (record.candidates[record.pinned].exclusion == Exclusion::none) return {};
    return "the host pinned " + std::string(methodText(record.pinned, words.methods)) + ", which cannot serve: " +
           exclusionText(record.candidates[record.pinned], words.methods[record.pinned].unavailable, words.engine);
}

std::string runnerUpLine(const DecisionRecord& record, const ExplainWords& words, const Rules& rules)
{
    std::uint32_t best = UINT32_MAX;
    for (std::uint32_t m = 0; m < record.methods; ++m) {
        const Candidate& candidate = record.candidates[m];
        if (m == record.method || candidate.exclusion != Exclusion::none || candidate.quantised < 0) continue;
        if (best == UINT32_MAX || candidate.quantised > record.candidates[best].quantised) best = m;
    }
    if (best == UINT32_MAX || !rules.engine) return {};
    return "next: " + std::string(methodText(best, words.methods)) + ", suitability " +
           knownText(suitabilityOf(record.candidates[best]), 2) + "; " +
           reasonFor(*rules.engine, rules.inference, best);
}

std::string eliminatedLine(const DecisionRecord& record, const ExplainWords& words)
{
    std::string text;
    for (std::uint32_t m = 0; m < record.methods; ++m) {
        const Candidate& candidate = record.candidates[m];
        if (m == record.method || candidate.exclusion == Exclusion::none) continue;
        text += (text.empty() ? "out: " : "; ") + std::string(methodText(m, words.methods)) + " (" +
                exclusionText(candidate, words.methods[m].unavailable, words.engine) + ")";
    }
    return text;
}

} // namespace

std::string explainWhy(const DecisionRecord& record, const ExplainWords& words)
{
    const Rules rules(record, words);
    ExplanationLines lines;
    lines.add(headline(record, words));
    if (record.method < record.methods && record.candidates[record.method].quantised >= 0 && rules.engine)
        lines.add("suitability " + knownText(suitabilityOf(record.candidates[record.method]), 2) + " by:");
    if (!rules.engine)
        addNumbers(record, lines);
    else if (record.method < record.methods)
        addRulesBehind(rules, record.method, 2, lines);
    const std::string pinned = pinnedLine(record, words);
    lines.add(pinned.empty() ? passedOverLine(record, words) : pinned);
    lines.add(planLine(record));
    lines.add(costLine(record));
    lines.add(sideLine(record));
    lines.add(cadenceLine(record));
    lines.add(sourceLine(record, words));
    lines.add(factsLine(record, rules));
    lines.add(runnerUpLine(record, words, rules));
    if (record.reason != GN_REASON_UNSEEN) lines.add(eliminatedLine(record, words));
    return lines.take();
}

namespace {

void addFloor(const DecisionRecord& record, const Candidate& candidate, const ExplainWords& words,
              ExplanationLines& lines)
{
    const bool heldOn = record.floorTruth < record.floorStrength;
    const double ofAll = words.engine ? words.engine->base().policy.floor.minimumQuality : 0.0;
    const bool ofItsOwn = std::fabs(double{record.minimumQuality} - ofAll) > 0.005; // what two places show
    lines.add("near floor: its quality " + knownText(double{candidate.quality}, 2) + " is below " +
              knownText(double{record.minimumQuality}, 2) +
              (ofItsOwn ? " (" + knownText(ofAll, 2) + " for all near lights together)" : "") +
              "; the floor holds because its condition is " + knownText(double{record.floorTruth}, 2) + " true, and " +
              knownText(double{record.floorStrength}, 2) +
              (heldOn ? " is enough and was reached a moment ago" : " is enough"));
}

void addBudget(const DecisionRecord& record, const Candidate& candidate, ExplanationLines& lines)
{
    const Candidate* const own = record.method < record.methods ? &record.candidates[record.method] : nullptr;
    const double spent = own ? double{own->predictedMs} + double{own->sharedMs} : 0.0;
    const double room = double{record.usableMs} - double{record.planMs} + spent;
    lines.add("budget: it needs " + costText(candidate) + ", and the other lights leave " +
              msText(std::max(room, 0.0)) + " of " + msText(double{record.usableMs}) + " usable (budget " +
              msText(double{record.budgetMs}) + ")");
}

void addOutscored(const DecisionRecord& record, std::uint32_t method, ExplanationLines& lines)
{
    if (record.method >= record.methods) return;
    const Candidate &candidate = record.candidates[method], &chosen = record.candidates[record.method];
    std::string text = "outscored: suitability " + knownText(suitabilityOf(candidate), 2) + " against " +
                       knownText(suitabilityOf(chosen), 2);
    if (candidate.quantised < 0) text = "outscored: no rule has an opinion of any method";
    if (record.budgeted)
        text += "; worth (importance x suitability of what shows as much x quality) " +
                knownText(utilityOf(record, record.candidates, method), 3) + " against " +
                knownText(utilityOf(record, record.candidates, record.method), 3);
    if (record.budgeted || record.priced)
        text += "; takes " + changeCostText(candidate) + " against " + costText(chosen);
    lines.add(std::move(text));
}

/// The elimination itself.
void addElimination(const DecisionRecord& record, std::uint32_t method, const ExplainWords& words,
                    ExplanationLines& lines)
{
    const Candidate& candidate = record.candidates[method];
    if (candidate.exclusion != Exclusion::none)
        return lines.add(exclusionText(candidate, words.methods[method].unavailable, words.engine));
    if (record.reason == GN_REASON_PINNED)
        return lines.add("the host pinned " + std::string(methodText(record.method, words.methods)));
    switch (candidate.why) {
    case plan::Why::floor:
        return addFloor(record, candidate, words, lines);
    case plan::Why::budget:
        return addBudget(record, candidate, lines);
    case plan::Why::hysteresis:
        return lines.add(heldText(record, method));
    case plan::Why::price:
        if (record.method >= record.methods) return; // the plan's choice could not be made after all
        return lines.add("it suits better (" + knownText(suitabilityOf(candidate), 2) + "), but " +
                         priceText(record.candidates[record.method], candidate));
    case plan::Why::noOpinion:
        return lines.add("no rule that fires speaks of it, and rules speak of others");
    case plan::Why::trait:
        return lines.add("its predicted time is not a number");
    case plan::Why::chosen: // by the plan, but something else serves
    case plan::Why::pinned:
    case plan::Why::never:
    case plan::Why::outscored:
        break;
    }
    addOutscored(record, method, lines);
}

} // namespace

std::string explainWhyNot(const DecisionRecord& record, std::uint32_t method, const ExplainWords& words)
{
    const Rules rules(record, words);
    ExplanationLines lines;
    const std::string name(methodText(method, words.methods));
    lines.add(headline(record, words));
    if (method == record.method) {
        lines.add(name + " is what was chosen");
        return lines.take();
    }
    if (method >= record.methods) {
        lines.add(name + " was added later");
        return lines.take();
    }
    lines.add("not " + name + ":");
    addElimination(record, method, words, lines);
    const Candidate& candidate = record.candidates[method];
    if (!rules.engine) {
        addNumbers(record, lines);
        return lines.take();
    }
    if (candidate.exclusion == Exclusion::vetoed) {
        const auto veto = static_cast<std::uint32_t>(candidate.detail);
        lines.add("  " + explainRule(*rules.engine, rules.inference, veto));
        lines.add(because(*rules.engine, veto));
    }
    lines.add("rules about it:");
    addRulesBehind(rules, method, 2, lines);
    if (const std::uint32_t silent = silentRuleFor(*rules.engine, rules.inference, method); silent != rules::kNoRule)
        lines.add("  silent: " + explainRuleFor(*rules.engine, rules.inference, silent, method));
    const bool able = candidate.exclusion == Exclusion::none || candidate.exclusion == Exclusion::vetoed;
    if (!able || record.reason == GN_REASON_PINNED) return lines.take();
    const std::vector<NearMiss> misses = nearMisses(record, *rules.engine, method);
    if (misses.empty()) {
        lines.add("no change of a single fact would choose it");
    } else {
        const auto fact = static_cast<Fact>(misses.front().fact);
        lines.add(std::string("it would be chosen with ") + kFactNames[misses.front().fact].name + " " +
                  factText(fact, misses.front().to) + " instead of " + factText(fact, misses.front().from));
    }
    return lines.take();
}

// --- the long form of the newest frame ---

std::string passedOverText(const LightDecision& decision, const Candidate& candidate)
{
    switch (decision.reason == GN_REASON_PINNED ? plan::Why::pinned : candidate.why) {
    case plan::Why::pinned:
        return "the host pinned another one";
    case plan::Why::floor:
        return "its quality " + knownText(double{candidate.quality}, 2) + " is below the near floor";
    case plan::Why::budget:
        return "does not fit the budget: needs " + changeCostText(candidate);
    case plan::Why::hysteresis:
        return std::string("held: ") + holdText(decision.hold);
    case plan::Why::price:
        if (decision.method == UINT32_MAX) break; // the plan's choice could not be made after all
        return priceText(decision.candidates[decision.method], candidate);
    case plan::Why::trait:
        return "its predicted time is not a number";
    case plan::Why::chosen: // by the plan, but something else serves
    case plan::Why::never:
    case plan::Why::noOpinion:
    case plan::Why::outscored:
        break;
    }
    return candidate.quantised < 0 ? "no opinion" : "outscored";
}

std::string Selector::explain(const LightDecision& decision, const rules::Engine* engine) const
{
    std::string text = "method: ";
    text += decision.method == UINT32_MAX ? "none" : methods_[decision.method].name;
    text += mapSideText(static_cast<std::uint32_t>(decision.mapSide));
    if (decision.method != UINT32_MAX)
        text += raysText(methods_[decision.method].has(GN_TRAIT_DEVICE_RAYS_BIT), decision.asksHost);
    text += " (";
    text += reasonText(decision.reason);
    if (decision.reason == GN_REASON_FALLBACK) text += ": " + methods_[decision.wanted].name;
    text += ")\n";
    if (decision.switched && decision.incumbent != UINT32_MAX)
        text += "before: " + methods_[decision.incumbent].name + "\n";
    if (decision.outgoing != UINT32_MAX)
        text += "fade: " + knownText(double{decision.fade}, 2) + ", the rest is " + methods_[decision.outgoing].name +
                "'s\n";
    if (decision.probed != UINT32_MAX) text += "probe: " + methods_[decision.probed].name + " is measured, not shown\n";
    if (decision.noFade) text += "no fade: " + std::string(decision.noFade) + "\n";
    text += "facts:";
    for (std::size_t i = 0; i < kFactCount; ++i)
        text += (i ? ", " : " ") + std::string(kFactNames[i].name) + " " + knownText(decision.facts[i], 2);
    text += decision.distanceMeasured ? "\n" : " (viewerDistance: lower bound)\n";
    if (engine) {
        rules::Inference inference = engine->makeInference();
        engine->evaluate(decision.facts, inference);
        text += "rules:\n" + rules::explain(*engine, inference, {.rulesPerOutput = 2, .because = false});
        if (!text.empty() && text.back() != '\n') text += '\n';
    }
    text += "candidates:\n";
    for (std::uint32_t i = 0; i < methods_.size(); ++i) {
        text += "  " + methods_[i].name + ": ";
        if (i >= decision.candidates.size()) {
            text += "was added later\n";
            continue;
        }
        const Candidate& candidate = decision.candidates[i];
        const char* unavailable = methods_[i].unavailable;
        if (i == decision.method)
            text += "chosen, " + knownText(decision.predictedMs, 2) + " ms";
        else if (candidate.exclusion != Exclusion::none)
            text += "out, " + exclusionText(candidate, unavailable ? unavailable : "", engine);
        else
            text += passedOverText(decision, candidate);
        text += '\n';
    }
    return text;
}

} // namespace gnomon
