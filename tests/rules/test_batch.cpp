#include "random_base.hpp"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <memory>

#include "allocation_count.hpp"
#include "rules/engine/batch.hpp"
#include "runtime/base/float_mode.hpp"

using namespace gnomon;
using namespace gnomon::rules;
using namespace gnomon::rules::test;

namespace {

constexpr InstructionSet kSets[] = {InstructionSet::Baseline, InstructionSet::Avx2, InstructionSet::Avx512};
const char* const kSetNames[] = {"baseline", "AVX2", "AVX-512"};

/// Columns of facts: mostly within the universe, some beyond it, on a corner, infinite or unknown.
std::vector<double> columns(Random& random, uint32_t count, bool unknowns)
{
    std::vector<double> facts(std::size_t(6) * count);
    for (double& fact : facts) {
        const uint32_t kind = random.below(24);
        fact = kind == 0 ? 0.0 : kind == 1 ? 1.0 : kind == 2 ? kInf : random.between(-0.2, 1.2);
        if (unknowns && kind == 3) fact = kNan;
    }
    return facts;
}

/// Whether situation `i` of a batch has the bits of a scalar evaluation.
bool sameBits(const Engine& engine, const BatchInference& all, uint32_t i, const Inference& one)
{
    bool same = std::bit_cast<uint64_t>(all.floorTruth[i]) == std::bit_cast<uint64_t>(one.floorTruth);
    for (uint32_t o = 0; o < engine.outputs().size(); ++o) {
        const std::size_t at = all.at(o, i);
        const OutputState& output = one.outputs[o];
        same = same && all.quantised[at] == output.quantised && all.vetoRule[at] == output.vetoRule;
        same = same && (!output.hasOpinion ||
                        std::bit_cast<uint64_t>(all.suitability[at]) == std::bit_cast<uint64_t>(output.suitability));
    }
    return same;
}

struct Hash {
    uint64_t value = 0xcbf29ce484222325u;
    void add(uint64_t word) { value = (value ^ word) * 0x100000001b3u; }
    void add(bool opinion, double suitability, int32_t quantised, uint32_t vetoRule)
    {
        add(opinion ? std::bit_cast<uint64_t>(suitability) : 0);
        add(static_cast<uint64_t>(quantised + 1) << 32 | vetoRule);
    }
};

} // namespace

TEST_CASE("a batch has the bits of the scalar engine, at every length, for every instruction set")
{
    Random random(61);
    for (int round = 0; round < 150; ++round) {
        const Engine engine = engineOf(anyBase(random, 5 + random.below(40)), kFourWithTrait);
        Inference one = engine.makeInference();
        const uint32_t count = 1 + static_cast<uint32_t>(round) % 33;
        const std::vector<double> facts = columns(random, count, round % 3 == 0);
        for (std::size_t s = 0; s < std::size(kSets); ++s) {
            if (!isSupported(kSets[s])) continue;
            CAPTURE(kSetNames[s]);
            const BatchEngine batch(engine, kSets[s]);
            BatchInference all = batch.makeInference(count);
            batch.evaluateBatch(facts, count, all);
            for (uint32_t i = 0; i < count; ++i) {
                std::vector<double> row;
                for (uint32_t f = 0; f < 6; ++f)
                    row.push_back(facts[std::size_t(f) * count + i]);
                engine.evaluate(row, one);
                REQUIRE(sameBits(engine, all, i, one));
            }
        }
    }
}

TEST_CASE("flanks of any width have the bits of the scalar engine")
{
    // Widths of 1, as ramps have, would not show a slope that is rounded otherwise.
    Random random(65);
    constexpr uint32_t kCount = 512;
    for (int round = 0; round < 200; ++round) {
        const double scale = random.between(0.001, 1000.0);
        double corners[6];
        for (double& corner : corners)
            corner = random.between(-scale, scale);
        std::sort(std::begin(corners), std::end(corners));
        const auto [a, b, c, d, e, f] = corners;
        RuleBase base = baseOf(
            {variable("x", -scale, scale,
                      {{"low", {-kInf, -kInf, a, b}, {}}, {"mid", {a, b, c, d}, {}}, {"high", {c, d, kInf, kInf}, {}}}),
             variable("y", -scale, scale, {{"low", {a, c, d, f}, {}}, {"high", {b, d, e, e}, {}}})}, // flanks overlap
            {"if x is low then o0 is favoured", "if x is mid then o1 is favoured", "if x is high then o2 is favoured",
             "if y is low then o3 is favoured", "if y is high then o3 is avoided"});
        REQUIRE(parseCondition({"x is mid"}, base.policy.floor.when, *std::make_unique<DiagnosticSink>("floor")));
        const Engine engine = engineOf(base, kFourWithTrait);
        Inference one = engine.makeInference();
        std::vector<double> facts(2 * kCount);
        for (double& fact : facts)
            fact = random.between(-scale, scale);
        for (std::size_t s = 0; s < std::size(kSets); ++s) {
            if (!isSupported(kSets[s])) continue;
            CAPTURE(kSetNames[s]);
            const BatchEngine batch(engine, kSets[s]);
            BatchInference all = batch.makeInference(kCount);
            batch.evaluateBatch(facts, kCount, all);
            for (uint32_t i = 0; i < kCount; ++i) {
                engine.evaluate(std::vector<double>{facts[i], facts[kCount + i]}, one);
                REQUIRE(sameBits(engine, all, i, one));
            }
        }
    }
}

TEST_CASE("what stands beside a situation in a batch changes nothing")
{
    Random random(62);
    const Engine engine = engineOf(anyBase(random, 30), kFourWithTrait);
    const BatchEngine batch(engine);
    BatchInference alone = batch.makeInference(1), among = batch.makeInference(20);
    std::vector<double> facts = columns(random, 20, true);
    batch.evaluateBatch(facts, 20, among);
    for (uint32_t i = 0; i < 20; ++i) {
        std::vector<double> row;
        for (uint32_t f = 0; f < 6; ++f)
            row.push_back(facts[f * 20 + i]);
        batch.evaluateBatch(row, 1, alone);
        for (uint32_t o = 0; o < 4; ++o)
            CHECK(alone.quantised[alone.at(o, 0)] == among.quantised[among.at(o, i)]);
    }
}

TEST_CASE("a batch allocates nothing and an empty one touches nothing")
{
    Random random(63);
    const Engine engine = engineOf(anyBase(random, 30), kFourWithTrait);
    const BatchEngine batch(engine);
    BatchInference all = batch.makeInference(64);
    const std::vector<double> facts = columns(random, 64, true);
    const std::vector<int32_t> untouched = all.quantised;
    const std::size_t before = allocationCount();
    batch.evaluateBatch({}, 0, all);
    CHECK(all.quantised == untouched);
    batch.evaluateBatch(facts, 64, all);
    CHECK(allocationCount() == before);
    CHECK(all.quantised != untouched);
}

TEST_CASE("a million random evaluations have one hash: scalar, batch, every compiler, every instruction set")
{
    constexpr uint32_t kBases = 100, kPerBase = 10'000, kAtOnce = 1'000;
    Hash scalar, batched[std::size(kSets)];
    Random random(64);
    for (uint32_t b = 0; b < kBases; ++b) {
        const Engine engine = engineOf(anyBase(random, 40), kFourWithTrait);
        Inference one = engine.makeInference();
        std::vector<double> row(6);
        for (uint32_t done = 0; done < kPerBase; done += kAtOnce) {
            const std::vector<double> facts = columns(random, kAtOnce, b % 4 == 0);
            for (uint32_t i = 0; i < kAtOnce; ++i) {
                for (uint32_t f = 0; f < 6; ++f)
                    row[f] = facts[std::size_t(f) * kAtOnce + i];
                engine.evaluate(row, one);
                for (const OutputState& o : one.outputs)
                    scalar.add(o.hasOpinion, o.suitability, o.quantised, o.vetoRule);
            }
            for (std::size_t s = 0; s < std::size(kSets); ++s) {
                if (!isSupported(kSets[s])) continue;
                const BatchEngine batch(engine, kSets[s]);
                BatchInference all = batch.makeInference(kAtOnce);
                batch.evaluateBatch(facts, kAtOnce, all);
                for (uint32_t i = 0; i < kAtOnce; ++i) {
                    for (uint32_t o = 0; o < 4; ++o) {
                        const std::size_t at = all.at(o, i);
                        batched[s].add(all.quantised[at] >= 0, all.suitability[at], all.quantised[at],
                                       all.vetoRule[at]);
                    }
                }
            }
        }
    }
    std::printf("hash of %u evaluations: scalar %016llx", kBases * kPerBase, (unsigned long long)scalar.value);
    for (std::size_t s = 0; s < std::size(kSets); ++s) {
        if (!isSupported(kSets[s])) {
            std::printf(", %s not on this processor", kSetNames[s]);
            continue;
        }
        std::printf(", %s %016llx", kSetNames[s], (unsigned long long)batched[s].value);
        CHECK(batched[s].value == scalar.value);
    }
    std::printf("\n");
    CHECK(scalar.value == 0x37c07c677a558923u); // the same for gcc 12 and clang 14
}

#if GNOMON_HAS_MXCSR
TEST_CASE("the host's rounding and denormal mode changes no decision, and is the host's again afterwards")
{
    constexpr unsigned kFlush = 0x8040; // FTZ | DAZ
    constexpr unsigned kDown = 0x2000, kUp = 0x4000, kTowardsZero = 0x6000, kStandard = 0x1f80;
    const auto hashIn = [](unsigned mode) {
        const unsigned before = _mm_getcsr();
        Hash scalar, batched;
        Random random(66);
        for (int b = 0; b < 20; ++b) {
            const RuleBase base = anyBase(random, 40);
            const std::vector<double> facts = columns(random, 100, b % 4 == 0);
            _mm_setcsr(kStandard | mode);
            const Engine engine = engineOf(base, kFourWithTrait); // coefficients are made in that mode too
            Inference one = engine.makeInference();
            const BatchEngine batch(engine);
            BatchInference all = batch.makeInference(100);
            batch.evaluateBatch(facts, 100, all);
            CHECK((_mm_getcsr() & 0xffc0) == (kStandard | mode));
            for (uint32_t i = 0; i < 100; ++i) {
                std::vector<double> row(6);
                for (uint32_t f = 0; f < 6; ++f)
                    row[f] = facts[f * 100 + i];
                engine.evaluate(row, one);
                for (uint32_t o = 0; o < 4; ++o) {
                    const OutputState& output = one.outputs[o];
                    const std::size_t at = all.at(o, i);
                    scalar.add(output.hasOpinion, output.suitability, output.quantised, output.vetoRule);
                    batched.add(all.quantised[at] >= 0, all.suitability[at], all.quantised[at], all.vetoRule[at]);
                }
            }
            CHECK((_mm_getcsr() & 0xffc0) == (kStandard | mode));
            _mm_setcsr(before);
        }
        CHECK(scalar.value == batched.value);
        return scalar.value;
    };
    const uint64_t expected = hashIn(0);
    for (const unsigned rounding : {0u, kDown, kUp, kTowardsZero}) {
        CAPTURE(rounding);
        CHECK(hashIn(rounding) == expected);
        CHECK(hashIn(rounding | kFlush) == expected);
    }
}
#endif
