// What the window draws over a picture, against the same from images on the CPU.
#include <algorithm>
#include <array>
#include <cmath>

#include "demo/program/aliasing.hpp"
#include "demo/program/measure.hpp"
#include "demo/program/picture_views.hpp"
#include "demo/program/pictures.hpp"
#include "host_fixture.hpp"

namespace gnomon::demo {
namespace {

/// A second light, so that errors of two meet in a picture.
Scene twoLights(LightKind kind = LightKind::Spot)
{
    Scene scene = boxOnFloor();
    scene.lights[0].kind = kind;
    Light light = scene.lights[0];
    light.name = "other";
    light.position = glm::dvec3(4.0, 5.0, 3.0);
    light.direction = glm::normalize(glm::dvec3(-4.0, -5.0, -3.0));
    scene.lights.push_back(light);
    return scene;
}

bool has(const ShadowHost& shadows, std::string_view method)
{
    const std::vector<GnMethodInfo> all = shadows.methods();
    return std::ranges::any_of(all, [&](const GnMethodInfo& is) { return is.pName == method && !is.pUnavailable; });
}

FrameSurfaces surfacesOf(Session& session)
{
    return {.depth = session.renderer.readDepth(), .normals = session.renderer.readNormals()};
}

/// How much of a colour is in a pixel that is mixed from it and a grey: by the distance of the largest from the
/// smallest channel.
double shareOf(const uint8_t* pixel, const Rgb8& colour)
{
    const auto spread = [](int a, int b, int c) { return std::max({a, b, c}) - std::min({a, b, c}); };
    return double(spread(pixel[0], pixel[1], pixel[2])) / spread(colour.r, colour.g, colour.b);
}

/// Per pixel the difference of visibility that is largest of the lights that it counts for.
std::vector<double> largestErrors(Session& judged, Session& truth, ErrorCount& errors)
{
    const std::vector<Image8> is = judged.renderer.readVisibility(), shouldBe = truth.renderer.readVisibility();
    const FrameSurfaces surfaces = surfacesOf(truth);
    const SceneState& state = truth.renderer.state();
    std::vector<double> largest(is[0].texels.size(), 0.0);
    for (size_t layer = 0; layer < state.present.size(); ++layer) {
        const uint32_t light = state.present[layer];
        const std::vector<uint8_t> counted = countedPixels(truth.scene, truth.renderer.camera(), surfaces,
                                                           truth.scene.lights[light], state.lights[light]);
        errors += compare(is[layer], shouldBe[layer], counted);
        for (size_t i = 0; i < largest.size(); ++i) {
            const double error = (int(is[layer].texels[i]) - int(shouldBe[layer].texels[i])) / 255.0;
            if (counted[i] == 1 && std::fabs(error) > std::fabs(largest[i])) largest[i] = error;
        }
    }
    return largest;
}

/// m of pictureOf() from its colours; nothing where no map is looked up.
std::optional<double> widthIn(const uint8_t* pixel)
{
    if (std::max(pixel[0], pixel[2]) < 255) return std::nullopt;
    return std::exp2((pixel[0] == 255 ? 3.0 : -3.0) * (255 - pixel[1]) / 255.0);
}

} // namespace

TEST_CASE("the view of errors has the colours and the counts that both visibilities give")
{
    const Scene scene = twoLights();
    Session judged(testDevice(), scene, {}), truth(testDevice(), scene, {});
    if (!has(truth.shadows, kTruthMethod)) return; // a build without Embree
    expect(judged.shadows.pinAll("shadow_map"));
    expect(judged.shadows.set("shadow_map", kResolutionSetting, 64.0)); // coarse: wrong both ways
    expect(truth.shadows.pinAll(kTruthMethod));
    settle(judged, "shadow_map", 0.0, false);
    settle(truth, kTruthMethod, 0.0, false);

    const ErrorView view(testDevice(), judged.renderer);
    for (const uint32_t left : {0u, 40u}) {
        drawFrame(truth, {.shadows = &truth.shadows});
        drawFrame(judged, {.shadows = &judged.shadows});
        const Image8 plain = judged.renderer.readColour();
        drawFrame(judged, {.shadows = &judged.shadows, .overlay = [&](VkCommandBuffer cmd, const Image&) {
                               view.record(cmd, judged.renderer, truth.renderer, left);
                           }});
        const Image8 shown = judged.renderer.readColour();
        ErrorCount errors;
        const std::vector<double> expected = largestErrors(judged, truth, errors);
        size_t red = 0, blue = 0, differing = 0;
        for (uint32_t y = 0; y < shown.height; ++y)
            for (uint32_t x = 0; x < shown.width; ++x) {
                const uint8_t* const pixel = shown.at(x, y);
                if (x < left) {
                    CHECK(std::equal(pixel, pixel + 3, plain.at(x, y)));
                    continue;
                }
                const double error = expected[size_t(y) * shown.width + x];
                const double share = shareOf(pixel, error > 0.0 ? kFalseLit : kFalseShadow);
                red += error > 0.0 && share > 0.9 && pixel[0] > pixel[2];
                blue += error < 0.0 && share > 0.9 && pixel[2] > pixel[0];
                differing += std::fabs(share - std::fabs(error)) > 0.02;
            }
        CHECK(red > 4);
        CHECK(blue > 4);
        CHECK(differing <= 4); // at the rim of a cone, where the shaders' ray is interpolated
        if (left > 0) continue;
        const ErrorView::Counts counts = view.counts();
        CHECK(std::fabs(double(counts.counted) - double(errors.counted)) <= 4.0);
        CHECK(std::fabs(double(counts.wrong) - double(errors.wrong())) <= 4.0);
    }
    checkSilence();
}

TEST_CASE("without an error the view is grey, and counts none wrong")
{
    const Scene scene = twoLights();
    Session session(testDevice(), scene, {});
    expect(session.shadows.pinAll("shadow_map"));
    settle(session, "shadow_map", 0.0, false);
    const ErrorView view(testDevice(), session.renderer);
    drawFrame(session, {.shadows = &session.shadows, .overlay = [&](VkCommandBuffer cmd, const Image&) {
                            view.record(cmd, session.renderer, session.renderer, 0);
                        }});
    const Image8 shown = session.renderer.readColour();
    for (size_t i = 0; i < shown.texels.size(); i += 3)
        REQUIRE((shown.texels[i] == shown.texels[i + 1] && shown.texels[i] == shown.texels[i + 2]));
    CHECK(view.counts().counted > shown.texels.size() / 6);
    CHECK(view.counts().wrong == 0);
    checkSilence();
}

TEST_CASE("the view of texels has the widths that are measured on the CPU")
{
    struct Case {
        LightKind kind;
        std::string method;
    };
    for (const Case& each : {Case{LightKind::Spot, "shadow_map"}, Case{LightKind::Point, "cube_map"},
                             Case{LightKind::Directional, "cascades"}}) {
        const std::string& method = each.method;
        CAPTURE(method);
        const Scene scene = twoLights(each.kind);
        Session session(testDevice(), scene, {});
        expect(session.shadows.pinAll(method));
        expect(session.shadows.set(method, kResolutionSetting, 128.0)); // neither end of the colours
        settle(session, method, 0.0, false);
        GnLightMap map{GN_INIT(GnLightMap)};
        const TexelView view(testDevice(), session.renderer);
        drawFrame(session, {.shadows = &session.shadows, .overlay = [&](VkCommandBuffer cmd, const Image&) {
                                REQUIRE(gnGetLightMap(session.shadows.context(), session.shadows.light(1), &map) >= 0);
                                view.record(cmd, session.renderer, map, 1);
                            }});
        const Image8 shown = session.renderer.readColour();
        const FrameSurfaces surfaces = surfacesOf(session);
        const CameraMatrices& camera = session.renderer.camera();
        const std::vector<uint8_t> counted =
            countedPixels(scene, camera, surfaces, scene.lights[1], session.renderer.state().lights[1]);
        const std::optional<ImageF> widths = measureAliasing(map, each.kind, camera, surfaces, counted);
        REQUIRE(widths);
        size_t compared = 0, differing = 0;
        double least = INFINITY, most = 0.0;
        for (size_t i = 0; i < widths->texels.size(); ++i) {
            const double m = std::clamp(double(widths->texels[i]), 0.125, 8.0);
            const std::optional<double> is = widthIn(&shown.texels[3 * i]);
            if (is.has_value() != (widths->texels[i] > 0.0f)) ++differing;
            if (!is || !(widths->texels[i] > 0.0f)) continue;
            ++compared;
            differing += std::fabs(*is / m - 1.0) > 0.02; // a step of 8 bits is 0.8 %
            least = std::min(least, m);
            most = std::max(most, m);
        }
        CHECK(compared > counted.size() / 4);
        CHECK(differing <= compared / 100); // rims of cones, borders of layers and faces
        CHECK(most > 1.2 * least);
    }
    checkSilence();
}

} // namespace gnomon::demo
