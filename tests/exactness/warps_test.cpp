// Maps that follow the view, beside plain ones of equal size, where the view is near and where it looks along the
// light.
#include <algorithm>
#include <cmath>

#include "demo/scene/primitives.hpp"
#include "exactness/stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{480, 270};

/// Posts beside a way of 160 m and boards over it, the eye on it, and a tower behind the eye whose shadow falls into
/// the view.
Scene avenue(LightKind kind, const glm::dvec3& direction)
{
    Scene scene;
    scene.name = "avenue";
    place(scene, "ground", demo::makeBox({.size = {60.0f, 1.0f, 200.0f}}), {0.0, -0.5, -60.0});
    for (int i = 0; i < 26; ++i)
        for (const double side : {-1.0, 1.0})
            place(scene, "post", demo::makeBox({.size = {0.4f, 2.5f, 0.4f}}),
                  {side * (2.5 + 0.3 * (i % 3)), 1.25, 6.0 - 6.0 * i});
    for (int i = 0; i < 12; ++i)
        place(scene, "board", demo::makeBox({.size = {1.7f, 0.1f, 0.8f}}), {0.5 * (i % 2), 3.5, 1.0 - 9.0 * i});
    place(scene, "tower", demo::makeBox({.size = {2.0f, 9.0f, 2.0f}}), {1.0, 4.5, 9.0});
    demo::Light& light = scene.lights.emplace_back();
    light.name = "light";
    light.kind = kind;
    light.direction = glm::normalize(direction);
    if (kind == LightKind::Spot) {
        light.position = glm::dvec3(0.0, 0.0, -30.0) - 70.0 * light.direction;
        light.outerAngle = 0.8f;
        light.innerAngle = 0.75f;
        light.range = 300.0f;
    }
    scene.camera = {{.eye = {0.0, 1.7, 4.0}, .target = {0.0, 1.2, -10.0}}};
    return scene;
}

ErrorCount errorOf(Stage& stage, const char* method, double resolution, Settings settings = {})
{
    settings.push_back({"resolution", resolution});
    return pooled(stage, stage.draw(method, settings));
}

double percent(const ErrorCount& error)
{
    return error.percent(error.wrong());
}

struct Errors {
    ErrorCount plain, minimal, desired, trapezoidal, psm, lispsm;
};

Errors errorsOf(Stage& stage, double resolution)
{
    const Errors errors{errorOf(stage, "shadow_map", resolution),
                        errorOf(stage, "shadow_map", resolution, {{"fit", 1.0}}),
                        errorOf(stage, "shadow_map", resolution, {{"fit", 2.0}}),
                        errorOf(stage, "trapezoidal", resolution),
                        errorOf(stage, "perspective_warp", resolution, {{"form", 0.0}}),
                        errorOf(stage, "perspective_warp", resolution, {{"form", 1.0}})};
    MESSAGE(stage.scene().name << " at " << resolution << ": shadow_map " << inWords(errors.plain) << ", minimal "
                               << inWords(errors.minimal) << ", desired view " << inWords(errors.desired)
                               << ", trapezoidal " << inWords(errors.trapezoidal) << ", PSM " << inWords(errors.psm)
                               << ", LiSPSM " << inWords(errors.lispsm));
    return errors;
}

} // namespace

TEST_CASE("where the view is near, every warped map is less wrong than a plain one of its size, and LiSPSM than PSM, "
          "all lights together")
{
    const test::DeviceTest silence;
    const glm::dvec3 across(0.8, -0.6, -0.1), behind(0.1, -0.5, -0.9), ahead(-0.2, -0.6, 0.8);
    Errors all;
    for (const LightKind kind : {LightKind::Directional, LightKind::Spot})
        for (const glm::dvec3& direction : {across, behind, ahead}) {
            const std::string lamp = nameOf(kind);
            CAPTURE(lamp);
            CAPTURE(direction.z);
            Stage stage(avenue(kind, direction), kSize);
            const Errors errors = errorsOf(stage, 512.0);
            CHECK(errors.plain.counted > 20'000);
            CHECK(percent(errors.trapezoidal) < 0.9 * percent(errors.plain));
            CHECK(percent(errors.psm) < percent(errors.plain));
            CHECK(percent(errors.lispsm) < 0.9 * percent(errors.plain));
            CHECK(percent(errors.lispsm) <= 1.25 * percent(errors.psm));
            CHECK(percent(errors.minimal) <=
                  1.2 * percent(errors.plain)); // along the posts' sides is not the worst way
            all.plain += errors.plain;
            CHECK(percent(errors.desired) <= percent(errors.plain));
            all.minimal += errors.minimal;
            all.desired += errors.desired;
            all.trapezoidal += errors.trapezoidal;
            all.psm += errors.psm;
            all.lispsm += errors.lispsm;
        }
    MESSAGE("all: shadow_map " << inWords(all.plain) << ", minimal " << inWords(all.minimal) << ", desired view "
                               << inWords(all.desired) << ", trapezoidal " << inWords(all.trapezoidal) << ", PSM "
                               << inWords(all.psm) << ", LiSPSM " << inWords(all.lispsm));
    CHECK(percent(all.minimal) < 0.9 * percent(all.plain));
    CHECK(percent(all.desired) < 0.7 * percent(all.plain));
    CHECK(all.desired.falseLit <= all.plain.falseLit); // a crop loses no caster
    CHECK(percent(all.trapezoidal) < 0.6 * percent(all.plain));
    CHECK(percent(all.lispsm) < 0.6 * percent(all.plain));
    CHECK(percent(all.lispsm) <= 1.05 * percent(all.psm));
}

TEST_CASE("of a spot light kilometres away no warp makes surfaces shadow themselves")
{
    const test::DeviceTest silence;
    for (const double distance : {1e4, 1e5}) {
        CAPTURE(distance);
        Scene scene = test::smallScene();
        demo::Light& light = scene.lights[0];
        light.position = distance * glm::normalize(glm::dvec3(2.0, 6.0, 3.0));
        light.direction = -glm::normalize(light.position);
        light.outerAngle = light.innerAngle = static_cast<float>(std::atan(7.0 / distance));
        light.range = 1e6f;
        scene.camera = {{.eye = {6.0, 8.0, 18.0}, .target = {0.0, 0.5, 0.0}, .verticalFov = 0.14f}};
        Stage stage(scene, kSize);
        const Errors errors = errorsOf(stage, 1024.0);
        CHECK(errors.plain.counted > 20'000);
        for (const ErrorCount& warped : {errors.trapezoidal, errors.psm, errors.lispsm})
            CHECK(double(warped.wrong()) <= 1.25 * double(errors.plain.wrong()) + 40.0);
    }
}

TEST_CASE("where the light is far larger than the view, moments of what is seen are less wrong, and hybrids trace less")
{
    const test::DeviceTest silence;
    for (const LightKind kind : {LightKind::Directional, LightKind::Spot}) {
        const std::string lamp = nameOf(kind);
        CAPTURE(lamp);
        Scene scene = avenue(kind, {0.8, -0.6, -0.1});
        scene.camera = {{.eye = {-1.0, 5.0, 1.0}, .target = {0.0, 0.0, -4.0}}};
        Stage stage(scene, kSize);
        const auto fitted = [&](const char* method, double fit) {
            const ErrorCount error = errorOf(stage, method, 512.0, {{"fit", fit}});
            return std::pair(error, stage.session().shadows.stats().rays);
        };
        const auto [whole, none] = fitted("moments", 0.0);
        const auto [seen, never] = fitted("moments", 1.0);
        MESSAGE("moments under a " << lamp << ": " << inWords(whole) << ", of what is seen " << inWords(seen));
        CHECK(whole.counted > 20'000);
        CHECK(seen.wrong() < whole.wrong());
        const auto [wholeTraced, wholeRays] = fitted("pcf_hybrid", 0.0);
        const auto [seenTraced, seenRays] = fitted("pcf_hybrid", 1.0);
        MESSAGE("pcf_hybrid under a " << lamp << ": " << inWords(wholeTraced) << " with " << wholeRays
                                      << " rays, of what is seen " << inWords(seenTraced) << " with " << seenRays);
        CHECK(seenTraced.wrong() <= wholeTraced.wrong());
        CHECK(seenRays < wholeRays);
    }
}

TEST_CASE("a tower behind the eye casts into warped maps")
{
    const test::DeviceTest silence;
    Stage stage(avenue(LightKind::Directional, {0.02, -0.5, -0.9}), kSize);
    Scene bare = avenue(LightKind::Directional, {0.02, -0.5, -0.9});
    bare.instances.pop_back(); // the tower
    Stage without(bare, kSize);
    size_t cast = 0;
    for (size_t i = 0; i < stage.truth[0].texels.size(); ++i)
        cast += stage.truth[0].texels[i] < without.truth[0].texels[i];
    CHECK(cast > 2000);
    const struct {
        const char* method;
        Settings settings;
    } kept[] = {{"trapezoidal", {}},
                {"perspective_warp", {{"form", 0.0}}},
                {"perspective_warp", {{"form", 1.0}}},
                {"shadow_map", {{"fit", 1.0}}},
                {"shadow_map", {{"fit", 2.0}}},
                {"moments", {{"fit", 1.0}}},
                {"pcf_hybrid", {{"fit", 1.0}}}};
    for (const auto& [method, settings] : kept) {
        Settings fine = settings;
        fine.push_back({"resolution", 2048.0});
        const Pictures picture = stage.draw(method, fine);
        size_t lost = 0;
        for (size_t i = 0; i < picture[0].texels.size(); ++i)
            lost += stage.truth[0].texels[i] < without.truth[0].texels[i] && picture[0].texels[i] > 127;
        MESSAGE(std::string(method) << ": of " << cast << " pixels that the tower shades " << lost << " are lit");
        CHECK(50 * lost < cast);
    }
}

TEST_CASE("whatever the light, warped maps are no worse than plain ones by more than a quarter, coarse ones twice")
{
    const test::DeviceTest silence;
    struct Hard {
        const char* what;
        LightKind kind;
        glm::dvec3 direction;
        double distance; ///< Spot: from the ground it shines on.
        float angle;
        glm::dvec3 eye, target;
    };
    const glm::dvec3 eye(0.0, 1.7, 4.0), target(0.0, 1.2, -10.0), down(0.0, -1.0, 0.0);
    const Hard cases[] = {
        {"exactly above", LightKind::Directional, down, 0.0, 0.0f, eye, target},
        {"the view looks along the light",
         LightKind::Directional,
         down,
         0.0,
         0.0f,
         {0.0, 30.0, -20.0},
         {0.0, 0.0, -20.01}},
        {"the view looks into the light", LightKind::Directional, {0.0, -0.05, 1.0}, 0.0, 0.0f, eye, {0.0, 1.9, 0.0}},
        {"a cone of 2 degrees", LightKind::Spot, {0.3, -0.8, -0.1}, 200.0, 0.0175f, eye, target},
        {"a cone of 178 degrees", LightKind::Spot, down, 4.0, 1.55f, eye, target},
        {"a lamp in view", LightKind::Spot, {0.0, -1.0, -0.2}, 3.0, 0.9f, eye, target},
        {"a lamp in the eye", LightKind::Spot, {0.0, -0.1, -1.0}, 0.0, 0.7f, eye, target},
        {"a lamp 20 km away", LightKind::Spot, {0.5, -0.8, -0.1}, 20'000.0, 0.005f, eye, target},
    };
    for (const Hard& hard : cases) {
        CAPTURE(std::string(hard.what));
        Scene scene = avenue(hard.kind, hard.direction);
        scene.name = hard.what;
        scene.lights[0].outerAngle = hard.angle;
        scene.lights[0].innerAngle = 0.9f * hard.angle;
        scene.lights[0].range = hard.kind == LightKind::Spot ? float(2.0 * hard.distance + 300.0) : 0.0f;
        scene.lights[0].position =
            hard.distance > 0.0 ? glm::dvec3(0.0, 0.0, -3.0) - hard.distance * scene.lights[0].direction : hard.eye;
        scene.camera = {{.eye = hard.eye, .target = hard.target}};
        Stage stage(scene, {240, 136});
        for (const double resolution : {64.0, 512.0}) {
            const Errors errors = errorsOf(stage, resolution);
            for (const ErrorCount& error :
                 {errors.minimal, errors.desired, errors.trapezoidal, errors.psm, errors.lispsm})
                CHECK(double(error.wrong()) <= (resolution > 64.0 ? 1.25 : 2.0) * double(errors.plain.wrong()) + 40.0);
        }
    }
}

} // namespace gnomon::exact
