#pragma once
// Objects behind handles that can be wrong: stale, foreign, made up.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <type_traits>
#include <utility>
#include <vector>

namespace gnomon {

/// 1 ... 65535, then from the start again.
inline std::uint16_t nextSlotMapTag() noexcept
{
    static std::atomic<std::uint32_t> made{0};
    return static_cast<std::uint16_t>(1 + made.fetch_add(1, std::memory_order_relaxed) % 0xffffu);
}

/// Objects by 64-bit handle: 24 bits slot, 24 bits generation of the slot, 16 bits tag of the map. The tag differs
/// between the maps of a process, so a handle of another kind or of another context is not found here. 0 is no handle.
/// Addresses stay as long as the object does. The caller locks.
template <typename T>
class SlotMap {
public:
    static constexpr std::uint32_t kMaxSlots = 1u << 24;

    SlotMap() : tag_(nextSlotMapTag()) {}

    /// @return the handle, or 0 if all slots are taken.
    std::uint64_t insert(T value)
    {
        if (free_.empty()) {
            if (slots_.size() == kMaxSlots) return 0;
            addSlot();
        }
        const std::uint32_t index = free_.back();
        Slot& slot = slots_[index];
        slot.value = std::move(value);
        slot.used = true;
        free_.pop_back();
        ++count_;
        return handleOf(index, slot.generation);
    }

    /// For so many insert()s, which then cannot fail. @return false if there are not as many slots
    bool makeRoom(std::size_t count)
    {
        if (count > free_.size() + (kMaxSlots - slots_.size())) return false;
        const auto before = static_cast<std::ptrdiff_t>(free_.size());
        while (free_.size() < count)
            addSlot();
        std::reverse(free_.begin() + before, free_.end()); // the last is taken first
        return true;
    }

    T* find(std::uint64_t handle) noexcept
    {
        Slot* slot = slotOf(handle);
        return slot ? &slot->value : nullptr;
    }
    const T* find(std::uint64_t handle) const noexcept { return const_cast<SlotMap*>(this)->find(handle); }

    /// Takes the object out, which cannot fail: there is room in the list of free slots. A slot whose generations are
    /// used up is never used again.
    /// @return a default-constructed T if the handle is wrong.
    T take(std::uint64_t handle) noexcept
    {
        static_assert(std::is_nothrow_default_constructible_v<T> && std::is_nothrow_move_constructible_v<T>);
        Slot* slot = slotOf(handle);
        if (!slot) return T{};
        T value = std::exchange(slot->value, T{});
        slot->used = false;
        --count_;
        if (++slot->generation < kGenerations) free_.push_back(indexOf(handle));
        return value;
    }

    /// Calls body(value) for every object in the order of the slots.
    template <typename Body>
    void forEach(Body&& body)
    {
        for (Slot& slot : slots_)
            if (slot.used) body(slot.value);
    }

    std::size_t size() const noexcept { return count_; }
    /// Number of the slot: small, reused after take().
    static std::uint32_t indexOf(std::uint64_t handle) noexcept
    {
        return static_cast<std::uint32_t>(handle & (kMaxSlots - 1));
    }

private:
    static constexpr std::uint32_t kGenerations = 1u << 24;

    struct Slot {
        T value{};
        std::uint32_t generation = 0;
        bool used = false;
    };

    void addSlot()
    {
        if (free_.capacity() <= slots_.size()) free_.reserve(2 * slots_.size() + 16); // for all: take() adds them
        slots_.emplace_back();
        free_.push_back(static_cast<std::uint32_t>(slots_.size() - 1));
    }

    std::uint64_t handleOf(std::uint32_t index, std::uint32_t generation) const noexcept
    {
        return static_cast<std::uint64_t>(tag_) << 48 | static_cast<std::uint64_t>(generation) << 24 | index;
    }

    Slot* slotOf(std::uint64_t handle) noexcept
    {
        const std::uint32_t index = indexOf(handle);
        if (index >= slots_.size()) return nullptr;
        Slot& slot = slots_[index];
        return slot.used && handle == handleOf(index, slot.generation) ? &slot : nullptr;
    }

    std::deque<Slot> slots_; // grows without moving what is there
    std::vector<std::uint32_t> free_;
    std::size_t count_ = 0;
    std::uint16_t tag_;
};

/// Non-dispatchable handles are pointers on 64-bit platforms and integers on others.
template <typename Handle>
Handle handleFromBits(std::uint64_t bits) noexcept
{
    if constexpr (std::is_pointer_v<Handle>)
        return reinterpret_cast<Handle>(static_cast<std::uintptr_t>(bits));
    else
        return bits;
}

template <typename Handle>
std::uint64_t bitsOf(Handle handle) noexcept
{
    if constexpr (std::is_pointer_v<Handle>)
        return reinterpret_cast<std::uintptr_t>(handle);
    else
        return handle;
}

} // namespace gnomon
