#include <algorithm>
#include <vector>

#include "rules/engine/lint_checks.hpp"
#include "rules/engine/sample_points.hpp"
#include "runtime/base/number_text.hpp"

/// Checks that look at many points instead of proving: what they find is there, what they miss may be too.

namespace gnomon::rules {
namespace {

/// Two sets of 8192: a share of 1 % is 80 points of a set.
constexpr uint32_t kPoints = 8192;

std::string percent(uint32_t part, uint32_t whole)
{
    return fixedText(100.0 * part / std::max(1u, whole), 1) + " %";
}

/// First half in checkCoverage(): no rule at all. This: some rule, but none that means it.
void checkWeakPoints(const Engine& engine, const SamplePoints& points, const Opinions& all, DiagnosticSink& sink)
{
    constexpr double kWeak = 0.1;
    if (engine.compiled().hasOtherwise) return; // it speaks up exactly there
    uint32_t weak = 0, first = 0;
    for (uint32_t i = 0; i < points.count; ++i) {
        double strongest = 0.0;
        for (uint32_t o = 0; o < all.outputCount; ++o)
            strongest = std::max(strongest, all.at(o, i).strongestStrength);
        if (strongest == 0.0 || strongest >= kWeak) continue; // 0: checkCoverage() names the region
        if (weak++ == 0) first = i;
    }
    if (weak != 0)
        sink.warning("L02", {},
                     "no rule is stronger than " + shortestText(kWeak) + " in " + percent(weak, points.count) +
                         " of the sampled situations, for example where " + pointText(engine, points, first));
}

/// Outputs that a rule favours by name or trait: those are meant to win somewhere.
std::vector<const Rule*> favouringRules(const Engine& engine)
{
    const std::string& best = engine.base().suitability.terms.back().name;
    std::vector<const Rule*> found(engine.outputs().size(), nullptr);
    for (const Rule& rule : engine.base().rules) {
        for (const Consequent& consequent : rule.consequents) {
            if (consequent.term != best) continue;
            for (std::size_t o = 0; o < found.size(); ++o) {
                const OutputInfo& output = engine.outputs()[o];
                const bool byName = consequent.kind == Consequent::Kind::Output && consequent.name == output.name;
                const bool byTrait =
                    consequent.kind == Consequent::Kind::Trait &&
                    std::find(output.traits.begin(), output.traits.end(), consequent.name) != output.traits.end();
                if ((byName || byTrait) && !found[o]) found[o] = &rule;
            }
        }
    }
    return found;
}

void checkWinners(const Engine& engine, const SamplePoints& points, const Opinions& all, DiagnosticSink& sink)
{
    constexpr double kMostTies = 0.01; // of the volume
    std::vector<bool> wins(engine.outputs().size(), false);
    for (const std::vector<uint32_t>& kind : engine.compiled().kinds) {
        uint32_t ties = 0, first = 0;
        Winner firstTie;
        for (uint32_t i = 0; i < points.count; ++i) {
            const Winner winner = winnerAmong(kind, all, i);
            if (winner.output == kNoRule) continue;
            wins[winner.output] = true;
            if (winner.runnerUp == kNoRule) continue;
            wins[winner.runnerUp] = true;
            if (ties++ == 0) {
                first = i;
                firstTie = winner;
            }
        }
        if (ties <= kMostTies * points.count) continue;
        sink.warning("L07", {},
                     "only the order of the outputs decides in " + percent(ties, points.count) +
                         " of the volume, for example between " + engine.outputs()[firstTie.output].name + " and " +
                         engine.outputs()[firstTie.runnerUp].name + " where " + pointText(engine, points, first));
    }
    const std::vector<const Rule*> favouring = favouringRules(engine);
    for (std::size_t o = 0; o < wins.size(); ++o) {
        if (favouring[o] && !wins[o])
            sink.warning("L07", favouring[o]->at,
                         engine.outputs()[o].name + " never wins, though rule " + inQuotes(favouring[o]->id) +
                             " favours it");
    }
}

/// Where the floor holds, some output of every kind must be good enough (as far as the host knows) and not vetoed.
void checkFloor(const Engine& engine, const SamplePoints& points, const Opinions& all, DiagnosticSink& sink)
{
    const Policy::Floor& floor = engine.base().policy.floor;
    if (floor.when.empty()) return;
    const SourceSpot at = floor.when.front().variableAt;
    for (const std::vector<uint32_t>& kind : engine.compiled().kinds) {
        uint32_t held = 0, violated = 0, first = 0;
        for (uint32_t i = 0; i < points.count; ++i) {
            if (all.floorTruth[i] < floor.atStrength) continue;
            ++held;
            const bool served = std::any_of(kind.begin(), kind.end(), [&](uint32_t output) {
                const double quality = engine.outputs()[output].quality;
                return !(quality < floor.minimumQuality) && !all.at(output, i).vetoed;
            });
            if (!served && violated++ == 0) first = i;
        }
        if (violated == 0) continue;
        std::string names;
        for (const uint32_t output : kind)
            names += (names.empty() ? "" : ", ") + engine.outputs()[output].name;
        sink.warning("L10", at,
                     "the floor asks for quality " + shortestText(floor.minimumQuality) + ", but none of " + names +
                         " may serve in " + percent(violated, held) + " of where it holds, for example where " +
                         pointText(engine, points, first));
        return;
    }
}

} // namespace

void checkSamples(const Engine& engine, DiagnosticSink& sink)
{
    if (engine.outputs().empty() || engine.base().rules.empty()) return;
    const SamplePoints cells = cellPoints(engine, kPoints), even = evenPoints(engine, kPoints);
    const Opinions atCells = opinionsAt(engine, cells);
    checkWeakPoints(engine, cells, atCells, sink);
    checkWinners(engine, even, opinionsAt(engine, even), sink);
    checkFloor(engine, cells, atCells, sink);
}

} // namespace gnomon::rules
