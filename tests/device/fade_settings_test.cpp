// Methods of one algorithm that differ in one setting are two methods: while one fades into the other, both are drawn
// in one frame, and neither may find what the other made with its own setting.
#include <algorithm>
#include <map>
#include <memory>
#include <vector>

#include "device/fade_support.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

Scene lightOf(demo::LightKind kind)
{
    Scene scene = smallScene();
    if (kind == demo::LightKind::Point) scene.lights[0] = pointLight("bulb", {1.0, 5.0, 2.0}, true);
    if (kind == demo::LightKind::Directional) scene.lights[0].kind = kind;
    scene.lights[0].radius = 0.3f;
    scene.instances[1].isStatic = false; // some of a map is kept, some drawn again
    return scene;
}

/// The lower end of its range, which takes less; the upper one, or what a test can afford, where the method has that.
double otherOf(const GnSettingInfo& setting)
{
    return setting.value != setting.minimum ? setting.minimum : std::min(setting.maximum, 64.0);
}

/// A method's, as they are now.
std::vector<GnSettingInfo> settingsOf(GnContext context, std::string_view name)
{
    for (const GnMethodInfo& method : availableMethods(context))
        if (method.pName == name) return {method.pSettings, method.pSettings + method.settingCount};
    return {};
}

constexpr uint32_t kOneFrame = 1; // in which both are drawn

/// Each fades into the other, or is shown at once where both are exact, while some of a map is kept.
void checkMixed(Host& host, const char* a, const char* b)
{
    const Image8 ofB = alone(host, b)[0], ofA = alone(host, a)[0]; // `a` last: no fade back to it
    const Image8 own[] = {ofA, ofB};
    const char* const names[] = {a, b};
    favour(host, a, kOneFrame);
    host.pinAll(nullptr);
    host.require(host.draw());
    CHECK(differences(host.pictures()[0], own[0]) == 0);
    for (const int to : {1, 0}) {
        favour(host, names[to], kOneFrame);
        for (uint32_t step = 1; step <= kOneFrame + 1; ++step) {
            host.require(host.draw());
            const GnDecision decision = host.decision(0);
            REQUIRE(std::string(decision.pMethod) == names[to]);
            CHECK((decision.pOutgoing != nullptr) == (decision.fade < 1.0f));
            CHECK(worstMix(host.pictures()[0], own[1 - to], own[to], double(decision.fade)) <= 0.51);
        }
        CHECK(host.decision(0).fade == 1.0f);
    }
}

/// A soft method that traces on the device averages over frames: none of its pictures is what a mix is held against.
bool showsOnePicture(const GnMethodInfo& method)
{
    return (method.traits & GN_TRAIT_DEVICE_RAYS_BIT) == 0 || (method.traits & GN_TRAIT_SOFT_PENUMBRA_BIT) == 0;
}

/// Of one method: how many pairs of settings were tried.
uint32_t checkMethod(Host& host, const GnMethodInfo& method)
{
    const std::string other = std::string("other_") + method.pName;
    const char* const names[] = {method.pName, other.c_str()};
    host.require(gnAddMethod(host.context, other.c_str(), method.pName));
    host.fixMapSides();
    const std::vector<GnSettingInfo> settings = settingsOf(host.context, other);
    const auto mode = std::ranges::find_if(settings, [](auto& s) { return s.pName == std::string("mode"); });
    uint32_t pairs = 0;
    for (const bool lastMode : {false, true}) {
        if (lastMode && mode == settings.end()) continue;
        for (const char* name : names)
            if (lastMode) host.require(gnSetMethodSetting(host.context, name, "mode", mode->maximum));
        for (const GnSettingInfo& setting : settings) {
            if (lastMode && setting.pName == std::string("mode")) continue;
            const double value = otherOf(setting);
            CAPTURE(std::string(method.pName) + (lastMode ? ", last mode, " : ", ") + setting.pName + " = " +
                    std::to_string(value));
            host.require(gnSetMethodSetting(host.context, names[1], setting.pName, value));
            checkMixed(host, names[0], names[1]);
            ++pairs;
            host.require(gnSetMethodSetting(host.context, names[1], setting.pName, setting.value));
        }
    }
    return pairs;
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "any two settings of a method fade into each other as two methods do")
{
    std::map<demo::LightKind, std::unique_ptr<Host>> hosts;
    for (const auto kind : {demo::LightKind::Spot, demo::LightKind::Point, demo::LightKind::Directional})
        hosts[kind] = std::make_unique<Host>(lightOf(kind), HostOptions{.extent = {160, 90}});
    uint32_t pairs = 0;
    for (const GnMethodInfo& method : availableMethods(hosts.begin()->second->context)) {
        if (!showsOnePicture(method)) continue;
        demo::LightKind kind = demo::LightKind::Directional;
        for (const demo::LightKind served : {demo::LightKind::Spot, demo::LightKind::Point})
            if (serves(method, served)) kind = served;
        pairs += checkMethod(*hosts[kind], method);
    }
    CHECK(pairs > 80);
}
