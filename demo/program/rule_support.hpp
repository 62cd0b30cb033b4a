#pragma once
// Rule bases without a device: the words the runtime knows, reading with findings, and rules over a trace.

#include <string>
#include <vector>

#include "demo/replay/trace.hpp"
#include "rules/engine/diagnostic.hpp"
#include "rules/engine/rule_base.hpp"
#include "runtime/select/vocabulary.hpp"

namespace gnomon::demo {

/// Facts and built-in methods, with the settings every context starts with.
RuleVocabulary runtimeVocabulary();

/// Prints findings; true if one of them is an error.
bool report(const std::vector<rules::Diagnostic>& diagnostics);

/// A path or the name of a shipped one; prints findings. Throws HostError if it cannot be used.
rules::RuleBase parseRules(const std::string& nameOrPath);

/// "name=value,..." as numbers in the order of the vocabulary's facts; NaN: not given. Throws HostError naming what is
/// no fact, or no value of it.
std::vector<double> parseFacts(const std::string& text, const RuleVocabulary& vocabulary);

/// Asks the rules again for every light of every frame, from the recorded facts: suitabilities, vetoes, near floors.
/// Methods that were unable stay so. Throws HostError if the rules do not bind.
/// @return What the trace does not hold, though the rules would have liked it best for a light that it can serve.
std::vector<std::string> applyRules(Trace& trace, const rules::RuleBase& base);

/// applyRules(), which prints what the trace does not hold.
void applyRulesAloud(Trace& trace, const rules::RuleBase& base);

} // namespace gnomon::demo
