// Shadows looked up in a host's own shader, in GLSL and in HLSL: as the light's method shows them where that is a map,
// as rays say in free air, and what is said where there is no map.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "device/sampled_support.hpp"
#include "device/target_support.hpp"
#include "shaders/sampled_comp.h"
#include "shaders/sampled_evsm_comp.h"
#include "shaders/sampled_evsm_hlsl.h"
#include "shaders/sampled_hlsl.h"
#include "shaders/sampled_lines_comp.h"
#include "shaders/sampled_lines_hlsl.h"
#include "shaders/sampled_msm_comp.h"
#include "shaders/sampled_msm_hlsl.h"
#include "shaders/sampled_soft_comp.h"
#include "shaders/sampled_soft_hlsl.h"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr VkExtent2D kExtent{160, 90};

bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

void markSampled(const Host& host, size_t light, bool sampled = true)
{
    GnLightInfo info = demo::toGnLight(host.scene.lights[light], demo::lightAt(host.scene.lights[light], 0.0));
    if (sampled) info.flags |= GN_LIGHT_SAMPLED_BIT;
    host.require(gnUpdateLight(host.context, host.lights[light], &info));
}

/// A spot, a bulb and the sun over the small scene, and what every pixel of the view shows.
struct Sampled {
    explicit Sampled(float radius = 0.0f, const HostOptions& options = {.extent = kExtent, .mapSide = 1024.0})
        : host(targetScene(demo::DepthConvention::ReversedInfinite, radius), options),
          view(bruteView(host, lensesFor(demo::DepthConvention::ReversedInfinite)[0], 0.0)),
          triangles(bruteTriangles(host))
    {
        host.scene.lights[2].radius = 0.3f * radius; // the sun's, radians
        for (size_t i = 0; i < host.lights.size(); ++i)
            markSampled(host, i);
        for (int y = 0; y < view.height; ++y)
            for (int x = 0; x < view.width; ++x) {
                const brute::Surface seen = brute::surfaceAt(view, triangles, x, y);
                sky.push_back(seen.depth == 0.0f);
                const glm::dvec3 place = sky.back() ? view.eye : brute::placeOf(view, x, y, seen.depth);
                const double side = glm::dot(seen.normal, place - view.eye) > 0.0 ? -1.0 : 1.0;
                points.push_back({glm::vec4(glm::vec3(place), 0.0f), glm::vec4(glm::vec3(side * seen.normal), 0.0f)});
            }
    }

    /// Pixels with a surface whose neighbours have the same visibility.
    bool clear(const Image8& picture, size_t pixel) const
    {
        const size_t width = kExtent.width, x = pixel % width, y = pixel / width;
        if (sky[pixel] || x == 0 || y == 0 || x + 1 == width || y + 1 == kExtent.height) return false;
        for (const size_t row : {pixel - width, pixel, pixel + width})
            for (const size_t at : {row - 1, row, row + 1})
                if (sky[at] || picture.texels[at] != picture.texels[pixel]) return false;
        return true;
    }

    Host host;
    brute::View view;
    std::vector<brute::Triangle> triangles;
    std::vector<SampledPoint> points;
    std::vector<bool> sky;
};

struct Tally {
    size_t clear = 0, dark = 0, differing = 0, edges = 0, differingAtEdges = 0;
};

float farthest(const std::vector<float>& a, const std::vector<float>& b)
{
    float most = 0.0f;
    for (size_t i = 0; i < a.size(); ++i)
        most = std::max(most, std::abs(a[i] - b[i]));
    return most;
}

Tally compare(const Sampled& scene, const Image8& picture, const std::vector<float>& sampled)
{
    Tally tally;
    for (size_t i = 0; i < sampled.size(); ++i) {
        if (scene.sky[i]) continue;
        const float shown = static_cast<float>(picture.texels[i]) / 255.0f;
        const bool differs = std::abs(sampled[i] - shown) > 0.01f, clear = scene.clear(picture, i);
        ++(clear ? tally.clear : tally.edges);
        tally.dark += clear && picture.texels[i] == 0;
        if (differs) ++(clear ? tally.differing : tally.differingAtEdges);
    }
    return tally;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a host's shader sees the shadows that a light's map shows, in GLSL and in HLSL")
{
    Sampled scene;
    Host& host = scene.host;
    Sampler glsl(k_sampled_comp), hlsl(k_sampled_hlsl);
    std::set<std::string> owners;
    for (const GnMethodInfo& method : availableMethods(host.context)) {
        const std::string name = method.pName;
        // All whose maps answer alone, and one each of those that have none, or ask others as well.
        const bool alone = hasMap(method) && !(method.traits & (GN_TRAIT_RAYS_BIT | GN_TRAIT_DEVICE_RAYS_BIT));
        if (!alone && name != "stencil_volume" && name != "pcf_hybrid") continue;
        for (const double filter : {1.0, 3.0}) {
            if (filter > 1.0 && gnSetMethodSetting(host.context, method.pName, "filter", filter) < 0) continue;
            for (uint32_t light = 0; light < host.lights.size(); ++light) {
                const demo::LightKind kind = host.scene.lights[light].kind;
                if (!serves(method, kind)) continue;
                host.pin(light, method.pName);
                host.require(host.draw());
                const Image8 picture = host.pictures()[light];
                const std::vector<float> answers = glsl.sample(host, light, scene.points);
                REQUIRE(glsl.last.litCount == 0);
                const std::string whose = glsl.last.pMethods[light];
                const bool own = whose == name;
                GnLightMap map{};
                if (own) {
                    owners.insert(name);
                    CHECK(gnGetLightMap(host.context, host.lights[light], &map) == GN_SUCCESS);
                    CHECK(map.imageView == glsl.last.pMaps[light]);
                } else {
                    CHECK(whose == (kind == demo::LightKind::Point ? "cube_map" : "shadow_map"));
                }
                const Tally tally = compare(scene, picture, answers);
                MESSAGE(name << " filter " << filter << " of " << host.scene.lights[light].name << ", from " << whose
                             << ": " << tally.differing << " of " << tally.clear << " clear pixels differ, "
                             << tally.differingAtEdges << " of " << tally.edges << " at edges");
                CHECK(tally.clear > 5000);
                CHECK(tally.dark > 40);
                // What is exact, and reconstructed edges, are farther from a map than its own filter.
                CHECK(tally.differing <= (own ? 0 : tally.clear / 50));
                // Edges that are drawn along lines, as ramps or by statistics are another look-up's.
                const bool ownEdges = name == "rbsm" || name == "rpcf" || name == "edt" || name == "moments";
                if (own) CHECK(tally.differingAtEdges * (ownEdges ? 8 : 50) <= tally.edges);
                CHECK(farthest(hlsl.sample(host, light, scene.points), answers) <
                      1.0f / 510.0f); // sums in another order
            }
            if (filter > 1.0) host.require(gnSetMethodSetting(host.context, method.pName, "filter", 1.0));
        }
        host.pinAll("ray_traced");
    }
    std::string list;
    for (const std::string& owner : owners)
        list += " " + owner;
    MESSAGE(owners.size() << " methods hand out maps of their own:" << list);
    CHECK(owners.size() >= 16); // all with maps but those that are warped, or made of pages
}

TEST_CASE_FIXTURE(DeviceTest, "a host's shader makes the lines of rbsm of a map's stairs, in GLSL and in HLSL")
{
    Sampled scene;
    Host& host = scene.host;
    Sampler glsl(k_sampled_lines_comp), hlsl(k_sampled_lines_hlsl), plain(k_sampled_comp);
    host.require(gnSetMethodSetting(host.context, "rbsm", "resolution", 256));
    host.pinAll("rbsm");
    host.require(host.draw());
    const std::vector<Image8> pictures = host.pictures();
    for (uint32_t light = 0; light < host.lights.size(); ++light) {
        const std::vector<float> answers = glsl.sample(host, light, scene.points);
        CHECK(std::string(glsl.last.pMethods[light]) == "rbsm");
        const Tally lines = compare(scene, pictures[light], answers);
        const Tally stairs = compare(scene, pictures[light], plain.sample(host, light, scene.points));
        MESSAGE(host.scene.lights[light].name
                << ": " << lines.differing << " clear pixels and " << lines.differingAtEdges << " of " << lines.edges
                << " at edges differ from rbsm, of plain look-ups " << stairs.differingAtEdges);
        CHECK(lines.clear > 5000);
        CHECK(lines.differing == 0);
        CHECK(lines.differingAtEdges * 100 <= lines.edges);
        CHECK(stairs.differingAtEdges >= 5 * lines.differingAtEdges + 5);
        CHECK(farthest(hlsl.sample(host, light, scene.points), answers) == 0.0f);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a host's shader has the penumbrae of pcss, in GLSL and in HLSL")
{
    Sampled scene(0.4f);
    Host& host = scene.host;
    Sampler glsl(k_sampled_soft_comp), hlsl(k_sampled_soft_hlsl), plain(k_sampled_comp);
    host.pinAll("pcss");
    host.require(host.draw());
    const std::vector<Image8> pictures = host.pictures();
    for (uint32_t light = 0; light < host.lights.size(); ++light) {
        const std::vector<float> answers = glsl.sample(host, light, scene.points);
        CHECK(std::string(glsl.last.pMethods[light]) == "pcss");
        const std::vector<float> hard = plain.sample(host, light, scene.points);
        double soft2 = 0.0, hard2 = 0.0;
        size_t penumbra = 0;
        for (size_t i = 0; i < answers.size(); ++i) {
            const double shown = pictures[light].texels[i] / 255.0;
            if (scene.sky[i] || shown < 0.02 || shown > 0.98) continue;
            ++penumbra;
            soft2 += (answers[i] - shown) * (answers[i] - shown);
            hard2 += (hard[i] - shown) * (hard[i] - shown);
        }
        const Tally tally = compare(scene, pictures[light], answers);
        const double rmse = std::sqrt(soft2 / double(penumbra)), rmseHard = std::sqrt(hard2 / double(penumbra));
        MESSAGE(host.scene.lights[light].name << ": RMSE " << rmse << " to pcss in " << penumbra
                                              << " pixels of penumbra, of hard look-ups " << rmseHard << "; "
                                              << tally.differing << " of " << tally.clear << " clear pixels differ");
        CHECK(penumbra > 100);
        CHECK(rmse <= 0.15 * rmseHard); // the nearest blocker is looked for with 32 taps, not in a pyramid
        CHECK(tally.differing * 1000 <= tally.clear);
        CHECK(farthest(hlsl.sample(host, light, scene.points), answers) < 0.05f);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "a host's shader has the statistics of moments, in GLSL and in HLSL")
{
    struct Kind {
        double kind;
        std::span<const uint32_t> glsl, hlsl;
        size_t edgesPerDiffering; ///< Of MSM sums in another order are divided by small differences.
    };
    for (const Kind& kind : {Kind{3.0, k_sampled_evsm_comp, k_sampled_evsm_hlsl, 200},
                             Kind{4.0, k_sampled_msm_comp, k_sampled_msm_hlsl, 40}}) {
        CAPTURE(kind.kind);
        Sampled scene;
        Host& host = scene.host;
        Sampler glsl(kind.glsl), hlsl(kind.hlsl), plain(k_sampled_comp);
        host.require(gnSetMethodSetting(host.context, "moments", "kind", kind.kind));
        host.pinAll("moments");
        host.require(host.draw());
        const std::vector<Image8> pictures = host.pictures();
        for (uint32_t light = 0; light < host.lights.size(); ++light) {
            CAPTURE(light);
            const Tally own = compare(scene, pictures[light], glsl.sample(host, light, scene.points));
            CHECK(std::string(glsl.last.pMethods[light]) == "moments");
            const Tally other = compare(scene, pictures[light], hlsl.sample(host, light, scene.points));
            const Tally hard = compare(scene, pictures[light], plain.sample(host, light, scene.points));
            MESSAGE(host.scene.lights[light].name << ", kind " << kind.kind << ": " << own.differingAtEdges << " (HLSL "
                                                  << other.differingAtEdges << ") of " << own.edges
                                                  << " pixels at edges differ from moments, of plain look-ups "
                                                  << hard.differingAtEdges);
            for (const Tally& tally : {own, other}) {
                CHECK(tally.clear > 5000);
                CHECK(tally.differing == 0);
                CHECK(tally.differingAtEdges * kind.edgesPerDiffering <= tally.edges);
                CHECK(hard.differingAtEdges > 2 * tally.differingAtEdges);
            }
        }
    }
}

TEST_CASE_FIXTURE(DeviceTest,
                  "what floats before the surfaces has shadows, whatever the zero of the host's coordinates")
{
    Sampled scene;
    Host& host = scene.host;
    host.require(gnWarmUpMethod(host.context, "shadow_map"));
    host.require(gnWarmUpMethod(host.context, "cube_map"));
    host.pinAll("ray_traced"); // has no map: one is drawn beside it
    const brute::Scene casters(scene.triangles);
    const double origin[3] = {100.0, -50.0, 7.0};
    std::vector<SampledPoint> floating, moved;
    for (const SampledPoint& point : scene.points) {
        const glm::dvec3 place = glm::mix(scene.view.eye, glm::dvec3(point.position), 0.95);
        floating.push_back({glm::vec4(glm::vec3(place), 0.0f), glm::vec4(0.0f)});
        moved.push_back({glm::vec4(glm::vec3(place - glm::dvec3(origin[0], origin[1], origin[2])), 0.0f), {}});
    }
    host.require(host.draw());
    Sampler sampler(k_sampled_comp);
    for (uint32_t light = 0; light < host.lights.size(); ++light) {
        const brute::Light lamp = bruteLight(host, light);
        Image8 truth(kExtent.width, kExtent.height, 1);
        for (size_t i = 0; i < floating.size(); ++i) {
            const glm::dvec3 at(floating[i].position);
            const bool sun = lamp.type == GN_LIGHT_TYPE_DIRECTIONAL;
            const glm::dvec3 toLight = sun ? -lamp.direction : lamp.position - at;
            const double away = glm::length(toLight);
            const bool outside =
                (lamp.type == GN_LIGHT_TYPE_SPOT &&
                 glm::dot(glm::normalize(lamp.direction), -toLight) < std::cos(lamp.coneAngle) * away) ||
                (!sun && lamp.range > 0.0 && away > lamp.range);
            truth.texels[i] = outside || !casters.blocked(at, toLight, sun ? 1e9 : 1.0) ? 255 : 0;
        }
        const std::vector<float> answers = sampler.sample(host, light, floating);
        const Tally tally = compare(scene, truth, answers);
        const Tally elsewhere = compare(scene, truth, sampler.sample(host, light, moved, origin));
        MESSAGE(host.scene.lights[light].name << ": " << tally.differing << " of " << tally.clear
                                              << " clear points differ from rays, " << elsewhere.differing
                                              << " about another zero, " << tally.dark << " are dark");
        CHECK(tally.clear > 5000);
        CHECK(tally.dark > 20);
        CHECK(tally.differing <= 2); // a texel of the map is 1 cm here, a pixel 5
        CHECK(elsewhere.differing <= 2);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "descriptors stay as they are while maps do, and are written again when these change")
{
    Sampled scene;
    Host& host = scene.host;
    host.pinAll("ray_traced");
    host.pin(0, "shadow_map");
    Sampler sampler(k_sampled_comp);
    host.require(host.draw());
    sampler.sample(host, 0, scene.points);
    const uint64_t first = sampler.last.revision;
    CHECK(first >= 1);
    for (int frame = 0; frame < 3; ++frame) {
        host.require(host.draw());
        sampler.sample(host, 0, scene.points);
        CHECK(sampler.last.revision == first);
    }
    host.require(gnSetMethodSetting(host.context, "shadow_map", "resolution", 128));
    host.require(host.draw());
    sampler.sample(host, 0, scene.points); // checks that maps change with the revision only
    CHECK(sampler.last.revision > first);
    const uint64_t second = sampler.last.revision;
    host.pin(0, "stencil_volume"); // beside it the map is that of 1 024 texels, which has been gone
    host.require(host.draw());
    sampler.sample(host, 0, scene.points);
    CHECK(sampler.last.revision >= second);
}

TEST_CASE_FIXTURE(DeviceTest, "what has no map is lit, and what is asked in vain is named")
{
    Sampled scene;
    Host& host = scene.host;
    GnSampledShadows shadows{};
    const auto ask = [&](const double* origin = nullptr) {
        return gnGetSampledShadows(host.context, host.views[0], origin, &shadows);
    };
    CHECK(ask() == GN_ERROR_FRAME_ORDER);
    CHECK(contains(host.lastError(), "view"));
    for (size_t i = 0; i < 3; ++i)
        host.pin(i, i == 1 ? "cube_map" : "shadow_map");
    host.require(host.draw());
    host.require(ask());
    CHECK(shadows.lightCount == 3);

    const double nan[3] = {0.0, std::numeric_limits<double>::quiet_NaN(), 0.0};
    CHECK(ask(nan) == GN_ERROR_NOT_A_NUMBER);
    CHECK(contains(host.lastError(), "pOrigin[1]"));
    CHECK(shadows.pMaps == nullptr);
    const double infinite[3] = {0.0, 0.0, std::numeric_limits<double>::infinity()};
    CHECK(ask(infinite) == GN_ERROR_INFINITE);
    CHECK(gnGetSampledShadows(host.context, host.views[0], nullptr, nullptr) == GN_ERROR_NULL_ARGUMENT);
    CHECK(gnGetSampledShadows(host.context, VK_NULL_HANDLE, nullptr, &shadows) == GN_ERROR_INVALID_HANDLE);

    // One light is not for shaders: lit everywhere, the others as they were. So is an index past the lights.
    Sampler sampler(k_sampled_comp);
    markSampled(host, 0, false);
    host.require(host.draw());
    const auto allLit = [&](uint32_t light) {
        const std::vector<float> answers = sampler.sample(host, light, scene.points);
        return std::count(answers.begin(), answers.end(), 1.0f) == std::ptrdiff_t(answers.size());
    };
    CHECK(allLit(0));
    CHECK(sampler.last.litCount == 1);
    CHECK(sampler.last.pMethods[0] == nullptr);
    CHECK(!allLit(1));
    CHECK(!allLit(2));
    CHECK(allLit(7));

    for (size_t i = 1; i < 3; ++i)
        markSampled(host, i, false);
    host.require(host.draw());
    CHECK(ask() == GN_ERROR_EMPTY);
    CHECK(contains(host.lastError(), "GN_LIGHT_SAMPLED_BIT"));

    markSampled(host, 0);
    host.require(host.draw({.call = Call::record, .drop = true}));
    CHECK(ask() == GN_ERROR_FRAME_ORDER); // it does not count
    host.require(host.draw());
    host.require(ask());
    CHECK(shadows.litCount == 2);
}
