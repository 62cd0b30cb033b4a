// Formulas of filtered moments, as the shaders have them, against counting and brute force.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "runtime/registry.hpp"
#include "shaders/filtered/moments.h"

namespace gnomon::gpu {
namespace {

/// What boxMeans() reads and writes here.
struct Memory {
    std::vector<vec4> source, means;
} memory;

vec4 sourceAt(const BoxSums& sums, uint at, uint line)
{
    return memory.source.at(boxTexel(sums, at, line));
}
void keep(const BoxSums& sums, uint at, uint line, vec4 value)
{
    memory.means.at(boxTexel(sums, at, line)) = value;
}
vec4 kept(const BoxSums& sums, uint at, uint line)
{
    return memory.means.at(boxTexel(sums, at, line));
}

struct Table {
    std::vector<glm::uvec4> before; ///< (side + 1)^2.
    uint side = 0;
} table;

glm::uvec4 summedBefore(uint x, uint y, float)
{
    return table.before.at(std::size_t{y} * (table.side + 1) + x);
}

} // namespace
} // namespace gnomon::gpu

#define BOX_SOURCE sourceAt
#define BOX_KEEP keep
#define BOX_KEPT kept
#define BOX_STORE keep
#include "shaders/filtered/box_means.h"
#define SUMMED_BEFORE summedBefore
#include "shaders/filtered/summed_mean.h"

namespace gnomon::gpu {
namespace {

/// Numbers that are the same with every C++ library.
class Random {
public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    float unit() { return static_cast<float>(static_cast<double>(engine_()) / 0x1p32); }
    std::uint32_t below(std::uint32_t end) { return static_cast<std::uint32_t>(engine_() % end); }

private:
    std::mt19937 engine_;
};

/// Every invocation of one filter pass.
void filter(const BoxSums& sums)
{
    memory.means.assign(memory.source.size(), vec4(-1.0f));
    const uint groups = (sums.side + BOX_GROUP - 1) / BOX_GROUP * ((sums.side + sums.box - 1) / sums.box);
    for (uint i = 0; i < BOX_GROUP * groups; ++i)
        boxMeans(sums, i);
}

MomentBounds constantsOf(uint kind, uint bits)
{
    return {.kind = kind,
            .exponent = momentExponent(kind, bits, 42.0f),
            .deviation = MOMENT_DEVIATION,
            .momentBias = MOMENT_BIAS};
}

vec4 mean(const MomentBounds& k, const std::vector<float>& depths)
{
    vec4 sum(0.0f);
    for (const float z : depths)
        sum += momentsOf(k.kind, k.exponent, z) / static_cast<float>(depths.size());
    return sum;
}

float shareLit(const std::vector<float>& depths, float z)
{
    return static_cast<float>(std::ranges::count_if(depths, [&](float depth) { return depth >= z; })) /
           static_cast<float>(depths.size());
}

} // namespace

TEST_CASE("box means along rows and columns equal sums by brute force, whatever the widths of box and image")
{
    Random random(1);
    for (const uint side : {1u, 2u, 7u, 64u, 100u}) {
        for (const uint box : {1u, 3u, 5u, 7u, 31u, 63u}) {
            for (const bool columns : {false, true}) {
                CAPTURE(side);
                CAPTURE(box);
                CAPTURE(columns);
                BoxSums sums{};
                sums.side = side;
                sums.box = box;
                sums.columns = columns ? 1 : 0;
                memory.source.resize(boxTexels(side));
                for (vec4& texel : memory.source)
                    texel = vec4(random.unit(), random.unit(), -random.unit(), 1.0f);
                filter(sums);
                float worst = 0.0f;
                for (uint line = 0; line < side; ++line) {
                    for (uint at = 0; at < side; ++at) {
                        glm::dvec4 expected(0.0);
                        for (int i = 0; i < static_cast<int>(box); ++i) {
                            const int from = static_cast<int>(at) + i - static_cast<int>(box / 2);
                            expected += glm::dvec4(sourceAt(
                                sums, static_cast<uint>(std::clamp(from, 0, static_cast<int>(side) - 1)), line));
                        }
                        const glm::dvec4 off = glm::abs(glm::dvec4(kept(sums, at, line)) - expected / double(box));
                        worst = std::max(worst, static_cast<float>(std::max({off.x, off.y, off.z, off.w})));
                    }
                }
                CHECK(worst < 1e-6f); // some ten roundings of numbers up to 1
            }
        }
    }
}

TEST_CASE("what is small beside e^84 in one line keeps its precision in a box mean")
{
    constexpr uint kSide = 64, kBox = 7;
    BoxSums sums{};
    sums.side = kSide;
    sums.box = kBox;
    memory.source.assign(boxTexels(kSide), vec4(3e36f));
    for (uint at = 20; at < 40; ++at)
        memory.source[boxTexel(sums, at, 0)] = vec4(1.5f);
    filter(sums);
    for (uint at = 23; at < 37; ++at)
        CHECK(kept(sums, at, 0).x == doctest::Approx(1.5));
}

// Sums of 100 x 100 texels of up to 2^20 go round 2^32 twice.
TEST_CASE("means of boxes anywhere in a table of sums that went round are those of the area that the box covers")
{
    Random random(3);
    table.side = 100;
    const uint side = table.side;
    std::vector<float> texels(std::size_t{side} * side);
    for (float& texel : texels)
        texel = std::floor(random.unit() * SUMMED_STEPS + 0.5f);
    table.before.assign(std::size_t{side + 1} * (side + 1), glm::uvec4(0));
    for (uint y = 0; y < side; ++y)
        for (uint x = 0; x < side; ++x)
            table.before[std::size_t{y + 1} * (side + 1) + x + 1] =
                summedBefore(x + 1, y, 0.0f) + summedBefore(x, y + 1, 0.0f) - summedBefore(x, y, 0.0f) +
                glm::uvec4(static_cast<uint>(texels[std::size_t{y} * side + x]), 1, 2, 3);
    for (int trial = 0; trial < 2000; ++trial) {
        const vec2 at(random.unit() * 110.0f - 5.0f, random.unit() * 110.0f - 5.0f);
        const vec2 width(random.unit() * 70.0f, random.unit() * 70.0f);
        const auto reach = [&](float middle, float wide) {
            const float w = std::clamp(wide, 1.0f, MAX_SUMMED_BOX), m = std::clamp(middle, 0.0f, 100.0f);
            return vec2(std::max(m - 0.5f * w, 0.0f), std::min(m + 0.5f * w, 100.0f));
        };
        const vec2 across = reach(at.x, width.x), down = reach(at.y, width.y);
        double sum = 0.0, area = 0.0;
        for (uint y = 0; y < side; ++y) {
            for (uint x = 0; x < side; ++x) {
                const auto covered = [](vec2 range, uint texel) {
                    const float from = static_cast<float>(texel);
                    return double{std::max(std::min(range.y, from + 1.0f) - std::max(range.x, from), 0.0f)};
                };
                const double share = covered(across, x) * covered(down, y);
                sum += share * double{texels[std::size_t{y} * side + x]};
                area += share;
            }
        }
        const vec4 mean = boxMean(at, width, side, 0.0f);
        CHECK(mean.x == doctest::Approx(sum / area / double{SUMMED_STEPS}).epsilon(1e-4));
        CHECK(mean.z == doctest::Approx(2.0 / double{SUMMED_STEPS}).epsilon(1e-3));
    }
}

TEST_CASE("quantised moments fill [0, 1] and are undone by their inverse")
{
    vec4 low(1.0f), high(0.0f);
    for (int i = 0; i <= 1000; ++i) {
        const float z = static_cast<float>(i) / 1000.0f;
        const vec4 m = momentsOf(MOMENTS_MSM, 1.0f, z), q = toQuantised(m), back = fromQuantised(q);
        low = glm::min(low, q);
        high = glm::max(high, q);
        for (int c = 0; c < 4; ++c)
            CHECK(back[c] == doctest::Approx(m[c]).epsilon(1e-4));
    }
    for (int c = 0; c < 4; ++c) {
        CHECK(low[c] > -1e-5f);
        CHECK(low[c] < 0.01f);
        CHECK(high[c] < 1.0f + 1e-5f);
        CHECK(high[c] > 0.99f);
    }
}

TEST_CASE("kinds with several moments never say less light than the share of depths that are lit, and four moments "
          "less than two")
{
    Random random(2);
    double excess[MOMENT_KINDS] = {};
    int count = 0;
    for (int trial = 0; trial < 3000; ++trial) {
        std::vector<float> layers(1 + random.below(4)), depths(1 + random.below(60));
        for (float& z : layers)
            z = random.unit();
        for (float& z : depths)
            z = layers[random.below(static_cast<std::uint32_t>(layers.size()))];
        const float z = random.unit();
        const float lit = shareLit(depths, z);
        ++count;
        for (const uint kind : {MOMENTS_VSM, MOMENTS_EVSM2, MOMENTS_EVSM4, MOMENTS_MSM}) {
            CAPTURE(kind);
            const MomentBounds k = constantsOf(kind, 32);
            const float said = momentsLit(k, mean(k, depths), z, z);
            CHECK(said >= lit - 2e-3f); // rounding of four moments, and their bias
            excess[kind] += static_cast<double>(said - lit);
        }
    }
    for (double& sum : excess)
        sum /= count;
    MESSAGE("mean excess: VSM " << excess[MOMENTS_VSM] << ", EVSM2 " << excess[MOMENTS_EVSM2] << ", EVSM4 "
                                << excess[MOMENTS_EVSM4] << ", MSM " << excess[MOMENTS_MSM]);
    CHECK(excess[MOMENTS_EVSM4] < excess[MOMENTS_VSM]);
    CHECK(excess[MOMENTS_MSM] < excess[MOMENTS_VSM]);
}

TEST_CASE("of two depths, the receiver on the farther, every kind gives the share of the farther")
{
    for (const uint kind : {MOMENTS_VSM, MOMENTS_ESM, MOMENTS_EVSM2, MOMENTS_EVSM4, MOMENTS_MSM}) {
        CAPTURE(kind);
        const MomentBounds k = constantsOf(kind, 32);
        for (int lit = 0; lit <= 10; ++lit) {
            std::vector<float> depths(10, 0.3f);
            std::fill_n(depths.begin(), lit, 0.8f);
            CHECK(momentsLit(k, mean(k, depths), 0.8f, 0.8f) == doctest::Approx(0.1 * lit).epsilon(0.01));
        }
    }
}

TEST_CASE("a receiver on a plane that is in the map at any slope is lit by every kind")
{
    for (uint kind = 0; kind < MOMENT_KINDS; ++kind) {
        const MomentBounds k = constantsOf(kind, 32);
        for (const float half : {0.3f, 0.1f, 0.03f, 0.01f, 0.001f}) {
            CAPTURE(kind);
            CAPTURE(half);
            std::vector<float> depths(1001);
            for (std::size_t i = 0; i < depths.size(); ++i)
                depths[i] = 0.5f + half * (static_cast<float>(i) / 500.0f - 1.0f);
            const float lit = momentsLit(k, mean(k, depths), 0.5f, 0.5f - half / std::sqrt(3.0f));
            CHECK(lit > 0.95f);
            if (kind == MOMENTS_MSM) CHECK(momentsLit(k, mean(k, depths), 0.5f, 0.5f) < (half > 0.05f ? 0.8f : 1.01f));
        }
    }
}

TEST_CASE("no depths, exponents and formats give what is no number, and none that a format cannot hold")
{
    for (uint kind = 0; kind < MOMENT_KINDS; ++kind) {
        for (const uint bits : {16u, 32u}) {
            for (const float asked : {-1.0f, 0.0f, 1.0f, 40.0f, 1e30f}) {
                MomentBounds k = constantsOf(kind, bits);
                k.exponent = momentExponent(kind, bits, asked);
                CAPTURE(kind);
                CAPTURE(bits);
                CAPTURE(asked);
                for (const float a : {0.0f, 0x1p-24f, 0.5f, 1.0f}) {
                    for (const float b : {0.0f, 0.5f, 1.0f}) {
                        const vec4 m = mean(k, {a, b});
                        for (int c = 0; c < 4; ++c)
                            CHECK(std::fabs(m[c]) < (bits == 16 && kind != MOMENTS_MSM ? 65504.0f : 3.4e38f));
                        for (const float z : {0.0f, 0x1p-24f, 0.5f, 1.0f}) {
                            const float lit = momentsLit(k, m, z, z);
                            CHECK(lit >= 0.0f);
                            CHECK(lit <= 1.0f);
                        }
                    }
                }
            }
        }
    }
    const LinearDepth spot{.scale = 0.001f, .offset = 0.0f, .perspective = 1.0f, .padding = 0.0f};
    CHECK(linearZ(spot, 0.0f) == doctest::Approx(0.001));
    CHECK(linearZ(spot, 1.0f) == 1.0f);
    CHECK(linearZ(spot, -1e30f) == doctest::Approx(0.0));
}

// Shaders for images of such sides differ: the warm-up runs those.
TEST_CASE("smaller maps lie in an image whose sides are powers of two as the map's are, side by side")
{
    for (uint side = 64; side <= 2048; side *= 2) {
        const uvec2 extent = momentLevelsExtent(side);
        CHECK(std::has_single_bit(extent.x));
        CHECK(std::has_single_bit(extent.y));
        std::vector<int> covered(size_t{extent.x} * extent.y);
        for (uint level = 1; level <= MOMENT_LEVELS; ++level) {
            const uvec2 corner = momentLevelCorner(side, level);
            REQUIRE(corner.x + (side >> level) <= extent.x);
            REQUIRE(corner.y + (side >> level) <= extent.y);
            for (uint y = 0; y < side >> level; ++y)
                for (uint x = 0; x < side >> level; ++x)
                    ++covered[size_t{corner.y + y} * extent.x + corner.x + x];
        }
        CHECK(std::ranges::max(covered) == 1);
    }
}

namespace {

const AlgorithmEntry& entryOfMoments()
{
    for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms)
        if (std::string_view(algorithm.entry->name) == "moments") return *algorithm.entry;
    FAIL("it is in every build");
    return *builtinRegistry().algorithms[0].entry;
}

std::size_t indexOf(const AlgorithmEntry& entry, std::string_view setting)
{
    std::size_t index = 0;
    while (entry.settings[index].name != setting)
        REQUIRE(++index < entry.settings.size());
    return index;
}

} // namespace

TEST_CASE("the exponent that is said to be in use is computed with, and kinds without one are not spoken of")
{
    const AlgorithmEntry& entry = entryOfMoments();
    const std::size_t exponent = indexOf(entry, "exponent");
    std::vector<double> settings;
    for (const SettingSpec& spec : entry.settings)
        settings.push_back(spec.standard);
    for (uint kind = 0; kind < MOMENT_KINDS; ++kind)
        for (const uint bits : {16u, 32u})
            for (const double asked : {1.0, 5.5, 6.0, 11.0, 12.0, 42.0}) {
                CAPTURE(kind);
                CAPTURE(bits);
                CAPTURE(asked);
                settings[indexOf(entry, "kind")] = kind;
                settings[indexOf(entry, "bits")] = bits;
                settings[exponent] = asked;
                const bool hasNone = kind == MOMENTS_VSM || kind == MOMENTS_MSM;
                const float used = momentExponent(kind, bits, static_cast<float>(asked));
                CHECK(entry.countsAs(settings, exponent) == (hasNone ? asked : double{used}));
                for (std::size_t i = 0; i < settings.size(); ++i)
                    if (i != exponent) CHECK(entry.countsAs(settings, i) == settings[i]);
            }
}

TEST_CASE("the setting says what the exponent is clamped to, and does not take more than 32 bits hold")
{
    const AlgorithmEntry& entry = entryOfMoments();
    const SettingSpec* setting = &entry.settings[indexOf(entry, "exponent")];
    const std::string_view about = setting->description;
    const auto clamped = [](uint kind, uint bits) {
        char text[16];
        std::snprintf(text, sizeof text, "%.2f", double(momentExponent(kind, bits, 1e30f)));
        return std::string(text);
    };
    CHECK(about.find("16 bits hold, " + clamped(MOMENTS_EVSM4, 16) + ",") != std::string_view::npos);
    CHECK(about.find("of ESM " + clamped(MOMENTS_ESM, 16) + ".") != std::string_view::npos);
    for (const uint kind : {MOMENTS_EVSM2, MOMENTS_EVSM4, MOMENTS_ESM})
        CHECK(momentExponent(kind, 32, static_cast<float>(setting->maximum)) == static_cast<float>(setting->maximum));
}

} // namespace gnomon::gpu
