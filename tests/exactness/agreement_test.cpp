// Settings that may change the cost of a method, never its answer; and two ways to the same answer held together.
#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "exactness/stage.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

constexpr VkExtent2D kSize{320, 180};

struct FirstFrame {
    Pictures pictures; ///< Of the first view; empty for lights that are not point lights.
    uint32_t casterPasses = 0;
};

std::vector<GnPassTiming> framePasses(GnContext context)
{
    uint32_t count = 0;
    REQUIRE(gnGetFramePasses(context, &count, nullptr) == GN_SUCCESS);
    std::vector<GnPassTiming> passes(count);
    REQUIRE(gnGetFramePasses(context, &count, passes.data()) == GN_SUCCESS);
    return passes;
}

/// The first frame of a context of its own: nothing was kept, so every part of a map that is needed is drawn.
/// \param everyDirection Six more views from the same eye, which together see all there is.
FirstFrame firstFrame(const Scene& scene, const char* method, const char* passPrefix,
                      const std::optional<Setting>& setting, bool everyDirection)
{
    demo::Session session(test::device(), scene,
                          {.scene = {},
                           .size = kSize,
                           .viewCount = everyDirection ? 7u : 1u,
                           .contextFlags = GN_CONTEXT_NO_BACKGROUND_BIT});
    const GnContext context = session.shadows.context();
    for (const char* needed : {method, "ray_traced"})
        REQUIRE(gnWarmUpMethod(context, needed) >= 0);
    if (setting) demo::expect(session.shadows.set(method, setting->name, setting->value));
    for (uint32_t i = 0; i < scene.lights.size(); ++i)
        demo::expect(session.shadows.pin(i, scene.lights[i].kind == LightKind::Point ? method : "ray_traced"));
    std::vector<demo::CameraState> cameras{session.camera(0.0)};
    for (int axis = 0; everyDirection && axis < 3; ++axis) {
        for (const double sign : {1.0, -1.0}) {
            demo::CameraState camera = cameras[0];
            glm::dvec3 ahead(0.0), up(0.0);
            ahead[axis] = sign;
            up[axis == 1 ? 2 : 1] = 1.0;
            camera.target = camera.eye + ahead;
            camera.up = up;
            camera.verticalFov = 1.7f; // 97 degrees: the six overlap
            cameras.push_back(camera);
        }
    }
    session.renderer.draw({.time = 0.0, .cameras = cameras, .shadows = &session.shadows});
    FirstFrame frame{.pictures = session.renderer.readVisibility()};
    for (size_t i = 0; i < scene.lights.size(); ++i)
        if (scene.lights[i].kind != LightKind::Point) frame.pictures[i] = {};

    const std::vector<GnPassTiming> passes = framePasses(context);
    frame.casterPasses =
        static_cast<uint32_t>(std::count_if(passes.begin(), passes.end(), [&](const GnPassTiming& pass) {
            const std::string_view name = pass.pName;
            return name.starts_with(passPrefix) && name.find("casters") != name.npos;
        }));
    return frame;
}

constexpr const char* kPavement = "pavement";

/// Shipped scenes with their point lights above all that is in view, so that parts of their maps are not needed: the
/// highest view ray falls, and starts below the lights. Of the pavement of the colonnade a small part is seen, on which
/// shadows of columns lie that are not.
Scene underTheLights(const std::string& name)
{
    Scene scene = shippedScene(name == kPavement ? "colonnade" : name);
    demo::CameraKey key;
    if (name == "room") key = {.eye = {0.0, 4.6, 2.2}, .target = {0.0, 0.0, -0.4}, .verticalFov = 1.2f};
    if (name == "colonnade") key = {.eye = {0.5, 3.0, 6.5}, .target = {-0.5, 0.0, 1.5}, .verticalFov = 0.9f};
    if (name == "bunny") key = {.eye = {3.0, 4.5, 8.0}, .target = {1.0, 1.0, 2.0}, .verticalFov = 0.9f};
    if (name == kPavement) key = {.eye = {1.0, 2.5, 9.5}, .target = {-2.5, 0.0, 6.0}, .verticalFov = 0.35f};
    scene.camera = {key};
    return scene;
}

size_t darkPixels(const Pictures& pictures)
{
    size_t sum = 0;
    for (const Image8& picture : pictures)
        sum += test::dark(picture);
    return sum;
}

/// Whether the newest frame prepared caps, which only z-fail has.
bool drewCaps(Stage& stage)
{
    const std::vector<GnPassTiming> passes = framePasses(stage.session().shadows.context());
    return std::any_of(passes.begin(), passes.end(),
                       [](const GnPassTiming& pass) { return std::string_view(pass.pName) == "volumes.caps"; });
}

} // namespace

TEST_CASE("skipped faces of cube_map leave the picture as it is, bit for bit")
{
    const test::DeviceTest silence;
    for (const std::string name : {"room", "colonnade", "bunny"}) {
        CAPTURE(name);
        const Scene scene = underTheLights(name);
        const FirstFrame culled = firstFrame(scene, "cube_map", "cube_faces", {}, false);
        const FirstFrame whole = firstFrame(scene, "cube_map", "cube_faces", {}, true);
        const auto lights = std::count_if(scene.lights.begin(), scene.lights.end(),
                                          [](const demo::Light& light) { return light.kind == LightKind::Point; });
        MESSAGE(name << ": " << culled.casterPasses << " faces drawn of " << whole.casterPasses);
        CHECK(whole.casterPasses == 6 * static_cast<uint32_t>(lights));
        CHECK(culled.casterPasses < whole.casterPasses);
        CHECK(test::differences(culled.pictures, whole.pictures) == 0);
        CHECK(darkPixels(culled.pictures) > 500);
    }
}

// Navratil 2015, 3.3.3: all geometry into every part, object culling, leaving out parts, leaving out casters.
TEST_CASE("the steps of culling of maps around a point light leave the picture as it is, bit for bit")
{
    const test::DeviceTest silence;
    struct Ladder {
        std::string method, passes;
        uint32_t parts;
    };
    for (const Ladder& ladder :
         {Ladder{"cube_map", "cube_faces", 6}, Ladder{"dual_paraboloid", "dual_paraboloid", 2}}) {
        for (const std::string name : {"room", "colonnade", "bunny", kPavement}) {
            CAPTURE(ladder.method);
            CAPTURE(name);
            const Scene scene = underTheLights(name);
            const auto lights = static_cast<uint32_t>(
                std::count_if(scene.lights.begin(), scene.lights.end(),
                              [](const demo::Light& light) { return light.kind == LightKind::Point; }));
            const auto drawn = [&](double culling) {
                return firstFrame(scene, ladder.method.c_str(), ladder.passes.c_str(), Setting{"culling", culling},
                                  false);
            };
            const FirstFrame whole = drawn(0.0);
            CHECK(whole.casterPasses == ladder.parts * lights);
            CHECK(darkPixels(whole.pictures) > 500);
            for (const double culling : {1.0, 2.0, 3.0}) {
                // A scene for each step is enough; of casters, most are needed but on the pavement.
                if (culling != (name == kPavement ? 3.0 : 2.0) && name != "room") continue;
                CAPTURE(culling);
                const FirstFrame culled = drawn(culling);
                MESSAGE(ladder.method << " in " << name << ", culling " << culling << ": " << culled.casterPasses
                                      << " parts of " << whole.casterPasses);
                CHECK((culling < 2.0 ? culled.casterPasses == whole.casterPasses
                                     : culled.casterPasses < whole.casterPasses));
                CHECK(test::differences(culled.pictures, whole.pictures) == 0);
            }
        }
    }
}

// Closed casters only: of open ones the two count different caps.
TEST_CASE("z-fail and z-pass volumes agree within 0.005 % of the pixels on closed casters")
{
    const test::DeviceTest silence;
    int passAlone = 0; // scenes where no caster needs z-fail by itself
    for (const std::string name : {"room", "colonnade", "scenario"}) {
        CAPTURE(name);
        Scene scene = shippedScene(name);
        const size_t before = scene.instances.size();
        scene = onlyClosed(std::move(scene));
        CHECK(scene.instances.size() < before);
        Stage stage(std::move(scene), {640, 360});
        const Pictures pass = stage.draw("stencil_volume", {{"z_fail", 0.0}});
        passAlone += !drewCaps(stage);
        const Pictures fail = stage.draw("stencil_volume", {{"z_fail", 1.0}});
        CHECK(drewCaps(stage));
        ErrorCount apart;
        for (size_t i = 0; i < pass.size(); ++i)
            apart += demo::compare(fail[i], pass[i], stage.counted[i]);
        MESSAGE(name << ": z-fail and z-pass apart " << inWords(apart) << "; z-fail wrong "
                     << inWords(pooled(stage, fail)) << "; z-pass wrong " << inWords(pooled(stage, pass)));
        CHECK(apart.counted > 50000);
        CHECK(apart.percent(apart.wrong()) <= 0.005);
        CHECK(darkPixels(pass) > 5000);
    }
    CHECK(passAlone >= 1);
}

TEST_CASE("volumes that end behind the farthest receiver and endless ones agree within 0.005 % of the pixels")
{
    const test::DeviceTest silence;
    for (const std::string name : {"room", "colonnade", "bunny"}) {
        CAPTURE(name);
        Stage stage(shippedScene(name), {640, 360});
        const Pictures bounded = stage.draw("stencil_volume", {{"bounded", 1.0}});
        const Pictures endless = stage.draw("stencil_volume", {{"bounded", 0.0}});
        ErrorCount apart;
        for (size_t i = 0; i < bounded.size(); ++i)
            apart += demo::compare(endless[i], bounded[i], stage.counted[i]);
        MESSAGE(name << ": bounded and endless apart " << inWords(apart));
        CHECK(apart.counted > 50000);
        CHECK(apart.percent(apart.wrong()) <= 0.005);
    }
}

// Whether a dropped volume would have been counted anywhere: moving and standing lights, near planes in shadow
// (z-fail).
TEST_CASE("volumes that chan_durand does not draw leave the picture as it is, bit for bit")
{
    const test::DeviceTest silence;
    for (const std::string name : {"room", "colonnade", "bunny", "scenario"}) {
        CAPTURE(name);
        Stage stage(shippedScene(name), {320, 180});
        for (const double time : {0.0, 1.3, 3.1}) {
            CAPTURE(time);
            stage.goTo(time);
            for (const double resolution : {64.0, 512.0}) {
                const Pictures culled = stage.draw("chan_durand", {{"resolution", resolution}});
                const Pictures all = stage.draw("chan_durand", {{"resolution", resolution}, {"cull", 0.0}});
                CHECK(test::differences(culled, all) == 0);
                CHECK(darkPixels(culled) > 500);
            }
        }
    }
}

// 64 texels: slats, wires and walls are thinner than one.
TEST_CASE("a wider vote of chan_durand misses less of what is thinner than a texel")
{
    const test::DeviceTest silence;
    for (const std::string name : {"room", "colonnade", "bunny"}) {
        CAPTURE(name);
        Stage stage(shippedScene(name), {640, 360});
        uint64_t first = 0, before = 0;
        for (const double widen : {0.0, 1.0, 2.0, 3.0}) {
            const ErrorCount error = pooled(stage, stage.draw("chan_durand", {{"resolution", 64.0}, {"widen", widen}}));
            MESSAGE(name << ": widened by " << widen << " wrong " << inWords(error));
            if (widen == 0.0) first = before = error.wrong();
            CHECK(error.wrong() <= before);
            before = error.wrong();
        }
        CHECK(first > 100);
        CHECK(5 * before <= first);
    }
}

} // namespace gnomon::exact
