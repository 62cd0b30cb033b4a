#pragma once
// Stands between gnomon and Vulkan: functions it is handed in place of the loader's.
#include <vector>

#include "device/fixture.hpp"

namespace gnomon::test {

struct Hook {
    const char* name; ///< "vk...", static storage.
    PFN_vkVoidFunction instead;
};

/// `instead` is what gnomon calls by that name; it may call Vulkan's own.
template <typename Function>
Hook hook(const char* name, Function* instead)
{
    return {name, reinterpret_cast<PFN_vkVoidFunction>(instead)};
}

/// Queues have no timestamps: gnomon learns no time on the GPU.
Hook withoutTimestamps();

/// Options of a host whose context takes its functions through the hooks.
HostOptions hooked(HostOptions base, std::vector<Hook> hooks);

} // namespace gnomon::test
