#include "demo/replay/budget.hpp"

#include <algorithm>
#include <limits>

#include "demo/io/number.hpp"
#include "demo/replay/replay.hpp"

namespace gnomon::demo {

namespace {

/// Of the frames in which a light takes any time.
double medianCheapestMs(const Trace& trace)
{
    std::vector<double> sums;
    for (uint32_t frame = 0; frame < trace.frames; ++frame)
        if (const double ms = cheapestMs(trace, frame); ms > 0.0) sums.push_back(ms);
    if (sums.empty()) return 0.0;
    const auto middle = sums.begin() + static_cast<std::ptrdiff_t>(sums.size() / 2);
    std::nth_element(sums.begin(), middle, sums.end());
    return *middle;
}

} // namespace

double cheapestMs(const Trace& trace, uint32_t frame)
{
    double sum = 0.0;
    for (uint32_t slot = 0; slot < trace.lights; ++slot) {
        if (!trace.lightStates[trace.cell(frame, slot)].present) continue;
        const MethodSet eligible = eligibleMethods(trace, frame, slot);
        double least = std::numeric_limits<double>::infinity();
        for (uint32_t m = 0; m < trace.methods.size(); ++m)
            if (eligible.has(m)) least = std::min(least, trace.measure(frame, slot, m).ms());
        if (!eligible.empty()) sum += least;
    }
    return sum;
}

Outcome<std::vector<BudgetPart>> parseBudgets(std::string_view text)
{
    std::vector<BudgetPart> parts;
    while (true) {
        const size_t comma = text.find(',');
        std::string_view word = trimmed(text.substr(0, comma));
        const std::string_view asked = word;
        if (word == "auto") word = kAutoBudget;
        const bool relative = word.ends_with('x');
        if (relative) word.remove_suffix(1);
        const std::optional<double> value = parseNumber(word);
        if (!value || !(*value > 0.0) || *value > kMostBudget)
            return Outcome<std::vector<BudgetPart>>::failure(std::string(asked) +
                                                             ": no budget like 4.5, 1.3x or auto, up to 1000000");
        parts.push_back({*value, relative});
        if (comma == std::string_view::npos) return parts;
        text.remove_prefix(comma + 1);
    }
}

void setBudgets(Trace& trace, const std::vector<BudgetPart>& parts)
{
    const double cheapest = medianCheapestMs(trace);
    for (uint32_t frame = 0; frame < trace.frames; ++frame) {
        const BudgetPart& part = parts[size_t{frame} * parts.size() / trace.frames];
        trace.budgetsMs[frame] = static_cast<float>(part.relative ? part.value * cheapest : part.value);
    }
}

Status setBudgets(Trace& trace, std::string_view text)
{
    const Outcome<std::vector<BudgetPart>> parts = parseBudgets(text);
    if (!parts) return Status::failure(parts.error());
    setBudgets(trace, *parts);
    return Done{};
}

} // namespace gnomon::demo
