#pragma once

/// The checks behind lint(). Each looks at one thing and reports into the sink.

#include "rules/engine/engine.hpp"

namespace gnomon::rules {

void checkPartitions(const Engine& engine, DiagnosticSink& sink);     ///< L06, lint_partition.cpp
void checkCoverage(const Engine& engine, DiagnosticSink& sink);       ///< L02, lint_coverage.cpp
void checkDeadRules(const Engine& engine, DiagnosticSink& sink);      ///< L03, cannot fire; lint_coverage.cpp
void checkRedundancy(const Engine& engine, DiagnosticSink& sink);     ///< L03 superfluous and L05, lint.cpp
void checkContradictions(const Engine& engine, DiagnosticSink& sink); ///< L04, lint_contradiction.cpp
void checkSamples(const Engine& engine, DiagnosticSink& sink);        ///< L02 weak, L07 and L10, lint_samples.cpp
void checkMonotony(const Engine& engine, DiagnosticSink& sink);       ///< L09, lint_monotony.cpp

} // namespace gnomon::rules
