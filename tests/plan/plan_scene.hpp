#pragma once
// Lights and methods as the plan step sees them.
#include <vector>

#include "runtime/plan/plan.hpp"

namespace gnomon::plan::test {

/// A scene of lights with the same methods; tests turn single knobs.
struct Scene {
    uint32_t methods;
    std::vector<LightMemory> memories;
    std::vector<LightRequest> requests;
    std::vector<Candidate> candidates;
    PlanInput input;
    PlanStep plan;

    Scene(uint32_t lights, std::vector<Candidate> each) : methods(static_cast<uint32_t>(each.size()))
    {
        memories.resize(lights);
        for (uint32_t i = 0; i < lights; ++i) {
            requests.push_back({.memory = &memories[i]});
            candidates.insert(candidates.end(), each.begin(), each.end());
        }
        input.methods = methods;
        input.budgetMs = 10.0;
        plan.reserve(lights, methods);
    }
    Scene(const Scene&) = delete;
    Candidate& of(uint32_t light, uint32_t method) { return candidates[light * methods + method]; }
    PlanReport step(uint32_t frames = 1)
    {
        PlanReport report;
        for (; frames > 0; --frames) {
            input.lights = requests;
            input.candidates = candidates;
            report = plan.step(input);
            ++input.frame;
            input.cut = false;
        }
        return report;
    }
    uint32_t chosen(uint32_t light) const { return plan.lights()[light].chosen; }
    Why why(uint32_t light, uint32_t method) const { return plan.why(light)[method]; }
};

inline constexpr uint32_t kCheap = 0, kGood = 1;

/// 0: cheap, suitability 0.5, 1 ms. 1: good, suitability 0.9, 4 ms.
inline std::vector<Candidate> cheapAndGood()
{
    return {{.suitability = 2048, .quality = 0.7f, .ms = 1.0}, {.suitability = 3686, .quality = 0.95f, .ms = 4.0}};
}

} // namespace gnomon::plan::test
