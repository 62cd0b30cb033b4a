#pragma once
/// The best plan there is for known values and times, as a measure of others: one method per light, values up,
/// milliseconds below a budget (multiple-choice knapsack). A table over the time left, bounded by greedy; greedy alone
/// where lights are many.

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/base/method_set.hpp"
#include "runtime/plan/shared_part.hpp"

namespace gnomon::demo {

/// Borrowed. Matrices are light by light: [light * methods + method].
struct PlanProblem {
    uint32_t lights = 0;
    uint32_t methods = 0;
    std::span<const double> values;     ///< lights x methods, >= 0.
    std::span<const double> costsMs;    ///< lights x methods, >= 0, finite.
    std::span<const MethodSet> allowed; ///< Per light; empty: it is left out.
    double budgetMs = 0.0;
};

struct BestPlan {
    double value = 0.0;
    double costMs = 0.0;
    bool fits = false; ///< False: even the cheapest plan is costlier than the budget; that plan is returned.
};

class BestPlans {
public:
    /// @param tableLights Above so many greedy alone decides.
    /// @param bins        Of the time between the cheapest plan and the budget. A plan found by the table is worth at
    ///     least the best one of a budget smaller by lights/bins of that time.
    BestPlans(uint32_t lights, uint32_t methods, uint32_t tableLights = 8, uint32_t bins = 512);

    /// `chosen` holds one method per light, plan::kNone for a light that may have none.
    BestPlan find(const PlanProblem& problem, std::span<uint32_t> chosen) noexcept;

private:
    struct Option {
        double costMs;
        double value;
        uint32_t method;
    };
    struct Step {
        double gainPerMs;
        uint32_t light;
        uint32_t option; ///< Index into options_ of the point the step leads to.
    };
    struct State { ///< The best way found to spend about so much.
        double value;
        double extraMs; ///< Above the cheapest plan, exact.
    };
    struct Origin {
        uint16_t bin;
        uint8_t option;
    };

    void gatherOptions(const PlanProblem& problem) noexcept;
    void walkGreedy(const PlanProblem& problem, double limitMs, std::span<uint32_t> chosen) noexcept;
    void fillSlack(const PlanProblem& problem, double slackMs, std::span<uint32_t> chosen) noexcept;
    void boundRest(uint32_t lights, double slackMs) noexcept;
    void addLight(uint32_t light, double slackMs, double hopeless) noexcept;
    bool readTable(uint32_t lights, std::span<uint32_t> chosen) const noexcept;
    bool fillTable(const PlanProblem& problem, double limitMs, double known, std::span<uint32_t> chosen) noexcept;
    std::span<const Option> optionsOf(uint32_t light) const noexcept;

    uint32_t bins_, tableLights_;
    std::vector<Option> options_; ///< Per light `methods` slots: undominated options by rising cost.
    std::vector<uint32_t> optionCounts_;
    std::vector<uint32_t> at_; ///< Per light, index into its options.
    std::vector<Step> steps_;
    std::vector<State> states_, nextStates_;
    std::vector<uint64_t> inUse_, nextInUse_; ///< A bit per state: the others are old.
    std::vector<Origin> origins_;
    std::vector<double> restOver_; ///< Per light: the most this one and the later ones add at dualPerMs_.
    double dualPerMs_ = 0.0;       ///< Gain per millisecond of the best step that greedy could not afford.
    std::vector<uint32_t> trial_;
    uint32_t methods_ = 0;
};

} // namespace gnomon::demo
