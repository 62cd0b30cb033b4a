// A second opinion from fuzzylite's command line, run as a program of its own: nothing of it is linked or copied.

#define DOCTEST_CONFIG_IMPLEMENT
#include "random_base.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <unistd.h>

#include "rules/engine/export_fll.hpp"
#include "runtime/base/number_text.hpp"
#if GNOMON_WITH_YAML
#include "rules/yaml/shipped.hpp"
#include "yaml_support.hpp"
#endif

using namespace gnomon;
using namespace gnomon::rules;
using namespace gnomon::rules::test;

namespace {

constexpr uint32_t kPoints = 2000, kExactPoints = 200; ///< The latter sample 20 000 times each: a second a base.

/// GNOMON_ORACLE_BASES=50 compares them all.
uint32_t randomBases()
{
    const char* wanted = std::getenv("GNOMON_ORACLE_BASES");
    const int count = wanted ? std::atoi(wanted) : 0;
    return count > 0 ? static_cast<uint32_t>(count) : 8;
}
constexpr double kExplained = 1e-6; ///< Sampling errors below this must not show.

struct Folder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("gnomon_fuzzylite_" + std::to_string(getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    std::string file(const char* name) const { return (path / name).string(); }
};

void write(const std::string& path, const std::string& text)
{
    std::ofstream file(path, std::ios::binary);
    file << text;
    REQUIRE(file.good());
}

/// fuzzylite compares with a tolerance of 1e-6 where we compare exactly: at corners, at strength 0 and at the
/// threshold. Points there would test its tolerance.
bool isClear(const Engine& engine, const std::vector<double>& facts, const Inference& inference)
{
    constexpr double kCorner = 1e-5, kStrength = 1e-5;
    for (std::size_t v = 0; v < engine.base().variables.size(); ++v) {
        for (const Term& term : engine.base().variables[v].terms) {
            for (const double corner : {term.shape.a, term.shape.b, term.shape.c, term.shape.d}) {
                if (std::abs(facts[engine.compiled().variables[v].fact] - corner) < kCorner) return false;
            }
        }
    }
    const auto isNear = [&](double truth, double limit) {
        return truth != limit && std::abs(truth - limit) < kStrength;
    };
    for (std::size_t i = 0; i < inference.rules.size(); ++i) {
        for (const double limit : {0.0, engine.base().options.minimumStrength})
            if (isNear(inference.rules[i].strength, limit)) return false;
    }
    return true;
}

/// What one sum over `resolution` steps may be off. Each bend of the set costs at most slope x step^2 / 8, against an
/// area that shrinks with the strength: 8 bends of slope 5 on an area of 0.4 x strength.
double samplingError(uint32_t resolution, double strength)
{
    const double step = 1.0 / resolution;
    return 8 * 5 * step * step / 8 / (0.4 * strength);
}

struct Comparison {
    double widest = 0.0; ///< Beyond what fuzzylite's own sampling explains.
    uint32_t opinions = 0, silent = 0, disagreements = 0;
};

/// Random points through both engines. `resolution` is fuzzylite's.
Comparison compare(const Engine& engine, const std::vector<OutputInfo>& outputs, uint32_t resolution, uint32_t points,
                   uint64_t seed)
{
    const Folder folder;
    const FllResult fll = exportFll(engine, resolution);
    REQUIRE_MESSAGE(!fll.text.empty(), fll.missing);
    Random random(seed);
    std::string lines;
    std::vector<std::vector<OutputState>> ours;
    Inference inference = engine.makeInference();
    const double threshold = engine.base().options.minimumStrength;
    std::optional<Engine> open; // without the threshold a strength just below it shows
    Inference openInference;
    if (threshold > 0.0) {
        RuleBase base = engine.base();
        base.options.minimumStrength = 0.0;
        open = engineOf(base, outputs);
        openInference = open->makeInference();
    }
    std::vector<double> facts(engine.facts().size(), 0.0);
    while (ours.size() < points) {
        std::string line;
        for (std::size_t v = 0; v < engine.base().variables.size(); ++v) {
            const Variable& variable = engine.base().variables[v];
            double& fact = facts[engine.compiled().variables[v].fact];
            fact = random.between(variable.low, variable.high);
            line += shortestText(fact) + " ";
        }
        engine.evaluate(facts, inference);
        if (open) open->evaluate(facts, openInference);
        const bool nearThreshold = std::any_of(openInference.rules.begin(), openInference.rules.end(),
                                               [&](auto& rule) { return std::abs(rule.strength - threshold) < 1e-5; });
        if (nearThreshold || !isClear(engine, facts, inference)) continue;
        lines += line + "\n";
        ours.push_back(inference.outputs);
    }
    write(folder.file("base.fll"), fll.text);
    write(folder.file("in.fld"), lines);
    const std::string command = "LC_ALL=C fuzzylite -i " + folder.file("base.fll") + " -d " + folder.file("in.fld") +
                                " -o " + folder.file("out.fld") + " -decimals 15 -dinputs false -dheader false > " +
                                folder.file("log") + " 2>&1";
    const int status = std::system(command.c_str());
    std::ifstream log(folder.file("log"));
    REQUIRE_MESSAGE(status == 0, std::string(std::istreambuf_iterator<char>(log), {}) << fll.text);

    Comparison result;
    std::ifstream out(folder.file("out.fld"));
    std::string line;
    for (const std::vector<OutputState>& states : ours) {
        REQUIRE(std::getline(out, line));
        std::size_t at = 0;
        for (const OutputState& state : states) {
            const std::size_t end = std::min(line.find(' ', at), line.size());
            const std::string word = line.substr(at, end - at);
            at = end + 1;
            if ((word == "nan" || word == "-nan") == state.hasOpinion) {
                ++result.disagreements;
                continue;
            }
            (state.hasOpinion ? result.opinions : result.silent) += 1;
            if (!state.hasOpinion) continue;
            const std::optional<double> theirs = parseNumber(word);
            REQUIRE_MESSAGE(theirs.has_value(), word);
            const double apart = std::abs(*theirs - state.suitability);
            const bool samples = engine.base().options.samples != 0; // then both do, step by step the same
            const double explained = samples ? 0.0 : samplingError(resolution, state.strongestStrength);
            if (explained < kExplained)
                result.widest = std::max(result.widest, apart);
            else
                CHECK(apart <= explained);
        }
    }
    return result;
}

struct Tally {
    Comparison sampled, exact;
    uint32_t bases = 0;

    static void add(Comparison& to, const Comparison& one)
    {
        to.widest = std::max(to.widest, one.widest);
        to.opinions += one.opinions;
        to.silent += one.silent;
        to.disagreements += one.disagreements;
    }

    template <typename Bind>
    void test(RuleBase base, const std::vector<OutputInfo>& outputs, uint64_t seed, Bind&& bind)
    {
        base.options.samples = 100;
        const Comparison coarse = compare(bind(base), outputs, 100, kPoints, seed);
        CHECK(coarse.disagreements == 0);
        CHECK(coarse.widest <= 1e-12);
        base.options.samples = 0;
        const Comparison fine = compare(bind(base), outputs, 20'000, kExactPoints, seed + 1);
        CHECK(fine.disagreements == 0);
        CHECK(fine.widest <= 1e-6);
        add(sampled, coarse);
        add(exact, fine);
        ++bases;
    }

    void print(const char* what) const
    {
        std::printf("%s: %u bases; %u points each sampled(100) within %s of fuzzylite (%u opinions, %u without); "
                    "%u exact within %s of Centroid 20000\n",
                    what, bases, kPoints, shortestText(sampled.widest).c_str(), sampled.opinions, sampled.silent,
                    kExactPoints, shortestText(exact.widest).c_str());
    }
};

} // namespace

TEST_CASE("random rule bases agree with fuzzylite, sampled and exact, and about having no opinion")
{
    Random random(71);
    Tally tally;
    while (tally.bases < randomBases()) {
        const RuleBase base = anyBase(random, 5 + random.below(30));
        const auto bind = [](const RuleBase& b) { return engineOf(b, kFourWithTrait); };
        if (!exportFll(bind(base), 100).missing.empty()) continue; // 'not (...)' under the product
        tally.test(base, kFourWithTrait, 100 * tally.bases + 7, bind);
    }
    CHECK(tally.sampled.silent > 1000);
    tally.print("random");
}

#if GNOMON_WITH_YAML
TEST_CASE("every shipped rule base agrees with fuzzylite")
{
    Tally tally;
    for (const ShippedRuleBase& shipped : shippedRuleBases()) {
        CAPTURE(shipped.name);
        tally.test(parsed(shipped.text), kMethods, 9, [](const RuleBase& b) { return bound(b); });
    }
    tally.print("shipped");
}
#endif

TEST_CASE("what FLL cannot say is refused with a reason")
{
    RuleBase base = baseOf({ramp("x"), ramp("y")}, {"if not (x is low and y is low) then o0 is favoured"});
    CHECK(!exportFll(engineOf(base, kFour), 100).text.empty());
    base.options.conjunction = Options::And::Product;
    CHECK(exportFll(engineOf(base, kFour), 100).text.empty());
    CHECK(exportFll(engineOf(base, kFour), 100).missing == "'not (...)' under the product");
}

int main(int argc, char** argv)
{
    if (std::system("command -v fuzzylite > /dev/null 2>&1") != 0) {
        std::printf("skipped: no program 'fuzzylite' here (Debian package fuzzylite)\n");
        return 77;
    }
    return doctest::Context(argc, argv).run();
}
