#pragma once

/// What the kernels of batch evaluation read and write: plain structs and pointers. The kernels are compiled once per
/// instruction set, so nothing here may have inline functions: the linker would keep one copy of each, and a processor
/// without AVX2 might meet the AVX2 one.

#include <stdint.h>

namespace gnomon::rules::batch {

inline constexpr uint32_t kLanes = 8; ///< Situations evaluated at once.

/// A variable and its terms.
struct Axis {
    uint32_t fact, firstTerm, termCount;
    double low, high;
};

/// Flanks of compiled.hpp.
struct Shape {
    double a, perRise, d, perFall;
};

/// One step of an antecedent. An accumulator holds the value under construction; Load puts it aside first.
struct Step {
    enum Kind : uint32_t { Load, LoadNot, AndTerm, AndNotTerm, OrTerm, OrNotTerm, Not, And, Or };
    Kind kind;
    uint32_t row; ///< Of the membership, times kLanes.
};

enum class Antecedent : uint32_t {
    Any,
    Chain, ///< Load, AndTerm, AndTerm, ...
    Four,  ///< A chain of four under the minimum; shorter ones say their last term again, which costs less than a branch.
};

struct Rule {
    uint32_t firstStep, stepCount;
    double weight;
    bool speaks; ///< Concludes something about an output: counts against `otherwise`.
    Antecedent shape;
};

inline constexpr uint32_t kSpokenStep = 4; ///< Speakers are looked at by so many, again to save a branch.

/// Rules that conclude one term of one output.
struct Speakers {
    uint32_t first, count; ///< A multiple of kSpokenStep, filled up with the row behind the last rule, which is zero.
};

/// A rule that concludes term `term` of an output or concept.
struct Entry {
    uint32_t rule, term, priority;
};

/// An output or a concept: who speaks of it, by falling priority.
struct Subject {
    uint32_t firstEntry, entryCount;
    uint32_t firstVeto, vetoCount; ///< Outputs only. Rules by falling index.
    uint32_t membership;           ///< Concepts only.
    uint32_t termCount;
    bool ranked; ///< Entries differ in priority.
};

/// Coefficients of CentroidTerms.
struct Cut {
    double area1, area2, moment1, moment2, moment3, height;
};

struct Program {
    const Axis* axes;
    const Shape* shapes;
    const Step* steps;
    const Rule* rules;        ///< `otherwise` last where there is one.
    const Speakers* speakers; ///< Per output and term. Empty for outputs that a priority matters to: see entries.
    const uint32_t* spoken;   ///< Rules times kLanes, for speakers.
    const uint32_t* order; ///< CompiledRules::steps.
    const Entry* entries;
    const uint32_t* vetoes;
    const Subject* outputs;
    const Subject* concepts;
    const Cut* cuts;     ///< One per term of suitability,
    const Cut* overlaps; ///< and one per pair of neighbours. Both null: the caller takes the centroids itself.
    uint32_t axisCount, ruleCount, orderCount, outputCount, termCount;
    uint32_t firstFloorStep, floorStepCount;
    double threshold, vetoAt, low, high, width, quantum;
    bool product, sum, hasOtherwise;
};

/// Where one block of kLanes situations is worked on. Every array holds rows of kLanes numbers, aligned to 64 bytes.
struct Block {
    const double* facts; ///< One row per fact of the host.
    double* low;         ///< Truth of memberships, lower bound;
    double* high;        ///< upper bound. Used only where a fact is unknown.
    double* strengthLow; ///< One row per rule, and one of zeros.
    double* strengthHigh;
    double* stackLow;
    double* stackHigh;
    double* terms;       ///< One row per output and term of suitability.
    double* suitability; ///< First of a column; outputs are `stride` numbers apart. Not aligned.
    int32_t* quantised;  ///< Likewise. -1 is no opinion.
    uint32_t* vetoRule;  ///< Likewise; written only for outputs that some rule may veto.
    double* floor;       ///< One row.
    uint32_t stride;
    bool unknown; ///< Some fact that matters is NaN.
};

using Kernel = void (*)(const Program&, const Block&);

void runBaseline(const Program& program, const Block& block);
#if GNOMON_BATCH_X86
void runAvx2(const Program& program, const Block& block);
void runAvx512(const Program& program, const Block& block);
#endif

} // namespace gnomon::rules::batch
