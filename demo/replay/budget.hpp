#pragma once

/// Budgets for a trace, in milliseconds or over the cheapest plan.

#include <string>
#include <string_view>

#include "demo/replay/trace.hpp"

namespace gnomon::demo {

/// `budget: auto` of a rule base: what the cheapest plan that keeps the floor costs, times this.
inline constexpr std::string_view kAutoBudget = "1.3x";

/// Milliseconds, or times the cheapest plan: far beyond any frame, and far from where a float ends.
inline constexpr double kMostBudget = 1e6;

/// The cheapest plan of a frame that keeps vetoes and floors, by the true times, milliseconds.
double cheapestMs(const Trace& trace, uint32_t frame);

/// One of equally long parts of a trace.
struct BudgetPart {
    double value = 0.0; ///< Milliseconds, or times the median frame's cheapest plan.
    bool relative = false;
};

/// \param text a,b,...: parts, each in milliseconds (`4.5`), or over the median frame's cheapest plan (`1.3x`), or
/// `auto`, which is `1.3x`. Each above 0 and at most kMostBudget; blanks round it do not count. Fails naming the part
/// that is none of these.
Outcome<std::vector<BudgetPart>> parseBudgets(std::string_view text);

/// Writes a budget into every frame. \param parts at least one.
void setBudgets(Trace& trace, const std::vector<BudgetPart>& parts);

/// Both. Fails as parseBudgets() does.
Status setBudgets(Trace& trace, std::string_view text);

} // namespace gnomon::demo
