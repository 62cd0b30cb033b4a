// What tests ask about a frame, and the scenes they make by hand.
#include <algorithm>
#include <array>

#include "device/fixture.hpp"
#include "rules/yaml/shipped.hpp"
#include "runtime/registry.hpp"

namespace gnomon::test {

using namespace demo;

// More than this means the messages themselves are the problem.
constexpr size_t kMaxMessages = 1000;

void GN_CALL Host::onMessage(const GnMessage* message, void* user)
{
    auto& self = *static_cast<Host*>(user);
    const std::lock_guard lock(self.messageMutex_);
    // Said on every device but the one whose knowledge is shipped, which the driver's compiler alone makes another.
    if (std::string_view(message->pId) == "KnowledgeForeign") return;
    if (self.messages_.size() < kMaxMessages)
        self.messages_.push_back(std::string(message->pId) + ": " + message->pText);
}

std::vector<std::string> Host::takeMessages()
{
    const std::lock_guard lock(messageMutex_);
    return std::exchange(messages_, {});
}

void Host::require(GnResult result) const
{
    REQUIRE_MESSAGE(result >= 0, std::string(gnResultName(result)) << ": " << lastError());
}

void Host::pinAll(const char* method)
{
    for (size_t i = 0; i < lights.size(); ++i)
        pin(i, method);
}

std::vector<std::byte> Host::depthTexels(uint32_t view)
{
    return readback_.image(surfaces_[view].depth, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, sizeof(float));
}

GnFrameStats Host::stats() const
{
    GnFrameStats stats{};
    require(gnGetFrameStats(context, &stats));
    return stats;
}

std::vector<GnPassTiming> Host::passes() const
{
    uint32_t count = 0;
    require(gnGetFramePasses(context, &count, nullptr));
    std::vector<GnPassTiming> passes(count);
    require(gnGetFramePasses(context, &count, passes.data()));
    return passes;
}

uint32_t Host::passCount(const std::string& name) const
{
    const std::vector<GnPassTiming> all = passes();
    return static_cast<uint32_t>(
        std::count_if(all.begin(), all.end(), [&](const GnPassTiming& pass) { return name == pass.pName; }));
}

namespace {

std::vector<GnMethodInfo> allMethods(GnContext context)
{
    uint32_t count = 0;
    REQUIRE(gnEnumerateMethods(context, &count, nullptr) == GN_SUCCESS);
    std::vector<GnMethodInfo> methods(count);
    REQUIRE(gnEnumerateMethods(context, &count, methods.data()) == GN_SUCCESS);
    return methods;
}

} // namespace

void Host::fixMapSides(double most)
{
    const std::vector<GnMethodInfo> methods = allMethods(context);
    for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms)
        for (const SettingSpec& setting : algorithm.entry->settings)
            for (const GnMethodInfo& method : methods)
                if (setting.byCoverage && std::string_view(algorithm.entry->name) == method.pAlgorithm)
                    require(gnSetMethodSetting(context, method.pName, setting.name, std::min(setting.standard, most)));
}

GnDecision Host::decision(size_t light, uint32_t view) const
{
    GnDecision decision{};
    require(gnGetDecision(context, views[view], lights[light], &decision));
    return decision;
}

std::string Host::explanation(size_t light, uint32_t view) const
{
    const GnQuestion question{.kind = GN_QUESTION_DECISION};
    size_t size = 0;
    require(gnExplain(context, views[view], lights[light], &question, &size, nullptr));
    std::string text(size, '\0');
    require(gnExplain(context, views[view], lights[light], &question, &size, text.data()));
    text.resize(size - 1);
    return text;
}

Light spotLight(const char* name, const glm::dvec3& position, const glm::dvec3& target, bool isStatic)
{
    Light light;
    light.name = name;
    light.kind = LightKind::Spot;
    light.position = position;
    light.direction = glm::normalize(target - position);
    light.outerAngle = 0.7f;
    light.innerAngle = 0.6f;
    light.range = 30.0f;
    light.isStatic = isStatic;
    return light;
}

Light pointLight(const char* name, const glm::dvec3& position, bool isStatic)
{
    Light light;
    light.name = name;
    light.kind = LightKind::Point;
    light.position = position;
    light.range = 30.0f;
    light.isStatic = isStatic;
    return light;
}

Scene smallScene()
{
    Scene scene;
    scene.name = "small";
    scene.meshes = {makeBox({.size = {12.0f, 0.2f, 12.0f}}), makeSphere({.radius = 0.8f, .slices = 24, .stacks = 12}),
                    makeBox({.size = {1.0f, 1.6f, 1.0f}})};
    const auto add = [&](const char* name, uint32_t mesh, const glm::dvec3& position) {
        Instance instance;
        instance.name = name;
        instance.mesh = mesh;
        instance.pose.position = position;
        instance.isStatic = true;
        scene.instances.push_back(instance);
    };
    add("floor", 0, {0.0, -0.1, 0.0});
    add("ball", 1, {-1.5, 1.6, 0.5});
    add("box", 2, {1.4, 0.9, -0.6});
    scene.lights = {spotLight("lamp", {3.0, 7.0, 4.0}, {0.0, 0.0, 0.0}, true)};
    scene.camera = {CameraKey{.eye = {0.0, 6.0, 8.0}, .target = {0.0, 0.3, 0.0}}};
    return scene;
}

size_t differences(const Image8& a, const Image8& b)
{
    REQUIRE(a.width == b.width);
    REQUIRE(a.height == b.height);
    size_t count = 0;
    for (size_t i = 0; i < a.texels.size(); ++i)
        count += a.texels[i] != b.texels[i];
    return count;
}

size_t differences(const std::vector<Image8>& a, const std::vector<Image8>& b)
{
    REQUIRE(a.size() == b.size());
    size_t count = 0;
    for (size_t i = 0; i < a.size(); ++i)
        count += differences(a[i], b[i]);
    return count;
}

size_t dark(const Image8& picture)
{
    return static_cast<size_t>(std::count(picture.texels.begin(), picture.texels.end(), uint8_t(0)));
}

size_t lit(const Image8& picture)
{
    return static_cast<size_t>(std::count(picture.texels.begin(), picture.texels.end(), uint8_t(255)));
}

std::vector<GnMethodInfo> availableMethods(GnContext context)
{
    std::vector<GnMethodInfo> methods = allMethods(context);
    std::erase_if(methods, [](const GnMethodInfo& method) { return method.pUnavailable != nullptr; });
    return methods;
}

bool tracesRays(GnContext context)
{
    uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(device().physicalDevice, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> listed(count);
    vkEnumerateDeviceExtensionProperties(device().physicalDevice, nullptr, &count, listed.data());
    const bool given = std::ranges::all_of(
        std::array{VK_KHR_RAY_QUERY_EXTENSION_NAME, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME},
        [&](std::string_view name) {
            return std::ranges::any_of(listed, [&](const auto& each) { return name == each.extensionName; });
        });
    size_t methods = 0, able = 0;
    for (const GnMethodInfo& method : allMethods(context)) {
        if ((method.traits & GN_TRAIT_DEVICE_RAYS_BIT) == 0) continue;
        ++methods;
        able += method.pUnavailable == nullptr;
        if (method.pUnavailable) MESSAGE(std::string(method.pName) << ": " << std::string(method.pUnavailable));
    }
    REQUIRE(methods > 0);
    CHECK(able == (given ? methods : 0));
    return able > 0;
}

std::string shippedRules(const char* name)
{
    const std::string_view text = rules::shippedRuleBase(name);
    REQUIRE(!text.empty());
    return std::string(text);
}

bool serves(const GnMethodInfo& method, LightKind kind)
{
    const GnTraits bit = kind == LightKind::Directional ? GN_TRAIT_DIRECTIONAL_BIT
                         : kind == LightKind::Spot      ? GN_TRAIT_SPOT_BIT
                                                        : GN_TRAIT_POINT_BIT;
    return (method.traits & bit) != 0;
}

bool hasMap(const GnMethodInfo& method)
{
    const std::span settings(method.pSettings, method.settingCount);
    return std::ranges::any_of(settings,
                               [](const GnSettingInfo& s) { return std::string_view(s.pName) == "resolution"; });
}

LightKind servedKind(const GnMethodInfo& method)
{
    return serves(method, LightKind::Spot)    ? LightKind::Spot
           : serves(method, LightKind::Point) ? LightKind::Point
                                              : LightKind::Directional;
}

GnInstance addHostDrawn(Host& host, GnInstanceFlags extra, double x, uint32_t mask, uint32_t* draws)
{
    GnInstanceCreateInfo info{};
    info.flags = GN_INSTANCE_HOST_DRAWN_BIT | extra;
    info.pName = "grass";
    info.transform.translation[0] = x;
    info.transform.translation[1] = 1.0;
    info.casterMask = mask;
    for (int i = 0; i < 3; ++i) {
        info.boundsMin[i] = -0.5f;
        info.boundsMax[i] = 0.5f;
    }
    info.pfnDrawCasters = [](VkCommandBuffer, const GnCasterProjection*, void* user) {
        if (user) ++*static_cast<uint32_t*>(user);
    };
    info.pUserData = draws;
    GnInstance instance = VK_NULL_HANDLE;
    host.require(gnCreateInstance(host.context, &info, &instance));
    return instance;
}

} // namespace gnomon::test
