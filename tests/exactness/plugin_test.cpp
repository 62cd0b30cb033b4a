// A method that comes as a shared object: it is listed, can be pinned, has settings, and what is no plug-in is refused
// with words.
#include <algorithm>
#include <cmath>
#include <string_view>

#include "device/fixture.hpp"
#include "gnomon/algorithm.h"

namespace gnomon::exact {
namespace {

constexpr const char* kMethod = "half_lit";

const GnMethodInfo* find(const std::vector<GnMethodInfo>& methods)
{
    const auto found = std::find_if(methods.begin(), methods.end(),
                                    [](const GnMethodInfo& info) { return std::string_view(info.pName) == kMethod; });
    return found == methods.end() ? nullptr : &*found;
}

/// Every pixel's visibility, or -1 where they differ.
int everywhere(const test::Image8& picture)
{
    const auto& texels = picture.texels;
    return std::adjacent_find(texels.begin(), texels.end(), std::not_equal_to<>()) == texels.end() ? texels.at(0) : -1;
}

} // namespace

TEST_CASE("a plug-in's method is listed once it is loaded, and not before")
{
    const test::DeviceTest silence;
    test::Host host(test::smallScene());
    CHECK(find(test::availableMethods(host.context)) == nullptr);
    CHECK(gnSetLightMethod(host.context, host.lights[0], kMethod) == GN_ERROR_UNKNOWN_METHOD);
    host.require(gnLoadPlugin(host.context, GNOMON_HALF_LIT));
    const std::vector<GnMethodInfo> methods = test::availableMethods(host.context);
    const GnMethodInfo* info = find(methods);
    REQUIRE(info != nullptr);
    CHECK(std::string(info->pAlgorithm) == kMethod);
    CHECK((info->traits & GN_TRAIT_SPOT_BIT) != 0);
    CHECK(info->roundTrips == 0);
    REQUIRE(info->settingCount == 1);
    CHECK(std::string(info->pSettings[0].pName) == "shade");
}

TEST_CASE("a light pinned to the plug-in is half lit everywhere, and its setting changes that")
{
    const test::DeviceTest silence;
    test::Host host(test::smallScene());
    host.require(gnLoadPlugin(host.context, GNOMON_HALF_LIT));
    host.pin(0, kMethod);
    host.require(gnWarmUp(host.context));
    REQUIRE(host.draw() == GN_SUCCESS);
    CHECK(std::string(host.decision(0).pMethod) == kMethod);
    CHECK(host.decision(0).reason == GN_REASON_PINNED);
    CHECK(std::abs(everywhere(host.pictures()[0]) - 127.5) < 1.0); // Vulkan leaves it to the device which way halves go

    host.require(gnSetMethodSetting(host.context, kMethod, "shade", 0.25));
    REQUIRE(host.draw() == GN_SUCCESS);
    CHECK(everywhere(host.pictures()[0]) == 64);

    CHECK(gnSetMethodSetting(host.context, kMethod, "shade", 1.5) == GN_ERROR_OUT_OF_RANGE);
    REQUIRE(host.draw({.call = test::Call::record}) == GN_SUCCESS);
    CHECK(everywhere(host.pictures()[0]) == 64);

    // Back to a method of gnomon's own.
    host.pin(0, "shadow_map");
    REQUIRE(host.draw() == GN_SUCCESS);
    CHECK(everywhere(host.pictures()[0]) == -1);
}

TEST_CASE("a file that is missing and an object that is no plug-in are refused with words, and change nothing")
{
    const test::DeviceTest silence;
    test::Host host(test::smallScene());
    const size_t before = test::availableMethods(host.context).size();

    CHECK(gnLoadPlugin(host.context, "/nowhere/absent_plugin.so") == GN_ERROR_UNSUPPORTED);
    CHECK(host.lastError().find("absent_plugin.so") != std::string::npos);
    CHECK(gnLoadPlugin(host.context, GNOMON_NO_PLUGIN) == GN_ERROR_UNSUPPORTED);
    CHECK(host.lastError().find("gnPluginMain") != std::string::npos);
    CHECK(gnLoadPlugin(host.context, nullptr) == GN_ERROR_NULL_ARGUMENT);
    CHECK(gnLoadPlugin(host.context, GNOMON_OLD_PLUGIN) == GN_ERROR_UNSUPPORTED);
    CHECK(host.lastError().find("GN_PLUGIN_VERSION " + std::to_string(GN_PLUGIN_VERSION + 1)) != std::string::npos);
    CHECK(gnLoadPlugin(host.context, GNOMON_OTHER_PLUGIN) == GN_ERROR_UNSUPPORTED);
    CHECK(host.lastError().find("exports no gnPluginVersion") != std::string::npos);

    CHECK(test::availableMethods(host.context).size() == before);
    CHECK(host.draw() == GN_SUCCESS);
}

} // namespace gnomon::exact
