// Receivers that cast no shadow: nothing says that they moved, and they are in the shadow wherever they come to lie.
#include <algorithm>
#include <string_view>

#include "device/fixture.hpp"
#include "runtime/registry.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

enum Part : size_t { kFloor, kBlock, kPanel };

constexpr double kFar = 500.0; // metres: out of reach and out of sight

/// A lamp, a block beside it that the camera does not see, and behind the block a panel that no light counts as a
/// caster. The floor lies below the lamp, where a sixth map of it shows nothing else.
Scene panelScene(demo::LightKind kind)
{
    Scene scene = smallScene();
    scene.meshes[0] = demo::makeBox({.size = {2.0f, 0.2f, 2.0f}});
    scene.meshes[1] = demo::makeBox({.size = {0.6f, 0.6f, 0.6f}});
    scene.meshes[2] = demo::makeBox({.size = {0.2f, 3.0f, 3.0f}});
    scene.instances[kFloor].pose.position = {0.0, -0.1, 0.0};
    scene.instances[kBlock].pose.position = {1.6, 3.0, 0.0};
    scene.instances[kPanel].pose.position = {3.0, 3.0, 0.0};
    for (const Part part : {kFloor, kPanel}) {
        scene.instances[part].casterMask = 2;
        scene.instances[part].isStatic = false;
    }
    const glm::dvec3 at(0.0, 3.0, 0.0);
    scene.lights = {kind == demo::LightKind::Point ? pointLight("lamp", at, true)
                                                   : spotLight("lamp", at, at + glm::dvec3(1.0, 0.0, 0.0), true)};
    if (kind == demo::LightKind::Directional) {
        scene.lights[0].kind = kind;
        scene.lights[0].range = 0.0f;
    }
    scene.lights[0].casterMask = 1;
    scene.camera = {demo::CameraKey{.eye = {-3.0, 4.0, 4.0}, .target = {1.0, 2.2, 0.0}}};
    return scene;
}

/// Whether its map is the view's: what is left out of it, since the view sees no receiver there, may be missing later.
bool followsView(const GnMethodInfo& method)
{
    const auto same = [&](const BuiltinAlgorithm& a) { return std::string_view(a.entry->name) == method.pAlgorithm; };
    const auto all = builtinRegistry().algorithms;
    const auto found = std::ranges::find_if(all, same);
    return found != all.end() && found->entry->followsView;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a receiver that casts no shadow is in the shadow wherever and whenever it comes")
{
    for (const auto kind : {demo::LightKind::Spot, demo::LightKind::Directional, demo::LightKind::Point}) {
        const Scene there = panelScene(kind);
        Host host(there, {.extent = {96, 64}});
        host.hide(kBlock);
        for (const GnMethodInfo& method : availableMethods(host.context)) {
            if (!followsView(method) || !serves(method, kind)) continue;
            host.beginAnew(there, method.pName);
            host.draw(2, {});
            const std::vector<Image8> wanted = host.pictures();
            REQUIRE(dark(wanted[0]) > 100);
            for (const bool sky : {false, true}) {
                for (const uint32_t frames : {1u, 3u}) { // of a frame that stands still, or of none
                    Scene before = there;
                    before.instances[kPanel].pose.position.x += kFar;
                    if (sky) before.instances[kFloor].pose.position.x += kFar;
                    host.beginAnew(before, method.pName);
                    host.draw(frames, {});
                    host.scene = there;
                    host.require(host.draw());
                    const std::string what = std::string(method.pName) + (sky ? ", sky, " : ", ") +
                                             std::to_string(frames) + " frames before"; // clang 14
                    CAPTURE(what);
                    CAPTURE(static_cast<int>(kind));
                    // Warps that were made for other receivers have other edges.
                    CHECK(differences(host.pictures(), wanted) <= dark(wanted[0]) / 8);
                }
            }
        }
    }
}
