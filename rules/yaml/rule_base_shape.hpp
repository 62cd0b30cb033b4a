#pragma once

/// The format of rule bases, as parseRuleBase() reads it. rules/README.md explains the keys.

#include "rules/engine/rule_base.hpp"
#include "rules/yaml/shape.hpp"

namespace gnomon::rules::shapes {

using yaml::Key;
using yaml::Shape;

inline constexpr uint32_t kMaxPromises = 256;
inline constexpr uint32_t kMaxPresets = 16;
inline constexpr double kMostFrames = 1'000'000; ///< Hours, not overflow.
inline constexpr double kMostFadeFrames = 600;   ///< Ten seconds at 60 Hz.
inline constexpr double kMostMilliseconds = 1e6;

// Only one word of each list is not its default.
inline constexpr std::string_view kConjunctions[] = {"min", "product"};
inline constexpr std::string_view kDisjunctions[] = {"max"};
inline constexpr std::string_view kAggregations[] = {"max", "sum"};
inline constexpr std::string_view kAllocations[] = {"none", "budget"};
inline constexpr std::string_view kAutomatic[] = {"auto"};

inline constexpr Shape kVersion = yaml::whole(1, 1);
inline constexpr Shape kAnyNumber = yaml::number({});
inline constexpr Shape kShare = yaml::number({.low = 0.0, .high = 1.0});
inline constexpr Shape kStrength = yaml::number({.low = 0.01, .high = 1.0});
inline constexpr Shape kShareBelow1 = yaml::number({.low = 0.0, .high = 0.99});
inline constexpr Shape kFrames = yaml::whole(0, kMostFrames);
inline constexpr Shape kWords = yaml::list(yaml::kText, 0, UINT32_MAX);

inline constexpr Shape kConjunction = yaml::word(kConjunctions);
inline constexpr Shape kDisjunction = yaml::word(kDisjunctions);
inline constexpr Shape kAggregation = yaml::word(kAggregations);
inline constexpr Shape kAllocation = yaml::word(kAllocations);
inline constexpr Key kOptionKeys[] = {
    {"and", &kConjunction},
    {"or", &kDisjunction},
    {"aggregation", &kAggregation, "of the rules that conclude one term of one output"},
    {"defuzzifier", &yaml::kText, "`centroid`, or `sampled(n)` with n from 2 to 100000"},
    {"allocation", &kAllocation, "`none`: the best suited serves; `budget`: the host plans with `policy`"},
    {"minimumStrength", &kShareBelow1, "weaker rules are silent; default 0"},
    {"vetoAt", &kStrength, "strength from which on `never` holds; default 0.5"},
};
inline constexpr Shape kOptions = yaml::map(kOptionKeys);

inline constexpr Shape kUniverse = yaml::list(kAnyNumber, 2, 2);
inline constexpr Shape kCorners = yaml::list(kAnyNumber, 4, 4);
inline constexpr Shape kTerms = yaml::named(kCorners, kMaxTerms);
inline constexpr Key kVariableKeys[] = {
    {"universe", &kUniverse, "least and greatest value; facts outside count as its nearest edge", true},
    {"unit", &yaml::kText, "`count` means whole numbers"},
    {"terms", &kTerms, "corners [a, b, c, d]: 0 up to a, 1 from b to c, 0 from d on", true},
};
inline constexpr Shape kVariable = yaml::map(kVariableKeys);
inline constexpr Shape kVariables = yaml::named(kVariable, kMaxVariables);
inline constexpr Shape kConcept = yaml::list(yaml::kText, 0, kMaxTerms);
inline constexpr Shape kConcepts = yaml::named(kConcept, kMaxConcepts);

inline constexpr Shape kPriority = yaml::whole(0, kHighestPriority);
inline constexpr Key kRuleKeys[] = {
    {"id", &yaml::kText, "default: the position in the list"},
    {"rule", &yaml::kText, "if CONDITION then CONCLUSIONS [with WEIGHT]", true},
    {"because", &yaml::kText, "a measurement or a source"},
    {"priority", &kPriority, "of rules with different conclusions the lower one yields; default 0"},
};
inline constexpr Shape kRule = yaml::map(kRuleKeys);
inline constexpr Shape kRules = yaml::list(kRule, 0, kMaxRules);
inline constexpr Shape kMonotony = yaml::list(yaml::kText, 0, kMaxPromises);

inline constexpr Shape kMilliseconds = yaml::number({.low = 0.0, .high = kMostMilliseconds});
inline constexpr Shape kTarget = yaml::number({.low = 0.01, .high = kMostMilliseconds});
inline constexpr Key kBudgetKeys[] = {
    {"targetFrameMs", &kTarget, "has no effect"},
    {"shadowCapMs", &kMilliseconds, "the budget where the host gives none or more; 0: no cap"},
    {"headroom", &kShareBelow1, "share of the budget that the plan leaves unused; default 0.02"},
};
inline constexpr Shape kBudgetMap = yaml::map(kBudgetKeys);
inline constexpr Shape kBudgetWord = yaml::word(kAutomatic);
inline constexpr const Shape* kBudgetChoices[] = {&kBudgetWord, &kBudgetMap};
inline constexpr Shape kBudget = yaml::either(kBudgetChoices);
inline constexpr Shape kTimes = yaml::number({.low = 1.0, .high = 100.0});
inline constexpr Key kFloorKeys[] = {
    {"when", &yaml::kText, "a condition, as in rules", true},
    {"minimumQuality", &kShare, "1 / (1 + wrong pixels in per cent); default 0.8"},
    {"oneLightTimes", &kTimes, "one light may be so many times as wrong, where all near ones are not; default 1"},
    {"atStrength", &kStrength, "default 0.5"},
};
inline constexpr Shape kFloor = yaml::map(kFloorKeys);
inline constexpr Shape kFade = yaml::whole(0, kMostFadeFrames);
inline constexpr Key kHysteresisKeys[] = {
    {"planGain", &kShare, "what a change must gain, as a share of what the current method is worth; default 0.02"},
    {"upgradesPerFrame", &kFrames, "default 2"},
    {"flipWindowFrames", &kFrames, "a method that comes back within so many frames is a flip; default 30"},
    {"flipBanFrames", &kFrames, "after which it may not come back for so many; default 120"},
    {"crossFadeFrames", &kFade, "0: changes show at once; default 8"},
};
inline constexpr Shape kHysteresis = yaml::map(kHysteresisKeys);
inline constexpr Shape kSigma = yaml::number({.low = 0.0, .high = 10.0});
inline constexpr Key kProbingKeys[] = {
    {"everyFrames", &kFrames, "0: never; default 60"},
    {"sigma", &kSigma, "standard errors that a trial keeps from the budget; default 2"},
};
inline constexpr Shape kProbing = yaml::map(kProbingKeys);
inline constexpr Key kPolicyKeys[] = {
    {"budget", &kBudget},
    {"floor", &kFloor, "least quality of lights for which the condition holds"},
    {"hysteresis", &kHysteresis},
    {"probing", &kProbing},
};
inline constexpr Shape kPolicy = yaml::map(kPolicyKeys);
inline constexpr Key kTunedKeys[] = {{"by", &yaml::kText}, {"from", &yaml::kText}, {"hash", &yaml::kText}};
inline constexpr Shape kTuned = yaml::map(kTunedKeys);

inline constexpr Shape kOptionsChange = yaml::changeOf(kOptions);
inline constexpr Shape kVariablesChange = yaml::changeOf(kVariables);
inline constexpr Shape kPolicyChange = yaml::changeOf(kPolicy);
inline constexpr Key kPresetKeys[] = {
    {"about", &yaml::kText, "what it is for, in a line"},
    {"options", &kOptionsChange},
    {"variables", &kVariablesChange},
    {"rules", &kRules, "each replaces the rule with its id, or is added"},
    {"without", &kWords, "ids of rules to leave out"},
    {"otherwise", &yaml::kText},
    {"policy", &kPolicyChange},
};
inline constexpr Shape kPreset = yaml::map(kPresetKeys);
inline constexpr Shape kPresets = yaml::named(kPreset, kMaxPresets);

inline constexpr Key kRuleBaseKeys[] = {
    {"version", &kVersion, "of the format", true},
    {"name", &yaml::kText, "for logs"},
    {"options", &kOptions},
    {"variables", &kVariables, "facts of the host, with words for their ranges", true},
    {"concepts", &kConcepts, "what rules conclude about the situation, for other rules to ask"},
    {"suitability", &kVariable, "terms of conclusions; default: avoided, acceptable, favoured"},
    {"rules", &kRules, {}, true},
    {"otherwise", &yaml::kText, "conclusions; fires with 1 - the strongest rule"},
    {"policy", &kPolicy},
    {"kinds", &kWords, "traits: a decision is always among the outputs with one of them"},
    {"monotony", &kMonotony, "promises: more VARIABLE never raises NAME"},
    {"tuned", &kTuned, "written by a tuner"},
    {"presets", &kPresets, "named changes of this base"},
};
inline constexpr Shape kRuleBase = yaml::map(kRuleBaseKeys);

} // namespace gnomon::rules::shapes
