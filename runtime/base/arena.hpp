#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>
#include <span>
#include <type_traits>
#include <vector>

namespace gnomon {

/// Memory that lives for one frame: a bump allocator over blocks that are kept, so that a steady frame allocates
/// nothing. Destructors are not run: trivially destructible types only. Safe from several threads.
class FrameArena {
public:
    explicit FrameArena(std::size_t blockSize = 1u << 20) : blockSize_(blockSize) {}

    void* allocate(std::size_t size, std::size_t alignment);

    template <typename T>
    T* make(const T& value = {})
    {
        static_assert(std::is_trivially_destructible_v<T>);
        return new (allocate(sizeof(T), alignof(T))) T(value);
    }

    /// Uninitialised array of a trivial type.
    template <typename T>
    std::span<T> array(std::size_t count)
    {
        static_assert(std::is_trivially_destructible_v<T>);
        return {static_cast<T*>(allocate(sizeof(T) * (count ? count : 1), alignof(T))), count};
    }

    template <typename T>
    std::span<T> copy(std::span<const T> values)
    {
        std::span<T> result = array<T>(values.size());
        if (!values.empty()) std::memcpy(result.data(), values.data(), values.size_bytes());
        return result;
    }

    /// Forgets everything; blocks stay.
    void reset() noexcept;
    std::size_t blockCount() const noexcept { return blocks_.size(); }

private:
    struct Block {
        std::unique_ptr<std::byte[]> bytes;
        std::size_t size = 0;
        std::size_t used = 0;
        void* take(std::size_t bytesWanted, std::size_t alignment) noexcept; ///< Null: does not fit.
    };
    std::mutex mutex_;
    std::vector<Block> blocks_;
    std::size_t blockSize_;
    std::size_t current_ = 0; ///< Block of the last success, tried first.
};

} // namespace gnomon
