// The layers of a conservative map around lights of every kind: whose projection each has, and what is in it.
#include <doctest/doctest.h>

#include <cmath>
#include <set>
#include <vector>

#include "algorithms/hybrid/conservative_layers.hpp"
#include "algorithms/shared/depth_map.hpp"
#include "maps_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr std::uint32_t kSide = 256;

/// A light among two small casters, one still and one moving, on either side of it along x.
struct Lit {
    MeshView mesh;
    std::vector<std::uint32_t> indices{0, 1, 2};
    Caster left, right;
    const Caster* statics[1] = {&left};
    const Caster* dynamics[1] = {&right};
    const Caster* all[2] = {&left, &right};
    LightCasters casters;
    LightView view;
    CameraView eye = camera({0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, -1.0f}, 0.4f, 64, 48);
    ShadowTask task;
    FrameArena arena;

    explicit Lit(GnLightType type)
    {
        mesh.indices = indices;
        const auto place = [this](Caster& caster, std::uint32_t id, float x) {
            caster.id = id;
            caster.revision = id;
            caster.mesh = &mesh;
            caster.translation = {x, 0.0f, 0.0f};
            caster.bounds = {{x - 0.5f, -0.5f, -0.5f}, {x + 0.5f, 0.5f, 0.5f}};
        };
        place(left, 1, -4.0f);
        place(right, 2, 4.0f);
        casters = {
            .statics = statics, .dynamics = dynamics, .all = all, .staticStamp = 3, .dynamicStamp = 4, .triangles = 2};
        const glm::vec3 at = type == GN_LIGHT_TYPE_POINT ? glm::vec3(0.0f) : glm::vec3(0.0f, 9.0f, 0.0f);
        view = light(type, at, {0.0f, -1.0f, 0.0f}, 20.0f, 0.7f);
        task = {.view = &eye, .light = &view, .casters = &casters};
    }
    Lit(const Lit&) = delete;

    ConservativeMapView map(ThesisOffset offset = ThesisOffset::halfDiagonal)
    {
        return conservativeView(task, kSide, offset, arena);
    }
    LayerContent content(std::uint32_t layer, std::uint64_t salt = 0, ThesisOffset offset = ThesisOffset::halfDiagonal)
    {
        return conservativeContent(task, map(offset), layer, salt, arena);
    }
};

bool holds(const LightFit& fit, const glm::vec3& at)
{
    return touches(Aabb{at, at}, fit.volume);
}

} // namespace

TEST_CASE("a point light has six layers, others one; each is where its fit says")
{
    for (const GnLightType type : {GN_LIGHT_TYPE_DIRECTIONAL, GN_LIGHT_TYPE_SPOT, GN_LIGHT_TYPE_POINT}) {
        CAPTURE(type);
        Lit lit(type);
        const ConservativeMapView map = lit.map();
        REQUIRE(map.fits.size() == (type == GN_LIGHT_TYPE_POINT ? 6 : 1));
        REQUIRE(map.projections.size() == map.fits.size());
        CHECK(map.resolution == kSide);
        Random random;
        std::vector<int> asked(map.fits.size());
        for (int i = 0; i < 6000; ++i) {
            const glm::vec3 at = random.vec(-4.0f, 4.0f);
            for (std::size_t layer = 0; layer < map.fits.size(); ++layer) {
                if (!holds(map.fits[layer], at)) continue;
                const glm::dvec4 clip = glm::dmat4(map.fits[layer].clipFromWorld) * glm::dvec4(at, 1.0);
                const ConservativeProjection& projection = map.projections[layer];
                const glm::dvec4 texel = projection.texelFromZero * glm::dvec4(glm::dvec3(at) - projection.zeroWs, 1.0);
                REQUIRE(glm::length(0.5 * kSide * (glm::dvec2(clip) / clip.w + 1.0) - glm::dvec2(texel) / texel.w) <
                        1e-3 * kSide);
                ++asked[layer];
            }
        }
        for (const int count : asked)
            CHECK(count > 100);
    }
}

TEST_CASE("layers are needed that a receiver on the screen can lie in, and not all of them")
{
    Lit lit(GN_LIGHT_TYPE_POINT);
    const ConservativeMapView map = lit.map();
    Random random;
    std::set<std::size_t> seen;
    for (int i = 0; i < 4000; ++i) {
        const glm::vec3 at =
            lit.eye.eye + random.in(0.2f, 25.0f) *
                              gpu::viewRayWs(lit.eye.constants, {random.in(0.0f, 64.0f), random.in(0.0f, 48.0f)});
        if (glm::length(at) > 20.0f) continue; // the light's range
        for (std::size_t layer = 0; layer < 6; ++layer)
            if (holds(map.fits[layer], at)) seen.insert(layer);
    }
    CHECK(seen.size() >= 2);
    for (const std::size_t layer : seen)
        CHECK((map.needed >> layer & 1) == 1);
    CHECK((map.needed & 0x3f) != 0x3f);
    Lit sun(GN_LIGHT_TYPE_DIRECTIONAL);
    CHECK(sun.map().needed == 1);
}

TEST_CASE("a layer holds what touches its part of space, and its stamp tells all it was made of")
{
    Lit lit(GN_LIGHT_TYPE_POINT);
    const ConservativeMapView map = lit.map();
    std::set<std::uint64_t> stamps;
    for (std::uint32_t layer = 0; layer < 6; ++layer) {
        const LayerContent content = lit.content(layer);
        const bool left = touches(lit.left.bounds, map.fits[layer].volume);
        const bool right = touches(lit.right.bounds, map.fits[layer].volume);
        CHECK(content.statics.size() + content.dynamics.size() == std::size_t{left} + std::size_t{right});
        for (const Caster* caster : content.statics)
            CHECK(touches(caster->bounds, map.fits[layer].volume));
        for (const Caster* caster : content.dynamics)
            CHECK(touches(caster->bounds, map.fits[layer].volume));
        stamps.insert(content.stamp);
        CHECK(lit.content(layer).stamp == content.stamp); // of the same, the same
        CHECK(lit.content(layer, 1).stamp != content.stamp);
        CHECK(lit.content(layer, 0, ThesisOffset::diagonal).stamp != content.stamp);
    }
    CHECK(stamps.size() == 6);

    const std::uint64_t before = lit.content(0).stamp, beside = lit.content(1).stamp; // +x and -x
    lit.right.revision = 9;
    CHECK(lit.content(0).stamp != before);
    CHECK(lit.content(1).stamp == beside); // the mover is not in it
    const std::uint64_t moved = lit.content(0).stamp;
    lit.view.constants.positionWs.x = 0.25f;
    lit.view.revision = 8;
    CHECK(lit.content(0).stamp != moved);
}

TEST_CASE("memory counts two layers, six faces each around a point light")
{
    const VkExtent2D none{0, 0};
    const std::vector<double> small{256.0, 0.0, 0.0, 1.0}, large{512.0, 0.0, 0.0, 1.0};
    const VkDeviceSize list = undecidedMemory(none);
    const VkDeviceSize spot = ConservativeMethod::memory(small, none, GN_LIGHT_TYPE_SPOT) - list;
    CHECK(spot == 2 * depthMapMemory(256, 1));
    CHECK(ConservativeMethod::memory(small, none, GN_LIGHT_TYPE_POINT) - list == 6 * spot);
    CHECK(ConservativeMethod::memory(large, none, GN_LIGHT_TYPE_SPOT) - list == 4 * spot);
}
