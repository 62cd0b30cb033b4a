#include "rules_support.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "rules/engine/centroid.hpp"

using namespace gnomon::rules;
using namespace gnomon::rules::test;

namespace {

/// Ascending terms of which only neighbours overlap, with flanks wide enough for the sampled sum to be a fair judge.
Variable randomPartition(Random& random)
{
    const double low = random.between(-5, 5);
    const double width = random.between(0.5, 20);
    const uint32_t terms = 2 + random.below(5);
    std::vector<double> cuts; // feet and shoulders of each overlap
    for (uint32_t i = 0; i < 2 * (terms - 1); ++i)
        cuts.push_back(random.between(0.05, 1));
    double sum = 0.05;
    for (double& cut : cuts)
        cut = sum += cut;
    for (double& cut : cuts)
        cut = low + width * cut / (sum + 0.05);
    std::vector<Term> made;
    for (uint32_t i = 0; i < terms; ++i) {
        // Not always a sum of one: the next term may start late, which leaves a dip or a gap.
        const double shift = i == 0 ? 0.0 : random.unit() * 0.9 * (cuts[2 * i - 1] - cuts[2 * i - 2]);
        const double a = i == 0 ? -kInf : cuts[2 * i - 2] + shift;
        const double b = i == 0 ? -kInf : cuts[2 * i - 1];
        const double c = i + 1 == terms ? kInf : cuts[2 * i];
        const double d = i + 1 == terms ? kInf : cuts[2 * i + 1];
        made.push_back({numbered("t", i), {a, b, c, d}, {}});
    }
    return variable("v", low, low + width, made);
}

/// Anything goes: terms nest, pile up and run past the edges.
Variable randomPile(Random& random)
{
    std::vector<Term> made;
    const uint32_t terms = 1 + random.below(6);
    for (uint32_t i = 0; i < terms; ++i) {
        std::array<double, 4> corners;
        for (double& corner : corners)
            corner = random.between(-0.3, 1.3);
        std::sort(corners.begin(), corners.end());
        corners[1] = std::max(corners[1], corners[0] + 0.05);
        corners[2] = std::max(corners[2], corners[1]);
        corners[3] = std::max(corners[3], corners[2] + 0.05);
        made.push_back({numbered("t", i), {corners[0], corners[1], corners[2], corners[3]}, {}});
    }
    return variable("v", 0, 1, made);
}

std::vector<double> randomStrengths(Random& random, std::size_t count)
{
    std::vector<double> strengths(count);
    for (double& s : strengths)
        s = random.below(3) == 0 ? 0.0 : random.unit();
    return strengths;
}

} // namespace

TEST_CASE("the centroid of one full trapezoid is that of the textbook formula")
{
    // Area and moment of a trapezoid with parallel sides d - a and c - b: two triangles and a rectangle.
    const Trapezoid t{0.1, 0.3, 0.6, 0.9};
    const double left = 0.5 * (t.b - t.a), middle = t.c - t.b, right = 0.5 * (t.d - t.c);
    const double moment = left * (t.a + 2 * t.b) / 3 + middle * (t.b + t.c) / 2 + right * (2 * t.c + t.d) / 3;
    const CentroidTerms terms(variable("v", 0, 1, {{"t", t, {}}}));
    REQUIRE(terms.isNeighbourForm());
    const Centroid found = terms.exact(std::array{1.0});
    CHECK(found.hasOpinion);
    CHECK(found.value == doctest::Approx(moment / (left + middle + right)).epsilon(1e-14));
}

TEST_CASE("without any strength there is no opinion, neither exact nor sampled")
{
    const CentroidTerms terms(defaultSuitability());
    const std::array<double, 3> none = {};
    CHECK_FALSE(terms.exact(none).hasOpinion);
    CHECK_FALSE(terms.exactGeneral(none).hasOpinion);
    CHECK_FALSE(terms.sampled(none, 100).hasOpinion);
    CHECK(terms.exact(std::array{0.0, 1e-9, 0.0}).hasOpinion);
}

TEST_CASE("the exact centroid equals 20000 samples to 1e-6 of the universe, on random ordered terms")
{
    Random random(1);
    for (int i = 0; i < 300; ++i) {
        const Variable v = randomPartition(random);
        const CentroidTerms terms(v);
        REQUIRE(terms.isNeighbourForm());
        const std::vector<double> strengths = randomStrengths(random, terms.termCount());
        const Centroid exact = terms.exact(strengths);
        const Centroid sampled = terms.sampled(strengths, 20'000);
        REQUIRE(exact.hasOpinion == sampled.hasOpinion);
        CHECK(std::abs(exact.value - sampled.value) <= 1e-6 * (v.high - v.low));
    }
}

TEST_CASE("the polynomial form and the envelope form agree to 1e-11 where both apply")
{
    Random random(2);
    for (int i = 0; i < 3000; ++i) {
        const Variable v = randomPartition(random);
        const CentroidTerms terms(v);
        const std::vector<double> strengths = randomStrengths(random, terms.termCount());
        const Centroid exact = terms.exact(strengths);
        const Centroid general = terms.exactGeneral(strengths);
        REQUIRE(exact.hasOpinion == general.hasOpinion);
        CHECK(std::abs(exact.value - general.value) <= 1e-11 * (v.high - v.low + std::abs(v.low)));
    }
}

TEST_CASE("terms that pile up are still integrated exactly")
{
    Random random(3);
    int opinions = 0;
    for (int i = 0; i < 300; ++i) {
        const CentroidTerms terms(randomPile(random));
        const std::vector<double> strengths = randomStrengths(random, terms.termCount());
        const Centroid exact = terms.exact(strengths);
        const Centroid sampled = terms.sampled(strengths, 20'000);
        if (!sampled.hasOpinion || !exact.hasOpinion) continue;
        ++opinions;
        CHECK(std::abs(exact.value - sampled.value) <= 1e-5); // edges of the universe cut flanks: O(1/n) there
    }
    CHECK(opinions > 200);
}

TEST_CASE("raising the strength of the highest term never lowers the centroid")
{
    const CentroidTerms terms(defaultSuitability());
    Random random(4);
    for (int i = 0; i < 200; ++i) {
        const double avoided = random.unit(), acceptable = random.unit();
        double previous = 0.0;
        for (int step = 0; step <= 50; ++step) {
            const double value = terms.exact(std::array{avoided, acceptable, step / 50.0}).value;
            CHECK(value >= previous - 1e-15);
            previous = value;
        }
    }
}
