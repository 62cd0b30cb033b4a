#pragma once
// What to measure although it does not serve: a method that may be cheaper than it is predicted.
#include "runtime/plan/plan.hpp"

namespace gnomon::plan {

/// A method to run beside a light's own, unseen, until its time is known.
struct Probe {
    uint32_t light = kNone; ///< Index in the plan's input; kNone: nothing is worth it.
    uint32_t method = kNone;
};

/// A prediction whose standard error is no more than this share of it is not worth a probe. In the median 13 % where
/// the method served the light and was timed (20 asked of `gnomon why` along a run of scenario), 21 % where it was not
/// (60).
inline constexpr double kSure = 0.15;

/// Of the lights that have a method to probe, that of least importance, and the method most likely to enter the plan:
/// it is worth what the light's own is, and may be cheaper. None that is known already (kSure), none whose time fits
/// the plan's spare milliseconds only with luck (above its prediction plus `sigmas` standard errors; spare is what the
/// plan leaves by its predictions and by what the newest frame took), and none that could not win if it took as many
/// below.
/// @param input  Of the newest step().
/// @param sigmas >= 0, the rule base's `probing.sigma`.
Probe chooseProbe(const PlanInput& input, const PlanStep& plan, const PlanReport& report, double sigmas) noexcept;

} // namespace gnomon::plan
