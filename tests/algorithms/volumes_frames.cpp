// Volume methods on a device: what they keep from frame to frame, and that their ways of counting agree.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "demo/program/measure.hpp"

using namespace gnomon::demo;

namespace {

constexpr const char* kMethod = "stencil_volume";
constexpr const char* kMasked = "chan_durand";

SessionOptions options(const std::string& scene, VkExtent2D size)
{
    SessionOptions result;
    result.scene = scene;
    result.size = size;
    result.validation = Device::validationPresent();
    return result;
}

GnFrameStats drawAt(Session& session, double time)
{
    const CameraState camera = session.camera(time);
    session.renderer.draw({.time = time, .cameras = {&camera, 1}, .shadows = &session.shadows});
    session.renderer.waitForFrame();
    return session.shadows.stats();
}

/// The pictures of all lights with the method and one of its settings.
std::vector<Image8> pictures(Session& session, const char* setting, double value, bool recorded = false)
{
    REQUIRE(session.shadows.set(kMethod, setting, value));
    settle(session, kMethod, 0.5, recorded);
    return session.renderer.readVisibility();
}

std::size_t differing(const std::vector<Image8>& a, const std::vector<Image8>& b)
{
    REQUIRE(a.size() == b.size());
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        REQUIRE(a[i].texels.size() == b[i].texels.size());
        for (std::size_t p = 0; p < a[i].texels.size(); ++p)
            count += a[i].texels[p] != b[i].texels[p];
    }
    return count;
}

/// A view whose near plane lies in the shadow of a slab (z-fail), with open casters inside and outside of it.
const char* const kCovered = R"(
name: covered
size: [320, 200]
frames: 60
meshes:
  ground: {plane: {size: [24, 24]}}
  slab: {box: {size: [6, 0.2, 6]}}
  ring: {torus: {radius: 1, tube: 0.35}}
  sheet: {cloth: {size: [2, 2]}}
  roof: {plane: {size: [7, 7]}}
instances:
  - {name: ground, mesh: ground, static: true}
  - {name: slab, mesh: slab, at: [0, 4, 6], static: true}
  - {name: roof, mesh: roof, at: [0.3, 5, 6.2], static: true}
  - {name: ring, mesh: ring, at: [0, 1.6, 0], static: true}
  - {name: sheet, mesh: sheet, at: [2.5, 2.4, 1], static: true}
lights:
  - {name: sun, kind: directional, direction: [0.2, -1, -0.15], static: true}
  - {name: lamp, kind: point, at: [0.6, 8, 6.5], range: 40, static: true}
  - {name: spot, kind: spot, at: [-1, 9, 8], aim: [0, 0, 1], cone: {inner: 35, outer: 40}, range: 40, static: true}
camera:
  - {eye: [0, 2, 6], target: [0, 0.8, 0], fov: 60}
)";

std::string coveredScene()
{
    const auto file = std::filesystem::temp_directory_path() / "gnomon_volumes_covered.yaml";
    std::ofstream(file) << kCovered;
    return file.string();
}

/// A floor under that many open sheets, one above the other along the light: its receivers in shadow lie behind all.
std::string stackedScene(int sheets)
{
    const auto file = std::filesystem::temp_directory_path() / "gnomon_volumes_stacked.yaml";
    std::ofstream out(file);
    out << "name: stacked\nsize: [320, 200]\nframes: 1\nmeshes:\n  ground: {plane: {size: [24, 24]}}\n"
           "  sheet: {plane: {size: [4, 4]}}\ninstances:\n  - {name: ground, mesh: ground, static: true}\n";
    for (int i = 0; i < sheets; ++i)
        out << "  - {name: sheet" << i << ", mesh: sheet, at: [0, " << 4.0 + 0.02 * i << ", 0], static: true}\n";
    out << "lights:\n  - {name: sun, kind: directional, direction: [0, -1, 0], static: true}\n"
           "camera:\n  - {eye: [0, 3, 9], target: [0, 0, 0], fov: 50}\n";
    return file.string();
}

} // namespace

TEST_CASE("what stands still builds no index list, and what moves builds its own only")
{
    Session session(options("torus_grid", {160, 120}));
    REQUIRE(session.shadows.pinAll(kMethod));
    settle(session, kMethod, 0.0, false);

    const GnFrameStats still = drawAt(session, 0.0);
    CHECK(still.indexListsBuilt == 0);
    CHECK(still.passesKept == 2); // static and moving sides

    const GnFrameStats moved = drawAt(session, 1.0 / 60.0);
    CHECK(moved.indexListsBuilt == 25); // the tori
    CHECK(moved.passesKept == 1);

    CHECK(drawAt(session, 1.0 / 60.0).indexListsBuilt == 0);
    CHECK(session.device.validation.messages() == std::vector<std::string>{});
}

TEST_CASE("z-fail and z-pass give the same picture")
{
    for (const char* scene : {"torus_grid", "room"}) {
        CAPTURE(scene);
        Session session(options(scene, {320, 240}));
        REQUIRE(session.shadows.pinAll(kMethod));
        const std::vector<Image8> pass = pictures(session, "z_fail", 0), fail = pictures(session, "z_fail", 1);
        // Caps and surfaces are drawn by different shaders: single pixels at their borders may differ.
        CHECK(differing(pass, fail) <= 3 * pass.size());
        CHECK(session.device.validation.messages() == std::vector<std::string>{});
    }
}

TEST_CASE("silhouettes from a compute shader give the picture of those from the CPU, bit by bit")
{
    for (const char* scene : {"torus_grid", "room", "colonnade"}) {
        CAPTURE(scene);
        Session session(options(scene, {320, 240}));
        REQUIRE(session.shadows.pinAll(kMethod));
        for (const double zFail : {0.0, 1.0}) {
            REQUIRE(session.shadows.set(kMethod, "z_fail", zFail));
            const std::vector<Image8> cpu = pictures(session, "silhouettes", 0),
                                      device = pictures(session, "silhouettes", 1);
            CHECK(differing(cpu, device) == 0);
            CHECK(differing(cpu, pictures(session, "silhouettes", 1, true)) == 0); // recorded
        }
        // Casters that moved, and the same frame from the CPU.
        REQUIRE(session.shadows.set(kMethod, "z_fail", 0));
        drawAt(session, 0.9);
        drawAt(session, 1.3);
        const std::vector<Image8> moved = session.renderer.readVisibility();
        REQUIRE(session.shadows.set(kMethod, "silhouettes", 0));
        drawAt(session, 1.3);
        CHECK(differing(moved, session.renderer.readVisibility()) == 0);
        CHECK(session.device.validation.messages() == std::vector<std::string>{});
    }
}

TEST_CASE("the compute shader finds silhouettes when light or casters moved, and only then")
{
    Session session(options("torus_grid", {160, 120}));
    REQUIRE(session.shadows.pinAll(kMethod));
    REQUIRE(session.shadows.set(kMethod, "silhouettes", 1));
    settle(session, kMethod, 0.0, false);

    const GnFrameStats still = drawAt(session, 0.0);
    CHECK(still.passesKept == 2); // static and moving sides
    const GnFrameStats moved = drawAt(session, 1.0 / 60.0);
    CHECK(moved.indexListsBuilt == 0);             // none on the CPU
    CHECK(moved.passesKept == 3);                  // static sides, edges and planes of the mesh
    CHECK(moved.passesRun == still.passesRun + 2); // commands, sides
    CHECK(drawAt(session, 1.0 / 60.0).passesKept == 2);
    CHECK(session.device.validation.messages() == std::vector<std::string>{});
}

TEST_CASE("volumes that end behind the receivers give the picture of infinite ones")
{
    for (const char* scene : {"torus_grid", "room"}) {
        CAPTURE(scene);
        Session session(options(scene, {320, 240}));
        REQUIRE(session.shadows.pinAll(kMethod));
        const std::vector<Image8> ended = pictures(session, "bounded", 1), endless = pictures(session, "bounded", 0);
        CHECK(differing(ended, endless) <= 8 * ended.size()); // sides are cut into other triangles
    }
}

TEST_CASE("a recorded frame shows the submitted frame's picture")
{
    Session session(options("colonnade", {320, 240}));
    REQUIRE(session.shadows.pinAll(kMethod));
    const std::vector<Image8> submitted = pictures(session, "z_fail", 0);
    CHECK(differing(submitted, pictures(session, "z_fail", 0, true)) == 0);
}

TEST_CASE("an eye in the shadow of closed and open casters sees what rays see")
{
    Session session(options(coveredScene(), {320, 200}));
    const std::optional<Truth> truth = measureTruth(session.device, session.scene, {320, 200}, 0.5);
    if (!truth) return; // built without ray tracing
    REQUIRE(session.shadows.pinAll(kMethod));
    for (const double zFail : {0.0, 1.0}) {
        const std::vector<Image8> seen = pictures(session, "z_fail", zFail);
        for (std::size_t i = 0; i < truth->lights.size(); ++i) {
            CAPTURE(truth->lights[i]);
            const ErrorCount errors = compare(seen[i], truth->visibility[i], truth->counted[i]);
            CHECK(errors.counted > 10000);
            CHECK(errors.wrong() <= 6);
        }
    }
    REQUIRE(session.shadows.pinAll(kMasked));
    settle(session, kMasked, 0.5, false);
    const std::vector<Image8> seen = session.renderer.readVisibility();
    for (std::size_t i = 0; i < truth->lights.size(); ++i) {
        CAPTURE(truth->lights[i]);
        const ErrorCount errors = compare(seen[i], truth->visibility[i], truth->counted[i]);
        MESSAGE(truth->lights[i] << ": " << errors.wrong() << " of " << errors.counted);
        CHECK(errors.percent(errors.wrong()) <= 0.1);
    }
    CHECK(session.device.validation.messages() == std::vector<std::string>{});
}

TEST_CASE("counts are modulo 256 in stencil_volume, modulo 128 at the silhouette pixels of chan_durand")
{
    for (const int sheets : {127, 128, 255, 256}) {
        CAPTURE(sheets);
        Session session(options(stackedScene(sheets), {320, 200}));
        const std::optional<Truth> truth = measureTruth(session.device, session.scene, {320, 200}, 0.0);
        if (!truth) return;                                      // built without ray tracing
        REQUIRE(session.shadows.set(kMasked, "resolution", 64)); // many silhouette pixels
        const auto falseLit = [&](const char* method) {
            REQUIRE(session.shadows.pinAll(method));
            settle(session, method, 0.0, false);
            return compare(session.renderer.readVisibility()[0], truth->visibility[0], truth->counted[0]).falseLit;
        };
        const std::uint64_t everywhere = falseLit(kMethod), masked = falseLit(kMasked);
        MESSAGE(sheets << " sheets: " << everywhere << " pixels falsely lit everywhere, " << masked
                       << " at silhouettes");
        CHECK((everywhere > 1000) == (sheets == 256));
        CHECK((masked > 100) == (sheets % 128 == 0));
    }
}

int main(int argc, char** argv)
{
    if (Device::nonePresent()) return 77;
    return doctest::Context(argc, argv).run();
}
