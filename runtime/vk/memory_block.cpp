#include "runtime/vk/memory_block.hpp"

#include <algorithm>

namespace gnomon {

std::optional<VkDeviceSize> DeviceMemory::Block::take(VkDeviceSize bytes, VkDeviceSize alignment)
{
    // n live slices leave at most n + 1 ranges between them; this one adds a slice.
    if (free.capacity() < live + 2) free.reserve(2 * (live + 2));
    for (std::size_t i = 0; i < free.size(); ++i) {
        const Range range = free[i];
        const VkDeviceSize start = (range.offset + alignment - 1) & ~(alignment - 1); // alignments are powers of two
        const VkDeviceSize before = start - range.offset;
        if (before + bytes > range.size) continue;
        const Range after{start + bytes, range.size - before - bytes};
        if (before) {
            free[i].size = before;
            if (after.size) free.insert(free.begin() + static_cast<std::ptrdiff_t>(i) + 1, after);
        } else if (after.size) {
            free[i] = after;
        } else {
            free.erase(free.begin() + static_cast<std::ptrdiff_t>(i));
        }
        ++live;
        return start;
    }
    return std::nullopt;
}

void DeviceMemory::Block::give(VkDeviceSize offset, VkDeviceSize bytes) noexcept
{
    --live;
    const auto after = std::lower_bound(free.begin(), free.end(), offset,
                                        [](const Range& range, VkDeviceSize value) { return range.offset < value; });
    const bool joinsBefore = after != free.begin() && (after - 1)->offset + (after - 1)->size == offset;
    const bool joinsAfter = after != free.end() && offset + bytes == after->offset;
    if (joinsBefore && joinsAfter) {
        (after - 1)->size += bytes + after->size;
        free.erase(after);
    } else if (joinsBefore) {
        (after - 1)->size += bytes;
    } else if (joinsAfter) {
        after->offset = offset;
        after->size += bytes;
    } else {
        free.insert(after, {offset, bytes});
    }
}

VkDeviceSize DeviceMemory::Block::largest() const noexcept
{
    VkDeviceSize most = 0;
    for (const Range& range : free)
        most = std::max(most, range.size);
    return most;
}

} // namespace gnomon
