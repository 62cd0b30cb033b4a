#pragma once
// The budget of a frame: the host's, below the cap of the rules; without one, that cap, or what `budget: auto` found.
#include <cstdint>

#include "rules/engine/rule_base.hpp"
#include "runtime/plan/plan.hpp"
#include "runtime/select/auto_budget.hpp"

namespace gnomon {

/// What a frame's budget follows from.
struct BudgetInput {
    double hostMs = 0.0;      ///< GnFrameInfo::budgetMs; 0: none.
    std::uint32_t lights = 0; ///< Of all views.
    bool cut = false;         ///< Of any view's camera.
    bool disturbed = false;   ///< What the frames before took is not the methods' doing.
    double tookMs = 0.0;      ///< All shadow passes of the newest frame, as measured or else as predicted.
    float intervalMs = 0.0f;  ///< Since the frame before.
    /// The newest frame that was measured.
    struct Measured {
        std::uint64_t frame = 0;
        double ms = -1.0;
        double plannedMs = 0.0, cheapestMs = 0.0; ///< As its plan predicted.
        bool beside = false;                      ///< Methods ran beside those of the plan.
    } measured;
};

class FrameBudget {
public:
    /// @param base in force; null: no rules
    void begin(const rules::RuleBase* base, const BudgetInput& input);
    /// The frame's lights are planned: what the cheapest plan takes, and a budget that follows it.
    void take(const plan::PlanReport& report);

    double ms() const { return ms_; } ///< In force; 0: none.
    /// For the plan step. While `budget: auto` measures, nothing fits, so that the plan is the cheapest.
    double planMs() const;
    double perCheapest() const { return perCheapest_; } ///< PlanInput::perCheapest.
    bool measuring() const { return measuring_; }       ///< The cheapest plan runs, for `budget: auto`.
    bool begins() const { return begins_; }             ///< It was measured; this is the first frame under the budget.
    /// What the cheapest plan of the frame before takes of it (Fact::frameBudget); 0: there is none.
    double cheapestShare() const { return ms_ > 0.0 ? cheapestMs_ / ms_ : 0.0; }

private:
    double ms_ = 0.0, perCheapest_ = 0.0, cheapestMs_ = 0.0;
    bool measuring_ = false, begins_ = false;
    AutoBudget auto_;
    std::uint64_t autoRules_ = 0; ///< Hash of the rule base it was measured for.
    std::uint64_t followed_ = 0;  ///< The newest frame that it followed.
};

} // namespace gnomon
