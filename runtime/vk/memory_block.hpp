#pragma once
// One block of device memory, where it comes from, and the free ranges in it.
#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/vk/memory.hpp"

namespace gnomon {

/// Memory for a block: the host's, where it has hooks, or a VkDeviceMemory of its own, mapped where that is asked for.
Result<GnMemoryBlock> obtainMemory(const DeviceTable& vk, const GnMemoryRequest& request);
void giveBackMemory(const DeviceTable& vk, const GnMemoryBlock& block) noexcept;

struct DeviceMemory::Block {
    struct Range {
        VkDeviceSize offset = 0; ///< In the VkDeviceMemory.
        VkDeviceSize size = 0;
    };

    GnMemoryBlock given{}; ///< Without memory: an empty slot; slices name blocks by index.
    VkDeviceSize size = 0;
    std::uint32_t type = 0;
    bool linear = false; ///< Buffers. Apart from optimal images, so that bufferImageGranularity never matters.
    bool own = false;    ///< Made for a single large slice.
    std::uint32_t live = 0;
    std::vector<Range> free; ///< By offset; neighbours are merged.

    /// First fit. Keeps room in `free` so that give() need not allocate.
    std::optional<VkDeviceSize> take(VkDeviceSize bytes, VkDeviceSize alignment);
    void give(VkDeviceSize offset, VkDeviceSize bytes) noexcept;
    VkDeviceSize largest() const noexcept;
};

} // namespace gnomon
