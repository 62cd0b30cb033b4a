// `gnomon methods` and `gnomon scenes`.
#include <cstdio>

#include "demo/io/number.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/session.hpp"
#include "demo/scene/scene_file.hpp"

namespace gnomon::demo {
namespace {

std::string traitWords(GnTraits traits)
{
    constexpr std::pair<GnTraitBits, const char*> words[] = {{GN_TRAIT_DIRECTIONAL_BIT, "directional"},
                                                             {GN_TRAIT_SPOT_BIT, "spot"},
                                                             {GN_TRAIT_POINT_BIT, "point"},
                                                             {GN_TRAIT_HARD_BIT, "hard"},
                                                             {GN_TRAIT_FIXED_PENUMBRA_BIT, "fixed penumbra"},
                                                             {GN_TRAIT_SOFT_PENUMBRA_BIT, "soft penumbra"},
                                                             {GN_TRAIT_EXACT_BIT, "exact"},
                                                             {GN_TRAIT_CPU_GEOMETRY_BIT, "reads triangles"},
                                                             {GN_TRAIT_TOPOLOGY_BIT, "topology"},
                                                             {GN_TRAIT_RAYS_BIT, "rays"},
                                                             {GN_TRAIT_FALLBACK_BIT, "fallback"},
                                                             {GN_TRAIT_PLANAR_BIT, "flat receivers only"}};
    std::string out;
    for (const auto& [bit, word] : words)
        if (traits & bit) out += (out.empty() ? "" : ", ") + std::string(word);
    return out;
}

std::string settingLine(const GnSettingInfo& setting)
{
    std::string out = std::string("    ") + setting.pName + " = ";
    appendNumber(out, setting.value);
    out += " [";
    appendNumber(out, setting.minimum);
    out += ", ";
    appendNumber(out, setting.maximum);
    return out + "]  " + setting.pDescription;
}

} // namespace

int methodsCommand()
{
    // The smallest thing a context can be made for: no scene, no window.
    const std::unique_ptr<Device> device = Device::create({});
    const GnContextCreateInfo info = device->contextInfo();
    GnContext context = VK_NULL_HANDLE;
    if (const GnResult result = gnCreateContext(&info, &context); result < 0)
        throw HostError(std::string("gnCreateContext: ") + gnResultName(result));
    uint32_t count = 0;
    gnEnumerateMethods(context, &count, nullptr);
    std::vector<GnMethodInfo> methods(count);
    gnEnumerateMethods(context, &count, methods.data());
    std::printf("on %s, %s\n", device->properties.deviceName, device->driver.c_str());
    for (const GnMethodInfo& method : methods) {
        std::printf("%s: %s; %u round trips%s%s\n", method.pName, traitWords(method.traits).c_str(), method.roundTrips,
                    method.pUnavailable ? "; unavailable: " : "", method.pUnavailable ? method.pUnavailable : "");
        std::printf("    %s\n", method.pSource);
        for (uint32_t i = 0; i < method.settingCount; ++i)
            std::printf("%s\n", settingLine(method.pSettings[i]).c_str());
    }
    gnDestroyContext(context);
    return 0;
}

int scenesCommand()
{
    int exitCode = 0;
    for (const ShippedScene& shipped : shippedScenes()) {
        const Outcome<Scene> scene = loadScene(shipped.file.string(), {.buildMeshes = false});
        if (!scene) {
            std::fprintf(stderr, "%s\n", scene.error().c_str());
            exitCode = 1;
            continue;
        }
        std::printf("%-20s %ux%u, %u frames, %zu lights, %zu instances\n%-20s %s\n", shipped.name.c_str(), scene->width,
                    scene->height, scene->frames, scene->lights.size(), scene->instances.size(), "",
                    scene->description.c_str());
    }
    return exitCode;
}

} // namespace gnomon::demo
