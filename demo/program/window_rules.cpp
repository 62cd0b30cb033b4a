#include "demo/program/window_rules.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "demo/io/number.hpp"
#include "demo/program/rule_support.hpp"
#include "rules/engine/lint.hpp"
#ifdef GNOMON_WITH_YAML
#include "rules/yaml/rule_base_reader.hpp"
#include "rules/yaml/shipped.hpp"
#endif

namespace gnomon::demo {
namespace {

/// Nothing where this build reads none, or the text is none.
std::optional<rules::RuleBase> parsed([[maybe_unused]] const RuleText& text)
{
#ifdef GNOMON_WITH_YAML
    return rules::parseRuleBase(text.text, text.name, text.preset).base;
#else
    return std::nullopt;
#endif
}

std::vector<std::string> shippedWithPresets()
{
    std::vector<std::string> names;
#ifdef GNOMON_WITH_YAML
    for (const rules::ShippedRuleBase& shipped : rules::shippedRuleBases()) {
        names.emplace_back(shipped.name);
        if (const auto base = parsed({std::string(shipped.text), names.back(), {}}))
            for (const rules::Preset& preset : base->presets)
                names.push_back(std::string(shipped.name) + ':' + preset.name);
    }
#endif
    return names;
}

} // namespace

Outcome<RuleText> withFloorQuality(RuleText text, double quality)
{
    constexpr std::string_view key = "minimumQuality:";
    std::string number;
    appendFixed(number, quality, 3);
    for (size_t at = text.text.find(key); at != std::string::npos; at = text.text.find(key, at)) {
        at = text.text.find_first_not_of(' ', at + key.size());
        if (at == std::string::npos) break;
        const size_t end = std::min(text.text.find_first_not_of("0123456789.+-eE", at), text.text.size());
        text.text.replace(at, end - at, number);
    }
    const auto base = parsed(text);
    if (!base || base->policy.floor.when.empty() || std::abs(base->policy.floor.minimumQuality - quality) > 0.001)
        return Outcome<RuleText>::failure(text.label() + ": there is no `minimumQuality` of a floor to change");
    return text;
}

WindowRules::WindowRules(ShadowHost& shadows, const std::string& rules, std::function<void()> beforeLoad)
    : shadows_(shadows), beforeLoad_(std::move(beforeLoad)), watch_(rules), // before they are read: a change is seen
      names_(shippedWithPresets())
{
    const RuleText text = valueOf(findRules(rules));
    if (text.name.empty()) return;
    expect(load(text));
    if (std::find(names_.begin(), names_.end(), text.label()) == names_.end())
        names_.insert(names_.begin(), text.label());
}

Status WindowRules::load(const RuleText& text)
{
    if (const Status loaded = shadows_.loadRules(text.text, text.name, text.preset); !loaded) return loaded;
    look(text);
    return Done{};
}

/// At rules that have come into force.
void WindowRules::look(const RuleText& text)
{
    text_ = text;
    inForce_ = text.label();
    fault_.clear();
    ++version_;
    base_ = parsed(text);
    findings_.clear();
    if (!base_) return;
    for (const rules::Diagnostic& finding : rules::lint(*base_, runtimeVocabulary().view()))
        if (finding.severity == rules::Severity::Warning) // the runtime found no error: a plug-in may bring names
            findings_.push_back(rules::toText(finding));
}

void WindowRules::poll()
{
    const std::string before = watch_.fault();
    if (auto text = watch_.poll(shadows_, beforeLoad_)) look({std::move(*text), text_.name, text_.preset});
    if (watch_.fault() != before) fault_.clear(); // the newer one counts
}

void WindowRules::choose(const std::string& rules)
{
    RuleWatch watch(rules);
    const Outcome<RuleText> text = findRules(rules);
    if (text) beforeLoad_();
    const Status loaded = text ? load(*text) : Status::failure(text.error());
    if (loaded)
        watch_ = std::move(watch);
    else
        fault_ = loaded.error();
}

void WindowRules::setFloorQuality(double quality)
{
    const Outcome<RuleText> text = withFloorQuality(text_, quality);
    if (text) beforeLoad_();
    if (const Status loaded = text ? load(*text) : Status::failure(text.error()); !loaded) fault_ = loaded.error();
}

} // namespace gnomon::demo
