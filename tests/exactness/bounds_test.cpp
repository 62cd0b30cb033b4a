// How wrong each method may be, in every shipped scene at time 0: wrong pixels among those that face the light, lie
// within its range and cone, and are not grazing; pooled over the lights a method serves. MESSAGE prints what is
// measured.
#include <algorithm>
#include <cmath>

#include "demo/program/receivers.hpp"
#include "exactness/results.hpp"
#include "runtime/registry.hpp"

namespace gnomon::exact {
namespace {

const ErrorCount& counted(const ErrorCount& error)
{
    CHECK(error.counted > 10000); // else a percentage says little
    return error;
}

double wrongPercent(const ErrorCount& error)
{
    return error.percent(error.wrong());
}

/// Per scene, what `method` makes of it, printed.
ErrorCount printed(const SceneResults& results, const std::string& method, uint32_t resolution = 0)
{
    const Pictures& pictures = results.of(method, resolution);
    const ErrorCount error = counted(results.pooled(pictures));
    std::string worst = "none";
    double worstPercent = -1.0;
    for (size_t layer = 0; layer < pictures.size(); ++layer) {
        if (pictures[layer].width == 0) continue;
        const double percent =
            wrongPercent(demo::compare(pictures[layer], results.truth[layer], results.counted[layer]));
        if (percent <= worstPercent) continue;
        worstPercent = percent;
        worst = results.light(layer).name;
    }
    MESSAGE(results.name << ": " << method << " " << (resolution ? std::to_string(resolution) : std::string())
                         << " wrong " << inWords(error) << "; worst light " << worst << " "
                         << percentText(worstPercent));
    return error;
}

bool isStandardDepth(const SceneResults& results)
{
    return results.scene.depth.convention == demo::DepthConvention::Standard;
}

/// Whether a receiver's direction from the light lies within `texels` of a border of the face it falls into.
/// A face of n texels spans [-1, 1] in the ratio of the smaller components to the largest.
bool nearFaceBorder(const glm::dvec3& fromLight, double texels, uint32_t resolution)
{
    const glm::dvec3 size = glm::abs(fromLight);
    const double largest = std::max({size.x, size.y, size.z});
    const double smallest = std::min({size.x, size.y, size.z});
    const double middle = size.x + size.y + size.z - largest - smallest;
    return middle / largest > 1.0 - 2.0 * texels / resolution;
}

/// Splits the counted pixels of a point light: `mask` keeps those near a face border, or the others.
std::vector<uint8_t> borderMask(const SceneResults& results, size_t layer, uint32_t resolution, bool nearBorder)
{
    const demo::ImageF& depth = results.surfaces.depth;
    const gpu::ViewConstants view = demo::viewConstants(results.scene, results.camera, {depth.width, depth.height});
    const glm::dvec3 light = results.state.lights[results.state.present[layer]].position - results.camera.eye;
    std::vector<uint8_t> mask = results.counted[layer];
    for (uint32_t y = 0; y < depth.height; ++y) {
        for (uint32_t x = 0; x < depth.width; ++x) {
            uint8_t& pixel = mask[size_t(y) * depth.width + x];
            if (pixel == 0) continue;
            const glm::vec2 at(float(x) + 0.5f, float(y) + 0.5f);
            const glm::dvec3 receiver(gpu::viewRayWs(view, at) * gpu::linearDepth(view, *depth.at(x, y)));
            if (nearFaceBorder(receiver - light, 2.0, resolution) != nearBorder) pixel = 0;
        }
    }
    return mask;
}

} // namespace

// Standard depth leaves an ulp a hundred times as long, and what is clear by the definition is not to its rasteriser.
TEST_CASE("volumes are clearly wrong on at most two pixels of a frame, all its lights together")
{
    for (const std::string& name : sceneNames()) {
        const SceneResults& results = resultsOf(name);
        if (isStandardDepth(results)) continue;
        CAPTURE(name);
        uint64_t clear = 0;
        for (size_t layer = 0; layer < results.truth.size(); ++layer) {
            const uint64_t ofLight = clearlyWrong(results.scene, results, results.of("stencil_volume")[layer], layer);
            MESSAGE(name << ": " << results.light(layer).name << ", clearly wrong " << ofLight);
            clear += ofLight;
        }
        CHECK(clear <= 2);
    }
}

TEST_CASE(
    "volumes are wrong on at most 0.005 % of the pixels, with standard depth 0.04 %, whichever way they are found")
{
    for (const std::string& name : sceneNames()) {
        CAPTURE(name);
        const SceneResults& results = resultsOf(name);
        const ErrorCount error = printed(results, "stencil_volume");
        CHECK(wrongPercent(error) <= edgePercent(isStandardDepth(results) ? 0.04 : 0.005));
        for (const char* method : {"octree_volume", "all_edges_volume"}) {
            const ErrorCount same = printed(results, method);
            CHECK(same.wrong() == error.wrong());
            CHECK(same.counted == error.counted);
        }
    }
}

TEST_CASE("pcf_hybrid is wrong on at most a third of the pixels that shadow_map is at the same map")
{
    for (const std::string& name : sceneNames()) {
        CAPTURE(name);
        const SceneResults& results = resultsOf(name);
        const GnTraits both = results.traitsOf("shadow_map") & results.traitsOf("pcf_hybrid");
        for (const uint32_t resolution : {kCoarse, 1024u}) {
            const ErrorCount map = counted(results.pooled(results.of("shadow_map", resolution), both));
            const ErrorCount hybrid = counted(results.pooled(results.of("pcf_hybrid", resolution), both));
            MESSAGE(name << ": at " << resolution << " texels pcf_hybrid " << inWords(hybrid) << ", shadow_map "
                         << inWords(map) << ", ratio " << double(hybrid.wrong()) / double(map.wrong()));
            CHECK(map.counted == hybrid.counted);
            CHECK(3 * hybrid.wrong() <= map.wrong());
        }
    }
}

// Casters thinner than two texels of 512 are in every shipped scene, where the second bound is what is asked for; the
// first holds all the same. What the map answers without volumes is shadow_map's error.
TEST_CASE(
    "chan_durand with maps of 512 texels is wrong on at most 0.1 % of the pixels, and a quarter of the map's own error")
{
    for (const std::string& name : sceneNames()) {
        CAPTURE(name);
        const SceneResults& results = resultsOf(name);
        CHECK(wrongPercent(printed(results, "chan_durand", 512)) <= 0.1);
        const GnTraits both = results.traitsOf("shadow_map") & results.traitsOf("chan_durand");
        const ErrorCount map = counted(results.pooled(results.of("shadow_map", 512), both));
        const ErrorCount hybrid = counted(results.pooled(results.of("chan_durand", 512), both));
        CHECK(map.counted == hybrid.counted);
        CHECK(4 * hybrid.wrong() <= map.wrong());
    }
}

TEST_CASE("the error of shadow_map falls by 1.4 to 2.6 with every doubling of its map from 512 to 4096")
{
    for (const std::string& name : sceneNames()) {
        CAPTURE(name);
        const SceneResults& results = resultsOf(name);
        double before = 0.0;
        for (const uint32_t resolution : kMapSizes) {
            const double now = wrongPercent(printed(results, "shadow_map", resolution));
            if (before > 0.0) {
                CAPTURE(resolution);
                MESSAGE(name << ": to " << resolution << " texels the error falls " << before / now << " times");
                CHECK(before >= 1.4 * now);
                CHECK(before <= 2.6 * now);
            }
            before = now;
        }
    }
}

// In smaller pictures than the bounds are meant for, ambiguous pixels are a floor under the error (rooms at 640x360:
// 0.04 %); there all three doublings are taken together.
TEST_CASE("the error of angular_spans falls by 1.4 to 2.6 with every doubling of its rows from 75 to 600")
{
    const bool full = testSize().width >= 1280;
    for (const std::string& name : sceneNames()) {
        CAPTURE(name);
        const SceneResults& results = resultsOf(name);
        std::vector<double> wrong;
        for (const uint32_t rows : kRowCounts)
            wrong.push_back(wrongPercent(printed(results, "angular_spans", rows)));
        for (size_t i = 1; i < wrong.size(); ++i) {
            MESSAGE(name << ": to " << kRowCounts[i] << " rows the error falls " << wrong[i - 1] / wrong[i]
                         << " times");
            if (!full) continue;
            CHECK(wrong[i - 1] >= 1.4 * wrong[i]);
            CHECK(wrong[i - 1] <= 2.6 * wrong[i]);
        }
        CHECK(wrong.front() >= 1.4 * 1.4 * 1.4 * wrong.back());
        CHECK(wrong.front() <= 2.6 * 2.6 * 2.6 * wrong.back());
    }
}

TEST_CASE("cube_map and dual_paraboloid of 1024 texels are wrong on at most 1 % of the pixels")
{
    uint32_t scenes = 0;
    for (const std::string& name : sceneNames()) {
        CAPTURE(name);
        const SceneResults& results = resultsOf(name);
        if (!results.has(LightKind::Point)) continue;
        ++scenes;
        CHECK(wrongPercent(printed(results, "cube_map", 1024)) <= 1.0);
        CHECK(wrongPercent(printed(results, "dual_paraboloid", 1024)) <= 1.0);
    }
    CHECK(scenes >= 3);
}

// In a single scene too few wrong pixels lie near borders to compare shares (0 to 5 at 1024 texels). All scenes
// together have about ten, and with faces of 256 texels, whose borders are wider and coarser, some 200.
TEST_CASE("cube_map is wrong along the borders of its faces at most 1.5 times as often as elsewhere")
{
    for (const uint32_t resolution : {256u, 1024u}) {
        CAPTURE(resolution);
        ErrorCount border, elsewhere;
        for (const std::string& name : sceneNames()) {
            const SceneResults& results = resultsOf(name);
            if (!results.has(LightKind::Point)) continue;
            const Pictures& pictures = results.of("cube_map", resolution);
            for (size_t layer = 0; layer < pictures.size(); ++layer) {
                if (pictures[layer].width == 0) continue;
                border +=
                    demo::compare(pictures[layer], results.truth[layer], borderMask(results, layer, resolution, true));
                elsewhere +=
                    demo::compare(pictures[layer], results.truth[layer], borderMask(results, layer, resolution, false));
            }
        }
        MESSAGE("cube_map " << resolution << ": along borders wrong " << inWords(border) << ", elsewhere "
                            << inWords(elsewhere));
        CHECK(border.counted > 1000);
        CHECK(wrongPercent(border) <= 1.5 * wrongPercent(elsewhere));
    }
}

namespace {

struct LitAndDark {
    uint64_t lit = 0, dark = 0;
};

LitAndDark truthOf(const SceneResults& results, LightKind kind)
{
    LitAndDark sum;
    for (size_t layer = 0; layer < results.truth.size(); ++layer) {
        if (results.light(layer).kind != kind) continue;
        for (size_t i = 0; i < results.counted[layer].size(); ++i)
            if (results.counted[layer][i] == 1) ++(results.truth[layer].texels[i] < 128 ? sum.dark : sum.lit);
    }
    return sum;
}

struct GrossBounds {
    double missingPercent = 5.0; ///< Of the dark pixels.
    double acnePercent = 1.0;    ///< Of the lit ones.
};

void checkNoGrossFailure(const SceneResults& results, const std::string& method, const KindOfLight& kind,
                         uint32_t variant = 0, const GrossBounds& bounds = {})
{
    const std::string kindName = nameOf(kind.kind);
    CAPTURE(results.name);
    CAPTURE(method);
    CAPTURE(kindName);
    const auto [lit, dark] = truthOf(results, kind.kind);
    const ErrorCount error = results.pooled(results.of(method, variant), kind.trait);
    const double missing = 100.0 * double(error.falseLit) / double(dark);
    const double acne = 100.0 * double(error.falseShadow) / double(lit);
    MESSAGE(results.name << ", " << method << ", " << kindName << ": of " << dark << " dark pixels lit "
                         << percentText(missing) << ", of " << lit << " lit ones dark " << percentText(acne));
    CHECK(dark > 500);
    CHECK(lit > 500);
    CHECK(missing < bounds.missingPercent);
    CHECK(acne < bounds.acnePercent);
}

/// An average over a box takes away what is thinner than half of it: under the colonnade's low sun 5.1 % of the dark
/// pixels by one of 5 texels, 11.6 % by that of `moments`, whose bounds are not tight; and folds of the cloth darken
/// each other (1.0 % of the lit ones). Hence 2.6 times the bounds for 5 texels, and so on.
GrossBounds boundsFor(double texels)
{
    const double factor = 1.0 + (texels - 1.0) / 2.5;
    return {factor * GrossBounds().missingPercent, factor * GrossBounds().acnePercent};
}

/// By the texels that the method averages over, and the side of its maps, for which bounds are given at 1024.
GrossBounds defaultBounds(const std::string& method)
{
    GrossBounds bounds = boundsFor(defaultOf(method, "filter", 1.0));
    bounds.missingPercent *= std::max(1.0, edgePercent(1024.0 / defaultOf(method, "resolution", 1024.0)));
    bounds.acnePercent = edgePercent(bounds.acnePercent);
    return bounds;
}

void checkNoGrossFailure(const SceneResults& results)
{
    for (const std::string& method : results.names)
        for (const KindOfLight& kind : kKinds) // off its plane a planar method is wrong: planar_test.cpp
            if (results.has(kind.kind) && (results.traitsOf(method) & kind.trait) != 0 &&
                (results.traitsOf(method) & GN_TRAIT_PLANAR_BIT) == 0)
                checkNoGrossFailure(results, method, kind, 0, defaultBounds(method));
}

} // namespace

// Not a bound on quality: neither may shadows be lost nor lit surfaces speckle, whatever the share of dark pixels.
TEST_CASE("no method misses shadows or shows acne, whatever the scene and the kind of light")
{
    for (const std::string& name : sceneNames())
        checkNoGrossFailure(resultsOf(name));
}

TEST_CASE("no method misses shadows or shows acne once everything has moved")
{
    bool odd = false; // every method in half of the scenes
    for (const std::string& name : sceneNames()) {
        checkNoGrossFailure(laterResultsOf(name, odd));
        odd = !odd;
    }
}

TEST_CASE("maps that average 5 x 5 texels lose no shadows wider than that, and show no acne")
{
    for (const std::string& name : sceneNames()) {
        const SceneResults& results = resultsOf(name);
        for (const std::string method : kAveraging)
            for (const KindOfLight& kind : kKinds)
                if (results.has(kind.kind) && (results.traitsOf(method) & kind.trait) != 0)
                    checkNoGrossFailure(results, method, kind, kWideFilter, boundsFor(kWideFilter));
    }
}

} // namespace gnomon::exact
