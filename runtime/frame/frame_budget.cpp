#include "runtime/frame/frame_budget.hpp"

#include "runtime/select/choice.hpp"

namespace gnomon {

void FrameBudget::begin(const rules::RuleBase* base, const BudgetInput& input)
{
    ms_ = budgetInForce(base, input.hostMs);
    perCheapest_ = 0.0;
    measuring_ = begins_ = false;
    if (input.hostMs != 0.0 || !countsTime(base) || !base->policy.budget.automatic) return;
    if (autoRules_ != base->textHash) auto_.restart();
    autoRules_ = base->textHash;
    auto_.look(input.lights, input.cut);
    // What was timed last, if nothing but methods had a part in it.
    const BudgetInput::Measured& measured = input.measured;
    if (measured.frame > followed_ && !input.disturbed && !measured.beside)
        auto_.follow(measured.ms, measured.plannedMs, measured.cheapestMs);
    followed_ = measured.frame;
    if (!input.disturbed) begins_ = auto_.note(input.tookMs, double{input.intervalMs});
    measuring_ = auto_.measuring();
    ms_ = auto_.ms();
    perCheapest_ = auto_.perCheapest();
}

double FrameBudget::planMs() const
{
    constexpr double kNextToNothingMs = 1e-3;
    return measuring_ ? kNextToNothingMs : ms_;
}

void FrameBudget::take(const plan::PlanReport& report)
{
    cheapestMs_ = report.cheapestMs;
    if (perCheapest_ > 0.0 && report.budgetMs > 0.0) ms_ = report.budgetMs;
}

} // namespace gnomon
