// The quadtree of a light's source.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include "algorithms/area/source_quads.hpp"

using namespace gnomon;

TEST_CASE("each of 289 points has a place of its own, those of a level in the level's words")
{
    std::set<std::uint32_t> places;
    for (std::uint32_t y = 0; y < kLattice; ++y) {
        for (std::uint32_t x = 0; x < kLattice; ++x) {
            const std::uint32_t place = placeOf({x, y});
            places.insert(place);
            CHECK(pointIn(place).x == x);
            CHECK(pointIn(place).y == y);
        }
    }
    CHECK(places.size() == 289);
    const std::uint32_t counts[] = {4, 5, 16, 56, 208};
    for (std::uint32_t level = 0; level <= kQuadLevels; ++level)
        CHECK(std::count_if(places.begin(), places.end(), [&](std::uint32_t place) {
                  return place / kWordPoints >= kFirstWord[level] && place / kWordPoints < kFirstWord[level + 1];
              }) == counts[level]);
    CHECK(pointIn(31).x == kLattice);
}

TEST_CASE("whatever is divided, weights are those of the trapezoidal rule: one in all, on needed points alone")
{
    std::mt19937 random(7);
    for (int run = 0; run < 200; ++run) {
        SourceQuads quads;
        const double odds = (run % 10) / 9.0;
        for (std::uint32_t level = 0; level < kQuadLevels; ++level) {
            std::vector<std::uint32_t> flags(quads.quads().size());
            std::generate(flags.begin(), flags.end(), [&] { return double(random()) / 4294967296.0 < odds ? 1u : 0u; });
            quads.divide(flags);
        }
        quads.end();
        double sum = 0.0, meanX = 0.0, meanY = 0.0;
        for (std::uint32_t place = 0; place < kPointWords * kWordPoints; ++place) {
            const float weight = quads.weight(place);
            if ((quads.needed(place / kWordPoints) >> place % kWordPoints & 1) == 0) CHECK(weight == 0.0f);
            if (weight == 0.0f) continue;
            sum += weight;
            meanX += weight * pointIn(place).square().x;
            meanY += weight * pointIn(place).square().y;
        }
        CHECK(sum == doctest::Approx(1.0));
        CHECK(std::abs(meanX) < 1e-5); // it integrates a plane exactly
        CHECK(std::abs(meanY) < 1e-5);
        if (odds == 0.0) CHECK(quads.points() == 4);
        if (odds == 1.0) CHECK(quads.points() == 289);
    }
}
