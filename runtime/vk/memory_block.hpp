#pragma once
// One VkDeviceMemory and the free ranges in it.
#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/vk/memory.hpp"

namespace gnomon {

struct DeviceMemory::Block {
    struct Range {
        VkDeviceSize offset = 0;
        VkDeviceSize size = 0;
    };

    VkDeviceMemory memory = VK_NULL_HANDLE; ///< Null: an empty slot; slices name blocks by index.
    VkDeviceSize size = 0;
    std::uint32_t type = 0;
    bool linear = false; ///< Buffers. Apart from optimal images, so that bufferImageGranularity never matters.
    bool own = false;    ///< Made for a single large slice.
    std::uint32_t live = 0;
    std::byte* mapped = nullptr;
    std::vector<Range> free; ///< By offset; neighbours are merged.

    /// First fit. Keeps room in `free` so that give() need not allocate.
    std::optional<VkDeviceSize> take(VkDeviceSize bytes, VkDeviceSize alignment);
    void give(VkDeviceSize offset, VkDeviceSize bytes) noexcept;
    VkDeviceSize largest() const noexcept;
};

} // namespace gnomon
