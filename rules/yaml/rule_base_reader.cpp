#include "rules/yaml/rule_base_reader.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "rules/engine/sentence.hpp"
#include "rules/yaml/document.hpp"
#include "rules/yaml/presets.hpp"
#include "rules/yaml/rule_base_shape.hpp"
#include "runtime/base/float_mode.hpp"
#include "runtime/base/hash.hpp"
#include "runtime/base/number_text.hpp"

namespace gnomon::rules {
namespace {

using yaml::MapReader;
using yaml::Node;

class Reader {
public:
    /// \param root of the document, or of the document with changes.
    Reader(const yaml::Document& document, const Node& root, DiagnosticSink& sink)
        : document_(document), root_(root), sink_(sink)
    {
    }

    RuleBase read()
    {
        RuleBase base;
        base.suitability = defaultSuitability();
        MapReader map(root_, shapes::kRuleBase, "a rule base", sink_);
        if (const Node* version = map.find("version"); version && yaml::numberOf(*version) != 1.0)
            sink_.error("R05", version->at, "this reader knows version 1 only" + yaml::foundText(*version));
        map.text("name", base.name);
        if (const Node* node = map.find("options")) readOptions(*node, base.options);
        if (const Node* node = map.find("variables")) readVariables(*node, base.variables);
        if (const Node* node = map.find("concepts")) readConcepts(*node, base.concepts);
        if (const Node* node = map.find("suitability")) readVariable("suitability", node->at, *node, base.suitability);
        if (const Node* node = map.find("rules")) readRules(*node, base.rules);
        if (const Node* node = map.find("otherwise")) readOtherwise(*node, base);
        if (const Node* node = map.find("policy")) {
            readPolicy(*node, base.policy);
            if (base.options.allocation == Options::Allocation::None) reportIdle(*node);
        }
        if (const Node* node = map.find("kinds"))
            readWords(*node, "'kinds'", [&](const Node& word) { base.kinds.push_back({word.text, word.at}); });
        if (const Node* node = map.find("monotony")) readMonotony(*node, base.monotony);
        if (const Node* node = map.find("tuned")) readTuned(*node);
        base.presets = readPresets(root_, sink_);
        return base;
    }

private:
    void readOptions(const Node& node, Options& options)
    {
        MapReader map(node, shapes::kOptions, "options", sink_);
        options.conjunction = static_cast<Options::And>(map.word("and", 0));
        map.word("or", 0);
        options.aggregation = static_cast<Options::Aggregation>(map.word("aggregation", 0));
        options.allocation = static_cast<Options::Allocation>(map.word("allocation", 0));
        map.number("minimumStrength", options.minimumStrength);
        map.number("vetoAt", options.vetoAt);
        if (const Node* defuzzifier = map.find("defuzzifier")) readDefuzzifier(*defuzzifier, options);
    }

    void readDefuzzifier(const Node& node, Options& options)
    {
        constexpr std::string_view kSampled = "sampled(";
        constexpr double kFewest = 2, kMost = 100'000;
        if (node.text == "centroid") return;
        std::string_view text = node.text;
        if (text.starts_with(kSampled) && text.ends_with(')')) {
            text = text.substr(kSampled.size(), text.size() - kSampled.size() - 1);
            const std::optional<double> samples = parseNumber(text);
            if (samples && *samples >= kFewest && *samples <= kMost && *samples == static_cast<uint32_t>(*samples)) {
                options.samples = static_cast<uint32_t>(*samples);
                return;
            }
        }
        sink_.error("R05", node.at, "'defuzzifier' must be centroid or sampled(2 to 100000)" + yaml::foundText(node));
    }

    void readVariables(const Node& node, std::vector<Variable>& variables)
    {
        if (node.kind != Node::Kind::Map) {
            sink_.error("R04", node.at, "'variables' must be a map, found " + std::string(kindText(node)));
            return;
        }
        for (const yaml::Entry& entry : node.entries) {
            Variable made;
            readVariable(entry.key, entry.keyAt, entry.value, made);
            variables.push_back(std::move(made));
        }
    }

    void readVariable(const std::string& name, SourceSpot at, const Node& node, Variable& variable)
    {
        variable.name = name;
        variable.at = at;
        MapReader map(node, shapes::kVariable, "variable " + inQuotes(name), sink_);
        if (const Node* universe = map.find("universe")) {
            std::array<double, 2> ends = {};
            if (readNumbers(*universe, "a universe", ends)) {
                variable.low = ends[0];
                variable.high = ends[1];
            }
        }
        map.text("unit", variable.unit);
        if (const Node* terms = map.find("terms")) readTerms(*terms, variable.terms);
    }

    void readTerms(const Node& node, std::vector<Term>& terms)
    {
        terms.clear();
        if (node.kind != Node::Kind::Map)
            sink_.error("R04", node.at,
                        "'terms' must be a map of name: [a, b, c, d], found " + std::string(kindText(node)));
        for (const yaml::Entry& entry : node.entries) {
            std::array<double, 4> corners = {};
            if (readNumbers(entry.value, "a term", corners))
                terms.push_back({entry.key, {corners[0], corners[1], corners[2], corners[3]}, entry.keyAt});
        }
    }

    /// `concepts: {scene: [simple, overlyComplex]}`
    void readConcepts(const Node& node, std::vector<Concept>& concepts)
    {
        if (node.kind != Node::Kind::Map)
            sink_.error("R04", node.at,
                        "'concepts' must be a map of name: [term, ...], found " + std::string(kindText(node)));
        for (const yaml::Entry& entry : node.entries) {
            Concept made{entry.key, {}, entry.keyAt};
            readWords(entry.value, "a concept", [&](const Node& word) { made.terms.push_back({word.text, word.at}); });
            concepts.push_back(std::move(made));
        }
    }

    template <typename Take>
    void readWords(const Node& node, std::string_view what, Take&& take)
    {
        const bool words = std::all_of(node.items.begin(), node.items.end(),
                                       [](const Node& item) { return item.kind == Node::Kind::Scalar; });
        if (node.kind != Node::Kind::Sequence || !words) {
            sink_.error("R04", node.at, std::string(what) + " is a list of words");
            return;
        }
        for (const Node& item : node.items)
            take(item);
    }

    template <std::size_t Count>
    bool readNumbers(const Node& node, std::string_view what, std::array<double, Count>& out)
    {
        if (node.kind != Node::Kind::Sequence || node.items.size() != Count) {
            sink_.error("R04", node.at, std::string(what) + " is a list of " + std::to_string(Count) + " numbers");
            return false;
        }
        for (std::size_t i = 0; i < Count; ++i) {
            const std::optional<double> value = yaml::numberOf(node.items[i]);
            if (!value) {
                sink_.error("R05", node.items[i].at,
                            "not a number: " + (node.items[i].text.empty() ? std::string(kindText(node.items[i]))
                                                                           : inQuotes(node.items[i].text)));
                return false;
            }
            out[i] = *value;
        }
        return true;
    }

    /// Hands a scalar to the sentence parser together with the way back to the file.
    template <typename Parse>
    bool readSentence(const Node& node, Parse&& parse)
    {
        if (node.kind != Node::Kind::Scalar) {
            sink_.error("R04", node.at, "a sentence must be a text, found " + std::string(kindText(node)));
            return false;
        }
        yaml::SpotFinder finder(document_, node);
        return parse(SentenceText{node.text, [&](std::size_t offset) { return finder.spotOf(offset); }});
    }

    void readRules(const Node& node, std::vector<Rule>& rules)
    {
        if (node.kind != Node::Kind::Sequence) {
            sink_.error("R04", node.at, "'rules' must be a list, found " + std::string(kindText(node)));
            return;
        }
        if (node.items.size() > kMaxRules) {
            sink_.error("R07", node.items[kMaxRules].at, "more than " + std::to_string(kMaxRules) + " rules");
            return;
        }
        for (const Node& item : node.items) {
            Rule made;
            made.at = item.at;
            MapReader map(item, shapes::kRule, "a rule", sink_);
            map.text("id", made.id);
            if (made.id.empty()) made.id = std::to_string(rules.size() + 1);
            map.text("because", made.because);
            map.count("priority", made.priority);
            const Node* sentence = map.find("rule");
            if (sentence && readSentence(*sentence, [&](const SentenceText& s) { return parseRule(s, made, sink_); }))
                rules.push_back(std::move(made));
        }
    }

    void readOtherwise(const Node& node, RuleBase& base)
    {
        Rule made;
        made.id = "otherwise";
        if (readSentence(node, [&](const SentenceText& s) { return parseOtherwise(s, made, sink_); }))
            base.otherwise = std::move(made);
    }

    void readMonotony(const Node& node, std::vector<Monotony>& promises)
    {
        constexpr std::size_t kMost = shapes::kMonotony.most;
        readWords(node, "'monotony'", [&](const Node& item) {
            Monotony made;
            if (promises.size() == kMost)
                sink_.error("R07", item.at, "more than " + std::to_string(kMost) + " sentences");
            else if (readSentence(item, [&](const SentenceText& s) { return parseMonotony(s, made, sink_); }))
                promises.push_back(std::move(made));
        });
    }

    void readPolicy(const Node& node, Policy& policy)
    {
        MapReader map(node, shapes::kPolicy, "policy", sink_);
        if (const Node* budget = map.find("budget")) readBudget(*budget, policy.budget);
        if (const Node* floor = map.find("floor")) {
            MapReader part(*floor, shapes::kFloor, "floor", sink_);
            if (const Node* when = part.find("when"))
                readSentence(*when, [&](const SentenceText& s) { return parseCondition(s, policy.floor.when, sink_); });
            part.number("minimumQuality", policy.floor.minimumQuality);
            part.number("oneLightTimes", policy.floor.oneLightTimes);
            part.number("atStrength", policy.floor.atStrength);
        }
        if (const Node* hysteresis = map.find("hysteresis")) {
            MapReader part(*hysteresis, shapes::kHysteresis, "hysteresis", sink_);
            part.number("planGain", policy.hysteresis.planGain);
            part.count("upgradesPerFrame", policy.hysteresis.upgradesPerFrame);
            part.count("flipWindowFrames", policy.hysteresis.flipWindowFrames);
            part.count("flipBanFrames", policy.hysteresis.flipBanFrames);
            part.count("crossFadeFrames", policy.hysteresis.crossFadeFrames);
        }
        if (const Node* probing = map.find("probing")) {
            MapReader part(*probing, shapes::kProbing, "probing", sink_);
            part.count("everyFrames", policy.probing.everyFrames);
            part.number("sigma", policy.probing.sigma);
        }
    }

    /// What only a plan reads, in a base for which none is made: all of `policy` but the length of cross-fades.
    void reportIdle(const Node& policy)
    {
        const auto report = [this](const yaml::Entry& entry) {
            sink_.warning("L11", entry.keyAt,
                          inQuotes(entry.key) + " has no effect without 'allocation: budget': no plan is made");
        };
        for (const yaml::Entry& part : policy.entries) {
            if (part.key != "hysteresis") {
                report(part);
                continue;
            }
            for (const yaml::Entry& entry : part.value.entries)
                if (entry.key != "crossFadeFrames") report(entry);
        }
    }

    void readBudget(const Node& node, Policy::Budget& budget)
    {
        if (node.kind == Node::Kind::Scalar && node.text == shapes::kAutomatic[0]) {
            budget.automatic = true;
            return;
        }
        MapReader part(node, shapes::kBudgetMap, "budget", sink_);
        // Read, as bases carry it, but for nothing: what the rest of a frame takes is not known here.
        double targetFrameMs = 0.0;
        part.number("targetFrameMs", targetFrameMs);
        if (const Node* target = part.find("targetFrameMs"))
            sink_.warning("L11", target->at,
                          "'targetFrameMs' has no effect: a budget comes from the host or 'shadowCapMs'");
        part.number("shadowCapMs", budget.shadowCapMs);
        part.number("headroom", budget.headroom);
    }

    /// Written by a tuner for people to read; checked for shape only.
    void readTuned(const Node& node)
    {
        MapReader map(node, shapes::kTuned, "tuned", sink_);
        std::string ignored;
        for (const yaml::Key& key : shapes::kTuned.allKeys())
            map.text(key.name, ignored);
    }

    const yaml::Document& document_;
    const Node& root_;
    DiagnosticSink& sink_;
};

/// A text and what is read from its document: the base, or the base as a preset changes it.
struct RuleText {
    const yaml::Document& document;
    std::string_view text, fileName;

    ParseResult read(const Node& root, std::string_view preset, DiagnosticSink sink) const
    {
        ParseResult result;
        RuleBase base = Reader(document, root, sink).read();
        base.file = std::string(fileName);
        base.preset = std::string(preset);
        base.textHash = preset.empty() ? hashOfBytes(text) : hashOfBytes(std::string(text) + '\0' + base.preset);
        const bool sound = sink.errorCount() == 0;
        const bool onlySentences = std::all_of(sink.all().begin(), sink.all().end(), [](const Diagnostic& finding) {
            return finding.id == "R06" || finding.severity == Severity::Warning;
        });
        if (onlySentences && validate(base, sink)) (sound ? result.base : result.remains) = std::move(base);
        result.diagnostics = sink.take();
        return result;
    }
};

} // namespace

ParseResult parseRuleBase(std::string_view text, std::string_view fileName, std::string_view preset)
{
    const FloatMode mode; // reading a number rounds
    DiagnosticSink sink(fileName);
    const std::optional<yaml::Document> document = yaml::parse(text, {}, sink);
    if (!document) return {{}, {}, sink.take()};
    const RuleText whole{*document, text, fileName};
    ParseResult result = whole.read(document->root, {}, std::move(sink));
    if (!result.base) return result;
    const std::vector<Preset> presets = result.base->presets;
    for (const Preset& each : presets) {
        DiagnosticSink changes(fileName);
        const Node changed = withPreset(document->root, each.name, changes);
        ParseResult read = whole.read(changed, each.name, std::move(changes));
        addNew(result.diagnostics, std::move(read.diagnostics), each.name);
        if (!read.base) { // a base is refused as a whole
            result.base.reset();
            return result;
        }
        if (each.name != preset) continue;
        result.base = std::move(read.base);
        result.base->presets = presets;
    }
    if (!preset.empty() && result.base->preset != preset) {
        result.diagnostics.push_back(
            {.id = "R05", .file = std::string(fileName), .message = noPreset(preset, *result.base)});
        result.base.reset();
    }
    return result;
}

} // namespace gnomon::rules
