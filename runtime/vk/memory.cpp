#include "runtime/vk/memory.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "runtime/vk/memory_block.hpp"

namespace gnomon {
namespace {

constexpr VkDeviceSize kMiB = 1u << 20;
// Large enough that a frame's maps share few allocations, small enough to give back. Under a small limit an eighth of
// it, so that images, buffers and both kinds of host-visible memory get a block each.
constexpr VkDeviceSize kBlockSize = 64 * kMiB;
// Some drivers align images to 64 KiB: a smaller block would never hold two.
constexpr VkDeviceSize kLeastBlock = 64 * 1024;

VkDeviceSize blockSizeFor(VkDeviceSize limit)
{
    return std::clamp(limit / 8, std::min(limit, kLeastBlock), kBlockSize);
}

/// "24 MiB"; small sizes in KiB. Rounded up for what is needed, down for what is left.
std::string sizeText(VkDeviceSize bytes, bool roundUp)
{
    const VkDeviceSize unit = bytes < kMiB ? 1024 : kMiB;
    return std::to_string((bytes + (roundUp ? unit - 1 : 0)) / unit) + (unit == kMiB ? " MiB" : " KiB");
}

VkDeviceSize largestDeviceHeap(const VkPhysicalDeviceMemoryProperties& memory)
{
    VkDeviceSize largest = 0;
    for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
        if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
            largest = std::max(largest, memory.memoryHeaps[i].size);
    return largest;
}

/// Higher is better; negative: unusable. Types with other flags (lazily allocated, protected, AMD's device-coherent and
/// uncached ones) want a feature that the host may not have enabled, or a use that is not ours.
int rateType(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t type, MemoryUse use)
{
    constexpr VkMemoryPropertyFlags kPlain = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                             VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    const VkMemoryPropertyFlags flags = memory.memoryTypes[type].propertyFlags;
    if (flags & ~kPlain) return -1;
    const bool local = flags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    const bool visible = flags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
    const bool cached = flags & VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    if (use == MemoryUse::device) return (local ? 2 : 0) + (visible ? 0 : 1);
    if (!visible || !(flags & VK_MEMORY_PROPERTY_HOST_COHERENT_BIT)) return -1;
    if (use == MemoryUse::readback) return (cached ? 2 : 0) + (local ? 0 : 1);
    // Device-local memory is free to take where the host sees the whole heap; a 256 MiB window is left to the host.
    const bool wholeHeap =
        local && memory.memoryHeaps[memory.memoryTypes[type].heapIndex].size == largestDeviceHeap(memory);
    return (wholeHeap ? 4 : 0) + (local ? 0 : 2) + (cached ? 0 : 1); // uncached: write-combined
}

/// The type that serves `use` best among those whose bit is set and whose heap could ever hold as much; none: no value.
std::optional<std::uint32_t> bestType(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t types,
                                      MemoryUse use, VkDeviceSize bytes)
{
    int best = -1;
    std::optional<std::uint32_t> chosen;
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
        if (!(types & (1u << i)) || memory.memoryHeaps[memory.memoryTypes[i].heapIndex].size < bytes) continue;
        const int rating = rateType(memory, i, use);
        if (rating <= best) continue;
        best = rating;
        chosen = i;
    }
    return chosen;
}

/// Whether buffers of that use lie in the GPU's own memory, as long as there is room.
bool isLocal(const VkPhysicalDeviceMemoryProperties& memory, MemoryUse use)
{
    const std::optional<std::uint32_t> type = bestType(memory, UINT32_MAX, use, 0);
    return type && (memory.memoryTypes[*type].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) != 0;
}

} // namespace

DeviceMemory::DeviceMemory(const DeviceTable& vk, VkDeviceSize limit, std::vector<std::uint32_t> sharingFamilies)
    : vk_(vk), limit_(limit),
      uploadIsFar_(isLocal(vk.memory, MemoryUse::device) && !isLocal(vk.memory, MemoryUse::upload)),
      families_(std::move(sharingFamilies))
{
    families_.push_back(vk.queueFamily);
    std::sort(families_.begin(), families_.end());
    families_.erase(std::unique(families_.begin(), families_.end()), families_.end());
}

DeviceMemory::~DeviceMemory()
{
    for (Block& block : blocks_)
        freeBlock(block);
}

VkDeviceSize DeviceMemory::used() const noexcept
{
    const std::lock_guard lock(mutex_);
    return used_;
}

VkDeviceSize DeviceMemory::held() const noexcept
{
    const std::lock_guard lock(mutex_);
    return held_;
}

Result<MemorySlice> DeviceMemory::allocate(const VkMemoryRequirements& needs, MemoryUse use, bool linear)
{
    std::uint32_t types = needs.memoryTypeBits;
    std::optional<std::uint32_t> type = bestType(vk_.memory, types, use, needs.size);
    if (!type) return Error{GN_ERROR_FEATURE_MISSING, "MemoryType", "memory: no memory type of the device will do"};

    const std::lock_guard lock(mutex_);
    Result<MemorySlice> first = allocateOf(*type, needs, linear);
    // The next best type where a heap is full. Where our own limit is reached, no heap helps.
    while (!first && first.error().result == GN_ERROR_OUT_OF_DEVICE_MEMORY && limit_ - held_ >= needs.size) {
        types &= ~(1u << *type);
        type = bestType(vk_.memory, types, use, needs.size);
        if (!type) break;
        if (Result<MemorySlice> other = allocateOf(*type, needs, linear)) return other;
    }
    return first;
}

/// A slice of a memory type, in a block that is there or in a new one.
Result<MemorySlice> DeviceMemory::allocateOf(std::uint32_t type, const VkMemoryRequirements& needs, bool linear)
{
    const bool own = needs.size > blockSizeFor(limit_) / 2;
    for (std::size_t i = 0; !own && i < blocks_.size(); ++i) {
        Block& block = blocks_[i];
        if (!block.given.memory || block.own || block.type != type || block.linear != linear) continue;
        if (const auto offset = block.take(needs.size, needs.alignment)) {
            used_ += needs.size;
            return MemorySlice{static_cast<std::uint32_t>(i), *offset, needs.size};
        }
    }
    Result<std::uint32_t> made = makeBlock(needs, type, linear, own);
    if (!made) return made.error();
    const auto offset = blocks_[*made].take(needs.size, needs.alignment); // an empty block starts aligned
    used_ += needs.size;
    return MemorySlice{*made, *offset, needs.size};
}

/// A block that holds what is needed; everything it needs on the host is there before the device is asked.
Result<std::uint32_t> DeviceMemory::makeBlock(const VkMemoryRequirements& needs, std::uint32_t type, bool linear,
                                              bool own)
{
    // A VkDeviceMemory of the host's may hold other things beside the block, of the other kind perhaps.
    const VkDeviceSize granularity = std::max<VkDeviceSize>(vk_.properties.limits.bufferImageGranularity, 1);
    const VkDeviceSize grain = vk_.hostAllocateMemory ? granularity : 1;
    const VkDeviceSize bytes = (needs.size + grain - 1) / grain * grain;
    if (limit_ - held_ < bytes) freeEmptyBlocks();
    if (limit_ - held_ < bytes) return overLimit(bytes, type, linear);
    auto slot = std::find_if(blocks_.begin(), blocks_.end(), [](const Block& block) { return !block.given.memory; });
    if (slot == blocks_.end()) slot = blocks_.emplace(blocks_.end());
    slot->free.reserve(4);
    slot->free.clear();

    const VkDeviceSize reserve = std::min(blockSizeFor(limit_), limit_ - held_) / grain * grain;
    const VkMemoryPropertyFlags flags = vk_.memory.memoryTypes[type].propertyFlags;
    const bool addressed = linear && vk_.rayQuery();
    GnMemoryRequest request{.memoryTypeIndex = type,
                            .size = own ? bytes : std::max(bytes, reserve),
                            .alignment = std::max(needs.alignment, grain), // both are powers of two
                            .allocateFlags =
                                addressed ? VkMemoryAllocateFlags{VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT} : 0,
                            .mapped = linear && (flags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT)};
    Result<GnMemoryBlock> given = obtainMemory(vk_, request);
    if (!given && given.error().result == GN_ERROR_OUT_OF_DEVICE_MEMORY && request.size > bytes) {
        request.size = bytes; // the heap is nearly full: take no reserve
        given = obtainMemory(vk_, request);
    }
    if (!given) return given.error();
    ++vk_.objectsMade;
    held_ += request.size;
    slot->given = *given;
    slot->size = request.size;
    slot->type = type;
    slot->linear = linear;
    slot->own = own;
    slot->live = 0;
    slot->free.push_back({given->offset, request.size}); // within the reserve
    return static_cast<std::uint32_t>(slot - blocks_.begin());
}

/// What is left is what one slice could still get: the unallocated rest, or the largest hole in a block of the kind.
Error DeviceMemory::overLimit(VkDeviceSize bytes, std::uint32_t type, bool linear) const
{
    VkDeviceSize left = limit_ - held_;
    for (const Block& block : blocks_)
        if (block.given.memory && !block.own && block.type == type && block.linear == linear)
            left = std::max(left, block.largest());
    return {GN_ERROR_OUT_OF_DEVICE_MEMORY, "MemoryLimit",
            "memory: needs " + sizeText(bytes, true) + ", " + sizeText(left, false) + " left (limit " +
                sizeText(limit_, false) + ")"};
}

void DeviceMemory::release(const MemorySlice& slice) noexcept
{
    if (slice.block == UINT32_MAX) return;
    const std::lock_guard lock(mutex_);
    Block& block = blocks_[slice.block];
    block.give(slice.offset, slice.size);
    used_ -= slice.size;
    if (block.live) return;
    // One empty block of a kind stays, so that what is destroyed and made again in turn costs no allocation.
    const bool another = std::any_of(blocks_.begin(), blocks_.end(), [&block](const Block& other) {
        return &other != &block && other.given.memory && !other.live && other.type == block.type &&
               other.linear == block.linear;
    });
    if (block.own || another) freeBlock(block);
}

void DeviceMemory::freeEmptyBlocks() noexcept
{
    for (Block& block : blocks_)
        if (!block.live) freeBlock(block);
}

void DeviceMemory::freeBlock(Block& block) noexcept
{
    if (!block.given.memory) return;
    giveBackMemory(vk_, block.given);
    held_ -= block.size;
    block.given = {};
    block.free.clear();
}

VkDeviceMemory DeviceMemory::memoryOf(const MemorySlice& slice, std::byte** mapped) const noexcept
{
    const std::lock_guard lock(mutex_); // blocks_ may grow meanwhile
    const Block& block = blocks_[slice.block];
    auto* const first = static_cast<std::byte*>(block.given.pMapped);
    if (mapped) *mapped = first ? first + (slice.offset - block.given.offset) : nullptr;
    return block.given.memory;
}

} // namespace gnomon
