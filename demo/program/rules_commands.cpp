// `gnomon lint` and `gnomon explain`: the rule engine alone, no device needed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "demo/io/file.hpp"
#include "demo/io/number.hpp"
#include "demo/program/checks.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/json.hpp"
#include "demo/program/rule_support.hpp"
#include "demo/program/session.hpp"
#include "demo/replay/trace.hpp"
#include "rules/engine/explain.hpp"
#include "rules/engine/export_fll.hpp"
#include "rules/engine/lint.hpp"
#include "runtime/select/facts.hpp"
#include "runtime/select/frame_plan.hpp"
#ifdef GNOMON_WITH_YAML
#include "rules/yaml/presets.hpp"
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

namespace {

rules::ParseResult readRules(const RuleText& text)
{
#ifdef GNOMON_WITH_YAML
    rules::ParseResult parsed = rules::parseRuleBase(text.text, text.name, text.preset);
    if (parsed.remains) { // what else is to be corrected
        rules::BindResult bound = rules::Engine::bind(std::move(*parsed.remains), runtimeVocabulary().view());
        std::move(bound.diagnostics.begin(), bound.diagnostics.end(), std::back_inserter(parsed.diagnostics));
    }
    return parsed;
#else
    throw HostError(text.name + ": this build reads no rule bases (GNOMON_WITH_YAML is off)");
#endif
}

std::string jsonOf(const std::vector<rules::Diagnostic>& findings)
{
    std::string out = "[";
    for (const rules::Diagnostic& finding : findings) {
        out += out.size() > 1 ? ",\n " : "";
        out += "{\"file\": " + jsonString(finding.file) + ", \"line\": " + std::to_string(finding.line) +
               ", \"column\": " + std::to_string(finding.column) + ", \"severity\": \"" +
               (finding.severity == rules::Severity::Error ? "error" : "warning") +
               "\", \"id\": " + jsonString(finding.id) + ", \"message\": " + jsonString(finding.message) + "}";
    }
    return out + "]\n";
}

} // namespace

rules::RuleBase parseRules(const std::string& nameOrPath)
{
    const RuleText text = valueOf(findRules(nameOrPath));
    rules::ParseResult parsed = readRules(text);
    report(parsed.diagnostics);
    if (!parsed) throw HostError(text.name + ": not a usable rule base");
    return std::move(*parsed.base);
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

/// What facts of a unit can be; none is negative.
struct FactRange {
    std::string_view unit;
    double high;
    bool isWhole = false;
};
constexpr FactRange kFactRanges[] = {
    {"count", 65536.0, true},                                       // lights: a view may have more than are drawn
    {"share", 1.0},           {"flag", 1.0, true}, {"m", 1e6},      // beyond, a float's step is a sixteenth of a metre
    {"log10", 12.0},                                                // a million million triangles
    {"ratio", 1000.0},        {"Hz", 10000.0},     {"px", 65536.0}, // wider than any picture
};

/// What no scene can have is a slip: per cent in place of a share, say.
void requireInRange(const rules::FactInfo& fact, double value, const std::string& item)
{
    const auto range = std::find_if(std::begin(kFactRanges), std::end(kFactRanges),
                                    [&](const FactRange& known) { return known.unit == fact.unit; });
    if (range == std::end(kFactRanges)) return;
    const bool isWhole = !range->isWhole || value == std::floor(value);
    if (value >= 0.0 && value <= range->high && isWhole) return;
    std::string high, hundredth;
    appendFixed(high, range->high, 0);
    appendNumber(hundredth, value / 100.0);
    const bool isPercent = fact.unit == "share" && value > 1.0 && value <= 100.0;
    throw HostError("--facts: '" + item + "' is out of range: " + fact.name + " is a " +
                    (range->isWhole ? "whole number" : "number") + " from 0 to " + high + " (" + fact.unit + ")" +
                    (isPercent ? "; for per cent write " + hundredth : ""));
}

} // namespace

std::vector<double> parseFacts(const std::string& text, const RuleVocabulary& vocabulary)
{
    std::vector<double> values(vocabulary.facts.size(), std::numeric_limits<double>::quiet_NaN());
    for (const std::string& item : parseNames(text)) {
        const size_t equals = item.find('=');
        const std::string name(trimmed(std::string_view(item).substr(0, equals)));
        const auto found = std::find_if(vocabulary.facts.begin(), vocabulary.facts.end(),
                                        [&name](const rules::FactInfo& fact) { return fact.name == name; });
        if (found == vocabulary.facts.end()) {
            std::vector<std::string_view> known;
            for (const rules::FactInfo& fact : vocabulary.facts)
                known.push_back(fact.name);
            throw HostError("--facts: no fact '" + name + "'" + rules::suggestion(name, known));
        }
        const std::optional<double> value = equals == std::string::npos
                                                ? std::nullopt
                                                : parseNumber(trimmed(std::string_view(item).substr(equals + 1)));
        if (!value) throw HostError("--facts: '" + item + "' is not name=number");
        const auto fact = static_cast<size_t>(found - vocabulary.facts.begin());
        if (!std::isnan(values[fact])) throw HostError("--facts: '" + name + "' is given twice");
        requireInRange(*found, *value, item);
        values[fact] = *value;
    }
    return values;
}

namespace {

/// What is wrong with the base as one of its presets changes it, and not with the base.
void lintPresets(const RuleText& text, const rules::RuleBase& base, const RuleVocabulary& vocabulary,
                 std::vector<rules::Diagnostic>& findings)
{
#ifdef GNOMON_WITH_YAML
    if (!text.preset.empty()) return; // that one is what was looked at
    for (const rules::Preset& preset : base.presets) {
        const rules::ParseResult changed = rules::parseRuleBase(text.text, text.name, preset.name);
        if (changed) rules::addNew(findings, rules::lint(*changed.base, vocabulary.view()), preset.name);
    }
#else
    (void)text, (void)base, (void)vocabulary, (void)findings;
#endif
}

} // namespace

int lintCommand(const LintOptions& options)
{
    const RuleVocabulary vocabulary = runtimeVocabulary();
    const RuleText text = valueOf(findRules(options.rules));
    rules::ParseResult parsed = readRules(text);
    std::vector<rules::Diagnostic>& findings = parsed.diagnostics;
    if (parsed) {
        for (rules::Diagnostic& finding : rules::lint(*parsed.base, vocabulary.view()))
            findings.push_back(std::move(finding));
        lintPresets(text, *parsed.base, vocabulary, findings);
        if (!options.trace.empty())
            for (rules::Diagnostic& finding : lintAlong(options.trace, *parsed.base, vocabulary))
                findings.push_back(std::move(finding));
    }
    bool failed = !parsed || (options.strict && !findings.empty());
    if (options.json) {
        std::printf("%s", jsonOf(findings).c_str());
        failed |= std::any_of(findings.begin(), findings.end(),
                              [](const auto& finding) { return finding.severity == rules::Severity::Error; });
        return failed ? 1 : 0;
    }
    failed |= report(findings);
    if (!parsed) throw HostError(text.name + ": not a usable rule base");
    std::printf("%s: %zu rules, %zu finding%s\n", parsed.base->name.c_str(), parsed.base->rules.size(), findings.size(),
                findings.size() == 1 ? "" : "s");
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

int presetsCommand(const std::string& nameOrPath)
{
    const rules::RuleBase base = parseRules(nameOrPath);
    if (base.presets.empty()) std::printf("%s has no presets\n", base.name.c_str());
    for (const rules::Preset& preset : base.presets)
        std::printf("%-8s %s\n", preset.name.c_str(), preset.about.c_str());
    return 0;
}

int exportFllCommand(const ExportOptions& options)
{
    requireWritable(options.out);
    const rules::BindResult bound = rules::Engine::bind(parseRules(options.rules), runtimeVocabulary().view());
    if (report(bound.diagnostics) || !bound.engine) return 1;
    const rules::FllResult fll = rules::exportFll(*bound.engine, options.resolution);
    if (fll.text.empty()) throw HostError(options.rules + ": FLL cannot say " + fll.missing);
    for (const rules::Rule& rule : bound.engine->base().rules)
        if (std::any_of(rule.consequents.begin(), rule.consequents.end(), [](const auto& c) { return c.isVeto(); }))
            std::fprintf(stderr, "note: rule %s: `never` is not written: FLL has no vetoes\n", rule.id.c_str());
    if (options.out.empty())
        std::printf("%s", fll.text.c_str());
    else
        expect(writeFile(options.out, fll.text));
    return 0;
}

} // namespace gnomon::demo
