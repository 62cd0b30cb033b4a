#include "random_base.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/base/float_mode.hpp"

using namespace gnomon::rules;
using namespace gnomon::rules::test;

namespace {

double membershipOf(const RuleBase& base, const Clause& clause, const std::vector<double>& facts)
{
    const auto variable = std::find_if(base.variables.begin(), base.variables.end(),
                                       [&](const Variable& v) { return v.name == clause.variable; });
    REQUIRE(variable != base.variables.end());
    const auto term = std::find_if(variable->terms.begin(), variable->terms.end(),
                                   [&](const Term& t) { return t.name == clause.term; });
    REQUIRE(term != variable->terms.end());
    const double fact = facts[static_cast<std::size_t>(variable - base.variables.begin())];
    return term->shape.membership(std::clamp(fact, variable->low, variable->high));
}

double truthOf(const RuleBase& base, const Antecedent& antecedent, const std::vector<double>& facts)
{
    std::vector<double> stack;
    for (const Clause& clause : antecedent) {
        if (clause.kind == Clause::Kind::Is) {
            stack.push_back(membershipOf(base, clause, facts));
        } else if (clause.kind == Clause::Kind::Not) {
            stack.back() = 1.0 - stack.back();
        } else {
            const double right = stack.back();
            stack.pop_back();
            stack.back() =
                clause.kind == Clause::Kind::And ? std::min(stack.back(), right) : std::max(stack.back(), right);
        }
    }
    REQUIRE(stack.size() == 1);
    return stack[0];
}

/// Strengths of the terms of suitability of one output, from the rules as they are written.
std::vector<double> strengthsOf(const RuleBase& base, const std::string& output, const std::vector<double>& facts)
{
    std::vector<double> strengths(base.suitability.terms.size(), 0.0);
    for (const Rule& rule : base.rules) {
        const double strength = rule.weight * truthOf(base, rule.antecedent, facts);
        for (const Consequent& consequent : rule.consequents) {
            if (consequent.name != output) continue;
            for (std::size_t t = 0; t < strengths.size(); ++t)
                if (base.suitability.terms[t].name == consequent.term) strengths[t] = std::max(strengths[t], strength);
        }
    }
    return strengths;
}

} // namespace

TEST_CASE("an evaluation is what the rules say, read one by one")
{
    constexpr double kRounding = 1e-9; // of a universe of 1
    Random random(31);
    uint32_t opinions = 0;
    for (int round = 0; round < 10; ++round) {
        const RuleBase base = randomBase(random, 40);
        const Engine engine = engineOf(base, kFour);
        Inference inference = engine.makeInference();
        for (int i = 0; i < 200; ++i) {
            const std::vector<double> facts = randomFacts(random);
            engine.evaluate(facts, inference);
            for (std::size_t o = 0; o < kFour.size(); ++o) {
                const Centroid expected = engine.suitability().exactGeneral(strengthsOf(base, kFour[o].name, facts));
                const OutputState& output = inference.outputs[o];
                REQUIRE(output.hasOpinion == expected.hasOpinion);
                if (!output.hasOpinion) continue;
                ++opinions;
                CHECK(std::abs(output.suitability - expected.value) < kRounding);
                CHECK(std::abs(output.quantised - expected.value * kSuitabilitySteps) < 0.5 + 1e-5);
            }
        }
    }
    CHECK(opinions > 5000);
}

#if GNOMON_HAS_MXCSR
TEST_CASE("the host's rounding and denormal mode changes no decision, and is the host's again afterwards")
{
    constexpr unsigned kFlush = 0x8040; // FTZ | DAZ
    constexpr unsigned kDown = 0x2000, kUp = 0x4000, kTowardsZero = 0x6000, kStandard = 0x1f80;
    const auto outputsIn = [](unsigned mode) {
        const unsigned before = _mm_getcsr();
        std::vector<OutputState> outputs;
        Random random(66);
        for (int b = 0; b < 20; ++b) {
            const RuleBase base = anyBase(random, 40);
            std::vector<std::vector<double>> facts(100);
            for (std::vector<double>& row : facts)
                row = randomFacts(random);
            if (b % 4 == 0) facts[7][2] = kNan;
            _mm_setcsr(kStandard | mode);
            const Engine engine = engineOf(base, kFourWithTrait); // coefficients are made in that mode too
            Inference inference = engine.makeInference();
            for (const std::vector<double>& row : facts) {
                engine.evaluate(row, inference);
                outputs.insert(outputs.end(), inference.outputs.begin(), inference.outputs.end());
            }
            CHECK((_mm_getcsr() & 0xffc0) == (kStandard | mode));
            _mm_setcsr(before);
        }
        return outputs;
    };
    const auto same = [](const OutputState& a, const OutputState& b) {
        return a.hasOpinion == b.hasOpinion && a.quantised == b.quantised && a.vetoRule == b.vetoRule &&
               a.suitability == b.suitability; // bit for bit
    };
    const std::vector<OutputState> expected = outputsIn(0);
    for (const unsigned rounding : {0u, kDown, kUp, kTowardsZero}) {
        CAPTURE(rounding);
        CHECK(std::ranges::equal(outputsIn(rounding), expected, same));
        CHECK(std::ranges::equal(outputsIn(rounding | kFlush), expected, same));
    }
}
#endif
