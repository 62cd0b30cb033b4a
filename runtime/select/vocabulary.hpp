#pragma once
// The words rules may use: facts with units, methods with traits, methods left out of this build.
#include <string>
#include <vector>

#include "rules/engine/engine.hpp"
#include "runtime/registry.hpp"

namespace gnomon {

struct RuleVocabulary {
    std::vector<rules::FactInfo> facts;
    std::vector<rules::OutputInfo> outputs; ///< In the order of decisions.
    std::vector<rules::OutputInfo> absent;
    std::vector<std::string> traits;

    /// Facts, traits and absent names; no outputs yet.
    explicit RuleVocabulary(const AlgorithmRegistry& registry);
    void addMethod(std::string name, GnTraits methodTraits);

    rules::Vocabulary view() const { return {.facts = facts, .outputs = outputs, .absent = absent, .traits = traits}; }
};

} // namespace gnomon
