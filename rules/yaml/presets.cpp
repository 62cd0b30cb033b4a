#include "rules/yaml/presets.hpp"

#include <algorithm>

#include "rules/yaml/rule_base_shape.hpp"

namespace gnomon::rules {
namespace {

using yaml::Entry;
using yaml::Node;

Node* findIn(Node& map, std::string_view key)
{
    const auto found = std::ranges::find(map.entries, key, &Entry::key);
    return found == map.entries.end() ? nullptr : &found->value;
}

std::string_view idOf(const Node& rule)
{
    const Node* id = rule.find("id");
    return id && id->kind == Node::Kind::Scalar ? std::string_view(id->text) : std::string_view();
}

void change(Node& base, const Node& by)
{
    if (base.kind != Node::Kind::Map || by.kind != Node::Kind::Map) {
        base = by;
        return;
    }
    for (const Entry& entry : by.entries) {
        if (Node* mine = findIn(base, entry.key))
            change(*mine, entry.value);
        else
            base.entries.push_back(entry);
    }
}

void changeRules(Node& rules, const Node& by)
{
    for (const Node& rule : by.items) {
        const std::string_view id = idOf(rule);
        const auto same = std::ranges::find(rules.items, id, idOf);
        if (!id.empty() && same != rules.items.end())
            *same = rule;
        else
            rules.items.push_back(rule);
    }
}

void leaveOut(Node& rules, const Node& without, DiagnosticSink& sink)
{
    for (const Node& id : without.items) {
        const auto found = std::ranges::find(rules.items, std::string_view(id.text), idOf);
        if (found != rules.items.end()) {
            rules.items.erase(found);
            continue;
        }
        std::vector<std::string_view> known;
        for (const Node& rule : rules.items)
            known.push_back(idOf(rule));
        sink.error("R05", id.at,
                   "'without' names no rule of the base: " + inQuotes(id.text) + suggestion(id.text, known));
    }
}

Preset readPreset(const Entry& entry, DiagnosticSink& sink)
{
    Preset preset{entry.key, {}, entry.keyAt};
    if (!isName(entry.key)) sink.error("R05", entry.keyAt, inQuotes(entry.key) + " cannot name a preset");
    // Options, variables and policy are read with the base.
    yaml::MapReader map(entry.value, shapes::kPreset, "preset " + inQuotes(entry.key), sink);
    map.text("about", preset.about);
    if (const Node* rules = map.find("rules"); rules && rules->kind != Node::Kind::Sequence)
        sink.error("R04", rules->at, "'rules' must be a list, found " + std::string(kindText(*rules)));
    if (const Node* without = map.find("without")) {
        const auto isWord = [](const Node& item) { return item.kind == Node::Kind::Scalar; };
        if (without->kind != Node::Kind::Sequence || !std::ranges::all_of(without->items, isWord))
            sink.error("R04", without->at, "'without' is a list of ids of rules");
    }
    return preset;
}

} // namespace

std::vector<Preset> readPresets(const Node& root, DiagnosticSink& sink)
{
    constexpr std::size_t kMost = shapes::kPresets.most;
    std::vector<Preset> presets;
    const Node* node = root.find("presets");
    if (!node) return presets;
    if (node->kind != Node::Kind::Map)
        sink.error("R04", node->at, "'presets' must be a map of name: changes, found " + std::string(kindText(*node)));
    if (node->entries.size() > kMost)
        sink.error("R07", node->entries[kMost].keyAt, "more than " + std::to_string(kMost) + " presets");
    else
        for (const Entry& entry : node->entries)
            presets.push_back(readPreset(entry, sink));
    return presets;
}

Node withPreset(const Node& root, std::string_view name, DiagnosticSink& sink)
{
    Node changed = root;
    std::erase_if(changed.entries, [](const Entry& entry) { return entry.key == "presets"; });
    for (const Entry& entry : root.find("presets")->find(name)->entries) {
        Node* rules = findIn(changed, "rules");
        if (entry.key == "about") continue;
        if (entry.key == "rules" && rules)
            changeRules(*rules, entry.value);
        else if (entry.key == "without" && rules)
            leaveOut(*rules, entry.value, sink);
        else if (Node* mine = findIn(changed, entry.key))
            change(*mine, entry.value);
        else
            changed.entries.push_back(entry);
    }
    return changed;
}

void addNew(std::vector<Diagnostic>& findings, std::vector<Diagnostic> more, std::string_view preset)
{
    const std::size_t before = findings.size();
    for (Diagnostic& finding : more) {
        const bool known = std::any_of(
            findings.begin(), findings.begin() + static_cast<std::ptrdiff_t>(before), [&](const Diagnostic& other) {
                return other.id == finding.id && other.line == finding.line && other.column == finding.column &&
                       (other.line != 0 || other.message == finding.message);
            });
        if (known) continue;
        finding.message += " (with preset " + inQuotes(preset) + ")";
        findings.push_back(std::move(finding));
    }
}

std::string noPreset(std::string_view name, const RuleBase& base)
{
    std::string message = "there is no preset " + inQuotes(name);
    if (base.presets.empty()) return message + ": the rule base has none";
    std::vector<std::string_view> known;
    for (const Preset& preset : base.presets)
        known.push_back(preset.name);
    return message + suggestion(name, known);
}

} // namespace gnomon::rules
