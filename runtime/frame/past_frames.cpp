#include "runtime/frame/past_frames.hpp"

#include <algorithm>

namespace gnomon {

const PastFrame& PastFrames::at(std::uint64_t frame) const
{
    static const PastFrame gone;
    const PastFrame& note = ring_[frame % ring_.size()];
    return note.frame == frame ? note : gone;
}

bool PastFrames::disturbedBefore(std::uint64_t frame, std::uint64_t count) const
{
    return std::any_of(ring_.begin(), ring_.end(),
                       [&](const PastFrame& past) { return past.disturbed && past.frame + count > frame; });
}

void FrameIntervals::note(Time start, bool follows)
{
    if (follows) ms_[count_++ % ms_.size()] = std::chrono::duration<float, std::milli>(start - start_).count();
    start_ = start;
}

float FrameIntervals::newestMs() const
{
    return count_ ? ms_[(count_ - 1) % ms_.size()] : 0.0f;
}

double FrameIntervals::rate() const
{
    const std::size_t known = std::min<std::size_t>(count_, ms_.size());
    float sum = 0.0f;
    for (std::size_t i = 0; i < known; ++i)
        sum += ms_[i];
    return sum > 0.0f ? 1000.0 * static_cast<double>(known) / sum : 0.0;
}

} // namespace gnomon
