// What a light costs in wrong pixels by a map follows from the outlines of its casters: leaves near the eye are not
// left to maps, a box of their size may be.
#include <string>
#include <vector>

#include "demo/scene/primitives.hpp"
#include "device/hooks.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

/// Nine casters of two metres on a floor, seven metres from the eye, under a spot light.
Scene nineOf(const demo::Mesh& caster)
{
    Scene scene;
    scene.meshes = {demo::makePlane({.width = 14.0f, .depth = 14.0f}), caster};
    scene.instances.push_back({.name = "floor", .mesh = 0});
    for (int i = 0; i < 9; ++i)
        scene.instances.push_back(
            {.name = "caster" + std::to_string(i),
             .mesh = 1,
             .pose = {.position = {2.8 * (i % 3) - 2.8, 0.8, 2.8 * static_cast<double>(i / 3) - 2.8}}});
    demo::Light spot{.name = "spot", .kind = demo::LightKind::Spot, .position = {3.0, 9.0, 4.0}, .range = 25.0f};
    spot.direction = glm::normalize(-spot.position);
    spot.innerAngle = 0.5f, spot.outerAngle = 0.6f;
    scene.lights = {spot};
    scene.camera = {{.eye = {0.0, 4.0, 8.0}, .target = {0.0, 0.0, 0.0}}};
    return scene;
}

struct Choice {
    std::string method;
    bool exact = false;
    double mapPercent = 0.0; ///< Wrong pixels that are expected of shadow_map.
};

Choice choiceFor(const demo::Mesh& caster)
{
    Host host(nineOf(caster), hooked({.extent = {320, 180}, .warmAll = true, .mapSide = 0.0}, {withoutTimestamps()}));
    const std::string rules = shippedRules("default");
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), "default"));
    host.draw(6, {.call = Call::record});
    Choice choice{.method = host.decision(0).pMethod};
    for (const GnMethodInfo& method : availableMethods(host.context))
        choice.exact |= choice.method == method.pName && (method.traits & GN_TRAIT_EXACT_BIT);
    uint32_t count = 0;
    host.require(gnGetCandidates(host.context, host.views[0], host.lights[0], &count, nullptr));
    std::vector<GnCandidate> candidates(count, GnCandidate{GN_INIT(GnCandidate)});
    host.require(gnGetCandidates(host.context, host.views[0], host.lights[0], &count, candidates.data()));
    for (const GnCandidate& candidate : candidates)
        if (std::string(candidate.pMethod) == "shadow_map") choice.mapPercent = 1.0 / double{candidate.quality} - 1.0;
    return choice;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "near leaves get exact shadows where a map of them would be wrong, recorded")
{
    const Choice box = choiceFor(demo::makeBox({.size = glm::vec3(1.4f)}));
    const Choice leaves =
        choiceFor(demo::makeLeaves({.size = glm::vec3(2.0f), .length = 0.3f, .width = 0.05f, .count = 300}));
    MESSAGE("box: " << box.method << ", a map wrong " << box.mapPercent << " %; leaves: " << leaves.method << ", "
                    << leaves.mapPercent << " %");
    CHECK(leaves.exact);
    CHECK(leaves.mapPercent > 2.0 * box.mapPercent);
}
