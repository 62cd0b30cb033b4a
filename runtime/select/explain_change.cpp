// What would change a decision, and what did.
#include <algorithm>
#include <cmath>

#include "rules/engine/explain.hpp"
#include "runtime/base/number_text.hpp"
#include "runtime/select/explain.hpp"

namespace gnomon {

namespace {

std::string frameText(const DecisionRecord& record, const ExplainWords& words)
{
    return "frame " + std::to_string(record.frame - words.frameOrigin);
}

std::string signedText(double change, int digits)
{
    return std::string(change < 0.0 ? "" : "+").append(fixedText(change, digits));
}

std::string missText(const NearMiss& miss, const ExplainWords& words)
{
    const auto fact = static_cast<Fact>(miss.fact);
    std::string text = "  " + std::string(kFactNames[miss.fact].name) + " " + factText(fact, miss.from) + " -> " +
                       factText(fact, miss.to);
    if (!std::isnan(miss.from))
        text += " (" +
                signedText(miss.to - miss.from, kFactNames[miss.fact].unit == std::string_view("count") ? 0 : 2) + ")";
    return text + ": " + std::string(methodText(miss.method, words.methods)) + " instead";
}

} // namespace

std::string explainWhatIf(const DecisionRecord& record, const ExplainWords& words)
{
    ExplanationLines lines;
    const std::string method(methodText(record.method, words.methods));
    lines.add("light '" + std::string(words.light) + "', " + frameText(record, words) + ": " + method +
              "; what would change it, one fact at a time:");
    if (!words.engine) {
        lines.add(record.ruleHash == 0 ? "  no rules are loaded, so no fact has a say"
                                       : "  the rule base of that frame is no longer loaded");
        return lines.take();
    }
    if (record.reason == GN_REASON_PINNED) {
        lines.add("  nothing: the host pinned it; unpinned, the facts of that frame would choose " + [&] {
            DecisionRecord free = record;
            free.pinned = UINT32_MAX;
            free.reason = GN_REASON_RULES;
            free.budgeted = false;
            const ChoiceInput input{.incumbent = record.incumbent, .fallbacks = record.fallbacks};
            return std::string(methodText(chooseBySuitability(free.all(), input).method, words.methods));
        }() + " by suitability");
        return lines.take();
    }
    std::vector<NearMiss> misses = nearMisses(record, *words.engine);
    if (misses.empty()) lines.add("  nothing: no change of a single fact within its universe flips the choice");
    const std::size_t shown = std::min(misses.size(), lines.left() - 2);
    for (std::size_t i = 0; i < shown; ++i)
        lines.add(missText(misses[i], words));
    std::string still;
    for (const rules::CompiledVariable& variable : words.engine->compiled().variables) {
        const bool flips =
            std::any_of(misses.begin(), misses.end(), [&](const NearMiss& miss) { return miss.fact == variable.fact; });
        if (!flips && variable.fact < kFactCount)
            still += (still.empty() ? "" : ", ") + std::string(kFactNames[variable.fact].name);
    }
    if (!still.empty() && !misses.empty()) lines.add("  no value of these alone: " + still);
    if (record.budgeted) lines.add("  (the other lights' methods and all predicted times unchanged)");
    return lines.take();
}

namespace {

/// Facts that moved, the largest share of what the rules tell apart first.
void addFacts(const DecisionRecord& now, const DecisionRecord& before, const ExplainWords& words,
              ExplanationLines& lines)
{
    std::vector<std::pair<double, std::uint32_t>> moved;
    for (std::uint32_t i = 0; i < kFactCount; ++i) {
        const double a = before.facts[i], b = now.facts[i];
        if (a == b || (std::isnan(a) && std::isnan(b))) continue;
        double width = std::max(std::abs(a), std::abs(b));
        if (words.engine)
            for (const rules::CompiledVariable& variable : words.engine->compiled().variables)
                if (variable.fact == i) width = variable.high - variable.low;
        const double share = std::abs(b - a) / width;
        moved.emplace_back(std::isfinite(share) ? -share : -1.0, i);
    }
    std::sort(moved.begin(), moved.end());
    std::string text;
    for (const auto& [share, i] : moved)
        text += (text.empty() ? "facts: " : "; ") + std::string(kFactNames[i].name) + " " +
                factText(static_cast<Fact>(i), before.facts[i]) + " -> " + factText(static_cast<Fact>(i), now.facts[i]);
    lines.add(text.empty() ? "facts: all the same" : text);
}

/// Rules whose strength changed most, with what they rest on now.
void addRules(const DecisionRecord& now, const DecisionRecord& before, const rules::Engine& engine,
              ExplanationLines& lines)
{
    rules::Inference was = engine.makeInference(), is = engine.makeInference();
    engine.evaluate(before.facts, was);
    engine.evaluate(now.facts, is);
    std::vector<std::pair<double, std::uint32_t>> changed;
    for (std::uint32_t i = 0; i < is.rules.size(); ++i)
        if (is.rules[i].strength != was.rules[i].strength)
            changed.emplace_back(-std::abs(is.rules[i].strength - was.rules[i].strength), i);
    std::sort(changed.begin(), changed.end());
    constexpr std::size_t kMostRules = 3;
    changed.resize(std::min(changed.size(), kMostRules));
    for (const auto& [change, rule] : changed)
        lines.add("  strength " + fixedText(was.rules[rule].strength, 2) + " -> " +
                  fixedText(is.rules[rule].strength, 2) + ": " + explainRule(engine, is, rule));
}

std::string suitabilityText(const Candidate& candidate)
{
    if (candidate.exclusion == Exclusion::vetoed) return "vetoed";
    if (candidate.quantised < 0) return "no opinion";
    return fixedText(candidate.quantised / double{rules::kSuitabilitySteps}, 2);
}

/// Methods whose case changed: the old and the new choice first.
void addCandidates(const DecisionRecord& now, const DecisionRecord& before, const ExplainWords& words,
                   ExplanationLines& lines)
{
    std::string text, out;
    const rules::Engine* const then = now.ruleHash == before.ruleHash ? words.engine : nullptr;
    const auto compare = [&](std::uint32_t m) {
        if (m >= now.methods || m >= before.methods) return;
        const Candidate& a = before.candidates[m];
        const Candidate& b = now.candidates[m];
        const std::string name(methodText(m, words.methods));
        if (suitabilityText(a) != suitabilityText(b))
            text +=
                (text.empty() ? "suitability: " : "; ") + name + " " + suitabilityText(a) + " -> " + suitabilityText(b);
        if ((a.exclusion == Exclusion::none) == (b.exclusion == Exclusion::none)) return;
        const std::string_view unavailable = words.methods[m].unavailable;
        out += (out.empty() ? "" : "; ") + name +
               (b.exclusion == Exclusion::none ? " can serve again (was out: " + exclusionText(a, unavailable, then)
                                               : " is out (" + exclusionText(b, unavailable, words.engine)) +
               ")";
    };
    compare(before.method);
    if (now.method != before.method) compare(now.method);
    for (std::uint32_t m = 0; m < now.methods; ++m)
        if (m != before.method && m != now.method) compare(m);
    lines.add(text);
    lines.add(out);
}

void addPlan(const DecisionRecord& now, const DecisionRecord& before, ExplanationLines& lines)
{
    const auto two = [](float a, float b) {
        return fixedText(double{a}, 2) + " -> " + fixedText(double{b}, 2) + " ms";
    };
    if (now.budgeted || before.budgeted)
        lines.add("plan of all lights " + two(before.planMs, now.planMs) + ", budget " +
                  two(before.budgetMs, now.budgetMs) + ": " + replanText(now.replan) +
                  (now.hold == plan::Hold::none ? "" : std::string("; held: ") + holdText(now.hold)));
    if (now.method < now.methods && before.method < before.methods)
        lines.add("predicted " +
                  two(before.candidates[before.method].predictedMs, now.candidates[now.method].predictedMs));
    if (now.knowledge > before.knowledge)
        lines.add("the cost model learned from " + std::to_string(now.knowledge - before.knowledge) + " timings");
    else if (now.knowledge < before.knowledge)
        lines.add("a knowledge base was loaded in between");
}

} // namespace

std::optional<DecisionRecord> earlierRecord(const DecisionRecord& record, std::uint64_t oldest, bool otherMethod,
                                            const std::function<bool(std::uint64_t, DecisionRecord&)>& find)
{
    DecisionRecord earlier;
    for (std::uint64_t frame = record.frame; frame-- > oldest;)
        if (find(frame, earlier) && (!otherMethod || earlier.method != record.method)) return earlier;
    return std::nullopt;
}

std::string explainWhatChanged(const DecisionRecord& record, const DecisionRecord* before, const ExplainWords& words)
{
    ExplanationLines lines;
    const std::string method = std::string(methodText(record.method, words.methods)) + mapSideText(record.mapSide);
    std::string head = "light '" + std::string(words.light) + "', " + frameText(record, words);
    if (!before) {
        lines.add(head + ": " + method + "; no earlier frame with this light is on record");
        return lines.take();
    }
    head += " against " + frameText(*before, words) + ": ";
    const std::string was = std::string(methodText(before->method, words.methods)) + mapSideText(before->mapSide);
    head += method == was ? "still " + method : was + " -> " + method;
    lines.add(head + " (" + reasonText(record.reason) +
              (record.reason == before->reason ? ")" : std::string(", before: ") + reasonText(before->reason) + ")"));
    if (record.pinned != before->pinned)
        lines.add(record.pinned == UINT32_MAX
                      ? "the host handed the light back to the rules"
                      : "the host pinned " + std::string(methodText(record.pinned, words.methods)));
    if (record.ruleHash != before->ruleHash) lines.add("rules were loaded in between");
    addFacts(record, *before, words, lines);
    if (words.engine && record.ruleHash == before->ruleHash) addRules(record, *before, *words.engine, lines);
    addCandidates(record, *before, words, lines);
    addPlan(record, *before, lines);
    return lines.take();
}

} // namespace gnomon
