// What a decision rested on, as numbers: facts and candidates through the C API.
#include <cmath>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

std::vector<GnFact> factsOf(const Host& host, size_t light)
{
    uint32_t count = 0;
    host.require(gnGetFacts(host.context, host.views[0], host.lights[light], &count, nullptr));
    std::vector<GnFact> facts(count);
    host.require(gnGetFacts(host.context, host.views[0], host.lights[light], &count, facts.data()));
    return facts;
}

std::vector<GnCandidate> candidatesOf(const Host& host, size_t light)
{
    uint32_t count = 0;
    host.require(gnGetCandidates(host.context, host.views[0], host.lights[light], &count, nullptr));
    std::vector<GnCandidate> candidates(count);
    host.require(gnGetCandidates(host.context, host.views[0], host.lights[light], &count, candidates.data()));
    return candidates;
}

double factNamed(const std::vector<GnFact>& facts, const std::string& name)
{
    for (const GnFact& fact : facts)
        if (name == fact.pName) return fact.value;
    FAIL(name);
    return 0.0;
}

const GnCandidate& candidateNamed(const std::vector<GnCandidate>& candidates, const std::string& name)
{
    for (const GnCandidate& candidate : candidates)
        if (name == candidate.pMethod) return candidate;
    FAIL(name);
    return candidates.front();
}

void load(Host& host, const char* name)
{
    const std::string rules = shippedRules(name);
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), name));
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "the facts of a decision are the scene's numbers, in units, NaN where nobody knows")
{
    Scene scene = smallScene();
    scene.lights.push_back(pointLight("bulb", {1.0, 5.0, 2.0}, false));
    Host host(scene);
    load(host, "default");
    host.draw(4, {});
    const std::vector<GnFact> facts = factsOf(host, 0);
    CHECK(factNamed(facts, "dynamicLights") == 1.0); // the bulb
    CHECK(factNamed(facts, "lightMotion") == 0.0);
    CHECK(factNamed(facts, "viewerDistance") == doctest::Approx(host.decision(0).viewerDistance));
    CHECK(factNamed(facts, "screenShare") > 0.0);
    CHECK(factNamed(facts, "screenShare") <= 1.0);
    CHECK(factNamed(facts, "casterTriangles") > 1.0);   // a ball has more than ten triangles
    CHECK(factNamed(facts, "receiverPlanarity") > 0.5); // a floor with little on it
    CHECK(factNamed(facts, "receiverPlanarity") <= 1.0);
    for (const GnFact& fact : facts)
        CHECK(std::string(fact.pUnit).size() > 0);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "what lies far off makes a sun's map too coarse for what is near, which exact edges serve")
{
    constexpr const char* kRules = R"(
version: 1
name: floors
options: {allocation: budget}
variables:
  viewerDistance: {universe: [0, 90], unit: m, terms: {near: [-.inf, -.inf, 30, 60], far: [30, 60, .inf, .inf]}}
suitability: {universe: [0, 1], terms: {acceptable: [0.2, 0.4, 0.6, 0.8], favoured: [0.6, 0.8, .inf, .inf]}}
rules:
  - {id: A, rule: "if viewerDistance is near or far then shadow_map is favoured and stencil_volume is acceptable", because: "a test"}
policy:
  floor: {when: viewerDistance is near, minimumQuality: 0.5}
)";
    const auto qualityOf = [&](Host& host, const char* method) {
        return double{candidateNamed(candidatesOf(host, 0), method).quality};
    };
    Scene scene = smallScene();
    scene.lights[0].kind = demo::LightKind::Directional;
    scene.lights[0].range = 0.0f;
    Host close(scene, {.mapSide = 0.0});
    close.require(gnLoadRules(close.context, kRules, std::string_view(kRules).size(), "floors"));
    close.draw(24, {});
    const double fine = qualityOf(close, "shadow_map");
    CHECK(fine > 0.5);

    demo::Instance post = scene.instances.back();
    for (const double side : {-1.0, 1.0}) {
        post.name = side < 0.0 ? "post left" : "post right";
        post.pose.position = {side * 2000.0, 1.0, side * 2000.0};
        scene.instances.push_back(post);
    }
    Host wide(scene, {.mapSide = 0.0});
    wide.require(gnLoadRules(wide.context, kRules, std::string_view(kRules).size(), "floors"));
    wide.draw(24, {});
    CHECK(qualityOf(wide, "shadow_map") < 0.3 * fine);
    CHECK(qualityOf(wide, "stencil_volume") == doctest::Approx(qualityOf(close, "stencil_volume")));
    CHECK(std::string(wide.decision(0).pMethod) == "stencil_volume");
    CHECK(wide.decision(0).reason == GN_REASON_FLOOR);
    CHECK(candidateNamed(candidatesOf(wide, 0), "shadow_map").elimination == GN_ELIMINATION_FLOOR);
}

TEST_CASE_FIXTURE(DeviceTest,
                  "planarity is high over a floor and low over hills, where the rules reject planar shadows")
{
    for (const bool hills : {false, true}) {
        CAPTURE(hills);
        Scene scene = smallScene();
        if (hills)
            scene.meshes[0] = demo::makeTerrain({.width = 24.0f, .depth = 24.0f, .height = 1.5f, .featureSize = 3.0f});
        for (const char* rules : {"default", "quality", "battery"}) {
            CAPTURE(std::string(rules));
            Host host(scene);
            load(host, rules);
            host.require(host.draw());
            CHECK(std::isnan(factNamed(factsOf(host, 0), "receiverPlanarity"))); // nothing is measured yet
            host.draw(6, {});
            const double planarity = factNamed(factsOf(host, 0), "receiverPlanarity");
            MESSAGE((hills ? "hills " : "floor ") << planarity);
            CHECK((hills ? planarity < 0.3 : planarity > 0.5)); // the ball, the box and their edges are not flat
            const GnCandidate planar = candidateNamed(candidatesOf(host, 0), "projected_planar");
            CHECK((planar.elimination == GN_ELIMINATION_NEVER) == hills);
            CHECK(planar.elimination != GN_ELIMINATION_NONE);
        }
    }
}

// Coordinates count from a point that follows the eye in steps of 256 m; nothing moves when that does.
TEST_CASE_FIXTURE(DeviceTest, "lights keep what was measured of them when the origin of all coordinates moves")
{
    Scene scene = smallScene();
    const glm::dvec3 away(192.0, 0.0, 0.0);
    for (demo::Instance& instance : scene.instances) {
        instance.pose.position += away;
        instance.isStatic = true;
    }
    for (demo::Light& light : scene.lights) {
        light.position += away;
        light.isStatic = true;
        light.range = 20.0f; // it reaches nothing where it would be seen from a grid about another origin
    }
    const glm::dvec3 eye = scene.camera[0].eye, target = scene.camera[0].target;
    double farthest = 0.0, least = 1.0, motion = 0.0;
    for (int phase = 0; phase < 8; ++phase) { // lights are measured in turns of eight frames
        Host host(scene);
        load(host, "default");
        for (int frame = 0; frame < 40; ++frame) {
            const double x = frame == 0 ? -80.0 : 0.1 * (frame - 16 - phase); // the first sets the origin: it is 0
            const glm::dvec3 at = away + glm::dvec3(x, 0.0, 0.0);
            const std::vector<demo::CameraState> cameras{{.eye = eye + at, .target = target + at}};
            FrameOptions options;
            options.cameras = &cameras;
            options.adjust = [&](GnFrameInfo&, std::vector<GnViewFrame>& views) { views[0].cameraCut = frame == 1; };
            host.require(host.draw(options));
            if (frame < 12) continue; // something has been measured by then
            const std::vector<GnFact> facts = factsOf(host, 0);
            farthest = std::max(farthest, factNamed(facts, "viewerDistance"));
            least = std::min(least, factNamed(facts, "screenShare"));
            motion = std::max(motion, factNamed(facts, "lightMotion"));
        }
    }
    MESSAGE("viewer distance at most " << farthest << ", share at least " << least << ", motion " << motion);
    CHECK(farthest < 20.0);
    CHECK(least > 0.05);
    CHECK(motion == 0.0);
}

TEST_CASE_FIXTURE(DeviceTest, "candidates name the chosen method, and why each of the others is not it")
{
    Host host(smallScene());
    host.draw(3, {});
    for (const GnCandidate& candidate : candidatesOf(host, 0)) // nobody to have an opinion
        CHECK((candidate.suitability == GN_SUITABILITY_NO_OPINION || candidate.suitability == GN_SUITABILITY_UNABLE));

    load(host, "thesis");
    host.draw(6, {});
    std::vector<GnCandidate> candidates = candidatesOf(host, 0);
    const GnCandidate chosen = candidateNamed(candidates, "octree_volume");
    CHECK(chosen.elimination == GN_ELIMINATION_NONE);
    CHECK(float(chosen.suitability) / GN_SUITABILITY_STEPS == doctest::Approx(host.decision(0).suitability));
    CHECK(chosen.predictedMs == doctest::Approx(host.decision(0).predictedMs));
    CHECK(chosen.sureMs > 0.0f);
    CHECK(chosen.quality > candidateNamed(candidates, "shadow_map").quality);
    CHECK(candidateNamed(candidates, "shadow_map").elimination == GN_ELIMINATION_OUTSCORED);
    CHECK(candidateNamed(candidates, "shadow_map").suitability < chosen.suitability);
    CHECK(candidateNamed(candidates, "cube_map").elimination == GN_ELIMINATION_UNABLE); // a spot light
    CHECK(candidateNamed(candidates, "cube_map").suitability == GN_SUITABILITY_UNABLE);

    host.pinAll("shadow_map");
    host.require(host.draw());
    candidates = candidatesOf(host, 0);
    CHECK(candidateNamed(candidates, "shadow_map").elimination == GN_ELIMINATION_NONE);
    CHECK(candidateNamed(candidates, "octree_volume").elimination == GN_ELIMINATION_PINNED);
}

TEST_CASE_FIXTURE(DeviceTest, "with a budget the plan says what stands in a method's way: floor or time")
{
    Host host(smallScene());
    std::string rules = shippedRules("default");
    if (const size_t at = rules.find("allocation: none"); at != std::string::npos)
        rules.replace(at, std::string("allocation: none").size(), "allocation: budget");
    host.require(gnLoadRules(host.context, rules.data(), rules.size(), "budget"));
    const FrameOptions poor{.adjust = [](GnFrameInfo& info, std::vector<GnViewFrame>&) { info.budgetMs = 1e-3f; }};
    host.draw(6, poor);
    uint32_t chosen = 0, held = 0;
    for (const GnCandidate& candidate : candidatesOf(host, 0)) {
        chosen += candidate.elimination == GN_ELIMINATION_NONE;
        held += candidate.elimination == GN_ELIMINATION_FLOOR || candidate.elimination == GN_ELIMINATION_BUDGET;
    }
    CHECK(chosen == 1);
    CHECK(held > 0);
}

TEST_CASE_FIXTURE(DeviceTest, "lists of facts and candidates that are too small get what fits, strangers nothing")
{
    Host host(smallScene());
    load(host, "default");
    host.require(host.draw());
    GnFact facts[2] = {};
    uint32_t count = 1;
    CHECK(gnGetFacts(host.context, host.views[0], host.lights[0], &count, facts) == GN_INCOMPLETE);
    CHECK(count == 1);
    CHECK(facts[0].pName != nullptr);
    CHECK(facts[1].pName == nullptr);
    GnCandidate candidates[2] = {};
    count = 1;
    CHECK(gnGetCandidates(host.context, host.views[0], host.lights[0], &count, candidates) == GN_INCOMPLETE);
    CHECK(count == 1);
    CHECK(candidates[1].pMethod == nullptr);

    CHECK(gnGetFacts(host.context, host.views[0], host.lights[0], nullptr, facts) == GN_ERROR_NULL_ARGUMENT);
    CHECK(gnGetCandidates(host.context, host.views[0], VK_NULL_HANDLE, &count, candidates) == GN_ERROR_INVALID_HANDLE);
    CHECK(count == 0);
    count = 2;
    CHECK(gnGetFacts(host.context, VK_NULL_HANDLE, host.lights[0], &count, facts) == GN_ERROR_INVALID_HANDLE);
    CHECK(count == 0);
}
