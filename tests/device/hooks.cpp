#include "device/hooks.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace gnomon::test {
namespace {

/// Of the context being created: all functions are asked for then.
std::vector<Hook> current;

PFN_vkVoidFunction insteadOf(const char* name)
{
    const auto found =
        std::ranges::find_if(current, [name](const Hook& each) { return std::strcmp(each.name, name) == 0; });
    return found == current.end() ? nullptr : found->instead;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL hookedGetDeviceProcAddr(VkDevice handle, const char* name)
{
    const PFN_vkVoidFunction instead = insteadOf(name);
    return instead ? instead : vkGetDeviceProcAddr(handle, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL hookedGetInstanceProcAddr(VkInstance instance, const char* name)
{
    if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
        return reinterpret_cast<PFN_vkVoidFunction>(&hookedGetDeviceProcAddr);
    const PFN_vkVoidFunction instead = insteadOf(name);
    return instead ? instead : vkGetInstanceProcAddr(instance, name);
}

} // namespace

Hook withoutTimestamps()
{
    return hook(
        "vkGetPhysicalDeviceQueueFamilyProperties2",
        +[](VkPhysicalDevice handle, uint32_t* count, VkQueueFamilyProperties2* families) {
            vkGetPhysicalDeviceQueueFamilyProperties2(handle, count, families);
            for (uint32_t i = 0; families && i < *count; ++i)
                families[i].queueFamilyProperties.timestampValidBits = 0;
        });
}

HostOptions hooked(HostOptions base, std::vector<Hook> hooks)
{
    base.context = [hooks = std::move(hooks), last = std::move(base.context)](GnContextCreateInfo& info) {
        current = hooks;
        info.pfnGetInstanceProcAddr = &hookedGetInstanceProcAddr;
        if (last) last(info);
    };
    return base;
}

} // namespace gnomon::test
