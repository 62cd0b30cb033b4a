#pragma once
// Which frames are timed pass by pass, whatever the host asks.
#include <cstdint>

#include "runtime/cost/cost_model.hpp"

namespace gnomon {

/// One frame in this many carries full barriers and a pair of timestamps around every pass; they cost up to 20 % there.
constexpr std::uint64_t kTimedPeriod = 8;

/// What has just been switched on for the first time is known least: its first settled frames are timed as well.
class TimedFrames {
public:
    /// A light has a method that was not timed with it. One while the last one's timings are still to come is passed
    /// over, so that of frames that all bring changes four in seven are timed.
    void noteChange(std::uint64_t frame)
    {
        if (changedAt_ == 0 || frame >= changedAt_ + cost::kLearnFrames) changedAt_ = frame;
    }
    /// @param probedSince frame in which a probe began; 0: none runs
    bool has(std::uint64_t frame, std::uint64_t probedSince) const
    {
        return frame % kTimedPeriod == 0 || isSettled(frame, changedAt_) || isSettled(frame, probedSince);
    }

private:
    static bool isSettled(std::uint64_t frame, std::uint64_t since)
    {
        return since != 0 && frame >= since + cost::kSettleFrames && frame < since + cost::kLearnFrames;
    }
    std::uint64_t changedAt_ = 0; ///< Frame of the switches whose methods are timed next.
};

} // namespace gnomon
