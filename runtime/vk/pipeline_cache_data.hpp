#pragma once
// A pipeline cache as bytes that a host keeps from one run to the next. Vulkan asks that a driver is handed what it
// once gave and nothing else, so its data lie behind a header of ours with their checksum.
#include <string>
#include <string_view>

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan_core.h>

#include "runtime/base/result.hpp"

namespace gnomon {

/// @param driverData of vkGetPipelineCacheData, or none
std::string packCacheData(std::string_view driverData);

/// The driver's data within what packCacheData() made, or what is wrong with it: damaged, or of another device or
/// driver.
Result<std::string_view> unpackCacheData(std::string_view packed, const VkPhysicalDeviceProperties& device);

} // namespace gnomon
