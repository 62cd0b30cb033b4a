#include "runtime/base/arena.hpp"

#include <algorithm>

namespace gnomon {

void* FrameArena::Block::take(std::size_t bytesWanted, std::size_t alignment) noexcept
{
    void* place = bytes.get() + used;
    std::size_t space = size - used;
    if (!std::align(alignment, bytesWanted, place, space)) return nullptr;
    used = size - space + bytesWanted;
    return place;
}

void* FrameArena::allocate(std::size_t size, std::size_t alignment)
{
    const std::lock_guard lock(mutex_);
    if (current_ < blocks_.size()) {
        if (void* place = blocks_[current_].take(size, alignment)) return place;
    }
    // Any block may still have room: threads ask in a different order every frame, and a block skipped for good would
    // have to be replaced by a new one.
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
        if (void* place = blocks_[i].take(size, alignment)) {
            current_ = i;
            return place;
        }
    }
    const std::size_t capacity = std::max(blockSize_, size + alignment);
    blocks_.push_back({std::make_unique_for_overwrite<std::byte[]>(capacity), capacity, 0});
    current_ = blocks_.size() - 1;
    return blocks_.back().take(size, alignment);
}

void FrameArena::reset() noexcept
{
    const std::lock_guard lock(mutex_);
    for (Block& block : blocks_)
        block.used = 0;
    current_ = 0;
}

} // namespace gnomon
