#pragma once
// Whether a queue's timestamps tell the time. Some have none, some are constant, and some run backwards.
#include <cstdint>

namespace gnomon {

/// Ticks of a queue's timestamps, which are so many bits wide and begin again at their end.
class DeviceClock {
public:
    explicit DeviceClock(std::uint32_t validBits)
        : mask_(validBits >= 64 ? ~0ull : (1ull << validBits) - 1), usable_(validBits > 0)
    {
    }

    std::uint64_t between(std::uint64_t from, std::uint64_t to) const
    {
        return ((to & mask_) - (from & mask_)) & mask_;
    }

    /// A pair of stamps of one frame. @param aroundPass with a pass between, which takes some time
    void note(std::uint64_t from, std::uint64_t to, bool aroundPass)
    {
        const std::uint64_t ticks = between(from, to);
        backwards_ |= ticks > mask_ / 2; // half of 36 bits, the least that a queue may have, at 1 ns: 34 seconds
        passes_ |= aroundPass;
        moves_ |= ticks != 0;
    }
    /// @return whether the frame's stamps can be believed. After three such frames in a row that cannot, none are asked
    /// for.
    bool endFrame()
    {
        const bool believed = !backwards_ && (moves_ || !passes_);
        if (!believed) ++faults_;
        if (believed && passes_) faults_ = 0;
        usable_ = usable_ && faults_ < kMostFaults;
        moves_ = backwards_ = passes_ = false;
        return believed;
    }
    bool usable() const { return usable_; }

private:
    static constexpr std::uint32_t kMostFaults = 3;
    std::uint64_t mask_;
    std::uint32_t faults_ = 0;
    bool usable_, moves_ = false, backwards_ = false, passes_ = false;
};

} // namespace gnomon
