#pragma once

/// A rule base as its author wrote it: names, terms, sentences and where each stands in the text. Nothing is resolved
/// yet; Engine::bind() (engine.hpp) ties the names to the facts and outputs a host really has.
///
/// The engine knows nothing of shadows. It ranks *outputs* by *suitability* from numeric *facts*; what an output is,
/// the host decides.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rules/engine/diagnostic.hpp"
#include "rules/engine/trapezoid.hpp"

namespace gnomon::rules {

/// Limits on what a rule base may hold. Rule files are untrusted, and every structure below is sized from them.
inline constexpr std::size_t kMaxRules = 4096;
inline constexpr std::size_t kMaxVariables = 64;
inline constexpr std::size_t kMaxTerms = 16;           ///< Terms of one variable; sizes fixed arrays in centroid.cpp.
inline constexpr std::size_t kMaxSentenceBytes = 4096; ///< One rule.
inline constexpr std::size_t kMaxNameBytes = 64;
inline constexpr std::size_t kMaxConcepts = 64;
inline constexpr uint32_t kHighestPriority = 9; ///< Of a rule; ten levels are more than an author can keep apart.
inline constexpr double kMaxMagnitude = 1e12;   ///< Of every finite number, so that no product of three overflows.

struct Term {
    std::string name;
    Trapezoid shape;
    SourceSpot at;
};

/// A linguistic variable: a fact with words for its ranges.
struct Variable {
    std::string name;
    double low = 0.0;  ///< Universe. Facts outside count as its nearest edge.
    double high = 1.0; ///< > low.
    std::string unit;  ///< Compared with the host's when both are given. "count" means whole numbers only.
    std::vector<Term> terms;
    SourceSpot at;

    bool isCount() const noexcept { return unit == "count"; }
};

/// Something rules conclude about the situation and other rules ask for: `then scene is overlyComplex`, `if scene is
/// overlyComplex`. Its terms are words without corners; each is as true as the rules that assert it.
struct Concept {
    struct Word {
        std::string name;
        SourceSpot at;
    };
    std::string name;
    std::vector<Word> terms; ///< 1 to kMaxTerms.
    SourceSpot at;
};

/// One element of an antecedent. Antecedents are kept in postfix order: operands first, then their connective.
struct Clause {
    enum class Kind : uint8_t { Is, Not, And, Or };

    Kind kind = Kind::Is;
    std::string variable; ///< Of a variable or a concept. Kind::Is only, like the members below.
    std::string term;
    SourceSpot variableAt;
    SourceSpot termAt;
};
using Antecedent = std::vector<Clause>;

/// One thing a rule concludes.
struct Consequent {
    enum class Kind : uint8_t {
        Output,     ///< `NAME is TERM`; NAME is an output or a concept
        Trait,      ///< `any NAME is TERM`: every output that has the trait
        Others,     ///< `others are TERM`: every output that the sentence does not name, by itself or by trait
        Never,      ///< `never NAME`: a veto
        NeverTrait, ///< `never any NAME`
    };

    Kind kind = Kind::Output;
    std::string name;
    std::string term;
    SourceSpot nameAt;
    SourceSpot termAt;

    bool isVeto() const noexcept { return kind == Kind::Never || kind == Kind::NeverTrait; }
};

struct Rule {
    std::string id;
    std::string sentence;  ///< As written, for people.
    std::string because;   ///< Why the rule is there: a measurement, a source.
    Antecedent antecedent; ///< Empty for `otherwise`.
    std::vector<Consequent> consequents;
    double weight = 1.0;   ///< (0, 1]. Multiplies the strength.
    uint32_t priority = 0; ///< 0..kHighestPriority. Where two rules conclude different terms, the lower one yields.
    SourceSpot at;         ///< Start of the sentence.
};

/// What the author promises and the linter checks: "more casterTriangles never raises stencil_volume".
struct Monotony {
    std::string variable;
    bool ascending = true; ///< `more`; otherwise `less`.
    bool raises = true;    ///< `never raises`; otherwise `never lowers`.
    bool isTrait = false;  ///< `any NAME`.
    std::string name;      ///< Output or trait.
    SourceSpot variableAt;
    SourceSpot nameAt;
    std::string sentence;
};

/// How inference is done. rules/README.md pins every choice.
struct Options {
    enum class And : uint8_t { Min, Product };
    enum class Aggregation : uint8_t {
        Max, ///< A term is as strong as its strongest rule.
        Sum, ///< Strengths of the rules with one conclusion are added, bounded at 1, then the term is cut once.
    };
    enum class Allocation : uint8_t {
        None,   ///< The best suitability wins.
        Budget, ///< The host weighs suitability against cost; see Policy.
    };

    And conjunction = And::Min; ///< `or` is always the maximum.
    Aggregation aggregation = Aggregation::Max;
    uint32_t samples = 0;         ///< 0 is the exact centroid; otherwise its midpoint sum over that many samples.
    double minimumStrength = 0.0; ///< [0, 1). Weaker rules count as silent.
    double vetoAt = 0.5;          ///< (0, 1]. A `never` holds from this strength on.
    Allocation allocation = Allocation::None;
};

/// What the host should do with suitabilities. The engine carries it and acts on none of it.
struct Policy {
    struct Budget {
        bool automatic = false;   ///< `budget: auto`: the host derives the budget from the cheapest acceptable plan.
        double shadowCapMs = 0.0; ///< The budget where the host gives none or more than that; 0: no cap.
        double headroom = 0.02;   ///< [0, 1). Share of the budget left unspent.
    };
    struct Floor {
        Antecedent when;             ///< Empty: no floor.
        double minimumQuality = 0.8; ///< [0, 1].
        double oneLightTimes = 1.0;  ///< [1, 100]. One light may be so many times as wrong, where all near ones are not.
        double atStrength = 0.5;     ///< (0, 1]. The floor holds while `when` is at least this true.
    };
    struct Hysteresis {
        double planGain = 0.02; ///< [0, 1]. What a change must gain, as a share of what the incumbent is worth.
        uint32_t upgradesPerFrame = 2;
        uint32_t flipWindowFrames = 30; ///< A-B-A within this window is a flip,
        uint32_t flipBanFrames = 120;   ///< after which the light does not go back for so long.
        uint32_t crossFadeFrames = 8; ///< A changed choice is shown as a mix with the one before for so long; 0: never.
    };
    struct Probing {
        uint32_t everyFrames = 60; ///< 0 never probes.
        double sigma = 2.0;        ///< Safety distance of a probe from the budget.
    };

    Budget budget;
    Floor floor;
    Hysteresis hysteresis;
    Probing probing;
};

/// A named change of a base that is written in it. What it changes is known to the reader alone.
struct Preset {
    std::string name;
    std::string about;
    SourceSpot at;
};

struct RuleBase {
    std::string name;
    std::string file;      ///< Used in diagnostics only.
    uint64_t textHash = 0; ///< FNV-1a of the text it was read from, and of `preset`; names the base in logs.
    Options options;
    std::vector<Variable> variables;
    std::vector<Concept> concepts;
    Variable suitability; ///< Shared by all outputs. defaultSuitability() unless the text says otherwise.
    std::vector<Rule> rules;
    std::optional<Rule> otherwise; ///< Fires with 1 - strongest rule.
    Policy policy;
    /// Traits of which an output needs one to compete: a decision is always among the outputs with one of them. Empty:
    /// all compete. For the linter, which asks who wins.
    std::vector<Concept::Word> kinds;
    std::vector<Monotony> monotony;
    std::vector<Preset> presets; ///< All that the text has.
    std::string preset;          ///< The one that this is; empty: the base as it stands.
};

/// 0..1 with the terms avoided, acceptable and favoured, which sum to 1 everywhere.
Variable defaultSuitability();

/// True for a word that may name a variable, a term, an output or a trait: a letter or underscore, then letters, digits
/// and underscores, at most kMaxNameBytes, and none of the grammar's own words.
bool isName(std::string_view word) noexcept;

/// Checks everything that can be checked without a host: names, universes, corners, references of rules to variables
/// and terms. Reports with id L01 (references) or R05 (values); true if there was no error.
bool validate(const RuleBase& base, DiagnosticSink& sink);

} // namespace gnomon::rules
