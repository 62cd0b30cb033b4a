#pragma once

/// The checks behind lint(). Each looks at one thing and reports into the sink.

#include <string>
#include <utility>

#include "rules/engine/engine.hpp"

namespace gnomon::rules {

/// Findings of one kind of which a base may have millions: reports the first ones, and at the end how many more there
/// are.
class CappedFindings {
public:
    static constexpr std::size_t kMostReported = 64; ///< More than anybody mends before linting again.

    CappedFindings(std::string_view id, DiagnosticSink& sink) : id_(id), sink_(sink) {}

    /// @param message makes the text, asked only where it is reported
    template <typename Message>
    void warning(SourceSpot at, Message&& message)
    {
        if (count_++ < kMostReported) sink_.warning(id_, at, message());
    }
    void finish()
    {
        if (count_ > kMostReported)
            sink_.warning(id_, {}, std::to_string(count_ - kMostReported) + " more findings of this kind");
    }

private:
    std::string_view id_;
    DiagnosticSink& sink_;
    std::size_t count_ = 0;
};

/// L06, lint_partition.cpp. \return whether the terms of all variables stand as they should
bool checkPartitions(const Engine& engine, DiagnosticSink& sink);
void checkCoverage(const Engine& engine, DiagnosticSink& sink);       ///< L02, lint_coverage.cpp
void checkDeadRules(const Engine& engine, DiagnosticSink& sink);      ///< L03, cannot fire; lint_coverage.cpp
void checkRedundancy(const Engine& engine, DiagnosticSink& sink);     ///< L03 superfluous and L05, lint.cpp
void checkContradictions(const Engine& engine, DiagnosticSink& sink); ///< L04, lint_contradiction.cpp
void checkSamples(const Engine& engine, DiagnosticSink& sink);        ///< L02 weak, L07 and L10, lint_samples.cpp
void checkMonotony(const Engine& engine, DiagnosticSink& sink);       ///< L09, lint_monotony.cpp

} // namespace gnomon::rules
