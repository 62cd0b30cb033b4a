// Which cells of a light's map the shadow of a caster can fall into; no device.
#include <doctest/doctest.h>

#include "algorithms/shared/map_lookup.hpp"
#include "algorithms/volumes/light_cells.hpp"
#include "tests/algorithms/maps_fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr std::uint32_t kResolution = 256;
constexpr float kRange = 60.0f;

LightView lightAt(GnLightType type, glm::vec3 position, glm::vec3 direction)
{
    LightView light;
    light.type = type;
    light.constants.positionWs = glm::vec4(position, type == GN_LIGHT_TYPE_DIRECTIONAL ? 0.0f : 1.0f);
    light.constants.directionWs = glm::vec4(direction, -2.0f);
    light.constants.range = type == GN_LIGHT_TYPE_DIRECTIONAL ? kUnlimitedRange : kRange;
    if (type == GN_LIGHT_TYPE_SPOT) {
        light.coneAngle = 0.6f;
        light.constants.directionWs.w = std::cos(light.coneAngle);
    }
    return light;
}

std::vector<LightFit> fitsOf(const LightView& light, const Aabb& scene)
{
    if (light.type == GN_LIGHT_TYPE_DIRECTIONAL) return {fitDirectional(light, scene)};
    if (light.type == GN_LIGHT_TYPE_SPOT) return {fitSpot(light, scene)};
    std::vector<LightFit> faces;
    for (std::uint32_t face = 0; face < 6; ++face)
        faces.push_back(fitCubeFace(light, scene, face, kResolution, 4.0f));
    return faces;
}

/// How chan_durand.frag looks into the map of one fit, from an eye about the light's place.
struct Look {
    glm::vec3 eye;
    gpu::MapConstants constants{};

    Look(const LightFit& fit, const LightView& light, glm::vec3 from) : eye(from)
    {
        CameraView view;
        view.eye = eye;
        ShadowTask task;
        task.view = &view;
        task.light = &light;
        constants = mapConstants(task, kResolution, 1);
        addProjection(constants, fit, task);
    }
};

/// As chan_durand.frag marks a receiver. @return false if the map does not look there.
bool mark(const Look& look, glm::dvec3 receiver, std::uint32_t& x, std::uint32_t& y, std::uint32_t& key)
{
    const gpu::MapLookup& map = look.constants.map;
    const glm::dvec3 seen = receiver - glm::dvec3(look.eye);
    const auto w = static_cast<float>(glm::length(seen));
    const glm::vec4 clip = map.clipOfEye + w * (map.clipFromRay * glm::vec4(glm::vec3(glm::normalize(seen)), 0.0f));
    if (clip.w <= 0.0f) return false;
    const glm::vec2 place = glm::vec2(clip) / clip.w * (static_cast<float>(gpu::CELLS) / map.side);
    if (place.x < 0.0f || place.y < 0.0f || place.x > gpu::CELLS || place.y > gpu::CELLS) return false;
    const auto cell = [](float at) { return std::min(static_cast<std::uint32_t>(at), gpu::CELLS - 1); };
    x = cell(place.x);
    y = cell(place.y);
    key = gpu::depthKey(gpu::mapDepth(map, clip));
    return true;
}

bool holds(std::span<const gpu::CellFootprint> footprints, std::uint32_t layer, std::uint32_t x, std::uint32_t y,
           std::uint32_t key)
{
    for (const gpu::CellFootprint& f : footprints)
        if (f.layer == layer && x >= f.lowerX && x <= f.upperX && y >= f.lowerY && y <= f.upperY && key >= f.nearestKey)
            return true;
    return false;
}

} // namespace

TEST_CASE("every receiver in the shadow of a box lies in its footprint, for all kinds of light, near the origin or not")
{
    Random random;
    for (const float far : {0.0f, 400.0f})
        for (const GnLightType type : {GN_LIGHT_TYPE_DIRECTIONAL, GN_LIGHT_TYPE_SPOT, GN_LIGHT_TYPE_POINT}) {
            CAPTURE(far);
            CAPTURE(static_cast<int>(type));
            const Aabb scene{glm::vec3(far - 12.0f), glm::vec3(far + 12.0f)};
            std::uint32_t looked = 0;
            for (int i = 0; i < 400; ++i) {
                const glm::vec3 position = random.vec(far - 9.0f, far + 9.0f);
                const LightView light = lightAt(type, position, random.unit());
                const glm::vec3 lower = random.vec(far - 10.0f, far + 8.0f);
                const bool thin = i % 2 != 0;
                const Aabb box{lower, lower + (thin ? glm::vec3(0.3f, 0.005f, 0.3f) : random.vec(0.01f, 4.0f))};
                const std::vector<LightFit> fits = fitsOf(light, scene);
                const glm::vec3 eye = position + random.in(1.0f, 20.0f) * random.unit();
                gpu::CellFootprint footprints[gpu::MAX_LAYERS];
                const std::uint32_t count = cellFootprints(fits, light, kResolution, box, footprints);
                for (int j = 0; j < 50; ++j) {
                    const glm::dvec3 share(random.vec(0.0f, 1.0f));
                    const glm::dvec3 blocker = glm::dvec3(box.lower) + share * glm::dvec3(box.upper - box.lower);
                    const glm::dvec3 ray = type == GN_LIGHT_TYPE_DIRECTIONAL
                                               ? glm::dvec3(light.direction())
                                               : glm::normalize(blocker - glm::dvec3(light.position()));
                    const auto past = static_cast<double>(random.in(0.0f, thin ? 0.01f : 9.0f));
                    for (std::uint32_t layer = 0; layer < fits.size(); ++layer) {
                        std::uint32_t x = 0, y = 0, key = 0;
                        if (!mark(Look(fits[layer], light, eye), blocker + past * ray, x, y, key)) continue;
                        ++looked;
                        REQUIRE(holds({footprints, count}, layer, x, y, key));
                    }
                }
            }
            CHECK(looked > 1000);
        }
}

TEST_CASE("receivers beside a box, before it, and in other faces lie outside its footprint")
{
    const Aabb scene{glm::vec3(-10.0f), glm::vec3(10.0f)}, box{{-0.5f, -0.5f, 4.0f}, {0.5f, 0.5f, 5.0f}};
    const LightView point = lightAt(GN_LIGHT_TYPE_POINT, glm::vec3(0.0f), {0, 0, 1});
    const std::vector<LightFit> fits = fitsOf(point, scene);
    gpu::CellFootprint footprints[gpu::MAX_LAYERS];
    REQUIRE(cellFootprints(fits, point, kResolution, box, footprints) == 1);
    CHECK(footprints[0].layer == 4); // +Z
    // Half a metre at four metres of a face that spans four: an eighth of it, and the texel around it.
    CHECK(footprints[0].upperX - footprints[0].lowerX <= gpu::CELLS / 8 + 1);
    const auto held = [&](glm::vec3 receiver) {
        std::uint32_t x = 0, y = 0, key = 0;
        REQUIRE(mark(Look(fits[4], point, glm::vec3(1.0f)), glm::dvec3(receiver), x, y, key));
        return holds({footprints, 1}, 4, x, y, key);
    };
    CHECK(held({0.0f, 0.0f, 6.0f}));
    CHECK(!held({0.0f, 0.0f, 3.5f}));
    CHECK(!held({3.0f, 0.0f, 6.0f}));
}

TEST_CASE("a box around the light casts into every face, one behind a spot light into none")
{
    const Aabb scene{glm::vec3(-10.0f), glm::vec3(10.0f)};
    gpu::CellFootprint footprints[gpu::MAX_LAYERS];
    const LightView point = lightAt(GN_LIGHT_TYPE_POINT, glm::vec3(0.0f), {0, 0, 1});
    REQUIRE(cellFootprints(fitsOf(point, scene), point, kResolution, {glm::vec3(-1.0f), glm::vec3(1.0f)}, footprints) ==
            6);
    for (const gpu::CellFootprint& f : footprints) {
        CHECK(f.lowerX + f.lowerY == 0);
        CHECK(f.upperX + f.upperY == 2 * (gpu::CELLS - 1));
    }
    const LightView spot = lightAt(GN_LIGHT_TYPE_SPOT, glm::vec3(0.0f), {0, 0, 1});
    CHECK(cellFootprints(fitsOf(spot, scene), spot, kResolution, {{-1, -1, -3}, {1, 1, -2}}, footprints) == 0);
}
