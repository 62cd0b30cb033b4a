// Silhouette revectorization on maps that are pictures of shadows: no device, and the receiver lies in one plane.
#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "revectorized_fixture.hpp"
#include "runtime/registry.hpp"

using namespace gnomon;

namespace {

/// Areas of a picture that came out wrong, samples.
struct Wrong {
    double over = 0.0, under = 0.0; ///< Dark where it should be lit, and the reverse.
    double all() const { return over + under; }
    void add(float visibility, bool shadow)
    {
        (shadow ? under : over) += shadow ? double(visibility) : 1.0 - double(visibility);
    }
};

struct Errors {
    Wrong map, conservative, middle;
};

Errors errorsOf(const std::vector<Shape>& shapes, uint32_t longest = kLongest)
{
    Errors errors;
    for (const Shape& shape : shapes) {
        const gpu::Picture picture = drawn(shape);
        forSamples([&](glm::vec2 at) {
            const bool shadow = shape(double(at.x), double(at.y));
            errors.map.add(nearest(picture, at), shadow);
            errors.conservative.add(revectorized(picture, at, gpu::REVECTORIZE_CONSERVATIVE, longest), shadow);
            errors.middle.add(revectorized(picture, at, gpu::REVECTORIZE_NONCONSERVATIVE, longest), shadow);
        });
    }
    return errors;
}

} // namespace

TEST_CASE("revectorized visibility is what was worked out by hand")
{
    const Shape stairs = [](double x, double y) { return y < 6.0 + std::floor(x / 4.0); };
    const Shape notch = [](double x, double y) { return y < 20.0 && !(x >= 10.0 && x < 14.0 && y >= 19.0); };
    const Shape bump = [](double x, double y) { return y < 20.0 || (x >= 10.0 && x < 14.0 && y < 21.0); };
    const Shape spot = [](double x, double y) { return x >= 10.0 && x < 11.0 && y >= 10.0 && y < 11.0; };
    const Shape hole = [=](double x, double y) { return !spot(x, y); };
    const Shape straight = [](double x, double) { return x < 24.0; };
    const Shape step = [](double x, double y) { return y < (x < 40.0 ? 20.0 : 21.0); };
    struct Row {
        const Shape& shape;
        glm::vec2 at;
        float conservative, middle, filtered;
    };
    const Row rows[] = {
        {stairs, {10.5f, 8.25f}, 0, 1, 0.625f}, {stairs, {11.75f, 8.10f}, 0, 0, 0.1625f},
        {stairs, {9.0f, 8.5f}, 1, 1, 1},        {stairs, {10.5f, 7.75f}, 0, 0, 0.125f},
        {stairs, {8.5f, 7.9f}, 0, 1, 0.775f},   {stairs, {8.25f, 7.6f}, 0, 1, 0.5375f},
        {notch, {10.5f, 19.25f}, 0, 1, 0.5f},   {notch, {12.0f, 19.25f}, 1, 1, 1},
        {notch, {12.0f, 19.75f}, 1, 1, 1},      {notch, {12.0f, 18.9f}, 0, 0, 0},
        {bump, {10.5f, 20.75f}, 0, 0, 0.5f},    {bump, {12.0f, 20.75f}, 0, 0, 0},
        {spot, {10.1f, 10.1f}, 0, 1, 0.6f},     {spot, {10.5f, 10.5f}, 0, 0, 0},
        {hole, {10.1f, 10.1f}, 0, 0, 0.4f},     {straight, {23.5f, 30.5f}, 0, 0, 0},
        {straight, {24.5f, 30.5f}, 1, 1, 1},    {step, {39.5f, 20.25f}, 0, 0, 0.28125f},
        {step, {30.0f, 20.25f}, 0, 1, 0.875f},  {step, {23.5f, 20.05f}, 1, 1, 1},
    };
    for (const Row& row : rows) {
        CAPTURE(row.at.x);
        CAPTURE(row.at.y);
        const gpu::Picture picture = drawn(row.shape);
        CHECK(revectorized(picture, row.at, gpu::REVECTORIZE_CONSERVATIVE) == row.conservative);
        CHECK(revectorized(picture, row.at, gpu::REVECTORIZE_NONCONSERVATIVE) == row.middle);
        CHECK(std::abs(revectorized(picture, row.at, gpu::REVECTORIZE_FILTERED) - row.filtered) < 1e-5f);
    }
}

TEST_CASE("conservative lines only darken, and away from edges nothing changes")
{
    std::mt19937 random(3);
    int darkened = 0, changed = 0;
    for (int i = 0; i < 20; ++i) {
        gpu::Picture noise;
        const double density = between(random, 0.05, 0.95);
        for (bool& texel : noise.shadow)
            texel = between(random, 0.0, 1.0) < density;
        for (int j = 0; j < 4000; ++j) {
            const double x = between(random, 0.0, gpu::kSide);
            const glm::vec2 at(x, between(random, 0.0, gpu::kSide)), centre = glm::floor(at) + 0.5f;
            const float map = nearest(noise, at);
            const float lines[] = {revectorized(noise, at, gpu::REVECTORIZE_CONSERVATIVE),
                                   revectorized(noise, at, gpu::REVECTORIZE_NONCONSERVATIVE),
                                   revectorized(noise, at, gpu::REVECTORIZE_FILTERED)};
            REQUIRE(lines[0] <= map);
            for (const float line : lines) {
                REQUIRE((line >= 0.0f && line <= 1.0f)); // not NaN, also on a texel's border
                if (gpu::texelEdges({&noise}, centre, map != 0.0f) == 0u) REQUIRE(line == map);
            }
            darkened += lines[0] < map;
            changed += lines[1] != map;
        }
    }
    CHECK(darkened > 1000);
    CHECK(changed > 1000);
}

TEST_CASE("lines through the middles of stairs are nearer to the truth than the stairs, and hardly one-sided")
{
    struct Row {
        const char* name;
        std::vector<Shape> shapes;
        double better; ///< At least; 2.7, 1.8 and 2.2 were worked out.
    };
    const Row rows[] = {{"half-planes", halfPlanes(), 2.0},
                        {"discs of 5 to 10 texels", discs(5.0, 10.0), 1.5},
                        {"discs of 20 to 40 texels", discs(20.0, 40.0), 2.0}};
    for (const Row& row : rows) {
        const Errors errors = errorsOf(row.shapes);
        MESSAGE(std::string(row.name) << ": map " << errors.map.all() << ", conservative " << errors.conservative.over
                                      << " over and " << errors.conservative.under << " under, middle "
                                      << errors.middle.over << " and " << errors.middle.under);
        CHECK(errors.map.all() >= row.better * errors.middle.all());
        CHECK(errors.middle.over <= 0.5 * errors.conservative.over);
        CHECK(errors.conservative.under <= 0.2 * errors.conservative.over);
    }
    double before = std::numeric_limits<double>::infinity();
    for (const uint32_t longest : {8u, 16u, 32u}) {
        const double now = errorsOf(halfPlanes(), longest).middle.all();
        MESSAGE("half-planes with stairs followed for " << longest << " texels: " << now);
        CHECK(now < before);
        before = now;
    }
}

namespace {

/// How far a shadow's height strays from a line, over the samples of its columns: root mean square, texels.
double roughness(const std::function<float(glm::vec2)>& visibility, double slope)
{
    std::vector<double> heights;
    double mean = 0.0;
    for (int x = kFirst * kSub; x < kEnd * kSub; ++x) {
        double dark = 0.0;
        for (int y = 0; y < gpu::kSide * kSub; ++y)
            dark += 1.0 - double(visibility(glm::vec2(float(x) + 0.5f, float(y) + 0.5f) / float(kSub)));
        heights.push_back(dark / kSub - slope * (x + 0.5) / kSub);
        mean += heights.back();
    }
    mean /= double(heights.size());
    double sum = 0.0;
    for (const double height : heights)
        sum += (height - mean) * (height - mean);
    return std::sqrt(sum / double(heights.size()));
}

} // namespace

TEST_CASE("along straight edges lines through the middles darken as much as they lighten, to 0.05 texels")
{
    // Where a line crosses from sample to sample along x and along y: its length (Crofton).
    const auto lengthOf = [](const Shape& shape) {
        double alongX = 0.0, alongY = 0.0;
        forSamples([&](glm::vec2 at) {
            const auto x = double(at.x), y = double(at.y);
            alongX += shape(x, y) != shape(x + 1.0 / kSub, y);
            alongY += shape(x, y) != shape(x, y + 1.0 / kSub);
        });
        return std::hypot(alongX, alongY) / kSub;
    };
    double length = 0.0;
    for (const Shape& shape : halfPlanes())
        length += lengthOf(shape);
    const Errors errors = errorsOf(halfPlanes());
    const double texels = double{kSub} * kSub * length;
    MESSAGE("texels of edge " << length << "; map off by " << errors.map.all() / texels << ", middle "
                              << errors.middle.all() / texels << ", more dark than light by "
                              << (errors.middle.over - errors.middle.under) / texels << ", conservative "
                              << (errors.conservative.over - errors.conservative.under) / texels);
    CHECK(length > 20.0 * kShapes);
    CHECK(std::abs(errors.middle.over - errors.middle.under) <= 0.05 * texels);
    CHECK(errors.conservative.over - errors.conservative.under > 0.05 * texels); // so the measure tells
}

TEST_CASE("no stair is followed past the map's border, and every value there is a visibility")
{
    std::vector<Shape> shapes = halfPlanes();
    std::mt19937 random(11);
    std::vector<gpu::Picture> pictures;
    for (const Shape& shape : shapes)
        pictures.push_back(drawn(shape));
    gpu::Picture noise;
    for (bool& dark : noise.shadow)
        dark = (random() & 1u) != 0;
    pictures.push_back(noise);
    uint64_t fetches = 0, beside = 0, changed = 0;
    for (const gpu::Picture& picture : pictures) {
        for (int i = 0; i < gpu::kSide * 4; ++i) {
            const float along = (float(i) + 0.5f) / 4.0f, last = float(gpu::kSide);
            for (const float across : {0.0f, 0.3f, last - 0.3f, std::nextafter(last, 0.0f)}) {
                for (const glm::vec2 at : {glm::vec2(along, across), glm::vec2(across, along)}) {
                    for (const uint32_t mode : {0u, 1u, 2u}) {
                        const float lit =
                            gpu::revectorizedVisibility({&picture, &fetches, &beside}, at, mode, gpu::MAX_STAIR);
                        REQUIRE((lit >= 0.0f && lit <= 1.0f));
                        changed += lit != nearest(picture, at);
                    }
                }
            }
        }
    }
    CHECK(fetches > 100'000);
    CHECK(changed > 100);
    CHECK(beside == 0);
}

TEST_CASE("lines need no memory beside the map")
{
    const auto entryOf = [](std::string_view name) {
        for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms)
            if (name == algorithm.entry->name) return algorithm.entry;
        FAIL(std::string(name));
        return static_cast<const AlgorithmEntry*>(nullptr);
    };
    const auto bytes = [&](const char* name, GnLightType type) {
        const AlgorithmEntry& entry = *entryOf(name);
        std::vector<double> settings;
        for (const SettingSpec& setting : entry.settings)
            settings.push_back(std::string_view(setting.name) == "resolution" ? 1024.0 : setting.standard);
        return entry.memoryFor(settings, {1280, 720}, type);
    };
    for (const GnLightType type : {GN_LIGHT_TYPE_DIRECTIONAL, GN_LIGHT_TYPE_SPOT})
        CHECK(bytes("rbsm", type) == bytes("shadow_map", type));
    CHECK(bytes("rbsm", GN_LIGHT_TYPE_POINT) == bytes("cube_map", GN_LIGHT_TYPE_POINT));
    CHECK(bytes("pcss", GN_LIGHT_TYPE_SPOT) > bytes("shadow_map", GN_LIGHT_TYPE_SPOT)); // so the books tell
}

TEST_CASE("stairs are gone: an edge strays from its line by half of what the map's does")
{
    std::mt19937 random(5);
    double map = 0.0;
    std::array<double, 2> lines{};
    for (int i = 0; i < 24; ++i) {
        const double slope = between(random, 1.0 / 16.0, 1.0); // tan of the angle to the rows
        const gpu::Picture picture = drawn(halfPlane(std::atan(slope), nearMiddle(random)));
        const double ofMap = roughness([&](glm::vec2 at) { return nearest(picture, at); }, slope);
        map += ofMap;
        for (const uint32_t mode : {gpu::REVECTORIZE_CONSERVATIVE, gpu::REVECTORIZE_NONCONSERVATIVE}) {
            const double ofLine = roughness([&](glm::vec2 at) { return revectorized(picture, at, mode); }, slope);
            CAPTURE(slope);
            CHECK(ofLine <= 1.2 * ofMap);
            lines[mode] += ofLine;
        }
    }
    MESSAGE("strays by " << map / 24 << " texels; conservative " << lines[0] / 24 << ", middle " << lines[1] / 24);
    CHECK(map >= 2.0 * lines[gpu::REVECTORIZE_CONSERVATIVE]);
    CHECK(map >= 2.0 * lines[gpu::REVECTORIZE_NONCONSERVATIVE]);
}

TEST_CASE("the ramp is continuous on stairs shorter than the longest, and its half is the middle line")
{
    std::mt19937 random(6);
    float largest = 0.0f;
    uint64_t apart = 0, asked = 0;
    for (int i = 0; i < 12; ++i) {
        const double slope = between(random, 1.0 / 7.0, 0.9); // both ways along a stair stay below 16 texels
        const gpu::Picture picture = drawn(halfPlane(std::atan(slope), nearMiddle(random)));
        const auto ramp = [&](float x, float y) {
            return revectorized(picture, {x / 16.0f, y / 16.0f}, gpu::REVECTORIZE_FILTERED);
        };
        for (int y = 20 * 16; y < 44 * 16; ++y) {
            for (int x = 20 * 16; x < 44 * 16; ++x) {
                const float fx = float(x) + 0.5f, fy = float(y) + 0.5f, here = ramp(fx, fy);
                largest =
                    std::max({largest, std::abs(here - ramp(fx + 1.0f, fy)), std::abs(here - ramp(fx, fy + 1.0f))});
                const float middle = revectorized(picture, {fx / 16.0f, fy / 16.0f}, gpu::REVECTORIZE_NONCONSERVATIVE);
                asked += here != 0.0f && here != 1.0f;
                apart += std::abs(here - 0.5f) > 1e-4f && (here > 0.5f) != (middle != 0.0f);
            }
        }
    }
    MESSAGE("largest step over a sixteenth of a texel: " << largest);
    CHECK(largest <= 0.1f);
    CHECK(asked > 10000);
    CHECK(apart == 0);
}

TEST_CASE("edges crawl less when the light moves")
{
    std::mt19937 random(7);
    double map = 0.0, middle = 0.0, conservative = 0.0, ramp = 0.0;
    for (int i = 0; i < 24; ++i) {
        const double angle = between(random, 0.0, 6.283185307);
        const glm::dvec2 through = nearMiddle(random);
        gpu::Picture before;
        for (int k = 0; k <= 8; ++k) {
            const double moved = k / 8.0;
            const gpu::Picture now = drawn(halfPlane(angle, through + glm::dvec2(moved, 0.6 * moved)));
            const glm::vec2 last(float(moved - 0.125), float(0.6 * (moved - 0.125))),
                step(float(moved), float(0.6 * moved));
            if (k > 0)
                forSamples([&](glm::vec2 at) {
                    const auto change = [&](uint32_t mode) {
                        return std::abs(revectorized(now, at + step, mode) - revectorized(before, at + last, mode));
                    };
                    map += std::abs(nearest(now, at + step) - nearest(before, at + last));
                    middle += change(gpu::REVECTORIZE_NONCONSERVATIVE);
                    conservative += change(gpu::REVECTORIZE_CONSERVATIVE);
                    ramp += change(gpu::REVECTORIZE_FILTERED);
                });
            before = now;
        }
    }
    MESSAGE("changes: map " << map << ", conservative " << conservative << ", middle " << middle << ", ramp " << ramp);
    CHECK(std::abs(ramp - middle) <= 0.05 * middle);
    CHECK(middle <= 0.7 * map);
    CHECK(conservative <= 0.75 * map);
}
