#pragma once

/// Findings about a rule base that works but probably not as meant. Ids:
///
///     L01  a name that nobody knows, a unit that does not match                    error, from Engine::bind()
///     L02  a region of facts where no rule speaks about an output, or only weakly  warning, with the region
///     L03  a rule that can never fire, or that a stronger rule makes superfluous   warning
///     L04  two rules that favour and avoid one output at once                      warning
///     L05  two rules that say the same                                             warning
///     L06  terms of a variable that leave a hole, pile up, are out of order, ...   warning
///     L07  an output that is favoured but never wins; ties that only order decides warning
///     L08  a decision that the noise of a fact overturns, along a recorded trace   warning, from lintTrace()
///     L09  a promise under `monotony` that does not hold                           warning, with the facts
///     L10  facts where the floor holds and no output may serve                     warning, with the facts
///     L11  a part of the policy that has no effect without a plan                  warning, from the reader
///
/// Every check is a function `void(const Engine&, DiagnosticSink&)` in lint.cpp's list. As long as terms of a variable
/// leave a hole or are out of order, L02, L07, L09 and L10 are not looked for: they would tell of that alone.

#include <span>
#include <vector>

#include "rules/engine/engine.hpp"

namespace gnomon::rules {

/// Binds `base` and checks it. Diagnostics of binding come first; after an error there, nothing else is checked.
std::vector<Diagnostic> lint(const RuleBase& base, const Vocabulary& vocabulary);

/// The checks alone, on a bound rule base.
std::vector<Diagnostic> lint(const Engine& engine);

/// Facts as a host met them, frame after frame.
struct FactTrace {
    std::span<const double> rows; ///< Engine::facts().size() numbers per frame. NaN is unknown.
    /// One number per fact: how far a measurement strays, in the unit of the fact; 0 is exact. Empty: estimated from
    /// the steps between frames.
    std::span<const double> noise;
    /// Frame of each row, for traces with gaps or of several lights one behind the other: steps are taken between
    /// successive frames only, and findings name them. Empty: 0, 1, 2, ...
    std::span<const uint32_t> frames;
};

/// L08: decisions that noise alone overturns. A decision is the best suitability among each of the base's `kinds`.
std::vector<Diagnostic> lintTrace(const Engine& engine, const FactTrace& trace);

} // namespace gnomon::rules
