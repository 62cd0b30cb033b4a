// The arithmetic of Engine::evaluate() on kLanes situations at once, operation for operation, so that every lane has
// the bits of the scalar engine. Included by one file per instruction set, which defines GNOMON_LANE_BYTES, the size of
// the processor's registers: wider vectors would be split by the compiler, slower than none. Everything is local to the
// file that includes it; see batch_program.hpp.

#include "rules/engine/batch_program.hpp"

namespace gnomon::rules::batch {
namespace {

using Vector = double __attribute__((vector_size(GNOMON_LANE_BYTES)));
using Ints = int32_t __attribute__((vector_size(GNOMON_LANE_BYTES / 2)));
constexpr unsigned kParts = kLanes * sizeof(double) / GNOMON_LANE_BYTES;

struct Lanes {
    Vector part[kParts];
};

#define GNOMON_INLINE inline __attribute__((always_inline))

GNOMON_INLINE Lanes load(const double* row)
{
    Lanes lanes;
    for (unsigned i = 0; i < kParts; ++i)
        lanes.part[i] = reinterpret_cast<const Vector*>(row)[i];
    return lanes;
}

GNOMON_INLINE void store(double* row, const Lanes& lanes)
{
    for (unsigned i = 0; i < kParts; ++i)
        reinterpret_cast<Vector*>(row)[i] = lanes.part[i];
}

/// Part `i` of the caller's columns, which start anywhere.
GNOMON_INLINE void storeLoose(double* column, unsigned i, Vector values)
{
    __builtin_memcpy(column + i * (kLanes / kParts), &values, sizeof values);
}
GNOMON_INLINE void storeTruncated(int32_t* column, unsigned i, Vector values)
{
    const Ints whole = __builtin_convertvector(values, Ints);
    __builtin_memcpy(column + i * (kLanes / kParts), &whole, sizeof whole);
}

template <typename Operation>
GNOMON_INLINE Lanes each(const Lanes& x, Operation operation)
{
    Lanes result;
    for (unsigned i = 0; i < kParts; ++i)
        result.part[i] = operation(x.part[i]);
    return result;
}

template <typename Operation>
GNOMON_INLINE Lanes each(const Lanes& x, const Lanes& y, Operation operation)
{
    Lanes result;
    for (unsigned i = 0; i < kParts; ++i)
        result.part[i] = operation(x.part[i], y.part[i]);
    return result;
}

GNOMON_INLINE Vector all(double value)
{
    return value - Vector{}; // which, unlike a sum, is known to be `value` whatever its sign: nothing is left to compute
}

GNOMON_INLINE Lanes fill(double value)
{
    return each(Lanes{}, [=](Vector) { return all(value); });
}

// As std::min and std::max: of equals the first. No lane is NaN or -0 where these are used.
GNOMON_INLINE Vector lesser(Vector x, Vector y)
{
    return y < x ? y : x;
}
GNOMON_INLINE Vector greater(Vector x, Vector y)
{
    return x < y ? y : x;
}
GNOMON_INLINE Lanes lesser(const Lanes& x, const Lanes& y)
{
    return each(x, y, [](Vector a, Vector b) { return lesser(a, b); });
}
GNOMON_INLINE Lanes greater(const Lanes& x, const Lanes& y)
{
    return each(x, y, [](Vector a, Vector b) { return greater(a, b); });
}
GNOMON_INLINE Lanes complement(const Lanes& x)
{
    return each(x, [](Vector a) { return 1.0 - a; });
}

/// Flanks::membership()
GNOMON_INLINE Vector membership(const Shape& shape, Vector x)
{
    const Vector risen = lesser(all(1.0), (x - shape.a) * shape.perRise);
    return greater(all(0.0), lesser(risen, (shape.d - x) * shape.perFall));
}

template <bool Unknown>
GNOMON_INLINE void fuzzify(const Program& program, const Block& block)
{
    for (uint32_t v = 0; v < program.axisCount; ++v) {
        const Axis& axis = program.axes[v];
        const Shape* const shapes = program.shapes + axis.firstTerm;
        const Lanes given = load(block.facts + axis.fact * kLanes);
        // NaN passes through, as it compares false.
        const Lanes x = each(given, [&](Vector f) { return lesser(greater(f, all(axis.low)), all(axis.high)); });
        double* const low = block.low + axis.firstTerm * kLanes;
        double* const high = block.high + axis.firstTerm * kLanes;
        for (uint32_t t = 0; t < axis.termCount; ++t) {
            const Lanes truth = each(x, [&](Vector at) { return membership(shapes[t], at); });
            if constexpr (Unknown) {
                const auto orIfUnknown = [](double bound) {
                    return [=](Vector m, Vector at) { return at == at ? m : all(bound); };
                };
                store(low + t * kLanes, each(truth, x, orIfUnknown(0.0)));
                store(high + t * kLanes, each(truth, x, orIfUnknown(1.0)));
            } else {
                store(low + t * kLanes, truth);
            }
        }
    }
}

template <bool Unknown>
struct Bounds {
    Lanes low;
};
template <>
struct Bounds<true> {
    Lanes low, high;
};

/// `row` counts numbers, kLanes a row.
template <bool Unknown>
GNOMON_INLINE Bounds<Unknown> rowOf(const double* low, const double* high, uint32_t row)
{
    if constexpr (Unknown)
        return {load(low + row), load(high + row)};
    else
        return {load(low + row)};
}

template <bool Unknown>
GNOMON_INLINE void setRow(double* low, double* high, uint32_t row, const Bounds<Unknown>& value)
{
    store(low + row, value.low);
    if constexpr (Unknown) store(high + row, value.high);
}

template <bool Unknown>
GNOMON_INLINE Bounds<Unknown> negated(const Bounds<Unknown>& x)
{
    if constexpr (Unknown)
        return {complement(x.high), complement(x.low)};
    else
        return {complement(x.low)};
}

template <bool Unknown, typename Operation>
GNOMON_INLINE Bounds<Unknown> joined(const Bounds<Unknown>& x, const Bounds<Unknown>& y, Operation operation)
{
    if constexpr (Unknown)
        return {operation(x.low, y.low), operation(x.high, y.high)};
    else
        return {operation(x.low, y.low)};
}

/// evaluateAntecedent() without the limiting clause.
template <bool Unknown, bool Product>
GNOMON_INLINE Bounds<Unknown> truthOf(const Step* steps, uint32_t count, Antecedent shape, const Block& block)
{
    using B = Bounds<Unknown>;
    const auto both = [](const B& x, const B& y) {
        return joined<Unknown>(x, y, [](const Lanes& a, const Lanes& b) {
            if constexpr (Product)
                return each(a, b, [](Vector p, Vector q) { return p * q; });
            else
                return lesser(a, b);
        });
    };
    const auto either = [](const B& x, const B& y) {
        return joined<Unknown>(x, y, [](const Lanes& a, const Lanes& b) { return greater(a, b); });
    };
    B value{};
    const auto rowAt = [&](uint32_t i) { return rowOf<Unknown>(block.low, block.high, steps[i].row); };
    if (shape == Antecedent::Four) return both(both(rowAt(0), rowAt(1)), both(rowAt(2), rowAt(3)));
    if (shape == Antecedent::Chain) {
        value = rowAt(0);
        for (const Step* step = steps + 1; step != steps + count; ++step)
            value = both(value, rowOf<Unknown>(block.low, block.high, step->row));
        return value;
    }
    uint32_t depth = 0;
    for (const Step* step = steps; step != steps + count; ++step) {
        const auto term = [&] { return rowOf<Unknown>(block.low, block.high, step->row); };
        switch (step->kind) {
        case Step::Load:
        case Step::LoadNot:
            setRow<Unknown>(block.stackLow, block.stackHigh, depth, value);
            depth += kLanes;
            value = step->kind == Step::Load ? term() : negated<Unknown>(term());
            break;
        case Step::AndTerm:
            value = both(value, term());
            break;
        case Step::AndNotTerm:
            value = both(value, negated<Unknown>(term()));
            break;
        case Step::OrTerm:
            value = either(value, term());
            break;
        case Step::OrNotTerm:
            value = either(value, negated<Unknown>(term()));
            break;
        case Step::Not:
            value = negated<Unknown>(value);
            break;
        case Step::And:
            value = both(rowOf<Unknown>(block.stackLow, block.stackHigh, depth -= kLanes), value);
            break;
        case Step::Or:
            value = either(rowOf<Unknown>(block.stackLow, block.stackHigh, depth -= kLanes), value);
            break;
        }
    }
    return value;
}

/// strengthOf()
GNOMON_INLINE Lanes weighted(const Lanes& truth, double weight, double threshold)
{
    return each(truth, [=](Vector t) {
        const Vector strength = t * weight;
        return strength < threshold ? all(0.0) : strength;
    });
}

constexpr double kSteps = 0x1p50; // kSumScale of compiled.hpp

/// Adds a strength in whole steps of 2^-50, as the scalar engine does in integers. Doubles hold such sums exactly up to
/// 2^53; beyond 2^50 the result is 1 whatever comes, so the sum may stop there.
GNOMON_INLINE Lanes added(const Lanes& sum, const Lanes& strength)
{
    return each(sum, strength, [](Vector total, Vector s) {
        const Vector steps = s * kSteps;
        const Vector near = (steps + 0x1p52) - 0x1p52; // a whole number beside it; no fraction fits above 2^52
        const Vector whole = near > steps ? near - 1.0 : near;
        return lesser(total + whole, all(kSteps));
    });
}

/// What the rules say about one term of an output, where no priority matters.
template <bool Sum>
GNOMON_INLINE Lanes spokenFor(const Program& program, const Speakers& speakers, const double* strengths)
{
    Lanes total = fill(0.0);
    const uint32_t* const end = program.spoken + speakers.first + speakers.count;
    for (const uint32_t* rules = program.spoken + speakers.first; rules != end; rules += kSpokenStep) {
        const auto strength = [&](uint32_t i) { return load(strengths + rules[i]); };
        if constexpr (Sum) {
            for (uint32_t i = 0; i < kSpokenStep; ++i)
                total = added(total, strength(i));
        } else {
            total = greater(total, greater(greater(strength(0), strength(1)), greater(strength(2), strength(3))));
        }
    }
    return Sum ? each(total, [](Vector s) { return s / kSteps; }) : total;
}

constexpr uint32_t kMostTerms = 16; // kMaxTerms of rule_base.hpp

/// Entries by falling priority. `contrary` are the strengths that limit, `strengths` those that are limited: the other
/// bound each where facts are unknown.
void join(const Program& program, const Subject& subject, const double* strengths, const double* contrary,
          double* terms)
{
    Lanes claimed[kMostTerms], claiming[kMostTerms], total[kMostTerms];
    for (uint32_t t = 0; t < subject.termCount; ++t)
        claimed[t] = claiming[t] = total[t] = fill(0.0);
    const Entry* entry = program.entries + subject.firstEntry;
    const Entry* const end = entry + subject.entryCount;
    uint32_t priority = subject.entryCount ? entry->priority : 0;
    for (; entry != end; ++entry) {
        if (entry->priority != priority) {
            priority = entry->priority;
            for (uint32_t t = 0; t < subject.termCount; ++t)
                claimed[t] = claiming[t];
        }
        Lanes against = fill(0.0);
        for (uint32_t t = 0; t < subject.termCount; ++t) {
            if (t != entry->term) against = greater(against, claimed[t]);
        }
        const Lanes left = lesser(load(strengths + entry->rule * kLanes), complement(against));
        claiming[entry->term] = greater(claiming[entry->term], load(contrary + entry->rule * kLanes));
        total[entry->term] = program.sum ? added(total[entry->term], left) : greater(total[entry->term], left);
    }
    for (uint32_t t = 0; t < subject.termCount; ++t)
        store(terms + t * kLanes, program.sum ? each(total[t], [](Vector s) { return s / kSteps; }) : total[t]);
}

template <bool Unknown, bool Product>
GNOMON_INLINE void fire(const Program& program, const Block& block)
{
    const double* const lows = block.strengthLow;
    const double* const highs = Unknown ? block.strengthHigh : block.strengthLow;
    const double threshold = program.threshold; // no store below can change it, which the compiler cannot know
    const uint32_t ruleCount = program.ruleCount, orderCount = program.orderCount;
    Lanes strongest = fill(0.0);
    for (uint32_t i = 0; i < orderCount; ++i) {
        const uint32_t at = program.order[i];
        if (at >= ruleCount) {
            const Subject& concept_ = program.concepts[at - program.ruleCount];
            join(program, concept_, lows, highs, block.low + concept_.membership * kLanes);
            if constexpr (Unknown) join(program, concept_, highs, lows, block.high + concept_.membership * kLanes);
            continue;
        }
        const Rule& rule = program.rules[at];
        const auto truth =
            truthOf<Unknown, Product>(program.steps + rule.firstStep, rule.stepCount, rule.shape, block);
        const Lanes strength = weighted(truth.low, rule.weight, threshold);
        store(block.strengthLow + at * kLanes, strength);
        if constexpr (Unknown)
            store(block.strengthHigh + at * kLanes, weighted(truth.high, rule.weight, threshold));
        if (rule.speaks) strongest = greater(strongest, strength);
    }
    if (program.hasOtherwise) {
        const Rule& rule = program.rules[program.ruleCount - 1];
        store(block.strengthLow + (program.ruleCount - 1) * kLanes,
              weighted(complement(strongest), rule.weight, threshold));
    }
    if (program.floorStepCount != 0)
        store(block.floor,
              truthOf<Unknown, Product>(program.steps + program.firstFloorStep, program.floorStepCount, Antecedent::Any,
                                        block)
                  .low);
    else
        store(block.floor, fill(0.0));
}

/// A Cut in registers or ready to be loaded: the compiler cannot know that no store changes the program, and would fetch
/// and spread every coefficient again.
struct WideCut {
    Vector area1, area2, moment1, moment2, moment3, height;
};
GNOMON_INLINE WideCut widened(const Cut& cut)
{
    return {all(cut.area1),   all(cut.area2),   all(cut.moment1),
            all(cut.moment2), all(cut.moment3), all(cut.height)};
}

GNOMON_INLINE Vector areaOf(const WideCut& cut, Vector s)
{
    return s * (cut.area1 + s * cut.area2);
}
GNOMON_INLINE Vector momentOf(const WideCut& cut, Vector s)
{
    return s * (cut.moment1 + s * (cut.moment2 + s * cut.moment3));
}

struct WideCuts {
    WideCut cuts[kMostTerms], overlaps[kMostTerms];
    Vector low, high, width, quantum;
    bool unitWidth;
};
GNOMON_INLINE void widen(const Program& program, WideCuts& wide)
{
    const uint32_t count = program.cuts ? program.termCount : 0;
    for (uint32_t t = 0; t < count; ++t)
        wide.cuts[t] = widened(program.cuts[t]);
    for (uint32_t t = 0; t + 1 < count; ++t)
        wide.overlaps[t] = widened(program.overlaps[t]);
    wide.low = all(program.low);
    wide.high = all(program.high);
    wide.width = all(program.width);
    wide.quantum = all(program.quantum);
    wide.unitWidth = program.width == 1.0;
}

/// CentroidTerms::exact() in the neighbour form, and Engine::quantisedOf(). `Terms` is the number of terms, 0 any.
template <uint32_t Terms>
GNOMON_INLINE void centroid(const WideCuts& wide, uint32_t termCount, const double* terms, double* suitability,
                            int32_t* quantised)
{
    const uint32_t count = Terms == 0 ? termCount : Terms;
    for (unsigned i = 0; i < kParts; ++i) {
        const auto strengthOf = [&](uint32_t t) { return reinterpret_cast<const Vector*>(terms + t * kLanes)[i]; };
        Vector area{}, moment{};
        for (uint32_t t = 0; t < count; ++t) {
            const Vector s = strengthOf(t);
            area += areaOf(wide.cuts[t], s);
            moment += momentOf(wide.cuts[t], s);
        }
        for (uint32_t t = 0; t + 1 < count; ++t) {
            const WideCut& overlap = wide.overlaps[t];
            const Vector s = lesser(lesser(strengthOf(t), strengthOf(t + 1)), overlap.height);
            area -= areaOf(overlap, s);
            moment -= momentOf(overlap, s);
        }
        const auto opinion = area > 0.0;
        const Vector raw = moment / (opinion ? area : all(1.0));
        const Vector value = lesser(greater(raw, wide.low), wide.high);
        const Vector offset = value - wide.low;
        const Vector share = wide.unitWidth ? offset : offset / wide.width; // x / 1 is x
        const Vector steps = opinion ? share * wide.quantum + 0.5 : all(-1.0);
        storeLoose(suitability, i, opinion ? value : all(0.0));
        storeTruncated(quantised, i, steps);
    }
}

template <bool Sum>
GNOMON_INLINE void conclude(const Program& program, const Block& block)
{
    WideCuts wide;
    widen(program, wide);
    for (uint32_t o = 0; o < program.outputCount; ++o) {
        const Subject& output = program.outputs[o];
        double* const terms = block.terms + o * program.termCount * kLanes;
        if (output.ranked)
            join(program, output, block.strengthLow, block.strengthLow, terms);
        else
            for (uint32_t t = 0; t < program.termCount; ++t)
                store(terms + t * kLanes, spokenFor<Sum>(program, program.speakers[o * program.termCount + t],
                                                         block.strengthLow));
        double* const suitability = block.suitability + static_cast<uint64_t>(o) * block.stride;
        int32_t* const quantised = block.quantised + static_cast<uint64_t>(o) * block.stride;
        if (program.cuts && program.termCount == 3)
            centroid<3>(wide, 3, terms, suitability, quantised);
        else if (program.cuts)
            centroid<0>(wide, program.termCount, terms, suitability, quantised);
        if (output.vetoCount == 0) continue;
        Lanes veto = fill(-1.0);
        for (uint32_t v = output.firstVeto; v < output.firstVeto + output.vetoCount; ++v) {
            const uint32_t rule = program.vetoes[v];
            veto = each(load(block.strengthLow + rule * kLanes), veto,
                        [&](Vector s, Vector before) { return s < program.vetoAt ? before : all(rule); });
        }
        int32_t* const column = reinterpret_cast<int32_t*>(block.vetoRule + static_cast<uint64_t>(o) * block.stride);
        for (unsigned i = 0; i < kParts; ++i)
            storeTruncated(column, i, veto.part[i]);
    }
}

template <bool Unknown, bool Product>
GNOMON_INLINE void runAs(const Program& program, const Block& block)
{
    fuzzify<Unknown>(program, block);
    fire<Unknown, Product>(program, block);
    if (program.sum)
        conclude<true>(program, block);
    else
        conclude<false>(program, block);
}

GNOMON_INLINE void runKernel(const Program& program, const Block& block)
{
    if (block.unknown)
        program.product ? runAs<true, true>(program, block) : runAs<true, false>(program, block);
    else
        program.product ? runAs<false, true>(program, block) : runAs<false, false>(program, block);
}

} // namespace
} // namespace gnomon::rules::batch
