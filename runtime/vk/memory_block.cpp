#include "runtime/vk/memory_block.hpp"

#include <algorithm>

namespace gnomon {

namespace {

/// The result is about memory whatever the hook says: then other memory, or another method, may serve.
Error hookError(const GnMemoryRequest& request, const std::string& what)
{
    return {GN_ERROR_OUT_OF_DEVICE_MEMORY, "MemoryHook",
            "pfnAllocateMemory: " + what + ", asked for " + std::to_string(request.size) + " bytes of memory type " +
                std::to_string(request.memoryTypeIndex)};
}

Result<GnMemoryBlock> askHost(const DeviceTable& vk, const GnMemoryRequest& request)
{
    GnMemoryBlock block{};
    const VkResult result = vk.hostAllocateMemory(&request, &block, vk.hostUserData);
    if (result != VK_SUCCESS) return hookError(request, "VkResult " + std::to_string(result));
    if (!block.memory) return hookError(request, "memory is null");
    const bool aligned = block.offset % request.alignment == 0;
    if (aligned && (block.pMapped || !request.mapped)) return block;
    vk.hostFreeMemory(&block, vk.hostUserData);
    if (aligned) return hookError(request, "pMapped is null");
    return hookError(request, "offset is " + std::to_string(block.offset) + ", no multiple of " +
                                  std::to_string(request.alignment));
}

} // namespace

Result<GnMemoryBlock> obtainMemory(const DeviceTable& vk, const GnMemoryRequest& request)
{
    if (vk.hostAllocateMemory) return askHost(vk, request);
    GnMemoryBlock block{};
    const VkMemoryAllocateFlagsInfo flags{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO, nullptr, request.allocateFlags,
                                          0};
    const VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, request.allocateFlags ? &flags : nullptr,
                                    request.size, request.memoryTypeIndex};
    VkResult result = vk.vkAllocateMemory(vk.device, &info, vk.hostAllocator, &block.memory);
    if (result != VK_SUCCESS) return vulkanError(result, "vkAllocateMemory");
    if (!request.mapped) return block;
    result = vk.vkMapMemory(vk.device, block.memory, 0, VK_WHOLE_SIZE, 0, &block.pMapped);
    if (result == VK_SUCCESS) return block;
    giveBackMemory(vk, block);
    return vulkanError(result, "vkMapMemory");
}

void giveBackMemory(const DeviceTable& vk, const GnMemoryBlock& block) noexcept
{
    if (vk.hostFreeMemory)
        vk.hostFreeMemory(&block, vk.hostUserData);
    else
        vk.vkFreeMemory(vk.device, block.memory, vk.hostAllocator); // unmaps
}

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
