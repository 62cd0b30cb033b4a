#include "yaml_support.hpp"

#include <algorithm>
#include <limits>

#include "rules/engine/lint.hpp"
#include "rules/yaml/shipped.hpp"

using namespace gnomon::rules;
using namespace gnomon::rules::test;

namespace {

RuleBase defaultBase()
{
    return parsed(shippedRuleBase("default"), "default.yaml");
}

struct Situation {
    const char* what;
    double dynamicLights, lightMotion, viewerDistance, screenShare, casterTriangles;
    const char* spot;  ///< Best method for a spot light,
    const char* point; ///< and for a point light, which shadow_map cannot serve; nor can the omni maps a spot light.
};

const Situation kSituations[] = {
    {"a small scene right ahead", 1, 1, 5, 0.5, 3.5, "stencil_volume", "stencil_volume"},
    {"the same at rest", 0, 0, 5, 0.5, 3.5, "stencil_volume", "stencil_volume"},
    {"a heavy scene right ahead", 1, 1, 5, 0.5, 5.5, "pcf_hybrid", "pcf_hybrid"},
    {"a crowd of moving lights right ahead", 18, 1, 5, 0.5, 3.5, "pcf_hybrid", "pcf_hybrid"},
    {"a speck right ahead", 1, 1, 5, 0.002, 5.5, "ray_traced", "ray_traced"},
    {"far and moving", 4, 1, 80, 0.5, 4.5, "shadow_map", "dual_paraboloid"},
    {"far and at rest", 4, 0, 80, 0.5, 4.5, "shadow_map", "cube_map"},
    {"far, moving, very heavy", 4, 1, 80, 0.5, 6.5, "shadow_map", "cube_map"},
    {"a far speck", 4, 1, 80, 0.002, 4.5, "shadow_map", "dual_paraboloid"},
};

using Names = std::initializer_list<const char*>;

constexpr Names kForSpot = {"ray_traced", "shadow_map", "stencil_volume", "pcf_hybrid", "chan_durand", "octree_volume"};
constexpr Names kForPoint = {"ray_traced",      "stencil_volume", "pcf_hybrid",   "cube_map",
                             "dual_paraboloid", "chan_durand",    "octree_volume"};

std::string bestOf(const Inference& inference, Names eligible)
{
    const auto suitability = [&](const char* name) { return inference.outputs[placeOf(name)].quantised; };
    return *std::ranges::max_element(eligible, {}, suitability);
}

} // namespace

TEST_CASE("default.yaml picks exact methods near and maps far, for spot and for point lights")
{
    const Engine engine = bound(defaultBase());
    Inference inference = engine.makeInference();
    for (const Situation& s : kSituations) {
        CAPTURE(s.what);
        engine.evaluate(std::vector<double>{s.dynamicLights, s.lightMotion, s.viewerDistance, s.screenShare,
                                            s.casterTriangles, 0.0, 0.5, 0.5, 0.0, 0.0, 0.0},
                        inference);
        CHECK(bestOf(inference, kForSpot) == s.spot);
        CHECK(bestOf(inference, kForPoint) == s.point);
    }
}

TEST_CASE("where a frame is recorded a map suits best near the viewer too, and volumes stay in reach of the price")
{
    const Engine engine = bound(defaultBase());
    Inference inference = engine.makeInference();
    for (const double distance : {5.0, 80.0}) {
        engine.evaluate(std::vector<double>{1, 1, distance, 0.5, 5.5, 0.0, 0.5, 0.5, 1.0, 0.0, 0.0}, inference);
        CHECK(bestOf(inference, {"shadow_map", "stencil_volume", "chan_durand"}) == "shadow_map"); // a spot light
        CHECK(bestOf(inference, {"stencil_volume", "cube_map", "chan_durand"}) == "cube_map");     // a point light
    }
    engine.evaluate(std::vector<double>{1, 1, 5, 0.5, 5.5, 0.0, 0.5, 0.5, 1.0, 0.0, 0.0}, inference);
    const auto suitability = [&](const char* name) { return inference.outputs[placeOf(name)].quantised; };
    CHECK(2 * suitability("stencil_volume") >= suitability("cube_map")); // what is liked half as well may serve
    CHECK(2 * suitability("chan_durand") >= suitability("cube_map"));
    CHECK(suitability("cube_map") > suitability("dual_paraboloid"));
}

TEST_CASE("near shadows are never best served by a plain map, whatever the other facts are")
{
    const Engine engine = bound(defaultBase());
    Inference inference = engine.makeInference();
    Random random(41);
    for (int i = 0; i < 20'000; ++i) {
        engine.evaluate(std::vector<double>{static_cast<double>(random.below(21)), random.unit(), random.between(0, 30),
                                            random.unit(), random.between(2, 7), random.between(0, 2), random.unit(),
                                            random.between(0, 2), 0.0, random.between(0, 100), random.between(0, 8)},
                        inference);
        const std::string best = bestOf(inference, {"ray_traced", "shadow_map", "stencil_volume", "pcf_hybrid",
                                                    "cube_map", "dual_paraboloid", "chan_durand", "octree_volume"});
        REQUIRE_MESSAGE((best == "stencil_volume" || best == "pcf_hybrid" || best == "ray_traced"), best);
    }
}

TEST_CASE("no shipped base lets shadows on a single plane serve where receivers are not flat, or near the viewer")
{
    const std::size_t planar = placeOf("projected_planar");
    Random random(7);
    for (const ShippedRuleBase& shipped : shippedRuleBases()) {
        CAPTURE(std::string(shipped.name));
        const Engine engine = bound(parsed(shipped.text, shipped.name));
        Inference inference = engine.makeInference();
        const bool thesis = shipped.name == "thesis"; // knows no planarity: avoids all but its own methods
        for (int i = 0; i < 5'000; ++i) {
            const double distance = random.between(0, 90), planarity = random.unit();
            engine.evaluate(std::vector<double>{static_cast<double>(random.below(21)), random.unit(), distance,
                                                random.unit(), random.between(2, 7), random.between(0, 2), planarity,
                                                random.between(0, 2), 0.0, random.between(0, 100),
                                                random.between(0, 8)},
                            inference);
            if (!thesis) REQUIRE(inference.outputs[planar].vetoed == (planarity <= 0.5));
            if (thesis || distance < 30.0)
                REQUIRE(bestOf(inference, {"ray_traced", "shadow_map", "stencil_volume", "pcf_hybrid", "cube_map",
                                           "dual_paraboloid", "chan_durand", "octree_volume", "all_edges_volume",
                                           "projected_planar"}) != "projected_planar");
        }
    }
}

TEST_CASE("while the viewer distance is unknown every method is acceptable and none is preferred")
{
    const Engine engine = bound(defaultBase());
    Inference inference = engine.makeInference();
    engine.evaluate(std::vector<double>{1, 0.5, kNan, 0.5, 4, 0, 0.5, 0.5, 0.0, 0.0, 0.0}, inference);
    for (const OutputState& output : inference.outputs) {
        CHECK(output.hasOpinion);
        CHECK(output.quantised == inference.outputs[0].quantised);
        CHECK(engine.ruleId(output.strongestRule) == "otherwise");
    }
}

TEST_CASE("default.yaml lints clean, reads every fact but the radius that penumbrae come of, and gives a reason for "
          "every rule")
{
    const RuleBase base = defaultBase();
    for (const Diagnostic& finding : lint(base, vocabulary()))
        FAIL_CHECK(toText(finding));
    for (const Rule& rule : base.rules)
        CHECK_FALSE(rule.because.empty());
    for (const FactInfo& fact : kFacts) {
        CAPTURE(fact.name);
        if (fact.name == std::string("lightRadius")) continue;
        CHECK(std::any_of(base.rules.begin(), base.rules.end(),
                          [&](const Rule& rule) { return contains(rule.sentence, fact.name); }));
    }
    CHECK(base.policy.floor.when.size() == 1);
    CHECK(base.policy.budget.headroom == 0.02);
}

TEST_CASE("every shipped rule base lints clean, without a warning, and gives a reason for every rule")
{
    for (const ShippedRuleBase& shipped : shippedRuleBases()) {
        const RuleBase base = parsed(shipped.text, shipped.name);
        for (const Diagnostic& finding : parseRuleBase(shipped.text, shipped.name).diagnostics)
            FAIL_CHECK(toText(finding));
        for (const Diagnostic& finding : lint(base, vocabulary()))
            FAIL_CHECK(toText(finding));
        for (const Rule& rule : base.rules)
            CHECK_MESSAGE(!rule.because.empty(), rule.id);
        CHECK(base.name == shipped.name);
    }
}

TEST_CASE("quality.yaml keeps exact edges near, battery.yaml takes maps as soon as it can")
{
    const Engine quality = bound(parsed(shippedRuleBase("quality"))),
                 battery = bound(parsed(shippedRuleBase("battery")));
    const auto best = [](const Engine& engine, std::vector<double> facts, Names eligible) {
        Inference inference = engine.makeInference();
        facts.resize(kFacts.size()); // not recorded, no penumbrae
        engine.evaluate(facts, inference);
        return bestOf(inference, eligible);
    };
    // dynamicLights, lightMotion, viewerDistance, screenShare, casterTriangles, lightRadius, receiverPlanarity,
    // frameBudget
    const std::vector<double> small = {1, 1, 5, 0.5, 3.2, 0, 0.5, 0.3}, big = {1, 1, 5, 0.7, 5.5, 0, 0.5, 0.9},
                              far = {1, 0, 80, 0.5, 3.2, 0, 0.5, 0.3}, late = {1, 1, 5, 0.5, 3.2, 0, 0.5, 1.5};
    const Names spot = {"ray_traced", "shadow_map", "stencil_volume", "pcf_hybrid"};
    const Names point = {"ray_traced", "stencil_volume", "pcf_hybrid", "cube_map", "dual_paraboloid"};
    CHECK(best(quality, small, spot) == "stencil_volume");
    CHECK(best(quality, big, point) == "pcf_hybrid");
    CHECK(best(quality, far, spot) == "stencil_volume");
    CHECK(best(quality, late, spot) == "stencil_volume");
    CHECK(best(battery, small, spot) == "stencil_volume");
    CHECK(best(battery, big, spot) == "shadow_map");
    CHECK(best(battery, big, point) == "dual_paraboloid");
    CHECK(best(battery, far, point) == "cube_map");
    CHECK(best(battery, late, spot) == "shadow_map");
}

TEST_CASE("far penumbrae suit even edges best by default.yaml while nothing moves; near ones and points never")
{
    const Names all = {"moments",     "shadow_map",  "cube_map",   "dual_paraboloid", "ray_traced",
                       "pcf_hybrid",  "pcss",        "rbssm",      "penumbra_wedges", "stencil_volume",
                       "virtual_map", "trapezoidal", "tile_shafts"};
    for (const char* name : {"default", "quality", "battery"}) {
        const Engine engine = bound(parsed(shippedRuleBase(name)));
        Inference inference = engine.makeInference();
        const auto best = [&](double motion, double distance, double triangles, double pixels) {
            engine.evaluate(std::vector<double>{2, motion, distance, 0.3, triangles, 0.0, 0.5, 0.3, 0.0, pixels, 1.0},
                            inference);
            return bestOf(inference, all);
        };
        const bool even = std::string(name) == "default"; // quality's floor holds there, too, and battery saves
        for (const double triangles : {3.2, 4.5, 6.5}) {
            CAPTURE(name);
            CAPTURE(triangles);
            for (const double pixels : {8.0, 50.0})
                CHECK((best(0, 80, triangles, pixels) == "moments") == even);
            CHECK(best(0, 80, triangles, 0) != "moments");
            CHECK(best(0, 5, triangles, 8) != "moments");
        }
        if (even) CHECK(best(1, 80, 4.5, 8) == "shadow_map"); // drawn and filtered again
    }
}

TEST_CASE("pages serve a light whose one map is too coarse: far off, and in recorded frames wherever it is")
{
    constexpr double kNoPenumbra = 0.0, kFine = 2.0, kCoarse = 20.0;
    const Names all = {"shadow_map", "cascades", "virtual_map", "trapezoidal", "rbsm", "perspective_warp"};
    const auto best = [&](const char* base, double motion, double distance, double recorded, double texel) {
        const Engine engine = bound(parsed(shippedRuleBase(base)));
        Inference inference = engine.makeInference();
        engine.evaluate(std::vector<double>{0, motion, distance, 0.9, 5.5, 0.0, 0.2, 0.3, recorded, kNoPenumbra, texel},
                        inference);
        return bestOf(inference, all);
    };
    for (const double motion : {0.0, 1.0}) {
        CAPTURE(motion);
        CHECK(best("default", motion, 80.0, 0.0, kCoarse) == "virtual_map");
        CHECK(best("default", motion, 5.0, 1.0, kCoarse) == "virtual_map");
        CHECK(best("default", motion, 80.0, 0.0, kFine) == "shadow_map");
        CHECK(best("default", motion, 5.0, 1.0, kFine) == "shadow_map");
        CHECK(best("default", motion, 5.0, 1.0, std::numeric_limits<double>::quiet_NaN()) == "shadow_map");
        CHECK(best("quality", motion, 80.0, 0.0, kCoarse) == "virtual_map");
    }
    CHECK(best("battery", 0.0, 5.0, 0.0, kCoarse) == "virtual_map");
    CHECK(best("battery", 0.0, 5.0, 0.0, kFine) == "shadow_map");
    CHECK(best("battery", 1.0, 5.0, 0.0, kCoarse) == "shadow_map"); // drawn again
}

TEST_CASE("the shipped rule bases are found by name, and nothing else is")
{
    CHECK(shippedRuleBases().size() == 4);
    CHECK(shippedRuleBases()[0].name == "default");
    CHECK(shippedRuleBase("nonesuch").empty());
}
