#pragma once

/// A bound rule base in the text format of fuzzylite (FLL, version 6), so that another engine can be asked for a second
/// opinion. Everything that inference has is written with what FLL has:
///
///     concepts, `otherwise`      output variables that later rule blocks ask for
///     aggregation `sum`          an output variable with BoundedSum, asked for by a last block
///     priorities                 one such variable per rule, and `not` of the contrary ones
///     `not (...)`                pushed inwards; FLL negates single terms only
///
/// Not written: vetoes, which are no terms, and the policy. Bases whose suitability has terms without width are not
/// written at all.

#include <cstdint>
#include <string>

#include "rules/engine/engine.hpp"

namespace gnomon::rules {

struct FllResult {
    std::string text;    ///< Empty where there is none;
    std::string missing; ///< what FLL cannot say then.
};

/// `resolution` is that of the centroid, which FLL only samples. Input variables have the order of
/// RuleBase::variables; the engine's outputs come first among the output variables.
FllResult exportFll(const Engine& engine, uint32_t resolution);

} // namespace gnomon::rules
