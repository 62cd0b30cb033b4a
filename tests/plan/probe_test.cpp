// Which method is measured beside those that serve.
#include "runtime/plan/probe.hpp"

#include <doctest/doctest.h>
#include <vector>

using namespace gnomon;
using namespace gnomon::plan;

namespace {

/// Two lights, method 0 serves; 1 shows as much, is predicted 15 % costlier, and not well known; 2 shows less.
struct Scene {
    std::vector<LightMemory> memories{2};
    std::vector<LightRequest> requests;
    std::vector<Candidate> candidates;
    PlanStep plan;
    PlanInput input;
    PlanReport report;
    double measuredMs = -1.0, lastSecondMs = 1e6;

    Scene()
    {
        for (LightMemory& memory : memories) {
            requests.push_back({.memory = &memory});
            candidates.push_back({.suitability = 3000, .quality = 1.0f, .ms = 2.0, .sigmaMs = 0.1});
            candidates.push_back({.suitability = 3000, .quality = 1.0f, .ms = 2.3, .sigmaMs = 0.45});
            candidates.push_back({.suitability = 3000, .quality = 0.5f, .ms = 2.1, .sigmaMs = 0.3});
        }
        requests[1].importance = 0.5;
        plan.reserve(2, 3);
    }
    Scene(const Scene&) = delete;
    Candidate& of(uint32_t light, uint32_t method) { return candidates[light * 3 + method]; }
    Probe probe(double budgetMs = 10.0, double sigmas = 2.0)
    {
        for (int frame = 0; frame < 2; ++frame) { // the second finds everything settled
            input = {.frame = input.frame + 1,
                     .lights = requests,
                     .candidates = candidates,
                     .methods = 3,
                     .budgetMs = budgetMs,
                     .measuredMs = measuredMs};
            report = plan.step(input);
        }
        return chooseProbe(input, plan, report, {.sigmas = sigmas, .frames = 7.0, .lastSecondMs = lastSecondMs});
    }
};

} // namespace

TEST_CASE("what may be cheaper and shows as much is probed, on the light of least importance")
{
    Scene scene;
    const Probe probe = scene.probe();
    CHECK(probe.light == 1);
    CHECK(probe.method == 1);
    scene.requests[1].pinned = 0;
    CHECK(scene.probe().light == 0);
    scene.of(0, 1).eligibility = Eligibility::trait;
    CHECK(scene.probe().light == kNone);
}

TEST_CASE("nothing is probed that is known, cannot win, or might not fit")
{
    Scene scene;
    scene.requests[1].pinned = 0;
    CHECK(scene.probe(10.0, 0.6).light == kNone); // it would have to take two thirds of a standard error less
    CHECK(scene.probe(10.0, 0.7).light == 0);
    CHECK(scene.probe(7.0).light == kNone); // 4 ms serve, 2.3 + 2 * 0.45 more are needed
    CHECK(scene.probe(7.6).light == 0);
    scene.measuredMs = 4.6; // what is predicted is not what is left
    CHECK(scene.probe(7.6).light == kNone);
    CHECK(scene.probe(8.2).light == 0);
    scene.measuredMs = 3.0; // nor is luck in one frame
    CHECK(scene.probe(7.0).light == kNone);
    scene.measuredMs = -1.0;
    scene.of(0, 1).firstFrameMs = 20.0;
    CHECK(scene.probe().light == kNone);
    scene.of(0, 1).firstFrameMs = 0.0;
    scene.of(0, 1).sigmaMs = 0.1; // 0.3 ms costlier for certain
    CHECK(scene.probe().light == kNone);
    scene.of(0, 1) = {.suitability = 3000, .quality = 1.0f, .ms = 2.01, .sigmaMs = 0.2}; // could win, but is known
    CHECK(scene.probe().light == kNone);
    scene.of(0, 1).sigmaMs = 0.4;
    CHECK(scene.probe().light == 0);
}

TEST_CASE("a probe wastes a fiftieth of the last second's shadow time at most")
{
    Scene scene;
    scene.lastSecondMs = 0.0; // not known
    CHECK(scene.probe().light == kNone);
    scene.lastSecondMs =
        50.0 * 7.0 * (2.3 + 2.0 * 0.45 - 2.0) + 1.0; // frames of its upper bound beyond the present cost
    CHECK(scene.probe().light == 1);
    scene.of(1, 1).firstFrameMs = 0.1;
    CHECK(scene.probe().light == 0);
    scene.of(1, 1).firstFrameMs = 0.0;
    for (const uint32_t light : {0u, 1u}) // nobody has timed it: it counts as 2.8 ms, and two errors up it is 3.3
        scene.of(light, 1) = {.suitability = 3000, .quality = 1.0f, .ms = 2.8, .likelyMs = 2.3};
    CHECK(scene.probe().light == kNone);
    scene.lastSecondMs += 50.0 * 7.0 * 0.1;
    CHECK(scene.probe().light == 1);
    scene.lastSecondMs = 1e6;
    CHECK(scene.probe().light == 1);
}

TEST_CASE("of two methods the one that needs less luck is probed")
{
    Scene scene;
    scene.requests[1].pinned = 0;
    scene.of(0, 2) = {.suitability = 3000, .quality = 1.0f, .ms = 2.2, .sigmaMs = 0.4};
    CHECK(scene.probe().method == 2);
    scene.of(0, 2).ms = 2.7;
    scene.of(0, 2).sigmaMs = 0.5;
    CHECK(scene.probe().method == 1);
}
