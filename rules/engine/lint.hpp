#pragma once

/// Findings about a rule base that works but probably not as meant. Ids:
///
///     L01  a name that nobody knows, a unit that does not match                    error, from Engine::bind()
///     L02  a region of facts where no rule speaks about an output                  warning, with the region
///     L03  a rule that can never fire, or that a stronger rule makes superfluous   warning
///     L05  two rules that say the same                                             warning
///     L06  terms of a variable that leave a hole, pile up, are out of order, ...   warning
///
/// Every check is a function `void(const Engine&, DiagnosticSink&)` in lint.cpp's list.

#include <vector>

#include "rules/engine/engine.hpp"

namespace gnomon::rules {

/// Binds `base` and checks it. Diagnostics of binding come first; after an error there, nothing else is checked.
std::vector<Diagnostic> lint(const RuleBase& base, const Vocabulary& vocabulary);

/// The checks alone, on a bound rule base.
std::vector<Diagnostic> lint(const Engine& engine);

} // namespace gnomon::rules
