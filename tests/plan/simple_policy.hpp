#pragma once
// The plainest chooser, to hold plan::PlanStep and what serves without a budget against.
#include <memory>

#include "demo/replay/replay.hpp"
#include "tests/plan/simple_times.hpp"

namespace gnomon::test {

/// With a budget: greedy by utility per millisecond, what serves counts for a little more, and all lights change
/// together where that is worth more or the budget is broken. Without (kMostBudget): of what is worth most the
/// cheapest, what serves stays until something is cheaper by a tenth.
std::unique_ptr<demo::ReplayPolicy> simplePolicy(const demo::Trace& trace, const cost::DeviceKnowledge& known,
                                                 const SimpleTuning& tuning);

} // namespace gnomon::test
