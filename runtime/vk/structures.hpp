#pragma once
// What builds of acceleration structures have in common.
#include "runtime/vk/device_table.hpp"

namespace gnomon {

/// Usage of buffers that builds read: vertices, indices, instances. Shaders may reach them by address as well.
inline constexpr VkBufferUsageFlags kBuildInput =
    VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
/// And of what they work in.
inline constexpr VkBufferUsageFlags kBuildScratch =
    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
/// And of what they make, which top levels and shaders reach by address.
inline constexpr VkBufferUsageFlags kBuildResult =
    VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;

/// @param alignment a power of two
constexpr VkDeviceSize alignedUp(VkDeviceSize offset, VkDeviceSize alignment)
{
    return (offset + alignment - 1) & ~(alignment - 1);
}

/// The geometry of a top level.
inline VkAccelerationStructureGeometryKHR instancesAt(VkDeviceAddress address)
{
    VkAccelerationStructureGeometryKHR geometry{};
    geometry.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR;
    geometry.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
    geometry.geometry.instances.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR;
    geometry.geometry.instances.data.deviceAddress = address;
    return geometry;
}

} // namespace gnomon
