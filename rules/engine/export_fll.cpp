#include "rules/engine/export_fll.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "runtime/base/number_text.hpp"

namespace gnomon::rules {
namespace {

/// Words with a meaning of their own in FLL's rules that ours does not reserve.
constexpr std::array<std::string_view, 5> kHedges = {"extremely", "seldom", "somewhat", "very", "if"};

/// One sentence part with what it takes to put it into another.
struct Text {
    std::string words;
    bool compound = false;
};

class Writer {
public:
    Writer(const Engine& engine, uint32_t resolution)
        : engine_(engine), base_(engine.base()), compiled_(engine.compiled()), resolution_(resolution),
          isSum_(base_.options.aggregation == Options::Aggregation::Sum), isRanked_(!compiled_.byPriority.empty())
    {
    }

    FllResult write()
    {
        checkNames();
        if (engine_.suitability().arePoints()) miss("terms of suitability without width");
        text_ = "Engine: " + (base_.name.empty() ? "unnamed" : base_.name) + "\n";
        for (const Variable& variable : base_.variables)
            inputVariable(variable);
        for (const OutputInfo& output : engine_.outputs())
            outputVariable(output.name);
        helperVariables();
        for (const uint32_t step : compiled_.steps) {
            if (step < compiled_.rules.size())
                rule(step);
            else if (isRanked_)
                assertions(step - static_cast<uint32_t>(compiled_.rules.size()));
        }
        for (uint32_t i = 0; isRanked_ && i < compiled_.writtenRules(); ++i) {
            for (const uint32_t slot : compiled_.effectsOf(compiled_.rules[i]))
                limitedConclusion(i, conclusionText(slot), contraryTo(i, slot));
        }
        if (compiled_.hasOtherwise) otherwise();
        if (isSum_) sums();
        if (!missing_.empty()) return {{}, missing_};
        return {text_, {}};
    }

private:
    enum class Block { None, Antecedents, Following };

    void miss(std::string_view what)
    {
        if (missing_.empty()) missing_ = what;
    }

    void checkNames()
    {
        const auto check = [&](std::string_view name) {
            if (std::find(kHedges.begin(), kHedges.end(), name) != kHedges.end()) miss("a name that FLL reserves");
        };
        const auto checkAll = [&](const auto& owner) {
            check(owner.name);
            for (const auto& term : owner.terms)
                check(term.name);
        };
        for (const Variable& variable : base_.variables)
            checkAll(variable);
        for (const Concept& concept_ : base_.concepts)
            checkAll(concept_);
        for (const OutputInfo& output : engine_.outputs())
            check(output.name);
        checkAll(base_.suitability);
    }

    /// Infinite shoulders end one universe beyond it.
    void terms(const Variable& variable)
    {
        const double width = variable.high - variable.low;
        for (const Term& term : variable.terms) {
            text_ += "  term: " + term.name + " Trapezoid";
            for (const double corner : {term.shape.a, term.shape.b, term.shape.c, term.shape.d})
                text_.append(" ").append(shortestText(std::clamp(corner, variable.low - width, variable.high + width)));
            text_ += "\n";
        }
    }

    void variableHead(std::string_view kind, std::string_view name, double low, double high)
    {
        text_.append(kind).append(": ").append(name).append("\n  enabled: true\n  range: ");
        text_ += shortestText(low) + " " + shortestText(high) + "\n  lock-range: false\n";
    }

    void inputVariable(const Variable& variable)
    {
        variableHead("InputVariable", variable.name, variable.low, variable.high);
        terms(variable);
    }

    void outputVariable(const std::string& name)
    {
        variableHead("OutputVariable", name, base_.suitability.low, base_.suitability.high);
        text_ += "  aggregation: Maximum\n  defuzzifier: Centroid " + std::to_string(resolution_) +
                 "\n  default: nan\n  lock-previous: false\n";
        terms(base_.suitability);
    }

    /// A variable that only carries degrees of truth from rule to rule.
    template <typename Words>
    void helper(const std::string& name, bool adds, const Words& words)
    {
        variableHead("OutputVariable", name, 0.0, 1.0);
        text_ += std::string("  aggregation: ") + (adds ? "BoundedSum" : "Maximum") +
                 "\n  defuzzifier: WeightedSum\n  default: nan\n  lock-previous: false\n";
        for (const auto& word : words)
            text_ += "  term: " + word.name + " Constant 1\n";
    }

    void helperVariables()
    {
        const std::vector<Concept::Word> on = {{"on", {}}};
        for (const Concept& concept_ : base_.concepts)
            helper(concept_.name, isSum_, concept_.terms);
        for (uint32_t i = 0; isRanked_ && i < compiled_.writtenRules(); ++i)
            helper(strengthName(i), false, on);
        if (compiled_.hasOtherwise) helper("spoken_", false, on);
        for (const OutputInfo& output : engine_.outputs()) {
            if (isSum_) helper(sumName(output), true, base_.suitability.terms);
        }
    }

    static std::string strengthName(uint32_t rule) { return "strength_" + std::to_string(rule); }
    static std::string sumName(const OutputInfo& output) { return "sum_" + output.name; }

    void openBlock(Block block)
    {
        if (block == block_) return;
        block_ = block;
        const bool first = block == Block::Antecedents;
        const bool product = first && base_.options.conjunction == Options::And::Product;
        const bool threshold = first && base_.options.minimumStrength > 0.0;
        text_ += std::string("RuleBlock: ") + (first ? "rules" : "conclusions") +
                 "\n  enabled: true\n  conjunction: " + (product ? "AlgebraicProduct" : "Minimum") +
                 "\n  disjunction: Maximum\n  implication: Minimum\n  activation: " +
                 (threshold ? "Threshold >= " + shortestText(base_.options.minimumStrength) : "General") + "\n";
    }

    std::string conclusionText(uint32_t slot) const
    {
        const OutputInfo& output = engine_.outputs()[slot / compiled_.suitabilityTerms];
        const Term& term = base_.suitability.terms[slot % compiled_.suitabilityTerms];
        return (isSum_ ? sumName(output) : output.name) + " is " + term.name;
    }

    /// What a rule concludes straight away; with priorities that is its own strength.
    std::vector<std::string> directConclusions(uint32_t index) const
    {
        std::vector<std::string> list;
        if (isRanked_) {
            list.push_back(strengthName(index) + " is on");
        } else {
            for (const uint32_t slot : compiled_.effectsOf(compiled_.rules[index]))
                list.push_back(conclusionText(slot));
            for (std::size_t c = 0; c < compiled_.concepts.size(); ++c) {
                const CompiledConcept& concept_ = compiled_.concepts[c];
                for (uint32_t a = concept_.firstAssertion; a < concept_.firstAssertion + concept_.assertionCount; ++a) {
                    if (compiled_.assertions[a].rule == index)
                        list.push_back(base_.concepts[c].name + " is " +
                                       base_.concepts[c].terms[compiled_.assertions[a].term].name);
                }
            }
        }
        if (compiled_.hasOtherwise && compiled_.rules[index].effectCount != 0) list.push_back("spoken_ is on");
        return list;
    }

    void rule(uint32_t index)
    {
        const std::vector<std::string> list = directConclusions(index);
        if (list.empty()) return; // a veto, or a conclusion about what this build does not have
        openBlock(Block::Antecedents);
        std::string conclusions;
        for (const std::string& conclusion : list)
            conclusions += (conclusions.empty() ? "" : " and ") + conclusion;
        text_ += "  rule: if " + antecedentText(compiled_.opsOf(compiled_.rules[index])) + " then " + conclusions +
                 weightText(compiled_.rules[index].weight) + "\n";
    }

    static std::string weightText(double weight) { return weight == 1.0 ? "" : " with " + shortestText(weight); }

    std::string antecedentText(std::span<const CompiledOp> ops)
    {
        struct Operand {
            Text is, isNot;
        };
        std::vector<Operand> stack;
        const auto within = [](const Text& part) {
            return part.compound ? std::string("(").append(part.words).append(")") : part.words;
        };
        const auto joined = [&](const Text& x, std::string_view word, const Text& y) {
            return Text{within(x).append(" ").append(word).append(" ").append(within(y)), true};
        };
        const bool product = base_.options.conjunction == Options::And::Product;
        for (const CompiledOp& op : ops) {
            if (op.kind == Clause::Kind::Is) {
                const std::string name(engine_.variableName(op.variable)), term(engine_.termName(op.variable, op.term));
                stack.push_back({{name + " is " + term}, {name + " is not " + term}});
            } else if (op.kind == Clause::Kind::Not) {
                if (stack.back().is.compound && product) miss("'not (...)' under the product");
                std::swap(stack.back().is, stack.back().isNot);
            } else {
                const Operand right = std::move(stack.back());
                stack.pop_back();
                Operand& left = stack.back();
                const bool isAnd = op.kind == Clause::Kind::And;
                left = {joined(left.is, isAnd ? "and" : "or", right.is),
                        joined(left.isNot, isAnd ? "or" : "and", right.isNot)};
            }
        }
        return stack.front().is.words;
    }

    /// Rules of higher priority that conclude another term of the same output.
    std::vector<uint32_t> contraryTo(uint32_t index, uint32_t slot) const
    {
        std::vector<uint32_t> found;
        for (uint32_t other = 0; other < compiled_.writtenRules(); ++other) {
            if (compiled_.rules[other].priority <= compiled_.rules[index].priority) continue;
            const auto effects = compiled_.effectsOf(compiled_.rules[other]);
            if (std::any_of(effects.begin(), effects.end(), [&](uint32_t s) {
                    return s != slot && s / compiled_.suitabilityTerms == slot / compiled_.suitabilityTerms;
                }))
                found.push_back(other);
        }
        return found;
    }

    void limitedConclusion(uint32_t index, const std::string& conclusion, const std::vector<uint32_t>& contrary)
    {
        openBlock(Block::Following);
        text_ += "  rule: if " + strengthName(index) + " is on";
        for (const uint32_t other : contrary)
            text_ += " and " + strengthName(other) + " is not on";
        text_ += " then " + conclusion + "\n";
    }

    /// With priorities: a concept once all rules that assert it have their strength.
    void assertions(uint32_t index)
    {
        const CompiledConcept& concept_ = compiled_.concepts[index];
        const auto all = std::span(compiled_.assertions).subspan(concept_.firstAssertion, concept_.assertionCount);
        for (const CompiledAssertion& assertion : all) {
            std::vector<uint32_t> contrary;
            for (const CompiledAssertion& other : all) {
                if (other.term != assertion.term &&
                    compiled_.rules[other.rule].priority > compiled_.rules[assertion.rule].priority)
                    contrary.push_back(other.rule);
            }
            limitedConclusion(assertion.rule,
                              base_.concepts[index].name + " is " + base_.concepts[index].terms[assertion.term].name,
                              contrary);
        }
    }

    void otherwise()
    {
        const CompiledRule& rule = compiled_.rules.back();
        if (rule.effectCount == 0) return;
        block_ = Block::None; // a block of its own: what it asks for is complete only now
        openBlock(Block::Antecedents);
        std::string conclusions;
        for (const uint32_t slot : compiled_.effectsOf(rule))
            conclusions += (conclusions.empty() ? "" : " and ") + conclusionText(slot);
        text_ += "  rule: if spoken_ is not on then " + conclusions + weightText(rule.weight) + "\n";
    }

    void sums()
    {
        openBlock(Block::Following);
        for (const OutputInfo& output : engine_.outputs()) {
            for (const Term& term : base_.suitability.terms)
                text_ += "  rule: if " + sumName(output) + " is " + term.name + " then " + output.name + " is " +
                         term.name + "\n";
        }
    }

    const Engine& engine_;
    const RuleBase& base_;
    const CompiledRules& compiled_;
    uint32_t resolution_;
    bool isSum_, isRanked_;
    Block block_ = Block::None;
    std::string text_;
    std::string missing_;
};

} // namespace

FllResult exportFll(const Engine& engine, uint32_t resolution)
{
    return Writer(engine, resolution).write();
}

} // namespace gnomon::rules
