#pragma once
// What to measure although it does not serve: a method that may be cheaper than it is foretold.
#include "runtime/plan/plan.hpp"

namespace gnomon::plan {

/// A method to run beside a light's own, unseen, until its time is known.
struct Probe {
    uint32_t light = kNone; ///< Index in the plan's input; kNone: nothing is worth it.
    uint32_t method = kNone;
};

/// Of the lights that have a method to probe, that of least importance, and the method most likely to enter the plan:
/// it is worth what the light's own is, foretold to take longer, and perhaps does not. None whose time fits the plan's
/// spare milliseconds only with luck (above its prediction plus `sigmas` standard errors), and none that could not win
/// if it took as many below: so what is known well is never probed.
/// @param input  Of the newest step().
/// @param sigmas >= 0, the rule base's `probing.sigma`.
Probe chooseProbe(const PlanInput& input, const PlanStep& plan, const PlanReport& report, double sigmas) noexcept;

} // namespace gnomon::plan
