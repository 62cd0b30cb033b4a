// `gnomon lint` and `gnomon explain`: the rule engine alone, no device needed.
#include <algorithm>
#include <cstdio>
#include <limits>

#include "demo/io/number.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/session.hpp"
#include "runtime/registry.hpp"
#include "runtime/select/facts.hpp"
#ifdef GNOMON_WITH_YAML
#include "rules/engine/explain.hpp"
#include "rules/engine/lint.hpp"
#include "rules/yaml/rule_base_reader.hpp"
#endif

namespace gnomon::demo {

#ifdef GNOMON_WITH_YAML
namespace {

/// The words the runtime gives to rules: its facts, and the algorithms of this build with their traits.
struct RuntimeVocabulary {
    RuntimeVocabulary()
    {
        for (const FactName& fact : kFactNames)
            facts.push_back({fact.name, fact.unit});
        const AlgorithmRegistry registry = builtinRegistry();
        for (const AlgorithmEntry* entry : registry.entries)
            outputs.push_back({entry->name, traitWords(entry->traits)});
        for (const char* name : registry.absent)
            absent.push_back({name, {}});
        traits = traitWords(GN_TRAIT_MAX_ENUM);
    }

    rules::Vocabulary view() const { return {.facts = facts, .outputs = outputs, .absent = absent, .traits = traits}; }

    std::vector<rules::FactInfo> facts;
    std::vector<rules::OutputInfo> outputs, absent;
    std::vector<std::string> traits;

private:
    // As runtime/select/selector.cpp says them.
    static std::vector<std::string> traitWords(GnTraits bits)
    {
        constexpr std::pair<GnTraitBits, const char*> words[] = {{GN_TRAIT_DIRECTIONAL_BIT, "directional"},
                                                                 {GN_TRAIT_SPOT_BIT, "spot"},
                                                                 {GN_TRAIT_POINT_BIT, "point"},
                                                                 {GN_TRAIT_HARD_BIT, "hard"},
                                                                 {GN_TRAIT_FIXED_PENUMBRA_BIT, "fixedPenumbra"},
                                                                 {GN_TRAIT_SOFT_PENUMBRA_BIT, "softPenumbra"},
                                                                 {GN_TRAIT_EXACT_BIT, "exact"},
                                                                 {GN_TRAIT_CPU_GEOMETRY_BIT, "cpuGeometry"},
                                                                 {GN_TRAIT_RAYS_BIT, "rays"}};
        std::vector<std::string> out;
        for (const auto& [bit, word] : words)
            if (bits & bit) out.emplace_back(word);
        return out;
    }
};

/// Prints findings; true if one of them is an error.
bool report(const std::vector<rules::Diagnostic>& diagnostics)
{
    bool failed = false;
    for (const rules::Diagnostic& diagnostic : diagnostics) {
        std::fprintf(stderr, "%s\n", rules::toText(diagnostic).c_str());
        failed = failed || diagnostic.severity == rules::Severity::Error;
    }
    return failed;
}

rules::RuleBase parse(const std::string& nameOrPath)
{
    const RuleText text = valueOf(findRules(nameOrPath));
    rules::ParseResult parsed = rules::parseRuleBase(text.text, text.name);
    report(parsed.diagnostics);
    if (!parsed) throw HostError(text.name + ": not a usable rule base");
    return std::move(*parsed.base);
}

std::vector<double> parseFacts(const std::string& text, const RuntimeVocabulary& vocabulary)
{
    std::vector<double> values(vocabulary.facts.size(), std::numeric_limits<double>::quiet_NaN());
    for (const std::string& item : parseNames(text)) {
        const size_t equals = item.find('=');
        const std::string name = item.substr(0, equals);
        const auto found = std::find_if(vocabulary.facts.begin(), vocabulary.facts.end(),
                                        [&name](const rules::FactInfo& fact) { return fact.name == name; });
        if (found == vocabulary.facts.end()) {
            std::string known;
            for (const rules::FactInfo& fact : vocabulary.facts)
                known += (known.empty() ? "" : ", ") + fact.name;
            throw HostError("--facts: no fact '" + name + "'; there are " + known);
        }
        const std::optional<double> value =
            equals == std::string::npos ? std::nullopt : parseNumber(std::string_view(item).substr(equals + 1));
        if (!value) throw HostError("--facts: '" + item + "' is not name=number");
        values[static_cast<size_t>(found - vocabulary.facts.begin())] = *value;
    }
    return values;
}

} // namespace

int lintCommand(const std::string& nameOrPath)
{
    const RuntimeVocabulary vocabulary;
    const rules::RuleBase base = parse(nameOrPath);
    const std::vector<rules::Diagnostic> findings = rules::lint(base, vocabulary.view());
    const bool failed = report(findings);
    std::printf("%s: %zu rules, %zu findings\n", base.name.c_str(), base.rules.size(), findings.size());
    return failed ? 1 : 0;
}

int explainCommand(const std::string& nameOrPath, const std::string& facts)
{
    const RuntimeVocabulary vocabulary;
    const std::vector<double> values = parseFacts(facts, vocabulary);
    rules::BindResult bound = rules::Engine::bind(parse(nameOrPath), vocabulary.view());
    if (report(bound.diagnostics) || !bound.engine) return 1;
    rules::Inference inference = bound.engine->makeInference();
    bound.engine->evaluate(values, inference);
    std::printf("%s", rules::explain(*bound.engine, inference, {.because = true}).c_str());
    return 0;
}

#else

int lintCommand(const std::string&)
{
    throw HostError("this build has no rule bases (GNOMON_WITH_YAML is off)");
}

int explainCommand(const std::string&, const std::string&)
{
    throw HostError("this build has no rule bases (GNOMON_WITH_YAML is off)");
}

#endif

} // namespace gnomon::demo
