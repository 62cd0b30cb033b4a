// Maps that cover what a view sees (the setting `fit`): each view's own, though views share the light.
#include <algorithm>
#include <string_view>

#include "device/fixture.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

bool hasFit(const GnMethodInfo& method)
{
    return std::any_of(method.pSettings, method.pSettings + method.settingCount,
                       [](const GnSettingInfo& setting) { return std::string_view(setting.pName) == "fit"; });
}

demo::CameraState looking(const Scene& scene, const glm::dvec3& eye, const glm::dvec3& target)
{
    demo::CameraState camera = demo::cameraAt(scene, 0.0);
    camera.eye = eye;
    camera.target = target;
    return camera;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "two views of a light each have the map of what they see, as one view alone")
{
    Scene scene = smallScene();
    const std::vector<demo::CameraState> cameras{looking(scene, {-1.5, 2.5, 3.0}, {-1.2, 0.4, 0.4}),
                                                 looking(scene, {1.0, 1.5, 2.0}, {1.3, 0.3, -0.8})};
    const std::vector<demo::CameraState> first{cameras[0]}, second{cameras[1]};
    Host both(scene, {.extent = {128, 96}, .viewCount = 2}), one(scene, {.extent = {128, 96}});
    uint32_t methods = 0;
    for (const GnMethodInfo& method : availableMethods(both.context)) {
        if (!hasFit(method)) continue;
        ++methods;
        for (const auto kind : {demo::LightKind::Spot, demo::LightKind::Directional}) {
            CAPTURE(std::string(method.pName));
            CAPTURE(static_cast<int>(kind));
            if (!serves(method, kind)) continue;
            scene.lights[0].kind = kind;
            scene.lights[0].range = kind == demo::LightKind::Spot ? 30.0f : 0.0f;
            const auto begin = [&](Host& host, double fit) {
                host.require(gnSetMethodSetting(host.context, method.pName, "resolution", 128.0));
                host.require(gnSetMethodSetting(host.context, method.pName, "fit", fit));
                host.beginAnew(scene, method.pName);
            };
            const auto alone = [&](const std::vector<demo::CameraState>& camera, double fit) {
                begin(one, fit);
                one.draw(2, {.cameras = &camera});
                return one.pictures();
            };
            begin(both, 1.0);
            both.draw(2, {.cameras = &cameras});
            const std::vector<Image8> seenByFirst = both.pictures(0), seenBySecond = both.pictures(1);
            CHECK(differences(seenByFirst, alone(first, 1.0)) == 0);
            CHECK(differences(seenBySecond, alone(second, 1.0)) == 0);
            CHECK(dark(seenByFirst[0]) > 100);
            CHECK(dark(seenBySecond[0]) > 100);
        }
    }
    CHECK(methods >= 4);
}
