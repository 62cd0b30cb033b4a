// The scripted scenario of Rautenbach 2008, 6.4, forwards and backwards, with rules/thesis.yaml on a real
// device.
#include <algorithm>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// From this time on, every light is to be served by this method.
struct Phase {
    double from;
    const char* what;
    const char* method;
};

// The times are those of the scene files; the methods are the thesis's.
const std::vector<Phase> kForward = {{0.0, "4 static lights", "octree_volume"},
                                     {2.0, "6 moving, near", "chan_durand"},
                                     {4.0, "13 moving, far", "shadow_map"},
                                     {6.0, "14 to 16 moving, far", "chan_durand"},
                                     {8.0, "9 moving, near", "chan_durand"}};
const std::vector<Phase> kReverse = {
    {0.0, "9 moving, near", "chan_durand"}, {2.0, "10 to 16 moving, near", "chan_durand"},
    {4.5, "16 moving, far", "chan_durand"}, {5.5, "13 moving, far", "shadow_map"},
    {7.5, "6 moving, near", "chan_durand"}, {9.5, "4 static lights", "octree_volume"}};

const Phase& phaseAt(const std::vector<Phase>& phases, double time)
{
    size_t i = phases.size() - 1;
    while (phases[i].from > time)
        --i;
    return phases[i];
}

/// The methods in the order in which they served, as the thesis lists them: one entry a change.
std::vector<std::string> play(const char* sceneName, const std::vector<Phase>& phases)
{
    Host host(demo::valueOf(demo::loadScene(sceneName)), {.extent = {160, 96}, .maxLights = 24, .warmAll = true});
    const std::string rules = shippedRules("thesis");
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), "thesis.yaml"));
    std::vector<std::string> sequence;
    uint32_t switches = 0;
    for (uint32_t frame = 0; frame < host.scene.frames; ++frame) {
        const double time = demo::frameTime(host.scene, frame);
        const bool cut = frame > 0 && demo::cameraCutsBetween(host.scene, demo::frameTime(host.scene, frame - 1), time);
        host.require(host.draw({.time = time, .adjust = [&](GnFrameInfo&, std::vector<GnViewFrame>& views) {
                                    views[0].cameraCut = cut;
                                }}));
        const Phase& phase = phaseAt(phases, time);
        for (const uint32_t light : demo::stateAt(host.scene, time).present) {
            const GnDecision decision = host.decision(light);
            REQUIRE(decision.pMethod);
            const bool right = std::string(decision.pMethod) == phase.method;
            CHECK_MESSAGE(right, std::string(sceneName)
                                     << " frame " << frame << " (" << std::string(phase.what) << "), light "
                                     << host.scene.lights[light].name << ": " << std::string(decision.pMethod) << "\n"
                                     << host.explanation(light));
            if (!right) return sequence; // one explanation is enough
            if (sequence.empty() || sequence.back() != decision.pMethod) sequence.emplace_back(decision.pMethod);
        }
        switches += host.stats().switches;
    }
    // A light switches when its phase does: those that are there in both of two phases with different methods.
    uint32_t expected = 0;
    for (size_t i = 1; i < phases.size(); ++i) {
        if (std::string(phases[i].method) == phases[i - 1].method) continue;
        const demo::SceneState before = demo::stateAt(host.scene, phases[i].from - 1.0 / host.scene.framesPerSecond);
        const demo::SceneState after = demo::stateAt(host.scene, phases[i].from);
        for (const uint32_t light : after.present)
            expected += std::count(before.present.begin(), before.present.end(), light) != 0;
    }
    CHECK(expected > 0);
    CHECK(switches == expected);
    return sequence;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "the thesis's scenario gives its sequence of methods with no extra switch")
{
    CHECK(play("scenario", kForward) ==
          std::vector<std::string>{"octree_volume", "chan_durand", "shadow_map", "chan_durand"});
}

TEST_CASE_FIXTURE(DeviceTest, "the thesis's scenario backwards gives its sequence of methods with no extra switch")
{
    CHECK(play("scenario_reverse", kReverse) ==
          std::vector<std::string>{"chan_durand", "shadow_map", "chan_durand", "octree_volume"});
}
