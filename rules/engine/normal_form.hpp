#pragma once

/// Antecedents as alternatives of conjunctions, for checks that compare rules with each other.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rules/engine/compiled.hpp"

namespace gnomon::rules {

/// A clause with its sign: membership index * 2, plus 1 under `not`.
using Literal = uint32_t;
using Conjunction = std::vector<Literal>; ///< Sorted.

/// An antecedent as alternatives of conjunctions, sorted, without alternatives that another one covers. Minimum,
/// maximum and 1 - x form a De Morgan algebra, so antecedents with one normal form have one strength everywhere; the
/// converse does not hold, and need not for a warning.
using NormalForm = std::vector<Conjunction>;

/// Nothing for antecedents with more than 64 alternatives, and for a negated compound under the product.
std::optional<NormalForm> normalFormOf(std::span<const CompiledOp> ops, Options::And conjunction);

/// Everywhere at most as strong: each alternative asks for all that some alternative of the other asks for.
bool isWeaker(const NormalForm& form, const NormalForm& than);

} // namespace gnomon::rules
