#pragma once

/// Multiple-choice knapsack: one method per light, values up, milliseconds below a budget.
///
/// Up to kTableLights lights a table over the time left is used, above that the greedy walk along the upper hulls of
/// the lights' options (Sinha and Zoltners 1979; for detail and rendering algorithm per object: Funkhouser and Sequin
/// 1993). Methods may need *shared parts*: work that is paid once however many lights use however many of them.
///
/// Nothing is allocated after reserve(); the same problem gives the same plan, whatever was solved before.

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/base/method_set.hpp"

namespace gnomon::plan {

inline constexpr uint32_t kNone = UINT32_MAX;
inline constexpr uint32_t kMaxParts = 32; ///< Bits of a mask.

/// Above this many lights greedy loses less than the table's resolution, in less time (README.md, "Which solver").
inline constexpr uint32_t kTableLights = 8;
/// The time between the cheapest plan and the budget is cut into so many bins. A plan found by the table is worth at
/// least the best one of a budget smaller by lights/bins of that time: 8/512 = 1.6 %.
inline constexpr uint32_t kTableBins = 512;

/// Work for all lights of a view together (a copy of its depth, say), paid once if any light's method needs it.
struct SharedPart {
    double ms = 0.0;   ///< >= 0, finite.
    MethodSet methods; ///< Those that need it.
};
/// What those of `methods` need together.
double partsMs(std::span<const SharedPart> parts, const MethodSet& methods) noexcept;

/// Borrowed. Matrices are light by light: [light * methods + method].
struct Problem {
    uint32_t lights = 0;
    uint32_t methods = 0;
    std::span<const double> values;     ///< lights x methods, >= 0.
    std::span<const double> costsMs;    ///< lights x methods, >= 0, finite.
    std::span<const MethodSet> allowed; ///< Per light; empty: it is left out.
    std::span<const SharedPart> parts;  ///< At most kMaxParts.
    double budgetMs = 0.0;
};

/// Sums over the chosen methods, in the order of lights, then of parts.
struct Sums {
    double value = 0.0;
    double costMs = 0.0; ///< With shared parts.
};
Sums sumOf(const Problem& problem, std::span<const uint32_t> chosen) noexcept;
/// The least that any plan costs, whatever it is worth; beyond six parts that cost something, the least found.
double cheapestMs(const Problem& problem) noexcept;

struct Solution {
    double value = 0.0;
    double costMs = 0.0;
    bool fits = false; ///< False: even the cheapest plan found is dearer than the budget; that plan is returned.
};

class Knapsack {
public:
    explicit Knapsack(uint32_t bins = kTableBins) : bins_(bins) {}

    /// Sizes the scratch memory. The only call that allocates. `tableLights` bounds what solveTable() accepts.
    void reserve(uint32_t lights, uint32_t methods, uint32_t tableLights = kTableLights);

    /// Table or greedy, whichever suits the number of lights. `chosen` holds one method per light, kNone for a light
    /// that may have none.
    Solution solve(const Problem& problem, std::span<uint32_t> chosen) noexcept;

    /// One of the two, whatever the number of lights. For tests and comparisons.
    Solution solveGreedy(const Problem& problem, std::span<uint32_t> chosen) noexcept;
    Solution solveTable(const Problem& problem, std::span<uint32_t> chosen) noexcept;

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
    enum class Method : uint8_t { greedy, table };

    bool tryPaying(const Problem& problem, Method method, uint32_t paid, Solution& best,
                   std::span<uint32_t> chosen) noexcept;
    Solution solvePaying(const Problem& problem, Method method, uint32_t paid, double known,
                         std::span<uint32_t> chosen) noexcept;
    bool gatherOptions(const Problem& problem, const MethodSet& barred) noexcept;
    void walkGreedy(const Problem& problem, double limitMs, std::span<uint32_t> chosen) noexcept;
    void fillSlack(const Problem& problem, double slackMs, std::span<uint32_t> chosen) noexcept;
    void boundRest(uint32_t lights, double slackMs) noexcept;
    void addLight(uint32_t light, double slackMs, double hopeless) noexcept;
    bool readTable(uint32_t lights, std::span<uint32_t> chosen) const noexcept;
    bool fillTable(const Problem& problem, double limitMs, double known, std::span<uint32_t> chosen) noexcept;
    std::span<const Option> optionsOf(uint32_t light) const noexcept;

    uint32_t bins_;
    uint32_t tableLights_ = 0;
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
    uint32_t paid_ = 0; ///< Parts that the best plan so far may use.
};

} // namespace gnomon::plan
