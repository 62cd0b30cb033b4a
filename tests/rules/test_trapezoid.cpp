#include "rules_support.hpp"

#include <algorithm>
#include <cmath>

#include <cmath>

#include "rules/engine/trapezoid.hpp"

using namespace gnomon::rules;
using namespace gnomon::rules::test;

namespace {

struct Case {
    const char* what;
    Trapezoid shape;
    double x;
    double expected;
};

const double kBelow2 = std::nextafter(2.0, 0.0);
const double kAbove8 = std::nextafter(8.0, 9.0);

const Case kCases[] = {
    {"far left", {2, 4, 6, 8}, -kInf, 0},
    {"just outside the left foot", {2, 4, 6, 8}, kBelow2, 0},
    {"left foot", {2, 4, 6, 8}, 2, 0},
    {"middle of the rising flank", {2, 4, 6, 8}, 3, 0.5},
    {"left shoulder", {2, 4, 6, 8}, 4, 1},
    {"core", {2, 4, 6, 8}, 5, 1},
    {"right shoulder", {2, 4, 6, 8}, 6, 1},
    {"quarter of the falling flank", {2, 4, 6, 8}, 7.5, 0.25},
    {"right foot", {2, 4, 6, 8}, 8, 0},
    {"just outside the right foot", {2, 4, 6, 8}, kAbove8, 0},
    {"far right", {2, 4, 6, 8}, kInf, 0},
    {"NaN", {2, 4, 6, 8}, kNan, 0},
    {"left shoulder at -inf", {-kInf, -kInf, 6, 8}, -kInf, 1},
    {"left shoulder far out", {-kInf, -kInf, 6, 8}, -1e300, 1},
    {"left shoulder, flank", {-kInf, -kInf, 6, 8}, 7, 0.5},
    {"left shoulder, NaN", {-kInf, -kInf, 6, 8}, kNan, 0},
    {"right shoulder at +inf", {2, 4, kInf, kInf}, kInf, 1},
    {"right shoulder, flank", {2, 4, kInf, kInf}, 2.5, 0.25},
    {"everything", {-kInf, -kInf, kInf, kInf}, -kInf, 1},
    {"everything, NaN", {-kInf, -kInf, kInf, kInf}, kNan, 0},
    {"triangle, apex", {0, 5, 5, 10}, 5, 1},
    {"triangle, just beside the apex is not the apex", {0, 0.5, 0.5, 1}, 0.4999995, 0.999999},
    {"vertical edges belong to the term", {2, 2, 8, 8}, 2, 1},
    {"vertical edges, one ulp outside", {2, 2, 8, 8}, kAbove8, 0},
    {"single point", {3, 3, 3, 3}, 3, 1},
};

} // namespace

TEST_CASE("a trapezoid has the tabulated membership at infinities, NaN, every corner and between corners")
{
    for (const Case& c : kCases) {
        CAPTURE(c.what);
        CHECK(c.shape.membership(c.x) == doctest::Approx(c.expected).epsilon(1e-15));
    }
}

TEST_CASE("terms that share a flank sum to one on it")
{
    const Trapezoid falling{-kInf, -kInf, 30, 60};
    const Trapezoid rising{30, 60, kInf, kInf};
    for (int i = -100; i <= 1000; ++i)
        CHECK(falling.membership(0.1 * i) + rising.membership(0.1 * i) == doctest::Approx(1.0).epsilon(1e-15));
    CHECK(falling.membership(45) == rising.membership(45)); // exactly: ties are decided by others
}

TEST_CASE("as evaluation has it a term is exact at its corners, and elsewhere as near as three roundings allow")
{
    Random random(71);
    for (int round = 0; round < 20'000; ++round) {
        double corners[4];
        const double scale = std::pow(10.0, random.between(-6.0, 9.0));
        for (double& corner : corners)
            corner = random.between(-scale, scale);
        std::sort(std::begin(corners), std::end(corners));
        Trapezoid term = {corners[0], corners[1], corners[2], corners[3]};
        if (round % 7 == 0) term.b = term.a; // vertical edges, shoulders, triangles
        if (round % 5 == 0) term.c = term.d;
        if (round % 11 == 0) term.c = term.b;
        if (round % 13 == 0) term.a = term.b = -kInf;
        if (round % 17 == 0) term.c = term.d = kInf;
        const Flanks flanks = flanksOf(term);
        for (const double corner : {term.a, term.b, term.c, term.d}) {
            if (std::isinf(corner)) continue;
            for (const double x : {std::nextafter(corner, -kInf), corner, std::nextafter(corner, kInf)}) {
                const double exact = term.membership(x), fast = flanks.membership(x);
                REQUIRE((exact == 0.0) == (fast == 0.0));
                if (x == corner) REQUIRE(exact == fast);
                REQUIRE(std::abs(exact - fast) <= 3e-16);
            }
        }
        for (int i = 0; i < 20; ++i) {
            const double x = random.between(-1.2 * scale, 1.2 * scale);
            REQUIRE(std::abs(term.membership(x) - flanks.membership(x)) <= 5e-16 * term.membership(x));
        }
    }
}
