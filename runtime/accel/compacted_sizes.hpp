#pragma once
// How much memory acceleration structures would take without what their builds left unused, as the device finds it.
#include <array>
#include <cstdint>

#include "runtime/vk/unique.hpp"

namespace gnomon {

/// Queries for the sizes of structures that frames have built, read when those frames are completed, without a wait.
/// One thread, the frame's.
class CompactedSizes {
public:
    explicit CompactedSizes(const DeviceTable& vk) : vk_(vk) {}

    /// Makes the queries, once. Where that fails there are none.
    void begin();

    /// A query for a structure that the frame builds. 0: none is free, and the structure stays as it is.
    std::uint64_t take(std::uint64_t frame);
    /// Bytes, or 0: not known, or told already.
    VkDeviceSize read(std::uint64_t query, std::uint64_t completedFrame);

    VkQueryPool pool() const { return pool_.get(); }
    static std::uint32_t indexOf(std::uint64_t query) { return static_cast<std::uint32_t>(query % kQueries); }

private:
    // Frames build few new meshes at a time, and ask for sizes two or three frames later.
    static constexpr std::uint64_t kQueries = 256;
    // Frames after which a query is free of which nobody has asked: its frame was dropped, or its structure is gone.
    static constexpr std::uint64_t kForgotten = 120;
    struct Taken {
        std::uint64_t query = 0; ///< 0: free.
        std::uint64_t frame = 0;
    };

    const DeviceTable& vk_;
    UniqueQueryPool pool_;
    bool tried_ = false;
    std::uint64_t round_ = 0; ///< Makes numbers of queries unique.
    std::array<Taken, kQueries> taken_{};
};

} // namespace gnomon
