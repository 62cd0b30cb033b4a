#include "rules/engine/batch.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "rules/engine/batch_program.hpp"
#include "rules/engine/float_mode.hpp"

namespace gnomon::rules {

using batch::kLanes;

/// The rules as the kernels want them.
struct BatchEngine::Tables {
    std::vector<batch::Axis> axes;
    std::vector<batch::Shape> shapes;
    std::vector<batch::Step> steps;
    std::vector<batch::Rule> rules;
    std::vector<uint32_t> order, spoken;
    std::vector<batch::Speakers> speakers;
    std::vector<batch::Entry> entries;
    std::vector<uint32_t> vetoes;
    std::vector<batch::Subject> outputs, concepts;
    std::vector<batch::Cut> cuts, overlaps;
    batch::Program program{};
    batch::Kernel kernel = nullptr;
    uint32_t membershipCount = 0, stackDepth = 0, factCount = 0;

    /// Rows of kLanes numbers in one block.
    std::size_t rowCount() const noexcept
    {
        const std::size_t bounds = 2 * (membershipCount + rules.size() + stackDepth) + 1;
        return factCount + bounds + std::size_t(program.outputCount) * program.termCount + 1;
    }
};

namespace {

batch::Kernel kernelFor(InstructionSet set) noexcept
{
#if GNOMON_BATCH_X86
    if (set == InstructionSet::Avx512) return &batch::runAvx512;
    if (set == InstructionSet::Avx2) return &batch::runAvx2;
#endif
    (void)set;
    return &batch::runBaseline;
}

/// Postfix to accumulator steps: an operand that is a single term needs no place of its own.
void appendSteps(std::span<const CompiledOp> ops, std::vector<batch::Step>& steps)
{
    using Step = batch::Step;
    const std::size_t first = steps.size();
    for (const CompiledOp& op : ops) {
        Step* const last = steps.size() > first ? &steps.back() : nullptr;
        const bool afterTerm = last && (last->kind == Step::Load || last->kind == Step::LoadNot);
        const bool negated = last && last->kind == Step::LoadNot;
        switch (op.kind) {
        case Clause::Kind::Is:
            steps.push_back({Step::Load, op.membership * kLanes});
            break;
        case Clause::Kind::Not:
            if (afterTerm && !negated)
                last->kind = Step::LoadNot;
            else
                steps.push_back({Step::Not, 0});
            break;
        case Clause::Kind::And:
            if (afterTerm)
                last->kind = negated ? Step::AndNotTerm : Step::AndTerm;
            else
                steps.push_back({Step::And, 0});
            break;
        case Clause::Kind::Or:
            if (afterTerm)
                last->kind = negated ? Step::OrNotTerm : Step::OrTerm;
            else
                steps.push_back({Step::Or, 0});
            break;
        }
    }
}

batch::Cut toCut(const CentroidTerms::Cut& cut)
{
    return {cut.area1, cut.area2, cut.moment1, cut.moment2, cut.moment3, cut.height};
}

/// Takes a row off the front of the scratch.
class Rows {
public:
    explicit Rows(std::vector<double>& scratch)
    {
        // Vectors are loaded whole, so every row starts on a cache line.
        const auto address = reinterpret_cast<std::uintptr_t>(scratch.data());
        next_ = scratch.data() + (64 - address % 64) % 64 / sizeof(double);
    }
    double* take(std::size_t rows) noexcept
    {
        double* const taken = next_;
        next_ += rows * kLanes;
        return taken;
    }

private:
    double* next_;
};

} // namespace

BatchEngine::~BatchEngine() = default;
BatchEngine::BatchEngine(BatchEngine&&) noexcept = default;
BatchEngine& BatchEngine::operator=(BatchEngine&&) noexcept = default;

BatchEngine::BatchEngine(const Engine& engine, InstructionSet set) : engine_(&engine)
{
    const CompiledRules& compiled = engine.compiled();
    const Options& options = engine.base().options;
    auto made = std::make_unique<Tables>();
    Tables& t = *made;
    t.kernel = kernelFor(set);
    t.membershipCount = compiled.membershipCount;
    t.stackDepth = compiled.stackDepth + 1;
    t.factCount = static_cast<uint32_t>(engine.facts().size());
    t.order = compiled.steps;
    for (const CompiledVariable& v : compiled.variables)
        t.axes.push_back({v.fact, v.firstTerm, v.termCount, v.low, v.high});
    for (const Flanks& f : compiled.flanks)
        t.shapes.push_back({f.a, f.perRise, f.d, f.perFall});
    for (const CompiledRule& rule : compiled.rules) {
        const auto first = static_cast<uint32_t>(t.steps.size());
        appendSteps(compiled.opsOf(rule), t.steps);
        auto count = static_cast<uint32_t>(t.steps.size()) - first;
        auto shape = rule.isChain ? batch::Antecedent::Chain : batch::Antecedent::Any;
        if (rule.isChain && count <= 4 && options.conjunction == Options::And::Min) {
            shape = batch::Antecedent::Four;
            for (; count < 4; ++count)
                t.steps.push_back(t.steps.back());
        }
        t.rules.push_back({first, count, rule.weight, rule.effectCount != 0, shape});
    }
    const auto firstFloorStep = static_cast<uint32_t>(t.steps.size());
    appendSteps(compiled.floor, t.steps);

    const auto addSubject = [&](std::vector<batch::Entry> entries, std::vector<batch::Subject>& list) {
        const auto higher = [](const batch::Entry& x, const batch::Entry& y) { return x.priority > y.priority; };
        std::stable_sort(entries.begin(), entries.end(), higher);
        const bool ranked = !entries.empty() && entries.front().priority != entries.back().priority;
        batch::Subject subject{};
        subject.ranked = ranked;
        subject.firstEntry = static_cast<uint32_t>(t.entries.size());
        subject.entryCount = static_cast<uint32_t>(entries.size());
        t.entries.insert(t.entries.end(), entries.begin(), entries.end());
        list.push_back(subject);
    };
    std::vector<std::vector<batch::Entry>> spoken(compiled.outputCount);
    std::vector<std::vector<uint32_t>> vetoes(compiled.outputCount);
    for (uint32_t r = 0; r < compiled.rules.size(); ++r) {
        for (const uint32_t slot : compiled.effectsOf(compiled.rules[r]))
            spoken[slot / compiled.suitabilityTerms].push_back(
                {r, slot % compiled.suitabilityTerms, compiled.rules[r].priority});
        for (const uint32_t output : compiled.vetoesOf(compiled.rules[r]))
            vetoes[output].push_back(r);
    }
    for (uint32_t o = 0; o < compiled.outputCount; ++o) {
        addSubject(std::move(spoken[o]), t.outputs);
        t.outputs.back().termCount = compiled.suitabilityTerms;
        t.outputs.back().firstVeto = static_cast<uint32_t>(t.vetoes.size());
        t.outputs.back().vetoCount = static_cast<uint32_t>(vetoes[o].size());
        t.vetoes.insert(t.vetoes.end(), vetoes[o].rbegin(), vetoes[o].rend()); // the first rule has the last word
    }
    for (const CompiledConcept& concept_ : compiled.concepts) {
        std::vector<batch::Entry> entries;
        for (uint32_t a = concept_.firstAssertion; a < concept_.firstAssertion + concept_.assertionCount; ++a) {
            const CompiledAssertion& assertion = compiled.assertions[a];
            entries.push_back({assertion.rule, assertion.term, compiled.rules[assertion.rule].priority});
        }
        addSubject(std::move(entries), t.concepts);
        t.concepts.back().termCount = concept_.termCount;
        t.concepts.back().membership = concept_.firstMembership;
    }
    for (const batch::Subject& output : t.outputs) {
        for (uint32_t term = 0; term < compiled.suitabilityTerms; ++term) {
            const auto firstSpoken = static_cast<uint32_t>(t.spoken.size());
            for (uint32_t e = output.firstEntry; !output.ranked && e < output.firstEntry + output.entryCount; ++e) {
                if (t.entries[e].term == term) t.spoken.push_back(t.entries[e].rule * kLanes);
            }
            while ((t.spoken.size() - firstSpoken) % batch::kSpokenStep != 0)
                t.spoken.push_back(static_cast<uint32_t>(compiled.rules.size()) * kLanes);
            t.speakers.push_back({firstSpoken, static_cast<uint32_t>(t.spoken.size()) - firstSpoken});
        }
    }
    const CentroidTerms& suitability = engine.suitability();
    if (suitability.isNeighbourForm() && options.samples == 0) {
        for (const CentroidTerms::Cut& cut : suitability.cuts())
            t.cuts.push_back(toCut(cut));
        for (const CentroidTerms::Cut& cut : suitability.overlaps())
            t.overlaps.push_back(toCut(cut));
    }
    const Variable& universe = engine.base().suitability;
    t.program = {.axes = t.axes.data(),
                 .shapes = t.shapes.data(),
                 .steps = t.steps.data(),
                 .rules = t.rules.data(),
                 .speakers = t.speakers.data(),
                 .spoken = t.spoken.data(),
                 .order = t.order.data(),
                 .entries = t.entries.data(),
                 .vetoes = t.vetoes.data(),
                 .outputs = t.outputs.data(),
                 .concepts = t.concepts.data(),
                 .cuts = t.cuts.empty() ? nullptr : t.cuts.data(),
                 .overlaps = t.overlaps.data(),
                 .axisCount = static_cast<uint32_t>(t.axes.size()),
                 .ruleCount = static_cast<uint32_t>(t.rules.size()),
                 .orderCount = static_cast<uint32_t>(t.order.size()),
                 .outputCount = compiled.outputCount,
                 .termCount = compiled.suitabilityTerms,
                 .firstFloorStep = firstFloorStep,
                 .floorStepCount = static_cast<uint32_t>(t.steps.size()) - firstFloorStep,
                 .threshold = std::max(options.minimumStrength, kNegligibleStrength),
                 .vetoAt = options.vetoAt,
                 .low = universe.low,
                 .high = universe.high,
                 .width = universe.high - universe.low,
                 .quantum = kSuitabilitySteps,
                 .product = options.conjunction == Options::And::Product,
                 .sum = options.aggregation == Options::Aggregation::Sum,
                 .hasOtherwise = compiled.hasOtherwise};
    tables_ = std::move(made);
}

BatchInference BatchEngine::makeInference(uint32_t capacity) const
{
    BatchInference made;
    made.stride = (capacity + kLanes - 1) / kLanes * kLanes;
    const std::size_t cells = std::size_t(made.stride) * tables_->program.outputCount;
    made.suitability.resize(cells);
    made.quantised.resize(cells, -1);
    made.vetoRule.resize(cells, kNoRule);
    made.floorTruth.resize(made.stride);
    made.scratch.resize(tables_->rowCount() * kLanes + 64 / sizeof(double));
    return made;
}

void BatchEngine::evaluateBatch(std::span<const double> facts, uint32_t count, BatchInference& out) const noexcept
{
    const FloatMode mode;
    evaluateInMode(facts, count, out);
}

[[gnu::noinline]] void BatchEngine::evaluateInMode(std::span<const double> facts, uint32_t count,
                                                   BatchInference& out) const noexcept
{
    const Tables& t = *tables_;
    assert(facts.size() == std::size_t(t.factCount) * count && count <= out.stride);
    Rows rows(out.scratch);
    double* const blockFacts = rows.take(t.factCount);
    batch::Block block{};
    block.facts = blockFacts;
    block.low = rows.take(t.membershipCount);
    block.high = rows.take(t.membershipCount);
    block.strengthLow = rows.take(t.rules.size() + 1);
    std::fill_n(block.strengthLow + t.rules.size() * kLanes, kLanes, 0.0);
    block.strengthHigh = rows.take(t.rules.size());
    block.stackLow = rows.take(t.stackDepth);
    block.stackHigh = rows.take(t.stackDepth);
    block.terms = rows.take(std::size_t(t.program.outputCount) * t.program.termCount);
    block.floor = rows.take(1);
    block.stride = out.stride;

    for (uint32_t begin = 0; begin < count; begin += kLanes) {
        const uint32_t lanes = std::min(kLanes, count - begin);
        block.unknown = false;
        for (const batch::Axis& axis : t.axes) {
            const double* const column = facts.data() + std::size_t(axis.fact) * count + begin;
            double* const row = blockFacts + std::size_t(axis.fact) * kLanes;
            if (lanes == kLanes)
                std::copy_n(column, kLanes, row);
            else
                for (uint32_t i = 0; i < kLanes; ++i)
                    row[i] = column[i < lanes ? i : 0]; // a short block repeats its first situation
            int unknowns = 0;
            for (uint32_t i = 0; i < kLanes; ++i)
                unknowns |= row[i] != row[i];
            block.unknown |= unknowns != 0;
        }
        block.suitability = out.suitability.data() + begin;
        block.quantised = out.quantised.data() + begin;
        block.vetoRule = out.vetoRule.data() + begin;
        t.kernel(t.program, block);
        for (uint32_t o = 0; t.program.cuts == nullptr && o < t.program.outputCount; ++o)
            takeCentroids(block.terms, o, out, begin);
        std::copy_n(block.floor, kLanes, out.floorTruth.data() + begin);
    }
}

/// Suitability terms without the closed form, and sampled ones: lane by lane with the engine's own functions.
void BatchEngine::takeCentroids(const double* terms, uint32_t output, BatchInference& out,
                                uint32_t begin) const noexcept
{
    const uint32_t termCount = tables_->program.termCount;
    std::array<double, kMaxTerms> strengths{};
    for (uint32_t i = 0; i < kLanes; ++i) {
        for (uint32_t t = 0; t < termCount; ++t)
            strengths[t] = terms[(std::size_t(output) * termCount + t) * kLanes + i];
        const Centroid centroid = engine_->centroidOf(std::span(strengths).first(termCount));
        out.suitability[out.at(output, begin + i)] = centroid.value;
        out.quantised[out.at(output, begin + i)] = engine_->quantisedOf(centroid);
    }
}

} // namespace gnomon::rules
