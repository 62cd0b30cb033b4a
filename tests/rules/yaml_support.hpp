#pragma once

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "rules/yaml/rule_base_reader.hpp"
#include "rules_support.hpp"

namespace gnomon::rules::test {

/// The facts and methods, as the runtime offers them.
inline const std::vector<FactInfo> kFacts = {
    {"dynamicLights", "count"},   {"lightMotion", "share"}, {"viewerDistance", "m"},        {"screenShare", "share"},
    {"casterTriangles", "log10"}, {"lightRadius", "m"},     {"receiverPlanarity", "share"}, {"frameBudget", "ratio"}};
inline const std::vector<OutputInfo> kMethods = {
    {"ray_traced", {"directional", "spot", "point", "hard", "exact", "cpuGeometry", "rays"}},
    {"shadow_map", {"directional", "spot", "hard", "fixedPenumbra"}},
    {"stencil_volume", {"directional", "spot", "point", "hard", "exact", "cpuGeometry"}},
    {"pcf_hybrid", {"directional", "spot", "point", "hard", "cpuGeometry", "rays"}},
    {"cube_map", {"point", "hard", "fixedPenumbra"}},
    {"dual_paraboloid", {"point", "hard", "fixedPenumbra", "cpuGeometry"}},
    {"chan_durand", {"directional", "spot", "point", "hard", "cpuGeometry"}},
    {"octree_volume", {"directional", "spot", "point", "hard", "exact", "cpuGeometry"}},
    {"all_edges_volume", {"directional", "spot", "point", "hard", "exact", "cpuGeometry"}},
    {"projected_planar", {"directional", "spot", "point", "hard", "cpuGeometry", "planar"}},
    {"mccool", {"directional", "spot", "point", "hard"}},
    {"angular_spans", {"directional", "spot", "point", "hard", "cpuGeometry", "rays"}},
    {"contour_chain", {"directional", "spot", "point", "hard", "cpuGeometry", "rays"}},
    {"penumbra_wedges", {"spot", "point", "hard", "softPenumbra", "cpuGeometry"}},
    {"tile_shafts", {"directional", "spot", "point", "hard", "exact", "cpuGeometry", "rays"}},
    {"conservative_map", {"directional", "spot", "point", "hard", "exact", "cpuGeometry", "rays"}},
    {"conservative_map_adjacency", {"directional", "spot", "point", "hard", "exact", "cpuGeometry", "rays"}},
    {"coherence_sampling", {"directional", "spot", "point", "hard", "softPenumbra", "cpuGeometry", "rays"}},
    {"eight_point_hybrid", {"directional", "spot", "hard", "softPenumbra", "cpuGeometry", "rays"}},
    {"rbsm", {"directional", "spot", "point", "hard", "fixedPenumbra"}},
    {"cascades", {"directional", "hard", "fixedPenumbra"}}};

inline const std::vector<std::string> kTraits = {"directional",  "spot",  "point",       "hard", "fixedPenumbra",
                                                 "softPenumbra", "exact", "cpuGeometry", "rays", "planar"};
inline Vocabulary vocabulary()
{
    return {.facts = kFacts, .outputs = kMethods, .absent = {}, .traits = kTraits};
}

inline std::string readFile(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    REQUIRE_MESSAGE(file.good(), path);
    return {std::istreambuf_iterator<char>(file), {}};
}

inline RuleBase parsed(std::string_view text, std::string_view name = "test.yaml")
{
    ParseResult result = parseRuleBase(text, name);
    for (const Diagnostic& d : result.diagnostics)
        MESSAGE(toText(d));
    REQUIRE(result.base.has_value());
    return std::move(*result.base);
}

inline Engine bound(const RuleBase& base)
{
    BindResult result = Engine::bind(base, vocabulary());
    for (const Diagnostic& d : result.diagnostics)
        MESSAGE(toText(d));
    REQUIRE(result.engine.has_value());
    return std::move(*result.engine);
}

/// The name of the output with the best quantised suitability; the first of equals.
inline std::string winner(const Engine& engine, const Inference& inference)
{
    std::size_t best = 0;
    for (std::size_t i = 1; i < inference.outputs.size(); ++i) {
        if (inference.outputs[i].quantised > inference.outputs[best].quantised) best = i;
    }
    return inference.outputs[best].quantised < 0 ? "nothing" : engine.outputs()[best].name;
}

} // namespace gnomon::rules::test
