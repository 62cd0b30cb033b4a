#pragma once

/// The grammar of rule sentences.
///
///     sentence    = "if" condition "then" conclusions
///     condition   = conjunction { "or" conjunction }                 -- "and" binds tighter than "or"
///     conjunction = unary { "and" unary }
///     unary       = "not" unary | "(" condition ")" | VARIABLE "is" [ "not" ] TERM { "or" TERM }
///     conclusions = conclusion { "and" conclusion } [ "with" WEIGHT ]
///     conclusion  = [ "any" ] NAME "is" TERM | "others" "are" TERM | "never" [ "any" ] NAME
///
/// VARIABLE may be a concept, and so may the NAME of a conclusion.
/// `x is few or average` is short for `x is few or x is average`. A weight belongs to the whole sentence.

#include <cstddef>
#include <functional>
#include <string_view>

#include "rules/engine/diagnostic.hpp"
#include "rules/engine/rule_base.hpp"

namespace gnomon::rules {

/// A sentence and the way from a byte offset inside it to a place in the file it came from.
struct SentenceText {
    std::string_view text;
    std::function<SourceSpot(std::size_t offset)> spotOf = [](std::size_t offset) {
        return SourceSpot{1, static_cast<uint32_t>(offset + 1)};
    };
};

/// `if ... then ...`. Fills antecedent, consequents, weight and sentence of `rule`. On an error reports R06 at the word
/// at fault, leaves `rule` unchanged and returns false.
bool parseRule(const SentenceText& sentence, Rule& rule, DiagnosticSink& sink);

/// The part after `then` alone, as `otherwise` has it. Vetoes are refused there.
bool parseOtherwise(const SentenceText& sentence, Rule& rule, DiagnosticSink& sink);

/// The part between `if` and `then` alone.
bool parseCondition(const SentenceText& sentence, Antecedent& condition, DiagnosticSink& sink);

/// `("more" | "less") VARIABLE never ("raises" | "lowers") ["any"] NAME`.
bool parseMonotony(const SentenceText& sentence, Monotony& promise, DiagnosticSink& sink);

} // namespace gnomon::rules
