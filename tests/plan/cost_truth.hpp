#pragma once
// A device for tests of the cost model: what lights differ by, noise and spikes.
#include <array>
#include <cmath>
#include <vector>

#include "runtime/cost/cost_model.hpp"
#include "runtime/cost/exponent.hpp"
#include "tests/plan/random.hpp"

namespace gnomon::cost::test {

using gnomon::test::Random;

inline constexpr uint32_t kMethods = 6, kLights = 8;

inline Workload anyWorkload(Random& random)
{
    return {.pixels = exp2Exactly(random.between(12, 20)),
            .casterTriangles = exp2Exactly(random.between(8, 20)),
            .mapTexels = exp2Exactly(2.0 * random.below(4) + 16),
            .still = random.unit() < 0.3,
            .mapFilled = exp2Exactly(random.between(-7, 0.5)),
            .mapTouched = (1.0 + random.below(6)) / 6.0};
}

/// Sums, and a factor per (light, method) that no knowledge base can know.
struct Truth {
    double factor = 1.0;
    double method = 1.0;
    std::vector<double> own;

    explicit Truth(Random& random)
    {
        for (uint32_t i = 0; i < kMethods * kLights; ++i)
            own.push_back(exp2Exactly(random.between(-0.2, 0.2)));
    }
    double ms(uint32_t light, uint32_t m, Pass pass, const Workload& w) const
    {
        const double k = 0.5 + 0.3 * m;
        const double time = pass == Pass::resolve ? 0.02 + 2.0 * k * w.pixels / 1e6
                                                  : 0.05 + 0.8 * k * w.casterTriangles / 1e5 +
                                                        (0.3 * w.mapTouched + 0.3 * w.mapFilled) * w.mapTexels / 1e6;
        return time * factor * (m == 2 ? method : 1.0) * own[light * kMethods + m];
    }
    /// 8 % noise; one timing in 200 is a spike of x2 to x6.
    double timed(Random& random, uint32_t light, uint32_t m, Pass pass, const Workload& w) const
    {
        const double gauss = random.unit() + random.unit() + random.unit() + random.unit() - 2.0; // sigma 0.577
        double time = ms(light, m, pass, w) * exp2Exactly(0.111 / 0.577 * gauss);
        if (random.unit() < 0.005) time *= random.between(2, 6);
        return time;
    }
};

inline constexpr Pass kPasses[] = {Pass::update, Pass::resolve};

/// Numbers per term as a fit finds them: the truth's, without what lights differ by, all over `factor`.
inline void calibrate(CostModel& model, double factor = 1.0, Kinship kinship = Kinship::same)
{
    for (uint32_t m = 0; m < kMethods; ++m) {
        const double k = (0.5 + 0.3 * m) / factor;
        std::array<TrackCost, kTracks> tracks;
        tracks[trackOf(Pass::update, Processor::gpu)] = {
            .ms = {0.05 / factor, 8.0 * k, 0.0, 0.3 / factor, 0.3 / factor}, .octaves = 0.3, .samples = 40};
        tracks[trackOf(Pass::resolve, Processor::gpu)] = {
            .ms = {0.02 / factor, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0 * k}, .octaves = 0.3, .samples = 40};
        model.teach(m, tracks, 0.0);
    }
    model.setKinship(kinship);
}

/// Octaves between what is predicted for a light by a method and what it takes.
inline double errorOf(const CostModel& model, const Truth& truth, uint32_t light, uint32_t m, const Workload& w)
{
    const double real = truth.ms(light, m, Pass::update, w) + truth.ms(light, m, Pass::resolve, w);
    return log2Exactly(model.predict(light, m, w, false).ms / real);
}

/// One frame's timings; `methodOf` says which method serves a light.
template <typename MethodOf>
void runFrameWith(CostModel& model, const Truth& truth, Random& random, const std::vector<Workload>& workloads,
                  MethodOf&& methodOf, uint64_t framesSinceSwitch = 1000)
{
    for (uint32_t light = 0; light < kLights; ++light)
        for (const Pass pass : kPasses) {
            const uint32_t m = methodOf(light);
            model.observe({.light = light,
                           .method = m,
                           .pass = pass,
                           .workload = workloads[light],
                           .gpuMs = truth.timed(random, light, m, pass, workloads[light]),
                           .framesSinceSwitch = framesSinceSwitch});
        }
    model.endFrame();
}

inline void runFrame(CostModel& model, const Truth& truth, Random& random, const std::vector<Workload>& workloads,
                     uint32_t methodShift = 0)
{
    runFrameWith(model, truth, random, workloads, [=](uint32_t light) { return (light + methodShift) % kMethods; });
}

inline std::vector<Workload> workloadsFor(Random& random)
{
    std::vector<Workload> workloads;
    for (uint32_t i = 0; i < kLights; ++i)
        workloads.push_back(anyWorkload(random));
    return workloads;
}

} // namespace gnomon::cost::test
