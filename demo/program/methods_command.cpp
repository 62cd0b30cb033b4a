// `gnomon methods`: what this build and device can do, as a list with settings or as the table of docs/methods.md.
#include <algorithm>
#include <cstdio>

#include "demo/io/number.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/session.hpp"
#include "runtime/registry.hpp"

namespace gnomon::demo {
namespace {

struct TraitWord {
    GnTraitBits bit;
    const char* word;
};
constexpr TraitWord kLightWords[] = {
    {GN_TRAIT_DIRECTIONAL_BIT, "directional"}, {GN_TRAIT_SPOT_BIT, "spot"}, {GN_TRAIT_POINT_BIT, "point"}};
constexpr TraitWord kEdgeWords[] = {{GN_TRAIT_HARD_BIT, "hard"},
                                    {GN_TRAIT_FIXED_PENUMBRA_BIT, "fixed penumbra"},
                                    {GN_TRAIT_SOFT_PENUMBRA_BIT, "soft penumbra"}};
constexpr TraitWord kNeedWords[] = {{GN_TRAIT_CPU_GEOMETRY_BIT, "reads triangles"},
                                    {GN_TRAIT_TOPOLOGY_BIT, "topology"},
                                    {GN_TRAIT_RAYS_BIT, "rays"},
                                    {GN_TRAIT_DEVICE_RAYS_BIT, "rays on the device"}};
constexpr TraitWord kRoleWords[] = {{GN_TRAIT_FALLBACK_BIT, "fallback"}, {GN_TRAIT_PLANAR_BIT, "flat receivers only"}};
constexpr TraitWord kExactWord[] = {{GN_TRAIT_EXACT_BIT, "exact"}};

std::string wordsOf(GnTraits traits, std::initializer_list<std::span<const TraitWord>> lists)
{
    std::string out;
    for (const std::span<const TraitWord> words : lists)
        for (const auto& [bit, word] : words)
            if (traits & bit) out += (out.empty() ? "" : ", ") + std::string(word);
    return out;
}

std::string settingLine(const GnSettingInfo& setting)
{
    std::string out = std::string("    ") + setting.pName + " = ";
    appendNumber(out, setting.value);
    if (setting.value < setting.minimum) out += " (by screen coverage)";
    out += " [";
    appendNumber(out, setting.minimum);
    out += ", ";
    appendNumber(out, setting.maximum);
    return out + "]  " + setting.pDescription;
}

void printList(const Device& device, const std::vector<GnMethodInfo>& methods)
{
    std::printf("on %s, %s\n", device.properties.deviceName, device.driver.c_str());
    for (const GnMethodInfo& method : methods) {
        const std::string traits =
            wordsOf(method.traits, {kLightWords, kEdgeWords, kExactWord, kNeedWords, kRoleWords});
        std::printf("%s: %s; %u round trips%s%s\n", method.pName, traits.c_str(), method.roundTrips,
                    method.pUnavailable ? "; unavailable: " : "", method.pUnavailable ? method.pUnavailable : "");
        std::printf("    %s\n", method.pSource);
        for (uint32_t i = 0; i < method.settingCount; ++i)
            std::printf("%s\n", settingLine(method.pSettings[i]).c_str());
    }
}

/// The folder of the method's algorithm below algorithms/; empty for a plug-in.
std::string familyOf(const GnMethodInfo& method)
{
    for (const BuiltinAlgorithm& algorithm : builtinRegistry().algorithms)
        if (std::string_view(method.pAlgorithm) == algorithm.entry->name) return algorithm.family;
    return {};
}

/// The method's name, as a link to its page where there is one.
std::string linkedName(const GnMethodInfo& method)
{
    const std::string name = std::string("`") + method.pName + "`", family = familyOf(method);
    return family.empty() ? name : "[" + name + "](../algorithms/" + family + "/" + method.pAlgorithm + ".md)";
}

const char* yesOrNo(bool yes)
{
    return yes ? "yes" : "no";
}

void printRow(const GnMethodInfo& method)
{
    std::printf("| %s | %s | %s | %s | %s | %s | %s | %u | %s | %s |\n", linkedName(method).c_str(),
                familyOf(method).c_str(), wordsOf(method.traits, {kLightWords}).c_str(),
                wordsOf(method.traits, {kEdgeWords}).c_str(), yesOrNo(method.traits & GN_TRAIT_EXACT_BIT),
                yesOrNo(!(method.traits & GN_TRAIT_CPU_GEOMETRY_BIT)), yesOrNo(method.roundTrips == 0),
                method.roundTrips, wordsOf(method.traits, {kRoleWords}).c_str(), method.pSource);
}

void printMarkdown(std::vector<GnMethodInfo> methods)
{
    std::stable_sort(methods.begin(), methods.end(),
                     [](const GnMethodInfo& a, const GnMethodInfo& b) { return familyOf(a) < familyOf(b); });
    std::printf("# Methods\n\nThis page is the output of `gnomon methods --markdown`. `gnomon methods` lists the "
                "settings as well.\n\n");
    std::printf("- *exact*: answers by geometry, not by samples.\n"
                "- *host-drawn casters*: whether it sees casters that the host draws itself.\n"
                "- *recorded*: whether `gnCmdRenderShadows()` can record it. Methods with GPU-CPU round trips "
                "need `gnSubmitShadows()`.\n"
                "- *fallback*: serves while the chosen method is not ready.\n\n");
    std::printf("| method | family | lights | shadow edges | exact | host-drawn casters | recorded | round trips | "
                "remarks | source |\n"
                "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
    for (const GnMethodInfo& method : methods)
        printRow(method);
}

} // namespace

int methodsCommand(bool markdown)
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
    if (markdown)
        printMarkdown(std::move(methods));
    else
        printList(*device, methods);
    gnDestroyContext(context);
    return 0;
}

} // namespace gnomon::demo
