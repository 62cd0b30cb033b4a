#pragma once

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "rules/yaml/rule_base_reader.hpp"
#include "rules_support.hpp"
#include "runtime/registry.hpp"
#include "runtime/select/vocabulary.hpp"

namespace gnomon::rules::test {

/// The facts and methods, as the runtime offers them.
inline const std::vector<FactInfo> kFacts = {
    {"dynamicLights", "count"},   {"lightMotion", "share"}, {"viewerDistance", "m"},        {"screenShare", "share"},
    {"casterTriangles", "log10"}, {"lightRadius", "m"},     {"receiverPlanarity", "share"}, {"frameBudget", "ratio"},
    {"recorded", "flag"},         {"penumbraPixels", "px"}, {"texelPixels", "px"}};
inline const RuleVocabulary kBuiltIn = [] {
    const AlgorithmRegistry registry = builtinRegistry();
    RuleVocabulary words(registry);
    for (const BuiltinAlgorithm& algorithm : registry.algorithms)
        words.addMethod(algorithm.entry->name, algorithm.entry->traits);
    return words;
}();
inline const std::vector<OutputInfo>& kMethods = kBuiltIn.outputs;

inline std::size_t placeOf(std::string_view method)
{
    const auto found = std::ranges::find(kMethods, method, &OutputInfo::name);
    REQUIRE(found != kMethods.end());
    return static_cast<std::size_t>(found - kMethods.begin());
}
inline Vocabulary vocabulary()
{
    return {.facts = kFacts, .outputs = kMethods, .absent = kBuiltIn.absent, .traits = kBuiltIn.traits};
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
