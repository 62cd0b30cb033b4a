// `gnomon lint` and `gnomon explain`: the rule engine alone, no device needed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "demo/io/file.hpp"
#include "demo/io/number.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/rule_support.hpp"
#include "demo/program/session.hpp"
#include "demo/replay/trace.hpp"
#include "rules/engine/explain.hpp"
#include "rules/engine/lint.hpp"
#include "runtime/select/facts.hpp"
#include "runtime/select/frame_plan.hpp"
#ifdef GNOMON_WITH_YAML
#include "rules/yaml/rule_base_reader.hpp"
#endif

namespace gnomon::demo {

RuleVocabulary runtimeVocabulary()
{
    const AlgorithmRegistry registry = builtinRegistry();
    RuleVocabulary vocabulary(registry);
    for (const BuiltinAlgorithm& algorithm : registry.algorithms) {
        const AlgorithmEntry* entry = algorithm.entry;
        vocabulary.addMethod(entry->name, entry->traits);
        Method method; // as every context has it until told otherwise
        method.entry = entry;
        for (const SettingSpec& setting : entry->settings)
            method.settings.push_back(setting.standard);
        method.noteSettings();
        vocabulary.outputs.back().quality = double{qualityOf(method, {})};
    }
    return vocabulary;
}

bool report(const std::vector<rules::Diagnostic>& diagnostics)
{
    bool failed = false;
    for (const rules::Diagnostic& diagnostic : diagnostics) {
        std::fprintf(stderr, "%s\n", rules::toText(diagnostic).c_str());
        failed = failed || diagnostic.severity == rules::Severity::Error;
    }
    return failed;
}

rules::RuleBase parseRules(const std::string& nameOrPath, size_t* findings)
{
#ifdef GNOMON_WITH_YAML
    const RuleText text = valueOf(findRules(nameOrPath));
    rules::ParseResult parsed = rules::parseRuleBase(text.text, text.name);
    report(parsed.diagnostics);
    if (findings) *findings = parsed.diagnostics.size();
    if (!parsed) throw HostError(text.name + ": not a usable rule base");
    return std::move(*parsed.base);
#else
    (void)findings;
    throw HostError(nameOrPath + ": this build reads no rule bases (GNOMON_WITH_YAML is off)");
#endif
}

namespace {

/// L08: the rules on what every light of a recorded trace met, one light behind the other.
std::vector<rules::Diagnostic> lintAlong(const std::string& file, const rules::RuleBase& base,
                                         const RuleVocabulary& vocabulary)
{
    const Outcome<Trace> read = readTrace(valueOf(readText(file)));
    if (!read) throw HostError(file + ": " + read.error());
    const Trace& trace = *read;
    const rules::BindResult bound = rules::Engine::bind(base, vocabulary.view());
    if (!bound.engine) return {};     // the findings of lint() say why
    std::vector<std::size_t> columns; // of the trace, per fact of the vocabulary; its count where there is none
    for (const rules::FactInfo& fact : vocabulary.facts)
        columns.push_back(static_cast<std::size_t>(std::find(trace.facts.begin(), trace.facts.end(), fact.name) -
                                                   trace.facts.begin()));
    std::vector<double> rows;
    std::vector<std::uint32_t> frames;
    for (std::uint32_t light = 0; light < trace.lights; ++light) {
        for (std::uint32_t frame = 0; frame < trace.frames; ++frame) {
            const std::size_t cell = trace.cell(frame, light);
            if (!trace.lightStates[cell].present) continue;
            const float* const values = trace.factValues.data() + cell * trace.facts.size();
            for (const std::size_t column : columns)
                rows.push_back(column < trace.facts.size() ? double{values[column]}
                                                           : std::numeric_limits<double>::quiet_NaN());
            frames.push_back(frame);
        }
    }
    return rules::lintTrace(*bound.engine, {.rows = rows, .noise = {}, .frames = frames});
}

std::vector<double> parseFacts(const std::string& text, const RuleVocabulary& vocabulary)
{
    std::vector<double> values(vocabulary.facts.size(), std::numeric_limits<double>::quiet_NaN());
    for (const std::string& item : parseNames(text)) {
        const size_t equals = item.find('=');
        const std::string name(trimmed(std::string_view(item).substr(0, equals)));
        const auto found = std::find_if(vocabulary.facts.begin(), vocabulary.facts.end(),
                                        [&name](const rules::FactInfo& fact) { return fact.name == name; });
        if (found == vocabulary.facts.end()) {
            std::string known;
            for (const rules::FactInfo& fact : vocabulary.facts)
                known += (known.empty() ? "" : ", ") + fact.name;
            throw HostError("--facts: no fact '" + name + "'; there are " + known);
        }
        const std::optional<double> value = equals == std::string::npos
                                                ? std::nullopt
                                                : parseNumber(trimmed(std::string_view(item).substr(equals + 1)));
        if (!value) throw HostError("--facts: '" + item + "' is not name=number");
        const auto fact = static_cast<size_t>(found - vocabulary.facts.begin());
        if (!std::isnan(values[fact])) throw HostError("--facts: '" + name + "' is given twice");
        values[fact] = *value;
    }
    return values;
}

} // namespace

int lintCommand(const std::string& nameOrPath, const std::string& trace)
{
    const RuleVocabulary vocabulary = runtimeVocabulary();
    size_t whileReading = 0;
    const rules::RuleBase base = parseRules(nameOrPath, &whileReading);
    std::vector<rules::Diagnostic> findings = rules::lint(base, vocabulary.view());
    if (!trace.empty())
        for (rules::Diagnostic& finding : lintAlong(trace, base, vocabulary))
            findings.push_back(std::move(finding));
    const bool failed = report(findings);
    std::printf("%s: %zu rules, %zu findings\n", base.name.c_str(), base.rules.size(), whileReading + findings.size());
    return failed ? 1 : 0;
}

int explainCommand(const std::string& nameOrPath, const std::string& facts)
{
    const RuleVocabulary vocabulary = runtimeVocabulary();
    const std::vector<double> values = parseFacts(facts, vocabulary);
    rules::BindResult bound = rules::Engine::bind(parseRules(nameOrPath), vocabulary.view());
    if (report(bound.diagnostics) || !bound.engine) return 1;
    rules::Inference inference = bound.engine->makeInference();
    bound.engine->evaluate(values, inference);
    std::printf("%s", rules::explain(*bound.engine, inference, {.because = true}).c_str());
    return 0;
}

} // namespace gnomon::demo
