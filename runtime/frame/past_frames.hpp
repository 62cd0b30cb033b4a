#pragma once
// What is to be known of a frame when its timings come, two or more frames later.
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace gnomon {

struct PastFrame {
    std::uint64_t frame = 0;
    std::uint64_t methods = 0; ///< A stamp: equal where lights, and all methods at work, are.
    bool beside = false;       ///< Methods ran beside those of the plan: fades, a probe.
    bool disturbed = false;    ///< Its timings are not the methods' doing.
    bool timedUnasked = false; ///< Whatever the host asked.
    /// Whose pipelines it ran for the first time; that they did not fail is known.
    std::uint32_t warmup = UINT32_MAX;
    float cpuMs = 0.0f;
    double plannedMs = 0.0, cheapestMs = 0.0; ///< PlanReport's.
    double pixels = 0.0;                      ///< Of all views.
};

/// The newest frames: twice as many as may be in flight.
class PastFrames {
public:
    void begin(std::uint64_t frame)
    {
        newest_ = frame;
        present() = {.frame = frame};
    }
    PastFrame& present() { return ring_[newest_ % ring_.size()]; } ///< The one that begun last.
    const PastFrame& at(std::uint64_t frame) const;                ///< Empty where the ring has moved on.
    /// Whether one of the `count` frames before this one was disturbed.
    bool disturbedBefore(std::uint64_t frame, std::uint64_t count) const;

private:
    std::array<PastFrame, 16> ring_{};
    std::uint64_t newest_ = 0;
};

/// Time from frame to frame.
class FrameIntervals {
public:
    using Time = std::chrono::steady_clock::time_point;
    /// @param follows the frame before was this one's predecessor
    void note(Time start, bool follows);
    float newestMs() const; ///< 0: none yet.
    double rate() const;    ///< Frames a second, of the last thirty; 0: not known.

private:
    std::array<float, 30> ms_{};
    std::uint32_t count_ = 0;
    Time start_{};
};

} // namespace gnomon
