#include "rules/engine/batch.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "rules/engine/batch_program.hpp"
#include "runtime/base/float_mode.hpp"

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

/// What comes of a compiled rule base, table by table.
class BatchEngine::TableMaker {
public:
    TableMaker(const Engine& engine, Tables& tables)
        : engine_(engine), compiled_(engine.compiled()), options_(engine.base().options), t_(tables)
    {
    }

    void addVariables();
    void addRules();
    void addOutputs();
    void addConcepts();
    void addSpeakers();
    void addCuts();
    batch::Program program() const;

private:
    void addSubject(std::vector<batch::Entry> entries, std::vector<batch::Subject>& list);

    const Engine& engine_;
    const CompiledRules& compiled_;
    const Options& options_;
    Tables& t_;
    uint32_t firstFloorStep_ = 0;
};

void BatchEngine::TableMaker::addVariables()
{
    for (const CompiledVariable& v : compiled_.variables)
        t_.axes.push_back({v.fact, v.firstTerm, v.termCount, v.low, v.high});
    for (const Flanks& f : compiled_.flanks)
        t_.shapes.push_back({f.a, f.perRise, f.d, f.perFall});
}

void BatchEngine::TableMaker::addRules()
{
    for (const CompiledRule& rule : compiled_.rules) {
        const auto first = static_cast<uint32_t>(t_.steps.size());
        appendSteps(compiled_.opsOf(rule), t_.steps);
        auto count = static_cast<uint32_t>(t_.steps.size()) - first;
        auto shape = rule.isChain ? batch::Antecedent::Chain : batch::Antecedent::Any;
        if (rule.isChain && count <= 4 && options_.conjunction == Options::And::Min) {
            shape = batch::Antecedent::Four;
            for (; count < 4; ++count)
                t_.steps.push_back(t_.steps.back());
        }
        t_.rules.push_back({first, count, rule.weight, rule.effectCount != 0, shape});
    }
    firstFloorStep_ = static_cast<uint32_t>(t_.steps.size());
    appendSteps(compiled_.floor, t_.steps);
}

/// @param entries what rules say of it, in the order of the rules
void BatchEngine::TableMaker::addSubject(std::vector<batch::Entry> entries, std::vector<batch::Subject>& list)
{
    const auto higher = [](const batch::Entry& x, const batch::Entry& y) { return x.priority > y.priority; };
    std::stable_sort(entries.begin(), entries.end(), higher);
    batch::Subject subject{};
    subject.ranked = !entries.empty() && entries.front().priority != entries.back().priority;
    subject.firstEntry = static_cast<uint32_t>(t_.entries.size());
    subject.entryCount = static_cast<uint32_t>(entries.size());
    t_.entries.insert(t_.entries.end(), entries.begin(), entries.end());
    list.push_back(subject);
}

void BatchEngine::TableMaker::addOutputs()
{
    std::vector<std::vector<batch::Entry>> spoken(compiled_.outputCount);
    std::vector<std::vector<uint32_t>> vetoes(compiled_.outputCount);
    for (uint32_t r = 0; r < compiled_.rules.size(); ++r) {
        for (const uint32_t slot : compiled_.effectsOf(compiled_.rules[r]))
            spoken[slot / compiled_.suitabilityTerms].push_back(
                {r, slot % compiled_.suitabilityTerms, compiled_.rules[r].priority});
        for (const uint32_t output : compiled_.vetoesOf(compiled_.rules[r]))
            vetoes[output].push_back(r);
    }
    for (uint32_t o = 0; o < compiled_.outputCount; ++o) {
        addSubject(std::move(spoken[o]), t_.outputs);
        t_.outputs.back().termCount = compiled_.suitabilityTerms;
        t_.outputs.back().firstVeto = static_cast<uint32_t>(t_.vetoes.size());
        t_.outputs.back().vetoCount = static_cast<uint32_t>(vetoes[o].size());
        t_.vetoes.insert(t_.vetoes.end(), vetoes[o].rbegin(), vetoes[o].rend()); // the first rule has the last word
    }
}

void BatchEngine::TableMaker::addConcepts()
{
    for (const CompiledConcept& concept_ : compiled_.concepts) {
        std::vector<batch::Entry> entries;
        for (uint32_t a = concept_.firstAssertion; a < concept_.firstAssertion + concept_.assertionCount; ++a) {
            const CompiledAssertion& assertion = compiled_.assertions[a];
            entries.push_back({assertion.rule, assertion.term, compiled_.rules[assertion.rule].priority});
        }
        addSubject(std::move(entries), t_.concepts);
        t_.concepts.back().termCount = concept_.termCount;
        t_.concepts.back().membership = concept_.firstMembership;
    }
}

/// For each output and term the rules that say it, where all of them count alike.
void BatchEngine::TableMaker::addSpeakers()
{
    for (const batch::Subject& output : t_.outputs) {
        for (uint32_t term = 0; term < compiled_.suitabilityTerms; ++term) {
            const auto firstSpoken = static_cast<uint32_t>(t_.spoken.size());
            for (uint32_t e = output.firstEntry; !output.ranked && e < output.firstEntry + output.entryCount; ++e) {
                if (t_.entries[e].term == term) t_.spoken.push_back(t_.entries[e].rule * kLanes);
            }
            while ((t_.spoken.size() - firstSpoken) % batch::kSpokenStep != 0)
                t_.spoken.push_back(static_cast<uint32_t>(compiled_.rules.size()) * kLanes);
            t_.speakers.push_back({firstSpoken, static_cast<uint32_t>(t_.spoken.size()) - firstSpoken});
        }
    }
}

void BatchEngine::TableMaker::addCuts()
{
    const CentroidTerms& suitability = engine_.suitability();
    if (!suitability.isNeighbourForm() || options_.samples != 0) return;
    for (const CentroidTerms::Cut& cut : suitability.cuts())
        t_.cuts.push_back(toCut(cut));
    for (const CentroidTerms::Cut& cut : suitability.overlaps())
        t_.overlaps.push_back(toCut(cut));
}

batch::Program BatchEngine::TableMaker::program() const
{
    const Variable& universe = engine_.base().suitability;
    return {.axes = t_.axes.data(),
            .shapes = t_.shapes.data(),
            .steps = t_.steps.data(),
            .rules = t_.rules.data(),
            .speakers = t_.speakers.data(),
            .spoken = t_.spoken.data(),
            .order = t_.order.data(),
            .entries = t_.entries.data(),
            .vetoes = t_.vetoes.data(),
            .outputs = t_.outputs.data(),
            .concepts = t_.concepts.data(),
            .cuts = t_.cuts.empty() ? nullptr : t_.cuts.data(),
            .overlaps = t_.overlaps.data(),
            .axisCount = static_cast<uint32_t>(t_.axes.size()),
            .ruleCount = static_cast<uint32_t>(t_.rules.size()),
            .orderCount = static_cast<uint32_t>(t_.order.size()),
            .outputCount = compiled_.outputCount,
            .termCount = compiled_.suitabilityTerms,
            .firstFloorStep = firstFloorStep_,
            .floorStepCount = static_cast<uint32_t>(t_.steps.size()) - firstFloorStep_,
            .threshold = std::max(options_.minimumStrength, kNegligibleStrength),
            .vetoAt = options_.vetoAt,
            .low = universe.low,
            .high = universe.high,
            .width = universe.high - universe.low,
            .quantum = kSuitabilitySteps,
            .product = options_.conjunction == Options::And::Product,
            .sum = options_.aggregation == Options::Aggregation::Sum,
            .hasOtherwise = compiled_.hasOtherwise};
}

BatchEngine::~BatchEngine() = default;
BatchEngine::BatchEngine(BatchEngine&&) noexcept = default;
BatchEngine& BatchEngine::operator=(BatchEngine&&) noexcept = default;

BatchEngine::BatchEngine(const Engine& engine, InstructionSet set) : engine_(&engine)
{
    auto made = std::make_unique<Tables>();
    made->kernel = kernelFor(set);
    made->membershipCount = engine.compiled().membershipCount;
    made->stackDepth = engine.compiled().stackDepth + 1;
    made->factCount = static_cast<uint32_t>(engine.facts().size());
    made->order = engine.compiled().steps;
    TableMaker maker(engine, *made);
    maker.addVariables();
    maker.addRules();
    maker.addOutputs();
    maker.addConcepts();
    maker.addSpeakers();
    maker.addCuts();
    made->program = maker.program();
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
