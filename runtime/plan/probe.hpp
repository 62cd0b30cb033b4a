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

/// Share of the last second's shadow time that a probe may cost beyond what the light's own method takes.
inline constexpr double kMostWaste = 0.02;

/// What is expected of a method; Candidate::ms may be one standard error above.
struct Guess {
    double ms = 0.0, sigmaMs = 0.0;

    explicit Guess(const Candidate& candidate) noexcept;
    /// How many standard errors less than expected it must take to be cheaper than `ownMs`; < 0: its time is known.
    double sigmasToWin(double ownMs) const noexcept;
};

struct ProbeLimits {
    double sigmas = 2.0;       ///< >= 0, the rule base's `probing.sigma`.
    double frames = 1.0;       ///< That a probe runs for.
    double lastSecondMs = 0.0; ///< All shadow passes of the last second; 0: not known, and nothing is probed.
};

/// Of the lights that have a method to probe, that of least importance, and the method most likely to enter the plan:
/// it is worth what the light's own is, and may be cheaper. Never one that is known already (kSure), that could not win
/// if it took `sigmas` standard errors less than predicted, or whose upper bound, so many above it, does not fit the
/// plan's spare milliseconds, by predictions and by what the newest frame took, or would waste more than kMostWaste.
/// @param input Of the newest step().
Probe chooseProbe(const PlanInput& input, const PlanStep& plan, const PlanReport& report,
                  const ProbeLimits& limits) noexcept;

} // namespace gnomon::plan
