// Percentage-closer filtering of revectorized edges, and what both fetch: on pictures of shadows, without a device.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "revectorized_fixture.hpp"

using namespace gnomon;

namespace {

float kernelOf(const gpu::Picture& picture, glm::vec2 at, uint32_t side, uint64_t* fetches = nullptr)
{
    return gpu::lineKernelVisibility({&picture, fetches}, at, gpu::boxKernel(side), kLongest);
}

/// The share of a texel's box around a place that is lit.
float bilinear(const gpu::Picture& picture, glm::vec2 at)
{
    const glm::vec2 low = at - 0.5f, part = low - glm::floor(low);
    const auto texel = [&](float x, float y) { return nearest(picture, glm::floor(low) + glm::vec2(x, y) + 0.5f); };
    const float first = (1.0f - part.x) * texel(0.0f, 0.0f) + part.x * texel(1.0f, 0.0f);
    const float second = (1.0f - part.x) * texel(0.0f, 1.0f) + part.x * texel(1.0f, 1.0f);
    return (1.0f - part.y) * first + part.y * second;
}

/// One tap by itself, its stairs followed from its own texel: bilinear at a straight edge, half so at tips and notches.
float tapAlone(const gpu::Picture& picture, glm::vec2 at, uint64_t* fetches)
{
    const gpu::Tap tap{&picture, fetches};
    const glm::vec2 corner = glm::floor(at), centre = corner + 0.5f;
    const bool lit = gpu::texelLit(tap, centre);
    const uint32_t edges = gpu::texelEdges(tap, centre, lit);
    if (edges == 0u) return lit ? 1.0f : 0.0f;
    const gpu::StairEnds ends = gpu::stairEnds(tap, centre, lit, edges, gpu::noSteps(), 15u, kLongest);
    if (gpu::stairPlaces(ends, at - corner, kLongest) < 0.0f) return bilinear(picture, at);
    const float ramp = gpu::revectorizedVisibility({&picture}, at, gpu::REVECTORIZE_FILTERED, kLongest);
    const bool twice = (ends.closed & 3u) == 3u || (ends.closed >> 2) == 3u;
    return twice ? 0.5f * (ramp + bilinear(picture, at)) : ramp;
}

/// The mean of side x side taps, `spacing` texels apart.
template <typename Taps>
float meanOf(glm::vec2 at, uint32_t side, float spacing, const Taps& tap)
{
    float sum = 0.0f;
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x)
            sum += tap(at + spacing * (glm::vec2(float(x), float(y)) - 0.5f * float(side - 1)));
    return sum / float(side * side);
}

gpu::Picture noise(std::mt19937& random)
{
    gpu::Picture picture;
    const double density = between(random, 0.05, 0.95);
    for (bool& texel : picture.shadow)
        texel = between(random, 0.0, 1.0) < density;
    return picture;
}

glm::vec2 anywhere(std::mt19937& random)
{
    const double x = between(random, 0.0, gpu::kSide);
    return {float(x), float(between(random, 0.0, gpu::kSide))};
}

/// Share of a box that is lit, by 64 x 64 places.
double boxLit(const Shape& shape, glm::vec2 at, double width)
{
    constexpr int kPlaces = 64;
    int lit = 0;
    for (int y = 0; y < kPlaces; ++y)
        for (int x = 0; x < kPlaces; ++x)
            lit += !shape(double(at.x) + width * ((x + 0.5) / kPlaces - 0.5),
                          double(at.y) + width * ((y + 0.5) / kPlaces - 0.5));
    return double(lit) / (kPlaces * kPlaces);
}

} // namespace

TEST_CASE("runs that taps take over are what each tap would find by itself, on shapes and on noise")
{
    std::mt19937 random(11);
    std::vector<gpu::Picture> pictures;
    for (const Shape& shape : halfPlanes())
        pictures.push_back(drawn(shape));
    for (const Shape& shape : discs(5.0, 40.0))
        pictures.push_back(drawn(shape));
    for (int i = 0; i < 20; ++i)
        pictures.push_back(noise(random));
    float apart = 0.0f;
    for (const gpu::Picture& picture : pictures) {
        for (int i = 0; i < 60; ++i) {
            const glm::vec2 at = anywhere(random); // at the map's border too
            for (const uint32_t side : {1u, 3u, 7u, 15u}) {
                const float alone =
                    meanOf(at, side, 1.0f, [&](glm::vec2 tap) { return tapAlone(picture, tap, nullptr); });
                apart = std::max(apart, std::abs(kernelOf(picture, at, side) - alone));
            }
        }
    }
    MESSAGE("apart by at most " << apart);
    CHECK(apart < 1e-4f);
}

TEST_CASE("a kernel of 7 x 7 fetches less than half of what its taps would fetch one by one")
{
    std::mt19937 random(12);
    uint64_t together = 0, alone = 0, unfiltered = 0;
    for (const std::vector<Shape>& shapes : {halfPlanes(), discs(5.0, 10.0), discs(20.0, 40.0)}) {
        for (const Shape& shape : shapes) {
            const gpu::Picture picture = drawn(shape);
            for (int i = 0; i < 200; ++i) {
                const glm::vec2 at = anywhere(random);
                const double lit = boxLit(shape, at, 7.0);
                if (lit == 0.0 || lit == 1.0) continue; // in the penumbra
                kernelOf(picture, at, 7, &together);
                meanOf(at, 7, 1.0f, [&](glm::vec2 tap) { return tapAlone(picture, tap, &alone); });
                unfiltered += 49;
            }
        }
    }
    MESSAGE("fetches a tap: " << double(together) / double(unfiltered) << " together, "
                              << double(alone) / double(unfiltered) << " alone");
    CHECK(unfiltered > 50000);
    CHECK(2 * together <= alone);
}

TEST_CASE("7 x 7 revectorized taps are as good as 15 x 15 nearest ones over the same width")
{
    struct Row {
        const char* name;
        std::vector<Shape> shapes;
    };
    for (const Row& row : {Row{"half-planes", halfPlanes()}, {"discs of 20 to 40 texels", discs(20.0, 40.0)}}) {
        std::mt19937 random(13);
        double revectorized = 0.0, fine = 0.0, coarse = 0.0, bilinear = 0.0;
        uint64_t pixels = 0;
        for (const Shape& shape : row.shapes) {
            const gpu::Picture picture = drawn(shape);
            for (int i = 0; i < 120; ++i) {
                const glm::vec2 at(float(between(random, kFirst + 4.0, kEnd - 4.0)),
                                   float(between(random, kFirst + 4.0, kEnd - 4.0)));
                const double truth = boxLit(shape, at, 7.0);
                if (truth == 0.0 || truth == 1.0) continue;
                const auto tap = [&](glm::vec2 place) { return nearest(picture, place); };
                revectorized += std::abs(double(kernelOf(picture, at, 7)) - truth);
                fine += std::abs(double(meanOf(at, 15, 7.0f / 15.0f, tap)) - truth);
                coarse += std::abs(double(meanOf(at, 7, 1.0f, tap)) - truth);
                bilinear += std::abs(boxLit(
                                         [&](double x, double y) {
                                             return nearest(picture, {float(x), float(y)}) == 0.0f;
                                         },
                                         at, 7.0) -
                                     truth);
                ++pixels;
            }
        }
        const double n = double(pixels);
        MESSAGE(std::string(row.name) << ", width 7, mean error of " << pixels << " receivers: 7 x 7 revectorized "
                                      << revectorized / n << ", nearest 15 x 15 " << fine / n << " and 7 x 7 "
                                      << coarse / n << ", the texels themselves " << bilinear / n);
        CHECK(pixels > 1000);
        CHECK(revectorized <= fine);
        CHECK(1.8 * revectorized <= coarse);
    }
}

TEST_CASE("kernels that lie in the light or in the dark say so exactly, and what lies between rises evenly")
{
    const gpu::Picture picture = drawn(halfPlane(0.4, {32.0, 32.0}));
    const glm::vec2 normal(-std::sin(0.4f), std::cos(0.4f));
    float before = 0.0f, steepest = 0.0f;
    for (int i = -160; i <= 160; ++i) { // sixteenths of a texel across the edge
        const glm::vec2 at = glm::vec2(32.0f, 32.0f) + normal * (float(i) / 16.0f);
        const float lit = kernelOf(picture, at, 7);
        if (i < -16 * 6) CHECK(lit == 0.0f);
        if (i > 16 * 6) CHECK(lit == 1.0f);
        CHECK(lit >= before - 0.01f);
        steepest = std::max(steepest, lit - before);
        before = lit;
    }
    MESSAGE("steepest rise in a sixteenth of a texel: " << steepest);
    CHECK(steepest <= 3.0f / (7.0f * 16.0f)); // thrice the mean
}

TEST_CASE("what lies beside no edge fetches five texels, and lines cost in proportion to edges")
{
    const auto fetched = [](const gpu::Picture& picture, uint32_t mode, bool edges, uint64_t& pixels) {
        uint64_t fetches = 0;
        for (int y = kFirst; y < kEnd; ++y) {
            for (int x = kFirst; x < kEnd; ++x) {
                const glm::vec2 at(float(x) + 0.3f, float(y) + 0.6f), centre = glm::floor(at) + 0.5f;
                const bool lit = nearest(picture, at) != 0.0f;
                if ((gpu::texelEdges({&picture}, centre, lit) != 0u) != edges) continue;
                ++pixels;
                uint64_t own = 0;
                gpu::revectorizedVisibility({&picture, &own}, at, mode, kLongest);
                if (!edges) CHECK(own <= 5);
                fetches += own;
            }
        }
        return fetches;
    };
    // Overhead beyond the map's own fetch, of pixels at edges.
    const auto overhead = [&](const std::vector<Shape>& shapes, uint32_t mode, uint64_t& pixels) {
        uint64_t fetches = 0, away = 0;
        for (const Shape& shape : shapes) {
            const gpu::Picture picture = drawn(shape);
            fetches += fetched(picture, mode, true, pixels);
            fetched(picture, mode, false, away);
        }
        CHECK(away > 1000);
        return double(fetches - pixels);
    };
    uint64_t ofGrown = 0, ofMiddle = 0, ofBands = 0;
    const double grown = overhead(halfPlanes(), gpu::REVECTORIZE_CONSERVATIVE, ofGrown);
    const double middle = overhead(halfPlanes(), gpu::REVECTORIZE_NONCONSERVATIVE, ofMiddle);
    std::vector<Shape> bands; // the same edges and a second one, 8 texels away
    for (const Shape& line : halfPlanes())
        bands.push_back([=](double x, double y) { return line(x, y) != line(x + 8.0, y + 8.0); });
    const double twice = overhead(bands, gpu::REVECTORIZE_NONCONSERVATIVE, ofBands);
    MESSAGE("fetches beyond the map's: conservative " << grown << ", middle " << middle << " at " << ofMiddle
                                                      << " pixels, of bands " << twice << " at " << ofBands);
    CHECK(grown <= middle);
    CHECK(middle <= 2.05 * grown); // where it is dark, at half of the pixels, a conservative line asks nothing
    CHECK(double(ofBands) > 1.3 * double(ofMiddle));
    const double each = middle / double(ofMiddle), eachOfBands = twice / double(ofBands);
    CHECK(std::abs(eachOfBands - each) <= 0.2 * each);
}
