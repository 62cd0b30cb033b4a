#include "demo/compare/fixed_choice.hpp"

#include <algorithm>
#include <cmath>

namespace gnomon::demo {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Methods = std::array<std::string, kLightKinds>;

/// Null: no method that was not cut serves the kind at equal quality.
const MethodTrial* cheapestOf(const std::vector<MethodTrial>& trials, size_t kind, const EqualQuality& quality)
{
    const MethodTrial* best = nullptr;
    for (const MethodTrial& trial : trials) {
        const KindTrial& mine = trial.kinds[kind];
        if (trial.overBest > 0.0 || !mine.served || !quality.holds(mine.errors)) continue;
        if (!best || mine.ms < best->kinds[kind].ms) best = &trial;
    }
    return best;
}

/// One method alone by its name; several with the kinds that each serves, since two choices may have the same ones.
std::string nameOf(const Methods& methods)
{
    std::vector<std::pair<std::string, std::string>> parts; // method, kinds
    for (size_t kind = 0; kind < kLightKinds; ++kind) {
        if (methods[kind].empty()) continue;
        const std::string word = nameOf(static_cast<LightKind>(kind));
        const auto known =
            std::find_if(parts.begin(), parts.end(), [&](const auto& part) { return part.first == methods[kind]; });
        if (known == parts.end())
            parts.emplace_back(methods[kind], word);
        else
            known->second += ", " + word;
    }
    if (parts.size() == 1) return parts.front().first;
    std::string name;
    for (const auto& [method, kinds] : parts)
        name += (name.empty() ? "" : " + ") + method + " (" + kinds + ")";
    return name;
}

class Choices {
public:
    Choices(const std::vector<MethodTrial>& trials, const std::array<bool, kLightKinds>& present,
            const EqualQuality& quality)
        : present_(present)
    {
        for (size_t kind = 0; kind < kLightKinds; ++kind)
            cheapest_[kind] = cheapestOf(trials, kind, quality);
    }

    /// \param first for the kinds it serves; null: the cheapest for all
    void add(const MethodTrial* first)
    {
        Methods methods;
        double ms = 0.0, least = 0.0;
        for (size_t kind = 0; kind < kLightKinds; ++kind) {
            if (!present_[kind]) continue;
            const MethodTrial* mine = first && first->kinds[kind].served ? first : cheapest_[kind];
            if (!mine) return;
            methods[kind] = mine->method;
            ms += mine->kinds[kind].ms;
            least += cheapest_[kind] ? cheapest_[kind]->kinds[kind].ms : kInfinity;
        }
        const auto same = [&](const FixedChoice& choice) { return choice.methods == methods; };
        if (std::any_of(made.begin(), made.end(), same)) return;
        made.push_back({nameOf(methods), methods, ms > kCut * least ? ms / least : 0.0});
    }

    std::vector<FixedChoice> made;

private:
    const std::array<bool, kLightKinds>& present_;
    std::array<const MethodTrial*, kLightKinds> cheapest_{};
};

} // namespace

double overBest(const MethodTrial& trial, const std::vector<MethodTrial>& earlier, const EqualQuality& quality)
{
    double least = kInfinity;
    for (size_t kind = 0; kind < kLightKinds; ++kind) {
        if (!trial.kinds[kind].served) continue;
        const MethodTrial* cheapest = cheapestOf(earlier, kind, quality);
        if (!cheapest) return 0.0;
        least = std::min(least, trial.kinds[kind].ms / cheapest->kinds[kind].ms);
    }
    return std::isfinite(least) ? least : 0.0;
}

std::vector<FixedChoice> fixedChoices(const std::vector<MethodTrial>& trials,
                                      const std::array<bool, kLightKinds>& present, const EqualQuality& quality)
{
    Choices choices(trials, present, quality);
    for (const MethodTrial& trial : trials)
        if (trial.overBest == 0.0) choices.add(&trial);
    choices.add(nullptr);
    for (const MethodTrial& trial : trials)
        if (trial.overBest > 0.0) choices.made.push_back({.name = trial.method, .overBest = trial.overBest});
    return std::move(choices.made);
}

} // namespace gnomon::demo
