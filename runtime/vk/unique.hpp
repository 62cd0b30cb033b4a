#pragma once
#include <utility>

#include "runtime/vk/device_table.hpp"

namespace gnomon {

/// Owns one device-level Vulkan handle. It knows how to destroy and how to move; nothing else.
template <typename Handle, auto DeviceTable::*Destroy>
class VkUnique {
public:
    VkUnique() = default;
    VkUnique(const DeviceTable& vk, Handle handle) noexcept : vk_(&vk), handle_(handle) {}
    VkUnique(VkUnique&& other) noexcept { swap(other); }
    VkUnique& operator=(VkUnique other) noexcept
    {
        swap(other);
        return *this;
    }
    ~VkUnique()
    {
        if (handle_) (vk_->*Destroy)(vk_->device, handle_, vk_->hostAllocator);
    }

    Handle get() const noexcept { return handle_; }
    explicit operator bool() const noexcept { return handle_ != VK_NULL_HANDLE; }

private:
    void swap(VkUnique& other) noexcept
    {
        std::swap(vk_, other.vk_);
        std::swap(handle_, other.handle_);
    }
    const DeviceTable* vk_ = nullptr;
    Handle handle_ = VK_NULL_HANDLE;
};

using UniqueSemaphore = VkUnique<VkSemaphore, &DeviceTable::vkDestroySemaphore>;
using UniqueCommandPool = VkUnique<VkCommandPool, &DeviceTable::vkDestroyCommandPool>;
using UniqueQueryPool = VkUnique<VkQueryPool, &DeviceTable::vkDestroyQueryPool>;
using UniqueShaderModule = VkUnique<VkShaderModule, &DeviceTable::vkDestroyShaderModule>;

} // namespace gnomon
