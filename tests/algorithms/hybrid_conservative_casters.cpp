// How casters and receivers meet in a conservative map: where points lie in it, and how far rounding may move them.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include <glm/gtc/matrix_transform.hpp>

#include "algorithms/hybrid/conservative_casters.hpp"

using namespace gnomon;

namespace {

constexpr std::uint32_t kSide = 512;
constexpr Aabb kScene{{-8.0f, 0.0f, -8.0f}, {8.0f, 6.0f, 8.0f}};

struct Lamp {
    LightView view;
    LightFit fit;
    ConservativeProjection projection;
    gpu::ConservativeConstants rounding{};

    /// @param at of a spot; null: directional. @param zero of the scene.
    explicit Lamp(const glm::vec3* at, const glm::vec3& zero = glm::vec3(0.0f))
    {
        view.type = at ? GN_LIGHT_TYPE_SPOT : GN_LIGHT_TYPE_DIRECTIONAL;
        view.coneAngle = 0.6f;
        view.constants.range = kUnlimitedRange;
        view.constants.positionWs = at ? glm::vec4(*at, 1.0f) : glm::vec4(0.0f);
        view.constants.directionWs = glm::vec4(glm::normalize(at ? zero - *at : glm::vec3(0.4f, -1.0f, -0.3f)), 0.8f);
        const Aabb scene{kScene.lower + zero, kScene.upper + zero};
        fit = at ? fitSpot(view, scene) : fitDirectional(view, scene);
        projection = conservativeProjection(fit, view, kSide);
        addRounding(rounding, projection, {});
    }
};

/// Texel, depth and w of a point.
struct Place {
    glm::dvec2 texel;
    double depth, w;
};

Place byFit(const Lamp& lamp, const glm::dvec3& world)
{
    const glm::dvec4 clip = glm::dmat4(lamp.fit.clipFromWorld) * glm::dvec4(world, 1.0);
    return {0.5 * kSide * (glm::dvec2(clip) / clip.w + 1.0), clip.z / clip.w, clip.w};
}

Place byProjection(const ConservativeProjection& p, const glm::dvec3& world)
{
    const glm::dvec4 at = p.texelFromZero * glm::dvec4(world - p.zeroWs, 1.0);
    const double perspective = static_cast<double>(p.depthConstant) + static_cast<double>(p.depthScale) / at.w;
    return {glm::dvec2(at) / at.w, p.perspective ? perspective : at.z, at.w};
}

glm::dvec3 randomDirection(std::mt19937& random)
{
    std::normal_distribution<double> coordinate;
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    return glm::normalize(glm::dvec3(x, y, z));
}

glm::dvec3 randomPoint(std::mt19937& random)
{
    std::uniform_real_distribution<double> share(0.0, 1.0);
    const double x = share(random), y = share(random), z = share(random);
    return glm::dvec3(kScene.lower) + glm::dvec3(x, y, z) * glm::dvec3(kScene.upper - kScene.lower);
}

const glm::vec3 kAt(20.0f, 12.0f, 6.0f);

/// Calls check(lamp, whether it is a spot).
template <typename Check>
void forLamps(const Check& check)
{
    for (const bool spot : {false, true}) {
        CAPTURE(spot);
        check(Lamp(spot ? &kAt : nullptr), spot);
    }
}

Caster turnedCaster(const glm::vec3& translation)
{
    Caster caster;
    caster.basis = glm::mat3(glm::scale(glm::rotate(glm::mat4(1.0f), 0.7f, glm::normalize(glm::vec3(1, 2, 3))),
                                        glm::vec3(2.0f, 0.5f, 1.3f)));
    caster.translation = translation;
    caster.bounds = {translation - 4.0f, translation + 4.0f};
    return caster;
}

/// But for floats' rounding.
bool same(double a, double b)
{
    return std::abs(a - b) <= 1e-6 * std::abs(b);
}

/// How far a corner may be off, metres, as the push says of a spot.
double errorWs(const Lamp& lamp, const Caster& caster)
{
    const gpu::ConservativePush push = conservativePush(lamp.projection, caster, false);
    return static_cast<double>(push.texelError / lamp.rounding.texelsPerMetre);
}

} // namespace

TEST_CASE("a point's texel and depth are those of the light's fit")
{
    forLamps([](const Lamp& lamp, bool spot) {
        CHECK(lamp.projection.side == kSide);
        CHECK(lamp.projection.perspective == spot);
        CHECK(lamp.projection.lightCoordinate == (spot ? 20.0f : 0.0f));
        std::mt19937 random(1);
        for (int i = 0; i < 1000; ++i) {
            const glm::dvec3 world = randomPoint(random);
            const Place fit = byFit(lamp, world), place = byProjection(lamp.projection, world);
            CHECK(glm::length(place.texel - fit.texel) < 1e-3);
            CHECK(std::abs(place.depth - fit.depth) < 1e-6);
            CHECK(std::abs(place.w - fit.w) < 1e-5);
        }
    });
}

TEST_CASE("rounding bounds how far a moved receiver moves in the map, and not by much more")
{
    forLamps([](const Lamp& lamp, bool spot) {
        CHECK((lamp.rounding.depthPerMetre == 0.0f) == spot);
        CHECK((lamp.rounding.depthSquare == 0.0f) != spot);
        std::mt19937 random(2);
        constexpr double metres = 1e-4;
        double texels = 0.0, depths = 0.0; // largest shares of what is allowed
        for (int i = 0; i < 20000; ++i) {
            const glm::dvec3 world = randomPoint(random);
            const Place from = byProjection(lamp.projection, world);
            if (glm::any(glm::greaterThan(glm::abs(from.texel - 0.5 * kSide), glm::dvec2(0.5 * kSide)))) continue;
            const Place to = byProjection(lamp.projection, world + metres * randomDirection(random));
            const glm::dvec2 moved = glm::abs(to.texel - from.texel) * from.w;
            texels = std::max(texels, std::max(moved.x, moved.y) / (metres * double(lamp.rounding.texelsPerMetre)));
            const double scaled = double(lamp.projection.depthConstant) - from.depth;
            const double allowed =
                double(lamp.rounding.depthPerMetre) + double(lamp.rounding.depthSquare) * scaled * scaled;
            depths = std::max(depths, std::abs(to.depth - from.depth) / (metres * allowed));
        }
        CHECK(texels < 1.001);
        CHECK(texels > 0.6);
        CHECK(depths < 1.001);
        CHECK(depths > 0.95);
    });
}

TEST_CASE("a caster's corners go where its transform takes them")
{
    forLamps([](const Lamp& lamp, bool) {
        const Caster caster = turnedCaster({1.0f, 2.0f, -3.0f});
        const gpu::ConservativePush push = conservativePush(lamp.projection, caster, false);
        CHECK(push.side == kSide);
        CHECK(push.depthConstant == lamp.projection.depthConstant);
        CHECK(push.depthScale == lamp.projection.depthScale);
        std::mt19937 random(3);
        for (int i = 0; i < 100; ++i) {
            const glm::dvec3 corner = randomDirection(random);
            const glm::dvec4 got = glm::dmat4(push.texelFromObject) * glm::dvec4(corner, 1.0);
            const glm::dvec3 world = glm::dmat3(caster.basis) * corner + glm::dvec3(caster.translation);
            const Place place = byProjection(lamp.projection, world);
            CHECK(glm::length(glm::dvec2(got) / got.w - place.texel) < 1e-3);
            CHECK(std::abs(got.w - place.w) < 1e-5);
        }
    });
}

TEST_CASE("margins hold what rounding the corners of a far caster does")
{
    const glm::vec3 far(4000.0f, 30.0f, -2500.0f), light = far + kAt;
    const Lamp lamp(&light, far);
    const Caster caster = turnedCaster(far);
    const gpu::ConservativePush push = conservativePush(lamp.projection, caster, false);
    std::mt19937 random(4);
    double texels = 0.0, w = 0.0;
    for (int i = 0; i < 1000; ++i) {
        const glm::dvec3 corner = randomDirection(random);
        const glm::dvec3 exact = glm::dmat3(caster.basis) * corner + glm::dvec3(caster.translation);
        const glm::vec3 rounded = caster.basis * glm::vec3(corner) + caster.translation;
        const Place a = byProjection(lamp.projection, exact), b = byProjection(lamp.projection, glm::dvec3(rounded));
        const glm::dvec2 moved = glm::abs(b.texel - a.texel) * a.w;
        texels = std::max(texels, std::max(moved.x, moved.y) / static_cast<double>(push.texelError));
        w = std::max(w, std::abs(b.w - a.w) / static_cast<double>(push.wError));
    }
    CHECK(texels < 0.5); // one rounding of what are eight
    CHECK(texels > 1.0 / 256.0);
    CHECK(w < 0.5);
    CHECK(w > 1.0 / 256.0);
}

TEST_CASE("an error in metres is 2^-20 of the coordinates of caster and light, in all of a push's margins")
{
    const Lamp spot(&kAt), sun(nullptr);
    Caster caster;
    caster.bounds = {{-3.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 1.0f}};
    const double unit = 0x1p-20;
    CHECK(same(errorWs(spot, caster), unit * (3.0 + 20.0)));
    CHECK(same(errorWs(sun, caster), unit * 3.0));
    caster.bounds.upper.y = 100.0f;
    CHECK(same(errorWs(spot, caster), unit * (100.0 + 20.0)));
    caster.translation.z = -50.0f;
    const double error = unit * (100.0 + 50.0 + 20.0), sunError = unit * (100.0 + 50.0);
    CHECK(same(errorWs(spot, caster), error));
    const gpu::ConservativePush push = conservativePush(spot.projection, caster, false);
    CHECK(same(double(push.wError), error)); // the axis of a perspective has length 1
    CHECK(push.depthError == gpu::DEPTH_ROUNDING);
    CHECK(same(double(push.depthErrorSquare), error * double(spot.rounding.depthSquare)));
    const gpu::ConservativePush flat = conservativePush(sun.projection, caster, false);
    CHECK(flat.wError == 0.0f);
    CHECK(flat.depthErrorSquare == 0.0f);
    CHECK(same(double(flat.depthError), double(gpu::DEPTH_ROUNDING) + sunError * double(sun.rounding.depthPerMetre)));
}

TEST_CASE("flags say how the map projects, which faces count, how they wind and how the thesis moves edges")
{
    forLamps([](Lamp lamp, bool spot) {
        const gpu::uint kind = spot ? gpu::CASTER_PERSPECTIVE : 0u;
        Caster caster;
        CHECK(conservativePush(lamp.projection, caster, false).flags == kind);
        CHECK(conservativePush(lamp.projection, caster, true).flags == (kind | gpu::CASTER_BACK_ONLY));
        caster.mirrored = true;
        CHECK(conservativePush(lamp.projection, caster, false).flags == (kind | gpu::CASTER_MIRRORED));
        lamp.projection.offset = ThesisOffset::tight;
        CHECK(conservativePush(lamp.projection, Caster(), false).flags == (kind | gpu::CASTER_TIGHT));
        lamp.projection.offset = ThesisOffset::diagonal;
        CHECK(conservativePush(lamp.projection, Caster(), false).flags == (kind | gpu::CASTER_DIAGONAL));
    });
}

TEST_CASE("only closed casters without holes are told by their back faces, mirrored or not")
{
    for (const bool mirrored : {false, true}) {
        Caster caster;
        caster.mirrored = mirrored;
        CHECK(!backFacesOnly(caster));
        caster.alphaTested = true;
        CHECK(!backFacesOnly(caster));
        caster.closed = true;
        CHECK(!backFacesOnly(caster));
        caster.alphaTested = false;
        CHECK(backFacesOnly(caster));
    }
}

TEST_CASE("what is squashed aslant may be off by more, as the ray tracer's way into it rounds by more")
{
    forLamps([](const Lamp& lamp, bool spot) {
        if (!spot) return;
        Caster turned = turnedCaster({5.0f, 1.0f, 2.0f}), squashed = turned;
        // Along a direction half-way between two axes, to a thousandth: 500 times the spread of an axis.
        const glm::mat3 aslant(glm::rotate(glm::mat4(1.0f), 0.785398f, glm::vec3(0, 0, 1)));
        squashed.basis = aslant * glm::mat3(1, 0, 0, 0, 1e-3f, 0, 0, 0, 1) * glm::transpose(aslant);
        const double ratio = errorWs(lamp, squashed) / errorWs(lamp, turned);
        CHECK(ratio > 150.0); // a third of it: a rotation's share is in the sum anyway
        CHECK(ratio < 600.0);
        Caster straight = turned;
        straight.basis = glm::mat3(1, 0, 0, 0, 1e-3f, 0, 0, 0, 1);
        CHECK(same(errorWs(lamp, straight), errorWs(lamp, turned)));

        // And so may receivers, whose rays go the same way.
        const Caster* casters[] = {&turned, &squashed, &straight};
        gpu::ConservativeConstants both{}, plain{};
        addRounding(both, lamp.projection, casters);
        addRounding(plain, lamp.projection, std::span(casters).first(1));
        CHECK(plain.texelsPerMetre == lamp.rounding.texelsPerMetre);
        CHECK(both.texelsPerMetre == plain.texelsPerMetre); // of no mesh: the host draws them
        MeshView mesh;
        squashed.mesh = &mesh;
        addRounding(both, lamp.projection, casters);
        CHECK(both.texelsPerMetre > 150.0f * plain.texelsPerMetre);
        CHECK(both.depthSquare > 150.0f * plain.depthSquare);
    });
}
