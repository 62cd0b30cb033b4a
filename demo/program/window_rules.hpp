#pragma once
// The rule base of a window: exchanged and read again while the scene runs, with what `gnomon lint` finds. What cannot
// be used leaves the last good rules in force.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "demo/program/rule_watch.hpp"
#include "demo/program/session.hpp"
#include "rules/engine/rule_base.hpp"

namespace gnomon::demo {

class WindowRules {
public:
    /// Loads the first rules; throws HostError where they are none. \param rules as findRules() takes it.
    /// \param beforeLoad called before other rules come into force.
    WindowRules(ShadowHost& shadows, const std::string& rules, std::function<void()> beforeLoad);

    /// Between frames: reads a changed file again.
    void poll();
    /// Other rules, as findRules() takes them.
    void choose(const std::string& rules);
    /// The rules in force with another least quality for lights near the eye, until they are read again.
    /// \param quality in [0, 1].
    void setFloorQuality(double quality);

    /// The first rules, the shipped ones and their presets.
    const std::vector<std::string>& names() const noexcept { return names_; }
    const std::string& inForce() const noexcept { return inForce_; }
    /// What is in force; null: no rules, or none that this build reads.
    const rules::RuleBase* base() const noexcept { return base_ ? &*base_ : nullptr; }
    /// Grows whenever rules come into force.
    uint32_t version() const noexcept { return version_; }
    /// Why the last change was refused; empty: it was not.
    const std::string& fault() const noexcept { return fault_.empty() ? watch_.fault() : fault_; }
    /// Of the rules in force, a line each.
    const std::vector<std::string>& findings() const noexcept { return findings_; }

private:
    Status load(const RuleText& text);
    void look(const RuleText& text);

    ShadowHost& shadows_;
    std::function<void()> beforeLoad_;
    RuleWatch watch_;
    std::vector<std::string> names_;
    std::string inForce_, fault_;
    RuleText text_;
    std::optional<rules::RuleBase> base_;
    std::vector<std::string> findings_;
    uint32_t version_ = 0;
};

/// The text with another number behind each `minimumQuality:`, those of presets too. Fails where that does not make it
/// the floor's, as in a text that has none. \param quality in [0, 1].
Outcome<RuleText> withFloorQuality(RuleText text, double quality);

} // namespace gnomon::demo
