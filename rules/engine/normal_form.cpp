#include "rules/engine/normal_form.hpp"

#include <algorithm>

namespace gnomon::rules {
namespace {

constexpr std::size_t kMostAlternatives = 64; ///< Beyond it an antecedent is compared with nothing.

bool includes(const Conjunction& whole, const Conjunction& part)
{
    return std::includes(whole.begin(), whole.end(), part.begin(), part.end());
}

void simplify(NormalForm& form, bool idempotent)
{
    for (Conjunction& conjunction : form) {
        std::sort(conjunction.begin(), conjunction.end());
        if (idempotent) // x and x is x under the minimum, weaker than x under the product
            conjunction.erase(std::unique(conjunction.begin(), conjunction.end()), conjunction.end());
    }
    std::sort(form.begin(), form.end());
    form.erase(std::unique(form.begin(), form.end()), form.end());
    const NormalForm all = form;
    std::erase_if(form, [&](const Conjunction& weaker) {
        return std::any_of(all.begin(), all.end(),
                           [&](const Conjunction& other) { return other != weaker && includes(weaker, other); });
    });
}

NormalForm allPairs(const NormalForm& left, const NormalForm& right)
{
    NormalForm result;
    for (const Conjunction& l : left) {
        for (const Conjunction& r : right) {
            Conjunction both = l;
            both.insert(both.end(), r.begin(), r.end());
            result.push_back(std::move(both));
        }
    }
    return result;
}

NormalForm either(NormalForm left, const NormalForm& right)
{
    left.insert(left.end(), right.begin(), right.end());
    return left;
}

} // namespace

/// Keeps every operand together with its negation, so that `not` is a swap.
std::optional<NormalForm> normalFormOf(std::span<const CompiledOp> ops, Options::And conjunction)
{
    const bool isMin = conjunction == Options::And::Min;
    struct Operand {
        NormalForm is, isNot;
        bool compound = false;
    };
    std::vector<Operand> stack;
    for (const CompiledOp& op : ops) {
        if (op.kind == Clause::Kind::Is) {
            stack.push_back({{{op.membership * 2}}, {{op.membership * 2 + 1}}, false});
            continue;
        }
        if (op.kind == Clause::Kind::Not) {
            if (stack.back().compound && !isMin) return std::nullopt; // De Morgan does not hold for the product
            std::swap(stack.back().is, stack.back().isNot);
            continue;
        }
        const Operand right = std::move(stack.back());
        stack.pop_back();
        Operand& left = stack.back();
        const bool isAnd = op.kind == Clause::Kind::And;
        if (isAnd ? left.is.size() * right.is.size() > kMostAlternatives
                  : isMin && left.isNot.size() * right.isNot.size() > kMostAlternatives)
            return std::nullopt;
        left.is = isAnd ? allPairs(left.is, right.is) : either(std::move(left.is), right.is);
        if (isMin) left.isNot = isAnd ? either(std::move(left.isNot), right.isNot) : allPairs(left.isNot, right.isNot);
        left.compound = true;
        simplify(left.is, isMin);
        simplify(left.isNot, isMin);
        if (left.is.size() > kMostAlternatives || left.isNot.size() > kMostAlternatives) return std::nullopt;
    }
    return std::move(stack.front().is);
}

bool isWeaker(const NormalForm& form, const NormalForm& than)
{
    return std::all_of(form.begin(), form.end(), [&](const Conjunction& conjunction) {
        return std::any_of(than.begin(), than.end(), [&](const Conjunction& c) { return includes(conjunction, c); });
    });
}

} // namespace gnomon::rules
