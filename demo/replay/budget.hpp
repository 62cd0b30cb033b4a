#pragma once

/// Budgets for a trace, in milliseconds or over the cheapest plan.

#include <string>
#include <string_view>

#include "demo/replay/trace.hpp"

namespace gnomon::demo {

/// `budget: auto` of a rule base: what the cheapest plan that keeps the floor costs, times this.
inline constexpr std::string_view kAutoBudget = "1.3x";

/// The cheapest plan of a frame that keeps vetoes and floors, by the true times, milliseconds.
double cheapestMs(const Trace& trace, uint32_t frame);

/** \brief Writes a budget into every frame.
\param text a,b,...: equally long parts of the trace, each in milliseconds (`4.5`), or over the median frame's cheapest
    plan (`1.3x`), or `auto`, which is `1.3x`.
*/
Status setBudgets(Trace& trace, std::string_view text);

} // namespace gnomon::demo
