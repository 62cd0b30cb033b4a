#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "rules/engine/lint_checks.hpp"
#include "rules/engine/normal_form.hpp"
#include "runtime/base/number_text.hpp"

/// L04. How strongly two rules can fire together follows from their normal forms: the height of a conjunction is the
/// lowest of what its clauses reach axis by axis, since axes do not depend on each other, and that of alternatives the
/// highest. Exact for the minimum; the product can only be lower. Words of one concept count as excluding each other.

namespace gnomon::rules {
namespace {

/// Where along an axis memberships have to be looked at.
struct Places {
    std::vector<double> xs; ///< Ascending.
    bool whole = false;     ///< Whole numbers: there is nothing between them.
};

/// Membership with its sign, straight from `from` to `to`.
struct Line {
    double from, to;
};

class Heights {
public:
    explicit Heights(const Engine& engine) : compiled_(engine.compiled())
    {
        for (uint32_t v = 0; v < compiled_.variables.size(); ++v) {
            const CompiledVariable& axis = compiled_.variables[v];
            axisOf_.insert(axisOf_.end(), axis.termCount, v);
            places_.push_back(placesOf(engine.base().variables[v]));
        }
        for (uint32_t c = 0; c < compiled_.concepts.size(); ++c)
            axisOf_.insert(axisOf_.end(), compiled_.concepts[c].termCount,
                           static_cast<uint32_t>(compiled_.variables.size()) + c);
    }

    /// Highest strength with which both fire at one point.
    double together(const NormalForm& x, const NormalForm& y) const
    {
        double highest = 0.0;
        for (const Conjunction& left : x) {
            for (const Conjunction& right : y)
                highest = std::max(highest, heightOf(left, right));
        }
        return highest;
    }

private:
    static Places placesOf(const Variable& variable)
    {
        constexpr double kMostNumbers = 4096;
        Places places;
        places.whole = variable.isCount() && variable.high - variable.low <= kMostNumbers;
        std::vector<double>& xs = places.xs;
        if (places.whole) {
            for (double x = std::ceil(variable.low); x <= variable.high; x += 1.0)
                xs.push_back(x);
            return places;
        }
        xs = {variable.low, variable.high};
        for (const Term& term : variable.terms)
            xs.insert(xs.end(), {term.shape.a, term.shape.b, term.shape.c, term.shape.d});
        std::erase_if(xs, [&](double x) { return !(x >= variable.low && x <= variable.high); });
        std::sort(xs.begin(), xs.end());
        xs.erase(std::unique(xs.begin(), xs.end()), xs.end());
        return places;
    }

    double heightOf(const Conjunction& left, const Conjunction& right) const
    {
        Conjunction all = left;
        all.insert(all.end(), right.begin(), right.end());
        std::stable_sort(all.begin(), all.end(), [&](Literal x, Literal y) { return axisOf_[x / 2] < axisOf_[y / 2]; });
        double height = 1.0;
        for (auto first = all.begin(); first != all.end() && height > 0.0;) {
            const uint32_t axis = axisOf_[*first / 2];
            const auto last = std::find_if(first, all.end(), [&](Literal l) { return axisOf_[l / 2] != axis; });
            const std::span<const Literal> literals(first, last);
            height = std::min(height, axis < places_.size() ? alongAxis(axis, literals) : ofConcept(literals));
            first = last;
        }
        return height;
    }

    double truthAt(Literal literal, double x) const
    {
        const double membership = compiled_.terms[literal / 2].membership(x);
        return literal % 2 == 0 ? membership : 1.0 - membership;
    }

    /// Highest minimum of the literals along one axis. Values at the ends of a piece are taken from its inside: that
    /// two terms share the very edge between them is no contradiction anybody meets.
    double alongAxis(uint32_t axis, std::span<const Literal> literals) const
    {
        const std::vector<double>& xs = places_[axis].xs;
        double highest = 0.0;
        if (places_[axis].whole) {
            for (const double x : xs) {
                double lowest = 1.0;
                for (const Literal literal : literals)
                    lowest = std::min(lowest, truthAt(literal, x));
                highest = std::max(highest, lowest);
            }
            return highest;
        }
        std::vector<Line> lines(literals.size());
        for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
            for (std::size_t l = 0; l < literals.size(); ++l) {
                const double quarter = truthAt(literals[l], 0.75 * xs[i] + 0.25 * xs[i + 1]);
                const double threeQuarters = truthAt(literals[l], 0.25 * xs[i] + 0.75 * xs[i + 1]);
                lines[l] = {1.5 * quarter - 0.5 * threeQuarters, 1.5 * threeQuarters - 0.5 * quarter};
            }
            highest = std::max(highest, highestMinimum(lines));
        }
        return highest;
    }

    /// Of straight lines over [0, 1]: at an end or where two cross.
    static double highestMinimum(const std::vector<Line>& lines)
    {
        const auto minimumAt = [&](double t) {
            double lowest = 1.0;
            for (const Line& line : lines)
                lowest = std::min(lowest, line.from + t * (line.to - line.from));
            return lowest;
        };
        double highest = std::max(minimumAt(0.0), minimumAt(1.0));
        for (std::size_t i = 0; i < lines.size(); ++i) {
            for (std::size_t j = i + 1; j < lines.size(); ++j) {
                const double slopes = (lines[i].to - lines[i].from) - (lines[j].to - lines[j].from);
                const double t = slopes == 0.0 ? 0.0 : (lines[j].from - lines[i].from) / slopes;
                if (t > 0.0 && t < 1.0) highest = std::max(highest, minimumAt(t));
            }
        }
        return highest;
    }

    static double ofConcept(std::span<const Literal> literals)
    {
        double height = 1.0;
        for (const Literal x : literals) {
            for (const Literal y : literals) {
                if (x / 2 == y / 2 && x != y) height = std::min(height, 0.5); // a word and its negation
                if (x / 2 != y / 2 && x % 2 == 0 && y % 2 == 0) height = 0.0;
            }
        }
        return height;
    }

    const CompiledRules& compiled_;
    std::vector<uint32_t> axisOf_; ///< Per membership.
    std::vector<Places> places_;   ///< Per variable.
};

/// Outputs that one rule favours (highest term of suitability) and the other avoids (lowest).
std::string disputed(const Engine& engine, uint32_t x, uint32_t y)
{
    const CompiledRules& compiled = engine.compiled();
    const uint32_t terms = compiled.suitabilityTerms;
    const auto concludes = [&](uint32_t rule, uint32_t slot) {
        const auto effects = compiled.effectsOf(compiled.rules[rule]);
        return std::binary_search(effects.begin(), effects.end(), slot);
    };
    std::string names;
    for (uint32_t o = 0; o < compiled.outputCount; ++o) {
        const uint32_t lowest = o * terms, highest = o * terms + terms - 1;
        if ((concludes(x, highest) && concludes(y, lowest)) || (concludes(x, lowest) && concludes(y, highest)))
            names += (names.empty() ? "" : ", ") + engine.outputs()[o].name;
    }
    return names;
}

} // namespace

void checkContradictions(const Engine& engine, DiagnosticSink& sink)
{
    // Neighbouring terms cross at one half, so rules beside each other always contradict each other by that much.
    constexpr double kContradiction = 0.5 + 1e-9;
    const CompiledRules& compiled = engine.compiled();
    if (compiled.suitabilityTerms < 2) return;
    const Heights heights(engine);
    std::vector<std::optional<NormalForm>> forms;
    for (uint32_t i = 0; i < compiled.writtenRules(); ++i)
        forms.push_back(normalFormOf(compiled.opsOf(compiled.rules[i]), engine.base().options.conjunction));
    CappedFindings found("L04", sink);
    for (uint32_t second = 1; second < forms.size(); ++second) {
        for (uint32_t first = 0; first < second; ++first) {
            const CompiledRule &a = compiled.rules[first], &b = compiled.rules[second];
            // A different priority declares which of the two is the exception; a light nudge contradicts nobody.
            const double weight = std::min(a.weight, b.weight);
            if (a.priority != b.priority || weight < kContradiction || !forms[first] || !forms[second]) continue;
            const std::string names = disputed(engine, first, second);
            if (names.empty()) continue;
            const double height = std::min(weight, heights.together(*forms[first], *forms[second]));
            if (height < kContradiction) continue;
            found.warning(engine.base().rules[second].at, [&] {
                return "rules " + inQuotes(engine.ruleId(first)) + " and " + inQuotes(engine.ruleId(second)) +
                       " favour and avoid " + names + " at once, with strength " + fixedText(height, 2) +
                       "; give the exception a priority";
            });
        }
    }
    found.finish();
}

} // namespace gnomon::rules
