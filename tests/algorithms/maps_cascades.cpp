// Where the maps of a directional light lie, for cameras at random; no device.
#include <doctest/doctest.h>

#include <glm/common.hpp>

#include "algorithms/maps/cascade_fit.hpp"
#include "algorithms/shared/depth_map.hpp"
#include "maps_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr std::uint32_t kSide = 512;
constexpr CascadeSplit kSplit{.count = 4, .blend = 0.9, .resolution = kSide, .borderTexels = 4.0f};

/// A task over one caster that fills a box.
struct Wide {
    CameraView view;
    LightView lamp;
    std::vector<Caster> all;
    LightCasters casters;
    std::vector<const Caster*> pointers;
    FrameArena arena;

    Wide(const Aabb& box, glm::vec3 direction) : lamp(light(GN_LIGHT_TYPE_DIRECTIONAL, {}, direction, INFINITY))
    {
        all.resize(1);
        all[0].bounds = box;
        pointers = {&all[0]};
        casters.all = casters.statics = pointers;
    }
    std::vector<Cascade> from(const CameraView& camera, const CascadeSplit& split = kSplit)
    {
        view = camera;
        ShadowTask task;
        task.view = &view;
        task.light = &lamp;
        task.casters = &casters;
        const std::span<const Cascade> cascades = fitCascades(task, split, arena);
        return {cascades.begin(), cascades.end()};
    }
};

glm::dvec3 inClip(const LightFit& fit, glm::dvec3 point)
{
    return glm::dvec3(glm::dmat4(fit.clipFromWorld) * glm::dvec4(point, 1.0));
}

// Slices are counted from 1 m, since the near plane of maps_fixture.hpp is nearer.
const Aabb kLand{{-400.0f, -5.0f, -300.0f}, {400.0f, 60.0f, 300.0f}};

CameraView somewhere(Random& random)
{
    const glm::vec3 eye(random.in(-300.0f, 300.0f), random.in(1.0f, 20.0f), random.in(-200.0f, 200.0f));
    return camera(eye, random.unit(), random.in(0.2f, 0.8f), 1280, 720);
}

} // namespace

TEST_CASE("slices end where Zhang's practical split has them")
{
    CHECK(splitDepth(1.0, 1000.0, 0.5, 0.0) == doctest::Approx(500.5));
    CHECK(splitDepth(1.0, 1000.0, 1.0 / 3.0, 1.0) == doctest::Approx(10.0));
    CHECK(splitDepth(1.0, 1000.0, 1.0 / 3.0, 0.5) == doctest::Approx(0.5 * (10.0 + 334.0)));
    CHECK(splitDepth(2.0, 50.0, 0.0, 0.7) == doctest::Approx(2.0));
    CHECK(splitDepth(2.0, 50.0, 1.0, 0.7) == doctest::Approx(50.0));
}

// Uniform, logarithmic and practical splits: Zhang et al. 2006, Eqs 2 to 4; the last halves the sum of both.
TEST_CASE("slices end within 1e-6 of the published splits")
{
    Random random;
    for (int i = 0; i < 2000; ++i) {
        const double n = static_cast<double>(random.in(0.05f, 5.0f)),
                     f = n * static_cast<double>(random.in(1.1f, 1e5f));
        const int m = 1 + i % 6, cut = i % 7 % (m + 1);
        const double even = n + (f - n) * cut / m, logarithmic = std::exp(std::log(n) + std::log(f / n) * cut / m);
        CHECK(std::abs(splitDepth(n, f, double(cut) / m, 0.0) / even - 1.0) < 1e-6);
        CHECK(std::abs(splitDepth(n, f, double(cut) / m, 1.0) / logarithmic - 1.0) < 1e-6);
        CHECK(std::abs(splitDepth(n, f, double(cut) / m, 0.5) / (0.5 * (even + logarithmic)) - 1.0) < 1e-6);
    }
}

TEST_CASE("what is seen in a slice lies in its map, inside the border, and all casters in depths and in the last map")
{
    Random random;
    for (int i = 0; i < 200; ++i) {
        Wide wide(kLand, glm::normalize(glm::vec3(random.in(-1.0f, 1.0f), -1.0f, random.in(-1.0f, 1.0f))));
        const std::vector<Cascade> cascades = wide.from(somewhere(random));
        REQUIRE(cascades.size() >= 3); // in wide views the third slice is as wide as the land
        const double near = 1.0, far = near + glm::length(glm::dvec3(kLand.upper - kLand.lower));
        const double inside = 1.0 - 2.0 * 4.0 / kSide + 1e-6;
        for (int j = 0; j < 60; ++j) {
            const std::uint32_t slice = static_cast<std::uint32_t>(j) % static_cast<std::uint32_t>(cascades.size() - 1);
            const double begin = slice == 0 ? 0.1 : splitDepth(near, far, slice / 4.0, kSplit.blend),
                         end = splitDepth(near, far, (slice + 1) / 4.0, kSplit.blend);
            const double depth = begin + (end - begin) * static_cast<double>(random.in(0.0f, 1.0f));
            const glm::vec2 pixel(random.in(0.0f, 1280.0f), random.in(0.0f, 720.0f));
            const glm::dvec3 seen =
                glm::dvec3(wide.view.eye) + depth * glm::dvec3(gpu::viewRayWs(wide.view.constants, pixel));
            const glm::dvec3 clip = inClip(cascades[slice].fit, seen);
            for (int axis = 0; axis < 2; ++axis) // where a slice has all of a side, what is beside it is beside all
                if (cascades[slice].half[axis] < cascades.back().half[axis]) REQUIRE(std::abs(clip[axis]) <= inside);
        }
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 point(corner & 1 ? kLand.upper.x : kLand.lower.x,
                                   corner & 2 ? kLand.upper.y : kLand.lower.y,
                                   corner & 4 ? kLand.upper.z : kLand.lower.z);
            for (const Cascade& cascade : cascades) {
                const glm::dvec3 clip = inClip(cascade.fit, point);
                REQUIRE((clip.z >= 0.0 && clip.z <= 1.0));
                if (&cascade != &cascades.back()) continue;
                REQUIRE(std::max(std::abs(clip.x), std::abs(clip.y)) <= 1.0);
            }
        }
    }
}

TEST_CASE("what a map shows touches its volume, and what lies beside it does not")
{
    Random random;
    int touching = 0, beside = 0;
    for (int i = 0; i < 100; ++i) {
        Wide wide(kLand, glm::normalize(glm::vec3(random.in(-1.0f, 1.0f), -1.0f, random.in(-1.0f, 1.0f))));
        for (const Cascade& cascade : wide.from(somewhere(random))) {
            for (int j = 0; j < 50; ++j) {
                const glm::vec3 point(random.in(kLand.lower.x, kLand.upper.x), random.in(kLand.lower.y, kLand.upper.y),
                                      random.in(kLand.lower.z, kLand.upper.z));
                const glm::dvec3 clip = inClip(cascade.fit, glm::dvec3(point));
                const double out = std::max(std::abs(clip.x), std::abs(clip.y));
                if (std::abs(out - 1.0) < 1e-4) continue;
                REQUIRE(touches(Aabb{point, point}, cascade.fit.volume) == (out < 1.0));
                ++(out < 1.0 ? touching : beside);
            }
        }
    }
    CHECK(touching > 1000);
    CHECK(beside > 1000);
}

TEST_CASE("along neither side is a map coarser than that of all casters, and an eye far away has maps of what it sees")
{
    // A street under the sun at noon, and the eye on it.
    Wide street({{-400.0f, 0.0f, -10.0f}, {400.0f, 5.0f, 10.0f}}, {0.0f, -1.0f, 0.0f});
    const std::vector<Cascade> along = street.from(camera({0.0f, 2.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, 0.5f, 1280, 720));
    REQUIRE(along.size() == 4);
    for (const Cascade& cascade : along) {
        CHECK(cascade.half.x <= along.back().half.x);
        CHECK(cascade.half.y <= along.back().half.y);
    }
    // Casters 120 m away through a long lens, lit from the side.
    Wide distant({{-30.0f, 0.0f, -180.0f}, {30.0f, 30.0f, -120.0f}}, glm::normalize(glm::vec3(1.0f, -0.2f, 0.0f)));
    const std::vector<Cascade> far = distant.from(camera({0.0f, 3.0f, 0.0f}, {0.0f, 0.0f, -1.0f}, 0.03f, 1280, 720));
    REQUIRE(far.size() >= 2);
    bool holds = false;
    for (std::size_t k = 0; k + 1 < far.size(); ++k) {
        const glm::dvec3 clip = inClip(far[k].fit, {0.0, 3.0, -125.0});
        holds = holds || std::max(std::abs(clip.x), std::abs(clip.y)) < 1.0;
    }
    CHECK(holds);
}

TEST_CASE("a map that moves stays on its grid of texels, whatever the resolution and wherever the frame's zero is")
{
    for (const std::uint32_t side : {64u, 500u, 1000u, 1024u}) {
        CAPTURE(side);
        CascadeSplit split = kSplit;
        split.resolution = side;
        Wide wide(kLand, glm::normalize(glm::vec3(0.4f, -1.0f, 0.2f)));
        const std::vector<Cascade> first =
            wide.from(camera({0.0f, 3.0f, 10.0f}, {0.0f, 0.0f, -1.0f}, 0.5f, 1280, 720), split);
        for (int i = 1; i < 50; ++i) {
            const std::vector<Cascade> now = wide.from(
                camera({1.7f * static_cast<float>(i), 3.0f, 10.0f}, {0.0f, 0.0f, -1.0f}, 0.5f, 1280, 720), split);
            for (std::size_t k = 0; k + 1 < now.size(); ++k) {
                const glm::dvec2 texels = (now[k].middle - first[k].middle) / (2.0 * now[k].half / double(side));
                CHECK(glm::length(texels - glm::round(texels)) < 1e-6);
            }
        }
    }
}

TEST_CASE("maps grow coarser, and what shows no more than the last map is left out")
{
    Random random;
    for (int i = 0; i < 100; ++i) {
        Wide wide(kLand, glm::normalize(glm::vec3(0.3f, -1.0f, random.in(-1.0f, 1.0f))));
        const std::vector<Cascade> cascades = wide.from(somewhere(random));
        for (std::size_t k = 1; k < cascades.size(); ++k)
            CHECK(cascades[k].fit.texelAtOne > cascades[k - 1].fit.texelAtOne);
        CHECK(cascades.back().layer == 3);
        for (std::size_t k = 0; k + 1 < cascades.size(); ++k)
            CHECK(cascades[k].layer == k);
    }
    // A wide view of a small thing.
    Wide small({{-1.0f, 0.0f, -1.0f}, {1.0f, 2.0f, 1.0f}}, {0.0f, -1.0f, 0.0f});
    const std::vector<Cascade> last = small.from(camera({0.0f, 1.0f, 30.0f}, {0.0f, 0.0f, -1.0f}, 0.8f, 1280, 720));
    CHECK(last.size() == 1);
    CHECK(last[0].layer == 3);
}

TEST_CASE("a place in the finest map is the same place in the others")
{
    Random random;
    for (int i = 0; i < 100; ++i) {
        Wide wide(kLand, glm::normalize(glm::vec3(random.in(-1.0f, 1.0f), -1.0f, random.in(-1.0f, 1.0f))));
        const std::vector<Cascade> cascades = wide.from(somewhere(random));
        for (const Cascade& cascade : cascades) {
            const glm::dvec4 part(cascadePart(cascades[0], cascade, kSide));
            for (int j = 0; j < 10; ++j) {
                const glm::dvec3 point = glm::dvec3(wide.view.eye) + glm::dvec3(random.vec(-200.0f, 200.0f));
                const auto texel = [&](const Cascade& of) {
                    return 0.5 * kSide * (glm::dvec2(inClip(of.fit, point)) + 1.0);
                };
                const glm::dvec2 here = texel(cascades[0]) * glm::dvec2(part) + glm::dvec2(part.z, part.w);
                // Matrices are floats: half an ulp of a clip coordinate of some tens is 1/500 of a texel.
                CHECK(glm::length(here - texel(cascade)) < 0.02);
                CHECK(std::abs(inClip(cascade.fit, point).z - inClip(cascades[0].fit, point).z) < 1e-12);
            }
        }
    }
}

TEST_CASE("a walk draws what stands still again only every eighth of a map's side, a turn keeps sizes")
{
    Wide wide(kLand, glm::normalize(glm::vec3(0.4f, -1.0f, 0.2f)));
    const auto at = [&](float x, float turned) {
        return wide.from(
            camera({x, 3.0f, 10.0f}, {std::sin(turned), -0.1f * std::cos(turned), -std::cos(turned)}, 0.5f, 1280, 720));
    };
    constexpr int kSteps = 2000;
    constexpr float kStep = 0.05f; // metres: 100 m
    std::vector<Cascade> before = at(0.0f, 0.0f);
    std::vector<int> changes(before.size(), 0);
    for (int i = 1; i <= kSteps; ++i) {
        const std::vector<Cascade> now = at(kStep * static_cast<float>(i), 0.0f);
        REQUIRE(now.size() == before.size());
        for (std::size_t k = 0; k < now.size(); ++k)
            changes[k] += now[k].fit.clipFromWorld != before[k].fit.clipFromWorld;
        before = now;
    }
    for (std::size_t k = 0; k + 1 < changes.size(); ++k) {
        const double eighth = before[k].half.x / 4.0;
        CAPTURE(k);
        CHECK(changes[k] >= 1);
        CHECK(changes[k] <= 2 * (kSteps * static_cast<double>(kStep) / eighth + 1.0)); // along both sides of the map
    }
    CHECK(changes.back() == 0);
    for (int i = 0; i < 100; ++i) {
        const std::vector<Cascade> turned = at(0.0f, 0.06f * static_cast<float>(i));
        for (std::size_t k = 0; k < turned.size(); ++k) {
            CHECK(turned[k].half == before[k].half);
            if (k + 1 == turned.size()) continue;
            const glm::dvec2 steps = turned[k].middle / (turned[k].half / 4.0);
            CHECK(glm::length(steps - glm::round(steps)) < 1e-9);
        }
    }
}
