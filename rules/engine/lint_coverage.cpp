#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "rules/engine/cells.hpp"
#include "rules/engine/concepts.hpp"
#include "rules/engine/lint_checks.hpp"
#include "runtime/base/number_text.hpp"

/// Which rules fire where, exactly. Whether a rule fires depends, for every term, only on whether its membership is 0,
/// 1 or between; with a `minimumStrength` also on whether it is above that, by the weights of the rules. So an axis
/// falls into few cells on which that does not change, and a region of facts is a box of cells. The search below
/// assigns one variable after the other and leaves the rest unknown; evaluating with bounds (Truth) then decides most
/// boxes long before all variables have a value.

namespace gnomon::rules {
namespace {

/// Cells first..last of one variable; the whole axis where `free`.
struct Range {
    bool free = true;
    std::size_t first = 0, last = 0;
    friend bool operator==(const Range&, const Range&) = default;
};
using Box = std::vector<Range>; ///< One per variable.

/// Per concept the variables it follows from, directly or through other concepts.
std::vector<std::vector<uint32_t>> variablesBehindConcepts(const CompiledRules& compiled)
{
    const std::size_t variables = compiled.variables.size();
    const auto rules = static_cast<uint32_t>(compiled.rules.size());
    std::vector<std::vector<uint32_t>> behind(compiled.concepts.size());
    for (const uint32_t step : compiled.steps) {
        if (step < rules) continue;
        const CompiledConcept& concept_ = compiled.concepts[step - rules];
        auto& found = behind[step - rules];
        for (uint32_t a = concept_.firstAssertion; a < concept_.firstAssertion + concept_.assertionCount; ++a) {
            for (const CompiledOp& op : compiled.opsOf(compiled.rules[compiled.assertions[a].rule])) {
                if (op.kind != Clause::Kind::Is) continue;
                if (op.variable < variables)
                    found.push_back(op.variable);
                else // settled in an earlier step
                    found.insert(found.end(), behind[op.variable - variables].begin(),
                                 behind[op.variable - variables].end());
            }
        }
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
    }
    return behind;
}

/// What has to hold somewhere for an output to be spoken of.
struct Question {
    std::vector<uint32_t> rules;     ///< Any of them fires, or
    std::vector<uint32_t> saturated; ///< none of these is fully true, where `otherwise` speaks of it.
    bool hasOtherwise = false;
};

/// Truths at which a rule of some weight, negated or not, becomes strong enough to be heard, and those that leave
/// `otherwise` too weak to be; none without a minimumStrength.
std::vector<double> levelsOf(const CompiledRules& compiled, double threshold)
{
    std::vector<double> levels;
    if (!(threshold > kNegligibleStrength)) return levels;
    const auto add = [&](double level) {
        if (!(level > 0.0 && level < 1.0)) return;
        levels.push_back(level);
        levels.push_back(1.0 - level);
    };
    const double spared = compiled.hasOtherwise ? 1.0 - threshold / compiled.rules.back().weight : 0.0;
    for (const CompiledRule& rule : compiled.rules) {
        add(threshold / rule.weight);
        add(spared / rule.weight);
    }
    std::sort(levels.begin(), levels.end());
    levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
    return levels;
}

class Search {
public:
    explicit Search(const Engine& engine)
        : compiled_(engine.compiled()), options_(engine.base().options),
          threshold_(std::max(options_.minimumStrength, kNegligibleStrength)), stack_(compiled_.stackDepth),
          memberships_(compiled_.membershipCount, Truth{0.0, 1.0}), strengths_(compiled_.rules.size()),
          box_(compiled_.variables.size()), behind_(variablesBehindConcepts(compiled_))
    {
        const std::vector<double> levels = levelsOf(compiled_, threshold_);
        for (const Variable& variable : engine.base().variables)
            cells_.push_back(cellsOf(variable, levels));
    }

    /// Boxes where the question is answered with no. Gives up, and says so, beyond kMostEvaluations.
    std::vector<Box> holes(const Question& question)
    {
        start(question, false);
        merge();
        return std::move(holes_);
    }

    /// Whether the question is answered with yes anywhere.
    bool holdsSomewhere(const Question& question)
    {
        start(question, true);
        return foundYes_;
    }

    bool gaveUp() const { return gaveUp_; }

    const std::vector<Cell>& cells(std::size_t variable) const { return cells_[variable]; }

private:
    static constexpr std::size_t kMostEvaluations = 10'000'000; ///< Of rules; some tenths of a second an output.
    static constexpr std::size_t kMostHoles = 256;

    enum class Answer { Yes, No, Undecided };

    void start(const Question& question, bool stopAtYes)
    {
        question_ = &question;
        stopAtYes_ = stopAtYes;
        foundYes_ = gaveUp_ = false;
        holes_.clear();
        evaluations_ = 0;
        descend();
    }

    /// Strength included: below minimumStrength a rule is silent.
    Truth strengthIn(uint32_t rule)
    {
        ++evaluations_;
        const Limited fired =
            evaluateAntecedent(compiled_.opsOf(compiled_.rules[rule]), memberships_, options_.conjunction, stack_);
        return strengthOf(fired.truth, compiled_.rules[rule].weight, threshold_);
    }

    /// Concepts follow from the variables. Exact like the rest, except under `sum`, where two partly true assertions
    /// may or may not add up to a fully true one or to the threshold.
    void settleConcepts()
    {
        if (compiled_.concepts.empty()) return;
        const auto rules = static_cast<uint32_t>(compiled_.rules.size());
        std::size_t left = compiled_.concepts.size();
        for (const uint32_t step : compiled_.steps) {
            if (left == 0) break; // what follows asserts nothing
            if (step < rules) {
                strengths_[step] = strengthIn(step);
                continue;
            }
            settleConcept(compiled_, compiled_.concepts[step - rules], options_.aggregation, strengths_, memberships_);
            --left;
        }
    }

    /// Also weighs the variables: one that settles a short undecided rule is worth assigning first.
    Answer answer(std::vector<double>& worth)
    {
        bool undecided = false;
        for (const uint32_t rule : question_->rules) {
            const Truth strength = strengthIn(rule);
            if (strength.low > 0.0) return Answer::Yes;
            if (strength.high > 0.0) {
                undecided = true;
                weigh(rule, worth);
            }
        }
        if (!question_->hasOtherwise) return undecided ? Answer::Undecided : Answer::No;
        bool maybeSaturated = false;
        const double weight = compiled_.rules.back().weight;
        const auto silences = [&](double strength) {
            return strengthOf({1.0 - strength, 1.0}, weight, threshold_).low == 0.0;
        };
        for (const uint32_t rule : question_->saturated) {
            const Truth strength = strengthIn(rule);
            if (silences(strength.low)) // `otherwise` is certainly silent
                return undecided ? Answer::Undecided : Answer::No;
            if (silences(strength.high)) {
                maybeSaturated = true;
                weigh(rule, worth);
            }
        }
        return maybeSaturated ? Answer::Undecided : Answer::Yes;
    }

    void weigh(uint32_t rule, std::vector<double>& worth) const
    {
        const auto ops = compiled_.opsOf(compiled_.rules[rule]);
        for (const CompiledOp& op : ops) {
            if (op.kind != Clause::Kind::Is) continue;
            const double share = 1.0 / static_cast<double>(ops.size() * ops.size());
            if (op.variable < box_.size()) {
                if (box_[op.variable].free) worth[op.variable] += share;
                continue;
            }
            for (const uint32_t variable : behind_[op.variable - box_.size()]) {
                if (box_[variable].free) worth[variable] += share;
            }
        }
    }

    void descend()
    {
        gaveUp_ |= evaluations_ > kMostEvaluations || (holes_.size() >= kMostHoles && !stopAtYes_);
        if (gaveUp_ || (foundYes_ && stopAtYes_)) return;
        std::vector<double> worth(box_.size(), 0.0);
        settleConcepts();
        const Answer found = answer(worth);
        foundYes_ |= found == Answer::Yes;
        if (found == Answer::No && !stopAtYes_) holes_.push_back(box_);
        const auto best = std::max_element(worth.begin(), worth.end());
        if (found != Answer::Undecided || best == worth.end() || *best == 0.0) return;
        const auto variable = static_cast<std::size_t>(best - worth.begin());
        const CompiledVariable& axis = compiled_.variables[variable];
        const std::span<Truth> memberships = std::span(memberships_).subspan(axis.firstTerm, axis.termCount);
        for (std::size_t i = 0; i < cells_[variable].size(); ++i) {
            box_[variable] = {false, i, i};
            for (uint32_t t = 0; t < axis.termCount; ++t) {
                const double membership = compiled_.terms[axis.firstTerm + t].membership(cells_[variable][i].inside);
                memberships[t] = {membership, membership};
            }
            descend();
        }
        box_[variable] = {};
        std::fill(memberships.begin(), memberships.end(), Truth{0.0, 1.0});
    }

    /// Joins boxes that differ in one variable only and are neighbours there.
    void merge()
    {
        for (bool changed = true; changed;) {
            changed = false;
            for (std::size_t i = 0; i < holes_.size() && !changed; ++i) {
                for (std::size_t j = i + 1; j < holes_.size() && !changed; ++j)
                    changed = mergePair(i, j);
            }
        }
    }

    bool mergePair(std::size_t i, std::size_t j)
    {
        std::optional<std::size_t> axis;
        for (std::size_t v = 0; v < box_.size(); ++v) {
            if (holes_[i][v] == holes_[j][v]) continue;
            if (axis || holes_[i][v].free || holes_[j][v].free) return false;
            axis = v;
        }
        Range& a = holes_[i][*axis];
        const Range& b = holes_[j][*axis];
        if (a.last + 1 != b.first && b.last + 1 != a.first) return false;
        a = {false, std::min(a.first, b.first), std::max(a.last, b.last)};
        holes_.erase(holes_.begin() + static_cast<std::ptrdiff_t>(j));
        return true;
    }

    const CompiledRules& compiled_;
    const Options& options_;
    const double threshold_; ///< Weaker rules are silent.
    std::vector<std::vector<Cell>> cells_;
    std::vector<Limited> stack_;
    std::vector<Truth> memberships_;
    std::vector<Truth> strengths_;
    Box box_;
    std::vector<std::vector<uint32_t>> behind_; ///< Per concept the variables it follows from.
    const Question* question_ = nullptr;
    std::vector<Box> holes_;
    std::size_t evaluations_ = 0;
    bool stopAtYes_ = false, foundYes_ = false, gaveUp_ = false;
};

/// "1 <= dynamicLights <= 2", "viewerDistance > 45 (far)". An end at the edge of the universe is left out: facts beyond
/// it count as the edge.
std::string rangeText(const Variable& variable, const std::vector<Cell>& cells, const Range& range)
{
    const Cell& first = cells[range.first];
    const Cell& last = cells[range.last];
    const bool toLow = range.first == 0;
    const bool toHigh = range.last + 1 == cells.size();
    std::string text;
    if (toLow && toHigh)
        text = "any " + variable.name;
    else if (first.low == last.high && (variable.isCount() || (!toLow && !toHigh)))
        text = variable.name + " = " + shortestText(first.low);
    else if (toLow)
        text = variable.name + (last.highOpen ? " < " : " <= ") + shortestText(last.high);
    else if (toHigh)
        text = variable.name + (first.lowOpen ? " > " : " >= ") + shortestText(first.low);
    else
        text = shortestText(first.low) + (first.lowOpen ? " < " : " <= ") + variable.name +
               (last.highOpen ? " < " : " <= ") + shortestText(last.high);
    for (const Term& term : variable.terms) {
        const bool covers = term.shape.membership(first.inside) > 0.5 && term.shape.membership(last.inside) > 0.5;
        if (covers) return text + " (" + term.name + ")";
    }
    return text;
}

std::string boxText(const Engine& engine, const Search& search, const Box& box)
{
    std::string text;
    for (std::size_t v = 0; v < box.size(); ++v) {
        if (!box[v].free)
            text += (text.empty() ? "" : ", ") + rangeText(engine.base().variables[v], search.cells(v), box[v]);
    }
    return text.empty() ? "anywhere" : "where " + text;
}

SourceSpot boxSpot(const Engine& engine, const Box& box)
{
    const auto bound = std::find_if(box.begin(), box.end(), [](const Range& range) { return !range.free; });
    return bound == box.end() ? SourceSpot{} : engine.base().variables[bound - box.begin()].at;
}

bool speaksOf(const CompiledRules& compiled, const CompiledRule& rule, uint32_t output)
{
    const auto effects = compiled.effectsOf(rule);
    return std::any_of(effects.begin(), effects.end(),
                       [&](uint32_t slot) { return slot / compiled.suitabilityTerms == output; });
}

Question questionFor(const Engine& engine, uint32_t output)
{
    const CompiledRules& compiled = engine.compiled();
    Question question;
    question.hasOtherwise = compiled.hasOtherwise && speaksOf(compiled, compiled.rules.back(), output) &&
                            compiled.rules.back().weight >= engine.base().options.minimumStrength;
    for (uint32_t i = 0; i < engine.base().rules.size(); ++i) {
        if (speaksOf(compiled, compiled.rules[i], output))
            question.rules.push_back(i);
        else if (question.hasOtherwise && compiled.rules[i].effectCount != 0)
            question.saturated.push_back(i);
    }
    return question;
}

void reportHoles(const Engine& engine, Search& search, const Question& question, const std::string& about,
                 DiagnosticSink& sink)
{
    constexpr std::size_t kMostReported = 8;
    const std::vector<Box> holes = search.holes(question);
    for (std::size_t i = 0; i < std::min(holes.size(), kMostReported); ++i)
        sink.warning("L02", boxSpot(engine, holes[i]),
                     "no rule speaks of " + about + " " + boxText(engine, search, holes[i]));
    if (holes.size() > kMostReported)
        sink.warning("L02", {}, std::to_string(holes.size() - kMostReported) + " more such regions for " + about);
    if (search.gaveUp())
        sink.warning("L02", {}, "too many combinations of facts: " + about + " was not checked everywhere");
}

} // namespace

void checkCoverage(const Engine& engine, DiagnosticSink& sink)
{
    // Outputs that the same rules speak of share their holes.
    std::map<std::pair<std::vector<uint32_t>, bool>, std::vector<uint32_t>> groups;
    for (uint32_t output = 0; output < engine.compiled().outputCount; ++output) {
        const Question question = questionFor(engine, output);
        groups[{question.rules, question.hasOtherwise}].push_back(output);
    }
    Search search(engine);
    for (const auto& [key, outputs] : groups) {
        std::string about;
        for (const uint32_t output : outputs)
            about += (about.empty() ? "" : ", ") + engine.outputs()[output].name;
        if (groups.size() == 1) about = "any output";
        reportHoles(engine, search, questionFor(engine, outputs.front()), about, sink);
    }
}

void checkDeadRules(const Engine& engine, DiagnosticSink& sink)
{
    Search search(engine);
    CappedFindings found("L03", sink);
    for (uint32_t i = 0; i < engine.base().rules.size(); ++i) {
        const Rule& rule = engine.base().rules[i];
        if (rule.weight < engine.base().options.minimumStrength) {
            found.warning(rule.at,
                          [&] { return "rule '" + rule.id + "' can never fire: its weight is below minimumStrength"; });
            continue;
        }
        Question question;
        question.rules = {i};
        if (!search.holdsSomewhere(question) && !search.gaveUp())
            found.warning(rule.at, [&] {
                return "rule '" + rule.id +
                       "' can never fire: its conditions exclude each other or ask for a concept that no rule asserts";
            });
    }
    found.finish();
}

} // namespace gnomon::rules
