#include "rules/engine/concepts.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <unordered_map>

namespace gnomon::rules {
namespace {

/// One step from a concept to another that one of its rules asks for.
struct Dependency {
    uint32_t on = 0;
    uint32_t rule = 0;
    SourceSpot at; ///< Where the rule asks.
};

using Dependencies = std::vector<std::vector<Dependency>>; ///< Per concept.

Dependencies dependenciesOf(const RuleBase& base)
{
    std::unordered_map<std::string_view, uint32_t> index;
    for (uint32_t i = 0; i < base.concepts.size(); ++i)
        index.emplace(base.concepts[i].name, i);
    Dependencies result(base.concepts.size());
    for (uint32_t r = 0; r < base.rules.size(); ++r) {
        for (const Consequent& consequent : base.rules[r].consequents) {
            const auto concluded = index.find(consequent.name);
            if (consequent.kind != Consequent::Kind::Output || concluded == index.end()) continue;
            for (const Clause& clause : base.rules[r].antecedent) {
                const auto asked = clause.kind == Clause::Kind::Is ? index.find(clause.variable) : index.end();
                if (asked != index.end()) result[concluded->second].push_back({asked->second, r, clause.variableAt});
            }
        }
    }
    return result;
}

/// Depth first. The path is at most kMaxConcepts long.
class Sorter {
public:
    Sorter(const RuleBase& base, DiagnosticSink& sink)
        : base_(base), sink_(sink), dependencies_(dependenciesOf(base)), state_(base.concepts.size(), State::New)
    {
    }

    std::optional<std::vector<uint32_t>> sorted()
    {
        for (uint32_t i = 0; i < base_.concepts.size(); ++i) {
            if (!visit(i)) return std::nullopt;
        }
        return std::move(order_);
    }

private:
    enum class State : uint8_t { New, OnPath, Done };

    bool visit(uint32_t index)
    {
        if (state_[index] == State::Done) return true;
        state_[index] = State::OnPath;
        path_.push_back(index);
        for (const Dependency& dependency : dependencies_[index]) {
            if (state_[dependency.on] == State::OnPath) return report(dependency);
            if (!visit(dependency.on)) return false;
        }
        path_.pop_back();
        state_[index] = State::Done;
        order_.push_back(index);
        return true;
    }

    /// "scene <- load <- scene": read the arrow as "is concluded from".
    bool report(const Dependency& closing)
    {
        std::string way;
        for (auto at = std::find(path_.begin(), path_.end(), closing.on); at != path_.end(); ++at)
            way += base_.concepts[*at].name + " <- ";
        const std::string& name = base_.concepts[closing.on].name;
        sink_.error("R08", closing.at,
                    "concept " + inQuotes(name) + " is concluded from itself: " + way + name + ", closed by rule " +
                        inQuotes(base_.rules[closing.rule].id) + "; take " + inQuotes(base_.concepts[closing.on].name) +
                        " out of that rule's condition");
        return false;
    }

    const RuleBase& base_;
    DiagnosticSink& sink_;
    Dependencies dependencies_;
    std::vector<State> state_;
    std::vector<uint32_t> path_;
    std::vector<uint32_t> order_;
};

} // namespace

std::optional<std::vector<uint32_t>> orderConcepts(const RuleBase& base, DiagnosticSink& sink)
{
    return Sorter(base, sink).sorted();
}

void settleConcept(const CompiledRules& compiled, const CompiledConcept& concept_, Options::Aggregation aggregation,
                   std::span<const Truth> strengths, std::span<Truth> memberships) noexcept
{
    std::array<Truth, kMaxTerms> strongest{}, claimed{}, ofThisPriority{};
    std::array<uint64_t, kMaxTerms> sumLow{}, sumHigh{};
    uint32_t priority = kHighestPriority;
    const auto entries = std::span(compiled.assertions).subspan(concept_.firstAssertion, concept_.assertionCount);
    for (const CompiledAssertion& entry : entries) {
        if (compiled.rules[entry.rule].priority != priority) {
            priority = compiled.rules[entry.rule].priority;
            claimed = ofThisPriority; // both hold the maximum over all levels so far
        }
        Truth contrary;
        for (uint32_t t = 0; t < concept_.termCount; ++t) {
            if (t == entry.term) continue;
            contrary.low = std::max(contrary.low, claimed[t].low);
            contrary.high = std::max(contrary.high, claimed[t].high);
        }
        const Truth given = strengths[entry.rule];
        const Truth left = {std::min(given.low, 1.0 - contrary.high), std::min(given.high, 1.0 - contrary.low)};
        Truth& level = ofThisPriority[entry.term];
        level = {std::max(level.low, given.low), std::max(level.high, given.high)};
        Truth& best = strongest[entry.term];
        best = {std::max(best.low, left.low), std::max(best.high, left.high)};
        sumLow[entry.term] += static_cast<uint64_t>(left.low * kSumScale);
        sumHigh[entry.term] += static_cast<uint64_t>(left.high * kSumScale);
    }
    for (uint32_t t = 0; t < concept_.termCount; ++t) {
        const auto added = [](uint64_t sum) { return std::min(1.0, static_cast<double>(sum) / kSumScale); };
        memberships[concept_.firstMembership + t] =
            aggregation == Options::Aggregation::Sum ? Truth{added(sumLow[t]), added(sumHigh[t])} : strongest[t];
    }
}

} // namespace gnomon::rules
